//! Boxes alone.

use arbitrary::Arbitrary;
use umber_bvh::BoundsBvh;
use umber_geometry::watertight::ShearedRay;
use umber_math::{Bounds3, Ray};

use super::{
    scene::{Mesh, RayInput},
    values::Triple,
};

/// Most boxes.
const MAX_BOXES: usize = 256;
/// Most rays.
const MAX_RAYS: usize = 16;

/// What is checked.
#[derive(Arbitrary, Debug)]
pub struct Input {
    boxes: Vec<BoxInput>,
    /// How often they are repeated, each time moved on.
    copies: Option<(u8, Triple)>,
    rays: Vec<RayInput>,
}

#[derive(Arbitrary, Debug)]
enum BoxInput {
    Corners(Triple, Triple),
    /// Around points.
    Around(Triple, Triple),
    /// Around one point.
    At(Triple),
}

impl BoxInput {
    fn bounds(&self) -> Bounds3 {
        match self {
            Self::Corners(min, max) => Bounds3 { min: min.vector(), max: max.vector() },
            Self::Around(a, b) => Bounds3::of_points([a.point(), b.point()]),
            Self::At(p) => Bounds3::of_points([p.point()]),
        }
    }
}

/// Every sound box that a ray meets is visited, once; no other kind ever is, and a nearer end is respected.
pub fn check(input: Input) {
    let boxes = boxes(&input);
    let bvh = BoundsBvh::build(&boxes);
    assert!(bvh.memory_bytes() > 0);
    let aims = aims(&boxes);
    for ray in input.rays.iter().take(MAX_RAYS) {
        let ray = ray.ray(|on| aims.point_on(on));
        check_all_met(&bvh, &boxes, &ray);
        check_nearest(&bvh, &boxes, &ray);
    }
}

fn boxes(input: &Input) -> Vec<Bounds3> {
    let mut boxes: Vec<Bounds3> = input.boxes.iter().take(MAX_BOXES).map(BoxInput::bounds).collect();
    let count = boxes.len();
    let (copies, step) = input.copies.map_or((0, None), |(n, step)| (usize::from(n), Some(step.vector())));
    for i in 0..(count * copies).min(MAX_BOXES - count) {
        let (Some(step), before) = (step, boxes[i]) else { break };
        boxes.push(Bounds3 { min: before.min + step, max: before.max + step });
    }
    boxes
}

/// Triangles across the boxes, for rays to be aimed at.
fn aims(boxes: &[Bounds3]) -> Mesh {
    let corners = |b: &Bounds3| [b.corners()[0], b.corners()[7], b.corners()[3]];
    let triangles = (0..boxes.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { points: boxes.iter().flat_map(corners).collect(), triangles }
}

fn is_sound(b: &Bounds3) -> bool {
    !b.is_empty() && b.min.is_finite() && b.max.is_finite()
}

fn check_all_met(bvh: &BoundsBvh, boxes: &[Bounds3], ray: &Ray) {
    let mut met = vec![0; boxes.len()];
    bvh.traverse(ray, |i, end| {
        assert_eq!(end.to_bits(), ray.t_max.to_bits());
        met[i as usize] += 1;
        None
    });
    for (i, (b, met)) in boxes.iter().zip(met).enumerate() {
        let entry = entry(b, ray).filter(|_| is_sound(b));
        assert!(met <= usize::from(is_sound(b)), "box {i} {b:?} {ray:?}");
        assert!(met == 1 || entry.is_none(), "box {i} {b:?} is met at {entry:?}, {ray:?}");
    }
}

/// Ends the ray where it enters a box, as one that looks for the first primitive does.
fn check_nearest(bvh: &BoundsBvh, boxes: &[Bounds3], ray: &Ray) {
    let mut nearest = ray.t_max;
    bvh.traverse(ray, |i, end| {
        assert_eq!(end.to_bits(), nearest.to_bits());
        let entry = entry(&boxes[i as usize], ray)? as f32;
        nearest = nearest.min(entry);
        Some(entry)
    });
    let want = boxes.iter().filter(|b| is_sound(b)).filter_map(|b| entry(b, ray)).fold(f64::INFINITY, f64::min);
    assert!(want == f64::INFINITY || nearest == want as f32, "{nearest} is not {want}, {ray:?}");
}

/// Where a ray enters a box before its end, in double precision; none where rounding could tell otherwise.
fn entry(b: &Bounds3, ray: &Ray) -> Option<f64> {
    let (o, d) = (ray.origin.0.as_dvec3(), ray.direction.0.as_dvec3());
    if ShearedRay::new(ray).is_none() || ray.t_max.is_nan() {
        return None;
    }
    let (mut near, mut far) = (f64::from(ray.t_min).max(0.0), f64::from(ray.t_max));
    for axis in 0..3 {
        let (low, high) = (f64::from(b.min[axis]) - o[axis], f64::from(b.max[axis]) - o[axis]);
        if d[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (t0, t1) = (low / d[axis], high / d[axis]);
        (near, far) = (near.max(t0.min(t1)), far.min(t0.max(t1)));
    }
    (near <= far * (1.0 - 1e-12)).then_some(near)
}
