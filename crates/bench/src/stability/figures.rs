//! The counts over a range of sizes and distances, as charts show them.

use serde::Serialize;
use umber_math::Vec3;

use super::{
    boxes,
    closed::{self, Inside},
    hits, offset,
    placed::{Placed, placements},
    roughness::{self, White},
    secondary,
    shapes::icosphere,
    slivers,
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
    vec![missed_hits(rays), slivers(rays), secondary_rays(rays), box_tests(rays)]
}

fn slivers(rays: usize) -> Figure {
    let names = ["Umber", "Möller–Trumbore, epsilon 10⁻⁶"];
    let title = "aimed inside of triangles one unit long, ten units away".to_string();
    let single = panel(title, "length over height (no unit)", names, decades(0, 6), |x| {
        let c = slivers::at(x, rays);
        [(c.missed, c.rays), (c.textbook_missed, c.rays)]
    });
    let title = "from inside of a closed sphere, flattened, at its edges and vertices: leaks".to_string();
    let closed = panel(title, "width over height (no unit)", names, decades(0, 6), |x| {
        slivers::closed(x, rays / 4).map(|c| (c.leaks, c.rays))
    });
    Figure { name: "stability_slivers", title: "Slivers", panels: vec![single, closed] }
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

/// A quantity over another.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// What it is of.
    pub name: String,
    /// Both quantities.
    pub points: Vec<[f64; 2]>,
}

/// Curves in one plane; the upright axis is logarithmic.
#[derive(Clone, Debug, Serialize)]
pub struct Plane {
    /// What is shown.
    pub title: &'static str,
    /// The quantity across, with its unit.
    pub x: &'static str,
    /// The upright quantity, with its unit.
    pub y: &'static str,
    /// What is shown for less.
    pub least: f64,
    /// Umber's first.
    pub curves: Vec<Curve>,
}

/// One chart of curves.
#[derive(Clone, Debug, Serialize)]
pub struct Curves {
    /// Name of its file, without an ending.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// Side by side.
    pub planes: Vec<Plane>,
}

/// `umber:fireflyClamp` of the chart, radiance: about ten times what the floor has on average.
pub const CLAMP: f32 = 10.0;
const ROUGHNESSES: [f64; 9] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.75, 1.0];

/// Energy and bright specks over roughness, from about `samples` samples at each point.
pub fn over_roughness(samples: usize) -> Curves {
    let over = |name: &str, of: &dyn Fn(f32) -> f64| Curve {
        name: name.into(),
        points: ROUGHNESSES.iter().map(|&r| [r, of(r as f32)]).collect(),
    };
    let energy = [(White::Plastic, "white plastic"), (White::Metal, "white metal: one scattering is followed")];
    let energy = energy.map(|(kind, name)| over(name, &|r| roughness::energy_error(kind, r, samples as u32 / 2)));
    let seeds = (samples / (1 << 14)).clamp(1, 64) as u32;
    let [free, clamped] = [0.0, CLAMP].map(|c| ROUGHNESSES.map(|r| roughness::caustic(r as f32, c, seeds)));
    let curve = |name: String, of: &dyn Fn(usize) -> f64| Curve {
        name,
        points: (0..ROUGHNESSES.len()).map(|i| [ROUGHNESSES[i], of(i)]).collect(),
    };
    let clamp_name = format!("umber:fireflyClamp = {CLAMP}, biased");
    let largest = vec![
        curve("Umber as it comes, without a clamp".into(), &|i| free[i].largest / free[i].mean),
        curve(clamp_name.clone(), &|i| clamped[i].largest / free[i].mean),
    ];
    let lost = vec![curve(clamp_name, &|i| 1.0 - clamped[i].mean / free[i].mean)];
    let x = "roughness (no unit)";
    let plane = |title, y, least, curves| Plane { title, x, y, least, curves };
    Curves {
        name: "stability_roughness",
        title: "From mirror to matt",
        planes: vec![
            plane("a white surface in a white room", "energy lost or won (part)", 1e-5, energy.into()),
            plane("a floor beside a metal sphere under a small lamp", "largest sample over the mean", 1.0, largest),
            plane("the same floor: what the clamp takes away", "light lost (part)", 1e-5, lost),
        ],
    }
}

/// One line a point of curves.
pub fn curves_text(curves: &Curves) -> String {
    let mut lines = vec![curves.title.to_string()];
    for plane in &curves.planes {
        lines.push(format!("  {}: {}", plane.title, plane.y));
        for curve in &plane.curves {
            let points = curve.points.iter().map(|[x, y]| format!("{x}: {y:.3e}")).collect::<Vec<_>>();
            lines.push(format!("    {}: {}", curve.name, points.join(", ")));
        }
    }
    lines.join("\n")
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
