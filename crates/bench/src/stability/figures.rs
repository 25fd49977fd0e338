//! The counts over a range of sizes and distances, as charts show them.

use serde::Serialize;
use umber_math::Vec3;

use super::{
    boxes,
    closed::{self, Inside},
    hits, offset,
    placed::{Placed, placements},
    secondary,
    shapes::icosphere,
};

/// Failures of rays.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Point {
    /// Size or distance, in units.
    pub x: f32,
    /// Rays that failed.
    pub failures: u64,
    /// Rays.
    pub rays: u64,
}

/// One method.
#[derive(Clone, Debug, Serialize)]
pub struct Series {
    /// What method, and what counts as failure where there are several.
    pub name: &'static str,
    /// In the order of `x`.
    pub points: Vec<Point>,
}

/// Methods against one quantity.
#[derive(Clone, Debug, Serialize)]
pub struct Panel {
    /// What rays, and what counts as failure.
    pub title: String,
    /// The quantity, with its unit.
    pub x: &'static str,
    /// Umber's first.
    pub series: Vec<Series>,
}

/// One chart.
#[derive(Clone, Debug, Serialize)]
pub struct Figure {
    /// Name of its file, without an ending.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// Side by side.
    pub panels: Vec<Panel>,
}

/// Powers of ten.
fn decades(from: i32, to: i32) -> impl Iterator<Item = f32> {
    (from..=to).map(|e| 10f64.powi(e) as f32)
}

/// A panel of a series a name, from failures and rays of each at each `x`.
fn panel<const N: usize>(
    title: String,
    x: &'static str,
    names: [&'static str; N],
    range: impl Iterator<Item = f32>,
    mut count: impl FnMut(f32) -> [(u64, u64); N],
) -> Panel {
    let mut series = names.map(|name| Series { name, points: Vec::new() });
    for x in range {
        for (series, (failures, rays)) in series.iter_mut().zip(count(x)) {
            series.points.push(Point { x, failures, rays });
        }
    }
    Panel { title, x, series: series.into() }
}

const DISTANCE: &str = "distance from the origin, units";

/// All charts, from `rays` rays at each point.
pub fn all(rays: usize) -> Vec<Figure> {
    vec![missed_hits(rays), secondary_rays(rays), box_tests(rays)]
}

fn missed_hits(rays: usize) -> Figure {
    let names = ["Umber", "Möller–Trumbore, epsilon 10⁻⁶"];
    let sizes =
        panel("aimed inside triangles at the origin".into(), "triangle size, units", names, decades(-6, 5), |x| {
            let c = hits::at(x, 0.0, rays);
            [(c.missed, c.rays), (c.textbook_missed, c.rays)]
        });
    let closed = |radius: f32, distance: f32| {
        let center = offset(distance);
        let mesh = icosphere(2).map(|p| p * radius + center);
        let (scene, inside) = (mesh.scene(), Inside { center, half: Vec3::splat(radius * 0.5) });
        let ours = closed::from_outside(&mesh, inside, rays, |r, c| closed::walk(&mesh, &scene, r, c));
        let textbook = closed::from_outside(&mesh, inside, rays, |r, c| closed::textbook_walk(&mesh, r, c));
        [ours, textbook].map(|c| (c.leaks + c.doubles, c.rays))
    };
    let title = "through edges and vertices of a closed sphere of radius 1: leaks, double hits";
    let distances = panel(title.into(), DISTANCE, names, decades(0, 5), |x| closed(1.0, x));
    Figure { name: "stability_hits", title: "Missed hits", panels: vec![sizes, distances] }
}

fn secondary_rays(rays: usize) -> Figure {
    let names =
        ["Umber, both", "fixed offset 10⁻⁴: meets its own triangle", "fixed offset 10⁻⁴: passes over a near one"];
    let turned = |radius: f32, distance: f32| {
        let transforms = placements(f64::from(distance), f64::from(radius)).swap_remove(1).transforms;
        let leaving = secondary::outwards(&Placed::new(icosphere(3), &transforms), rays);
        let near = secondary::near_lid(&transforms, Vec3::ZERO, rays).unwrap_or_default();
        let ours = leaving.own + leaving.wrong + near.own + near.wrong;
        [(ours, leaving.rays + near.rays), (leaving.textbook, leaving.rays), (near.textbook, near.rays)]
    };
    let at_origin =
        panel("a turned sphere at the origin".into(), "radius, units", names, decades(-5, 5), |x| turned(x, 0.0));
    let title = "a turned sphere of radius 1000".to_string();
    let far = panel(title, DISTANCE, names, decades(0, 6), |x| turned(1e3, x));
    Figure { name: "stability_secondary", title: "Rays that leave surfaces", panels: vec![at_origin, far] }
}

fn box_tests(rays: usize) -> Figure {
    let names = ["Umber", "plain slabs, single precision"];
    let title = "at the edges of flat triangles of one unit: hits lost to box tests".to_string();
    let distances = panel(title, DISTANCE, names, decades(0, 7), |x| {
        let c = boxes::at(x, rays);
        [(c.lost, c.hits), (c.textbook_lost, c.hits)]
    });
    Figure { name: "stability_boxes", title: "Box tests", panels: vec![distances] }
}

/// One line a point: where, and how many failed by each method.
pub fn text(figure: &Figure) -> String {
    let mut lines = vec![figure.title.to_string()];
    for panel in &figure.panels {
        lines.push(format!("  {}", panel.title));
        let Some(first) = panel.series.first() else { continue };
        for (i, point) in first.points.iter().enumerate() {
            let failed = panel.series.iter().map(|s| (s.name, s.points[i]));
            let failed = failed.map(|(name, p)| format!("{name} {} of {}", p.failures, p.rays));
            lines.push(format!("    {} {:e}: {}", panel.x, point.x, failed.collect::<Vec<_>>().join("; ")));
        }
    }
    lines.join("\n")
}
