//! Quantities over roughness: linear across, logarithmic upright.

use plotters::style::text_anchor::{HPos, Pos, VPos};
use umber_bench::stability::figures::{Curves, Plane};

use super::efficiency::{decades, ticks};
use super::*;
use crate::report::Failures;

/// Pixels: width of a plane, height of the head, of the planes and of the foot.
const BESIDE: u32 = 440;
const HEAD: u32 = 46;
const HEIGHT: u32 = 380;
const FOOT: u32 = 30;

/// A plane each beside the other, a line a curve.
///
/// # Errors
/// The file cannot be written.
pub fn curves(what: &Curves, report: &Failures, file: &Path) -> Result<()> {
    let count = what.planes.len() as u32;
    let root = SVGBackend::new(file, (BESIDE * count, HEAD + HEIGHT + FOOT)).into_drawing_area();
    root.fill(&PANEL).map_err(failed)?;
    let (top, rest) = root.split_vertically(HEAD);
    top.draw(&Text::new(what.title, (16, 12), font(20))).map_err(failed)?;
    let (planes, bottom) = rest.split_vertically(HEIGHT);
    for (plane, area) in what.planes.iter().zip(planes.split_evenly((1, count as usize))) {
        draw(plane, &area)?;
    }
    let about = format!("{}; commit {}; {}", report.processor, report.commit, report.command);
    bottom.draw(&Text::new(about, (16, 8), font(12))).map_err(failed)?;
    root.present().map_err(failed)
}

fn draw(plane: &Plane, area: &Area<'_>) -> Result<()> {
    let place = |p: &[f64; 2]| (p[0], p[1].max(plane.least).log10());
    let points = || plane.curves.iter().flat_map(|c| &c.points);
    let y = decades(points().map(|p| p[1].max(plane.least)), 0.3);
    let x = -0.05..1.05;
    let (title, below) = area.split_vertically(26 + 18 * plane.curves.len() as u32);
    title.draw(&Text::new(plane.title, (16, 2), font(14))).map_err(failed)?;
    for (i, curve) in plane.curves.iter().enumerate() {
        let row = 32 + 18 * i as i32;
        title.draw(&PathElement::new([(16, row), (40, row)], COLORS[i].stroke_width(3))).map_err(failed)?;
        title.draw(&Text::new(curve.name.clone(), (48, row - 6), font(13))).map_err(failed)?;
    }
    let mut chart = ChartBuilder::on(&below)
        .margin(8)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(x.clone(), y.clone())
        .map_err(failed)?;
    for (at, _) in ticks(&y) {
        chart.draw_series([PathElement::new([(x.start, at), (x.end, at)], RULE.stroke_width(1))]).map_err(failed)?;
    }
    for (i, curve) in plane.curves.iter().enumerate().rev() {
        let line: Vec<_> = curve.points.iter().map(place).collect();
        chart.draw_series([PathElement::new(line.clone(), COLORS[i].stroke_width(2))]).map_err(failed)?;
        chart.draw_series(line.into_iter().map(|p| Circle::new(p, 4, COLORS[i].filled()))).map_err(failed)?;
    }
    let range = below.get_pixel_range();
    let at = |point: (f64, f64)| {
        let (px, py) = chart.backend_coord(&point);
        (px - range.0.start, py - range.1.start)
    };
    let middle = font(12).pos(Pos::new(HPos::Center, VPos::Top));
    let bottom = at((0.0, y.start)).1;
    for value in [0.0, 0.2, 0.4, 0.6, 0.8, 1.0] {
        below
            .draw(&Text::new(format!("{value}"), (at((value, y.start)).0, bottom + 6), middle.clone()))
            .map_err(failed)?;
    }
    below.draw(&Text::new(plane.x, (at((0.5, y.start)).0, bottom + 24), middle.clone())).map_err(failed)?;
    let right = font(12).pos(Pos::new(HPos::Right, VPos::Center));
    for (value, text) in ticks(&y) {
        let (px, py) = at((x.start, value));
        below.draw(&Text::new(text, (px - 8, py), right.clone())).map_err(failed)?;
    }
    let (_, center) = at((x.start, (y.start + y.end) / 2.0));
    let turned = font(12).transform(FontTransform::Rotate270).pos(Pos::new(HPos::Center, VPos::Top));
    below.draw(&Text::new(plane.y, (10, center), turned)).map_err(failed)
}
