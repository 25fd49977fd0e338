//! Error over time, a line a method; both axes logarithmic.

use std::ops::Range;

use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::failures::power;
use super::*;
use crate::report::{EfficiencyScene, Method};

/// Pixels: width, height of the head without the legend, of a line of it, of the plane and of the foot.
const WIDTH: u32 = 760;
const HEAD: u32 = 44;
const LINE: u32 = 18;
const HEIGHT: u32 = 420;
const FOOT: u32 = 84;
/// Beside the peers': Umber's modes, then every peer; apart in lightness too.
const METHODS: [RGBColor; 6] = [
    RGBColor(0, 90, 156),
    RGBColor(96, 170, 226),
    RGBColor(20, 40, 84),
    RGBColor(178, 82, 48),
    RGBColor(240, 168, 60),
    RGBColor(120, 120, 116),
];
/// Pixels: radius of the ring around a picture on the front.
const RING: i32 = 8;
/// Of them, Umber's.
const OWN: usize = 3;

/// Error over seconds of rendering, a line a method. Ringed: what no other picture is both faster and more exact than.
///
/// # Errors
/// The file cannot be written.
pub fn efficiency(scene: &EfficiencyScene, file: &Path) -> Result<()> {
    let head = HEAD + LINE * (scene.methods.len() as u32 + 1);
    let root = SVGBackend::new(file, (WIDTH, head + HEIGHT + FOOT)).into_drawing_area();
    root.fill(&PANEL).map_err(failed)?;
    let (top, rest) = root.split_vertically(head);
    let (plane, bottom) = rest.split_vertically(HEIGHT);
    let title = format!("{}, {} × {}: error over time", scene.name, scene.width, scene.height);
    top.draw(&Text::new(title, (16, 12), font(20))).map_err(failed)?;
    let colors = colors(&scene.methods);
    let row = |i: usize| (HEAD + LINE * i as u32) as i32 + 6;
    for (i, (method, color)) in scene.methods.iter().zip(&colors).enumerate() {
        let y = row(i);
        top.draw(&PathElement::new([(16, y), (40, y)], color.stroke_width(3))).map_err(failed)?;
        top.draw(&Circle::new((28, y), 4, color.filled())).map_err(failed)?;
        top.draw(&Text::new(about(method), (48, y - 6), font(13))).map_err(failed)?;
    }
    let y = row(scene.methods.len());
    top.draw(&Circle::new((28, y), RING, INK.stroke_width(1))).map_err(failed)?;
    let front = "the Pareto front: no other picture against the same reference is both faster and more exact";
    top.draw(&Text::new(front, (48, y - 6), font(13))).map_err(failed)?;
    draw(scene, &colors, &plane)?;
    let absent: String = scene.absent.iter().map(|peer| format!("; {peer}")).collect();
    let lines = [
        format!("against: {}{absent}", scene.reference),
        format!("{}; commit {}; median of {} rounds in turn", scene.processor, scene.commit, scene.rounds),
        scene.command.clone(),
    ];
    for (line, y) in lines.into_iter().zip([8, 30, 52]) {
        bottom.draw(&Text::new(line, (16, y), font(12))).map_err(failed)?;
    }
    root.present().map_err(failed)
}

/// Umber's modes have the first colours, the peers those after.
fn colors(methods: &[Method]) -> Vec<RGBColor> {
    let (mut own, mut peers) = (0..OWN, OWN..METHODS.len());
    methods.iter().map(|m| if m.is_own() { own.next() } else { peers.next() }.map_or(INK, |i| METHODS[i])).collect()
}

fn about(method: &Method) -> String {
    let reference = if method.own_reference { ", against its own reference" } else { "" };
    let start = format!("first picture of 64 samples after {:.1} s from the start", method.from_start_seconds);
    let name = if method.is_own() { &method.name } else { &method.about };
    if method.points.is_empty() {
        return format!("{name}: no picture within the time");
    }
    format!("{name}{reference}; {start}")
}

