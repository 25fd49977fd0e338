//! Plain loops over eight lanes.

use umber_geometry::watertight::{DEPTH_ERROR, DETERMINANT_RANGE};

use super::{Isa, LaneHits, LaneMasks, Lanes, compile_traversals, instances, triangles};
use crate::{
    instance::InstanceBvh,
    mesh::MeshBvh,
    ray::TraversalRay,
    search::Search,
    wide::{WIDTH, WideNode},
};

/// Any processor.
pub(crate) struct Portable;

/// The larger; the second where the first is NaN, as the vector instruction gives it.
#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller; the second where the first is NaN.
#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

impl Isa for Portable {
    #[inline(always)]
    unsafe fn boxes(node: &WideNode, ray: &TraversalRay, reach: f32, near: &mut Lanes) -> u32 {
        let mut far = [reach; WIDTH];
        near.0 = [ray.t_min; WIDTH];
        for axis in 0..3 {
            let (o, first) = (ray.origin(axis), ray.near[axis]);
            let (low, high) = (&node.planes[2 * axis + first], &node.planes[2 * axis + (1 - first)]);
            for i in 0..WIDTH {
                near.0[i] = max((low[i] - o) * ray.inverse[axis], near.0[i]);
                far[i] = min((high[i] - o) * ray.inverse_far[axis], far[i]);
            }
        }
        (0..WIDTH).fold(0, |mask, i| mask | u32::from(near.0[i] <= far[i]) << i)
    }

    #[inline(always)]
    unsafe fn triangles(
        rows: *const f32,
        count: usize,
        ray: &TraversalRay,
        limit: f32,
        out: &mut LaneHits,
    ) -> LaneMasks {
        let mut masks = LaneMasks::NONE;
        let [kx, ky, kz] = ray.sheared.axes;
        let (o, s) = (ray.sheared.start, ray.sheared.shear);
        for lane in 0..count {
            let vertex = |v: usize| {
                // SAFETY: nine rows of `count` floats are readable.
                let at = |k: usize| unsafe { *rows.add((3 * v + k) * count + lane) };
                let z = at(kz) - o.z;
                ((at(kx) - o.x) - s.x * z, (at(ky) - o.y) - s.y * z, z)
            };
            let ((ax, ay, az), (bx, by, bz), (cx, cy, cz)) = (vertex(0), vertex(1), vertex(2));
            let u = cx * by - cy * bx;
            let v = ax * cy - ay * cx;
            let w = bx * ay - by * ax;
            if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
                continue;
            }
            let det = (u + v) + w;
            if u == 0.0 || v == 0.0 || w == 0.0 || !DETERMINANT_RANGE.contains(&det.abs()) {
                masks.again |= 1 << lane;
                continue;
            }
            let inverse = 1.0 / det;
            let (b0, b1, b2) = (u * inverse, v * inverse, w * inverse);
            let t = (b0 * (s.z * az) + b1 * (s.z * bz)) + b2 * (s.z * cz);
            let depth = az.abs().max(bz.abs()).max(cz.abs());
            let reach = [ax, ay, bx, by, cx, cy].into_iter().fold(depth, |m: f32, x| m.max(x.abs()));
            let spread = az.max(bz).max(cz) - az.min(bz).min(cz);
            let unsure = (DEPTH_ERROR * s.z.abs()) * (depth * det.abs() + spread * (reach * reach));
            if t.abs() * det.abs() <= unsure {
                masks.near |= 1 << lane;
            } else {
                masks.hit |= u32::from(t > ray.t_min && t <= limit) << lane;
            }
            out.t.0[lane] = t;
            [out.barycentrics[0].0[lane], out.barycentrics[1].0[lane], out.barycentrics[2].0[lane]] = [b0, b1, b2];
        }
        masks
    }

    compile_traversals!();
}
