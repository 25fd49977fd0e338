//! The box and triangle tests, on eight lanes of any vector unit.

use umber_geometry::watertight::{DEPTH_ERROR, DETERMINANT_RANGE};

use super::{LaneHits, LaneMasks, Lanes, vector::Vector};
use crate::{ray::TraversalRay, wide::WideNode};

/// Which children's boxes the ray meets before `reach`, a bit a child, and where it enters them. `reach` is the
/// end of the search with [`FAR_SLACK`](crate::ray::FAR_SLACK).
///
/// # Safety
/// The processor has the unit.
#[inline(always)]
pub(super) unsafe fn boxes<V: Vector>(node: &WideNode, ray: &TraversalRay, reach: f32, near: &mut Lanes) -> u32 {
    // SAFETY: the caller vouches for the unit.
    unsafe {
        let (x, y, z) = (slab::<V>(node, ray, 0), slab::<V>(node, ray, 1), slab::<V>(node, ray, 2));
        let enter = V::largest([x.0, y.0, z.0], V::splat(ray.t_min));
        let leave = V::smallest([x.1, y.1, z.1], V::splat(reach));
        enter.store(&mut near.0);
        V::bits(enter.at_most(leave))
    }
}

/// Where the ray enters and leaves the children's slabs of one axis. NaN where the axis does not count.
///
/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn slab<V: Vector>(node: &WideNode, ray: &TraversalRay, axis: usize) -> (V, V) {
    // SAFETY: the caller vouches for the unit; a row of planes is eight floats, near indices are 0 or 1.
    unsafe {
        let planes = node.planes.as_ptr().add(2 * axis);
        let o = V::splat(ray.origin(axis));
        let low = V::load(planes.add(ray.near[axis]).cast()).sub(o);
        let high = V::load(planes.add(1 - ray.near[axis]).cast()).sub(o);
        (low.mul(V::splat(ray.inverse[axis])), high.mul(V::splat(ray.inverse_far[axis])))
    }
}

/// Tests `count` triangles, from 1 to 8. `rows` are their nine coordinate rows, `count` apart.
///
/// # Safety
/// The processor has the unit; `9 · count + 7` floats are readable at `rows`.
#[inline(always)]
pub(super) unsafe fn triangles<V: Vector>(
    rows: *const f32,
    count: usize,
    ray: &TraversalRay,
    limit: f32,
    out: &mut LaneHits,
) -> LaneMasks {
    // SAFETY: the caller vouches for the unit and for the floats.
    unsafe {
        let e = edges::<V>(rows, count, ray);
        let zero = V::splat(0.0);
        let below = V::or(V::or(e.u.less(zero), e.v.less(zero)), e.w.less(zero));
        let above = V::or(V::or(zero.less(e.u), zero.less(e.v)), zero.less(e.w));
        let candidates = !V::bits(V::and(below, above)) & ((1 << count) - 1);
        if candidates == 0 {
            return LaneMasks::NONE;
        }
        let det = e.u.add(e.v).add(e.w);
        let size = det.abs();
        let (least, most) = (V::splat(*DETERMINANT_RANGE.start()), V::splat(*DETERMINANT_RANGE.end()));
        let in_range = V::bits(V::and(least.at_most(size), size.at_most(most)));
        let at_edge = V::or(V::or(e.u.equal(zero), e.v.equal(zero)), e.w.equal(zero));
        let again = (V::bits(at_edge) | !in_range) & candidates;
        let t = resolve(&e, det, ray, out);
        let (distance, error) = nearness(&e, size, t, ray);
        let near = V::bits(distance.at_most(error)) & candidates & !again;
        let between = V::and(V::splat(ray.t_min).less(t), t.at_most(V::splat(limit)));
        let hit = V::bits(between) & candidates & !(again | near);
        LaneMasks { hit, near, again }
    }
}

/// Eight triangles in the ray's space: the edge functions, and the places of the vertices.
#[derive(Clone, Copy)]
struct Edges<V> {
    u: V,
    v: V,
    w: V,
    across: [V; 6],
    depths: [V; 3],
}

/// # Safety
/// As for [`triangles`].
#[inline(always)]
unsafe fn edges<V: Vector>(rows: *const f32, count: usize, ray: &TraversalRay) -> Edges<V> {
    // SAFETY: the caller's promise.
    unsafe {
        let [ax, ay, az] = vertex::<V>(rows, count, ray);
        let [bx, by, bz] = vertex::<V>(rows.add(3 * count), count, ray);
        let [cx, cy, cz] = vertex::<V>(rows.add(6 * count), count, ray);
        let u = cx.mul(by).sub(cy.mul(bx));
        let v = ax.mul(cy).sub(ay.mul(cx));
        let w = bx.mul(ay).sub(by.mul(ax));
        Edges { u, v, w, across: [ax, ay, bx, by, cx, cy], depths: [az, bz, cz] }
    }
}

/// One vertex of eight triangles, sheared; its depth is not yet scaled.
///
/// # Safety
/// The processor has the unit; `3 · count + 7` floats are readable at `rows`.
#[inline(always)]
unsafe fn vertex<V: Vector>(rows: *const f32, count: usize, ray: &TraversalRay) -> [V; 3] {
    // SAFETY: the caller's promise; axes are below three.
    unsafe {
        let ([kx, ky, kz], o, s) = (ray.sheared.axes, ray.sheared.start, ray.sheared.shear);
        let z = V::load(rows.add(kz * count)).sub(V::splat(o.z));
        let x = V::load(rows.add(kx * count)).sub(V::splat(o.x));
        let y = V::load(rows.add(ky * count)).sub(V::splat(o.y));
        [x.sub(V::splat(s.x).mul(z)), y.sub(V::splat(s.y).mul(z)), z]
    }
}

/// Writes barycentrics and parameter of each lane; gives the parameter.
///
/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn resolve<V: Vector>(e: &Edges<V>, det: V, ray: &TraversalRay, out: &mut LaneHits) -> V {
    // SAFETY: the caller's promise.
    unsafe {
        let inverse = V::splat(1.0).div(det);
        let scale = V::splat(ray.sheared.shear.z);
        let (b0, b1, b2) = (e.u.mul(inverse), e.v.mul(inverse), e.w.mul(inverse));
        let [az, bz, cz] = e.depths;
        let t = b0.mul(scale.mul(az)).add(b1.mul(scale.mul(bz))).add(b2.mul(scale.mul(cz)));
        t.store(&mut out.t.0);
        b0.store(&mut out.barycentrics[0].0);
        b1.store(&mut out.barycentrics[1].0);
        b2.store(&mut out.barycentrics[2].0);
        t
    }
}

/// Where the first is at most the second, the hit may be on either side of the ray's origin, by rounding. `size` is
/// that of the determinant.
///
/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn nearness<V: Vector>(e: &Edges<V>, size: V, t: V, ray: &TraversalRay) -> (V, V) {
    // SAFETY: the caller's promise.
    unsafe {
        let [az, bz, cz] = e.depths;
        let [ax, ay, bx, by, cx, cy] = e.across;
        let depth = az.abs().max(bz.abs()).max(cz.abs());
        let across = ax.abs().max(ay.abs()).max(bx.abs().max(by.abs())).max(cx.abs().max(cy.abs()));
        let reach = depth.max(across);
        let spread = az.max(bz).max(cz).sub(az.min(bz).min(cz)).mul(reach.mul(reach));
        let scale = V::splat(DEPTH_ERROR * ray.sheared.shear.z.abs());
        (t.abs().mul(size), scale.mul(depth.mul(size).add(spread)))
    }
}