fn draw(scene: &EfficiencyScene, colors: &[RGBColor], area: &Area<'_>) -> Result<()> {
    let points = || scene.methods.iter().flat_map(|m| &m.points);
    let x = decades(points().map(|p| p.seconds), 0.12);
    let y = decades(points().map(|p| p.error), 0.2);
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .margin_right(18)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(x.clone(), y.clone())
        .map_err(failed)?;
    for (at, _) in ticks(&x) {
        chart.draw_series([PathElement::new([(at, y.start), (at, y.end)], RULE.stroke_width(1))]).map_err(failed)?;
    }
    for (at, _) in ticks(&y) {
        chart.draw_series([PathElement::new([(x.start, at), (x.end, at)], RULE.stroke_width(1))]).map_err(failed)?;
    }
    // Umber's last, so that nothing hides it
    for (method, color) in scene.methods.iter().zip(colors).rev() {
        let line: Vec<_> = method.points.iter().map(|p| (p.seconds.log10(), p.error.log10())).collect();
        chart.draw_series([PathElement::new(line.clone(), color.stroke_width(2))]).map_err(failed)?;
        chart.draw_series(line.iter().map(|at| Circle::new(*at, 4, color.filled()))).map_err(failed)?;
        let best = method.points.iter().zip(line).filter(|(p, _)| p.on_front);
        chart.draw_series(best.map(|(_, at)| Circle::new(at, RING, INK.stroke_width(1)))).map_err(failed)?;
    }
    let range = area.get_pixel_range();
    let at = |point: (f64, f64)| {
        let (px, py) = chart.backend_coord(&point);
        (px - range.0.start, py - range.1.start)
    };
    let below = font(12).pos(Pos::new(HPos::Center, VPos::Top));
    let bottom = at((x.start, y.start)).1;
    for (value, text) in ticks(&x) {
        area.draw(&Text::new(text, (at((value, y.start)).0, bottom + 6), below.clone())).map_err(failed)?;
    }
    let beside = font(12).pos(Pos::new(HPos::Right, VPos::Center));
    for (value, text) in ticks(&y) {
        let (px, py) = at((x.start, value));
        area.draw(&Text::new(text, (px - 8, py), beside.clone())).map_err(failed)?;
    }
    let (center, _) = at(((x.start + x.end) / 2.0, y.start));
    area.draw(&Text::new("seconds of rendering (wall time, all cores)", (center, bottom + 26), below))
        .map_err(failed)?;
    let (_, center) = at((x.start, (y.start + y.end) / 2.0));
    let turned = font(12).transform(FontTransform::Rotate270).pos(Pos::new(HPos::Center, VPos::Top));
    area.draw(&Text::new("error (relMSE, no unit)", (10, center), turned)).map_err(failed)
}

/// What logarithms of positive values span, with some room.
pub(super) fn decades(values: impl Iterator<Item = f64>, room: f64) -> Range<f64> {
    let logs: Vec<f64> = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10).collect();
    let lowest = logs.iter().copied().fold(f64::MAX, f64::min);
    let highest = logs.iter().copied().fold(f64::MIN, f64::max);
    if logs.is_empty() { 0.0..1.0 } else { lowest - room..highest + room }
}

/// Powers of ten in a range of logarithms, by their names; twos and fives too where there are few.
pub(super) fn ticks(range: &Range<f64>) -> Vec<(f64, String)> {
    let whole = || range.start.floor() as i32..=range.end.ceil() as i32;
    let inside = |at: &(f64, String)| range.contains(&at.0);
    let powers: Vec<_> = whole().map(|e| (f64::from(e), power(e))).filter(inside).collect();
    if powers.len() >= 4 {
        return powers;
    }
    let finer = whole().flat_map(|e| {
        [1.0, 2.0, 5.0].map(|m: f64| {
            let value = m * 10f64.powi(e);
            let text =
                if (-2..=3).contains(&e) { format!("{}", (value * 1e4).round() / 1e4) } else { format!("{value:e}") };
            (value.log10(), text)
        })
    });
    finer.filter(inside).collect()
}
