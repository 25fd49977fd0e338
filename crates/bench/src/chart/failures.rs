//! Failures per ray, over size or distance; both axes logarithmic, with a floor for none.

use std::ops::Range;

use umber_bench::stability::figures::{Figure, Panel, Point, Series};

use super::*;
use crate::report::Failures;

/// Pixels: width of one panel alone and of each of several, height of the head, of the panels and of the foot.
const WIDE: u32 = 720;
const BESIDE: u32 = 560;
const HEAD: u32 = 46;
const HEIGHT: u32 = 400;
const FOOT: u32 = 30;
/// Decades between the least rate that the rays can tell and the line for none.
const BELOW: f64 = 0.8;

/// Failures per ray: a panel each beside the other, a line a method.
///
/// # Errors
/// The file cannot be written.
pub fn failures(figure: &Figure, report: &Failures, file: &Path) -> Result<()> {
    let count = figure.panels.len() as u32;
    let width = if count == 1 { WIDE } else { BESIDE * count };
    let root = SVGBackend::new(file, (width, HEAD + HEIGHT + FOOT)).into_drawing_area();
    root.fill(&PANEL).map_err(failed)?;
    let (top, rest) = root.split_vertically(HEAD);
    top.draw(&Text::new(figure.title, (16, 12), font(20))).map_err(failed)?;
    let (panels, bottom) = rest.split_vertically(HEIGHT);
    for (panel, area) in figure.panels.iter().zip(panels.split_evenly((1, count as usize))) {
        draw(panel, &area)?;
    }
    let about = format!("{}; commit {}; {}", report.processor, report.commit, report.command);
    bottom.draw(&Text::new(about, (16, 8), font(12))).map_err(failed)?;
    root.present().map_err(failed)
}

/// Decades of the rates that are shown: down to one ray of all, the next lower whole one.
fn decades(panel: &Panel) -> i32 {
    let rays = panel.series.iter().flat_map(|s| &s.points).map(|p| p.rays).max().unwrap_or(1);
    (rays.max(10) as f64).log10().ceil() as i32
}

fn draw(panel: &Panel, area: &Area<'_>) -> Result<()> {
    let lowest = -f64::from(decades(panel));
    let none = lowest - BELOW;
    let place = |p: &Point| {
        let rate = p.failures as f64 / p.rays.max(1) as f64;
        (f64::from(p.x).log10(), if p.failures == 0 { none } else { rate.log10() })
    };
    let xs = || panel.series.iter().flat_map(|s| &s.points).map(|p| place(p).0);
    let x: Range<f64> = xs().fold(f64::MAX, f64::min) - 0.4..xs().fold(f64::MIN, f64::max) + 0.4;
    let (title, below) = area.split_vertically(26 + 18 * panel.series.len() as u32);
    title.draw(&Text::new(panel.title.clone(), (16, 2), font(14))).map_err(failed)?;
    for (i, series) in panel.series.iter().enumerate() {
        let y = 32 + 18 * i as i32;
        let line = [(16, y), (40, y)];
        title.draw(&PathElement::new(line, COLORS[i].stroke_width(3))).map_err(failed)?;
        title.draw(&Circle::new((28, y), 4, COLORS[i].filled())).map_err(failed)?;
        title.draw(&Text::new(series.name, (48, y - 6), font(13))).map_err(failed)?;
    }
    let mut chart = ChartBuilder::on(&below)
        .margin(8)
        .margin_right(18)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(x.clone(), none - 0.3..0.3)
        .map_err(failed)?;
    let ticks: Vec<f64> = std::iter::once(none).chain((lowest as i32..=0).map(f64::from)).collect();
    for &y in &ticks {
        let line = PathElement::new([(x.start, y), (x.end, y)], RULE.stroke_width(1));
        chart.draw_series([line]).map_err(failed)?;
    }
    axes(&below, &chart, panel.x, &x, &ticks)?;
    // Umber's last, so that nothing hides it.
    for (i, series) in panel.series.iter().enumerate().rev() {
        line(&mut chart, series, COLORS[i], place)?;
    }
    Ok(())
}

type Plane<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;

fn line(
    chart: &mut Plane<'_, '_>,
    series: &Series,
    color: RGBColor,
    place: impl Fn(&Point) -> (f64, f64),
) -> Result<()> {
    let points: Vec<_> = series.points.iter().filter(|p| p.rays > 0).map(place).collect();
    chart.draw_series([PathElement::new(points.clone(), color.stroke_width(2))]).map_err(failed)?;
    chart.draw_series(points.into_iter().map(|p| Circle::new(p, 4, color.filled()))).map_err(failed)?;
    Ok(())
}

/// Numbers along both axes, and what they are: written by hand, since the lowest is no power of ten.
fn axes(area: &Area<'_>, chart: &Plane<'_, '_>, name: &str, x: &Range<f64>, ticks: &[f64]) -> Result<()> {
    use plotters::style::text_anchor::{HPos, Pos, VPos};
    let range = area.get_pixel_range();
    let at = |point: (f64, f64)| {
        let (px, py) = chart.backend_coord(&point);
        (px - range.0.start, py - range.1.start)
    };
    let bottom = at((x.start, ticks[0])).1 + 22;
    let middle = font(12).pos(Pos::new(HPos::Center, VPos::Top));
    for exponent in x.start.ceil() as i32..=x.end.floor() as i32 {
        let (px, _) = at((f64::from(exponent), 0.0));
        area.draw(&Text::new(power(exponent), (px, bottom), middle.clone())).map_err(failed)?;
    }
    let (center, _) = at(((x.start + x.end) / 2.0, 0.0));
    area.draw(&Text::new(name, (center, bottom + 20), middle.clone())).map_err(failed)?;
    let right = font(12).pos(Pos::new(HPos::Right, VPos::Center));
    for (i, &y) in ticks.iter().enumerate() {
        let (px, py) = at((x.start, y));
        let label = if i == 0 { "none".to_string() } else { power(y as i32) };
        area.draw(&Text::new(label, (px - 8, py), right.clone())).map_err(failed)?;
    }
    let (_, py) = at((x.start, (ticks[0]) / 2.0));
    let turned = font(12).transform(FontTransform::Rotate270).pos(Pos::new(HPos::Center, VPos::Top));
    area.draw(&Text::new("failures per ray", (10, py), turned)).map_err(failed)
}

/// A power of ten, as one writes it.
pub(super) fn power(exponent: i32) -> String {
    match exponent {
        0 => "1".into(),
        1 => "10".into(),
        2 => "100".into(),
        _ => format!("10{}", exponent.to_string().chars().map(superscript).collect::<String>()),
    }
}

fn superscript(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        _ => c.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(c),
    }
}
