//! Charts, on a light panel of their own so that they read on light and dark pages alike.

use std::path::Path;

use anyhow::{Result, anyhow};
use plotters::prelude::*;

use crate::{measure::PEERS, report::Report};

mod curves;
mod efficiency;
mod failures;

pub use curves::curves;
pub use efficiency::efficiency;
pub use failures::failures;

const PANEL: RGBColor = RGBColor(250, 250, 248);
const INK: RGBColor = RGBColor(40, 40, 44);
const RULE: RGBColor = RGBColor(214, 214, 210);
/// One a peer: apart in lightness too, for those who cannot tell the hues.
const COLORS: [RGBColor; 3] = [RGBColor(0, 90, 156), RGBColor(240, 168, 60), RGBColor(178, 82, 48)];
/// Pixels: width, height of the head, of each kind's panel and of the foot.
const SIZE: [u32; 4] = [1000, 64, 250, 30];

/// Speeds: a panel a kind of ray, a group a scene, a bar a peer.
///
/// # Errors
/// The file cannot be written.
pub fn rays(report: &Report, file: &Path) -> Result<()> {
    let Some(first) = report.scenes.first() else { return Ok(()) };
    let kinds: Vec<_> = first.kinds.iter().map(|k| k.kind).collect();
    let [width, head, panel, foot] = SIZE;
    let root = SVGBackend::new(file, (width, head + panel * kinds.len() as u32 + foot)).into_drawing_area();
    root.fill(&PANEL).map_err(failed)?;
    let (top, rest) = root.split_vertically(head);
    legend(&top, report)?;
    let (panels, bottom) = rest.split_vertically(panel * kinds.len() as u32);
    for (index, area) in panels.split_evenly((kinds.len(), 1)).iter().enumerate() {
        speeds(area, report, index, kinds[index])?;
    }
    let about = format!("{}; commit {}; {}", report.processor, report.commit, report.command);
    bottom.draw(&Text::new(about, (16, 8), font(13))).map_err(failed)?;
    root.present().map_err(failed)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn font(size: u32) -> TextStyle<'static> {
    ("sans-serif", size).into_font().color(&INK)
}

fn failed(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("chart: {error}")
}

fn legend(area: &Area<'_>, report: &Report) -> Result<()> {
    let title = format!("Millions of single rays a second on one thread, beside {}", report.peer);
    area.draw(&Text::new(title, (16, 10), font(20))).map_err(failed)?;
    for (i, peer) in PEERS.iter().enumerate() {
        let x = 16 + 150 * i as i32;
        area.draw(&Rectangle::new([(x, 42), (x + 14, 56)], COLORS[i].filled())).map_err(failed)?;
        area.draw(&Text::new(*peer, (x + 20, 42), font(14))).map_err(failed)?;
    }
    Ok(())
}

fn speeds(area: &Area<'_>, report: &Report, kind: usize, name: &str) -> Result<()> {
    let values = report.scenes.iter().flat_map(|s| &s.kinds[kind].mrays_per_second);
    let highest = values.copied().fold(0.0, f64::max).max(1e-3) * 1.12;
    let scenes = report.scenes.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .caption(name, font(16))
        .margin(8)
        .x_label_area_size(24)
        .y_label_area_size(52)
        .build_cartesian_2d(0.0..scenes, 0.0..highest)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .disable_x_axis()
        .y_labels(5)
        .axis_style(INK)
        .light_line_style(PANEL)
        .bold_line_style(RULE)
        .label_style(font(12))
        .draw()
        .map_err(failed)?;
    let part = 0.8 / PEERS.len() as f64;
    for (place, scene) in report.scenes.iter().enumerate() {
        for (peer, &speed) in scene.kinds[kind].mrays_per_second.iter().enumerate() {
            let left = place as f64 + 0.1 + part * peer as f64;
            let bar = Rectangle::new([(left, 0.0), (left + part * 0.92, speed)], COLORS[peer].filled());
            let number = Text::new(format!("{speed:.1}"), (left, speed + highest * 0.07), font(11));
            chart.draw_series([bar]).map_err(failed)?;
            chart.draw_series([number]).map_err(failed)?;
        }
        let below = area.get_pixel_range();
        let (x, _) = chart.backend_coord(&(place as f64 + 0.1, 0.0));
        let at = (x - below.0.start, below.1.end - below.1.start - 26);
        area.draw(&Text::new(scene.scene.clone(), at, font(13))).map_err(failed)?;
    }
    Ok(())
}
