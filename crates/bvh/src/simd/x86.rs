//! What AVX2 and AVX-512 have in common: the arithmetic on eight lanes.
//!
//! Multiplication and addition are never fused, so that hits are those of the scalar test.

use std::arch::x86_64::*;

use umber_geometry::watertight::DEPTH_ERROR;

use super::LaneHits;
use crate::{ray::TraversalRay, wide::WideNode};

/// Where the ray enters and leaves the children's slabs of one axis. NaN where the axis does not count.
///
/// # Safety
/// The processor has AVX.
#[inline(always)]
pub(super) unsafe fn slab(node: &WideNode, ray: &TraversalRay, axis: usize) -> (__m256, __m256) {
    // SAFETY: the caller vouches for the unit; rows of planes are aligned to 32 bytes, near indices are 0 or 1.
    unsafe {
        let planes = node.planes.as_ptr().add(2 * axis);
        let o = _mm256_set1_ps(ray.origin(axis));
        let low = _mm256_sub_ps(_mm256_load_ps(planes.add(ray.near[axis]).cast()), o);
        let high = _mm256_sub_ps(_mm256_load_ps(planes.add(1 - ray.near[axis]).cast()), o);
        let enter = _mm256_mul_ps(low, _mm256_set1_ps(ray.inverse[axis]));
        (enter, _mm256_mul_ps(high, _mm256_set1_ps(ray.inverse_far[axis])))
    }
}

/// Eight triangles in the ray's space: the edge functions, and the depths of the vertices.
#[derive(Clone, Copy)]
pub(super) struct Edges {
    pub u: __m256,
    pub v: __m256,
    pub w: __m256,
    across: [__m256; 6],
    depths: [__m256; 3],
}

/// # Safety
/// The processor has AVX; `9 · count + 7` floats are readable at `rows`.
#[inline(always)]
pub(super) unsafe fn edges(rows: *const f32, count: usize, ray: &TraversalRay) -> Edges {
    // SAFETY: the caller's promise.
    unsafe {
        let (ax, ay, az) = vertex(rows, count, ray);
        let (bx, by, bz) = vertex(rows.add(3 * count), count, ray);
        let (cx, cy, cz) = vertex(rows.add(6 * count), count, ray);
        let (u, v, w) = (edge(cx, by, cy, bx), edge(ax, cy, ay, cx), edge(bx, ay, by, ax));
        Edges { u, v, w, across: [ax, ay, bx, by, cx, cy], depths: [az, bz, cz] }
    }
}

/// One vertex of eight triangles, sheared; its depth is not yet scaled.
///
/// # Safety
/// The processor has AVX; `3 · count + 7` floats are readable at `rows`.
#[inline(always)]
unsafe fn vertex(rows: *const f32, count: usize, ray: &TraversalRay) -> (__m256, __m256, __m256) {
    // SAFETY: the caller's promise; axes are below three.
    unsafe {
        let ([kx, ky, kz], o, s) = (ray.sheared.axes, ray.sheared.start, ray.sheared.shear);
        let z = _mm256_sub_ps(_mm256_loadu_ps(rows.add(kz * count)), _mm256_set1_ps(o.z));
        let x = _mm256_sub_ps(_mm256_loadu_ps(rows.add(kx * count)), _mm256_set1_ps(o.x));
        let y = _mm256_sub_ps(_mm256_loadu_ps(rows.add(ky * count)), _mm256_set1_ps(o.y));
        let x = _mm256_sub_ps(x, _mm256_mul_ps(_mm256_set1_ps(s.x), z));
        let y = _mm256_sub_ps(y, _mm256_mul_ps(_mm256_set1_ps(s.y), z));
        (x, y, z)
    }
}

/// # Safety
/// The processor has AVX.
#[inline(always)]
unsafe fn edge(px: __m256, qy: __m256, py: __m256, qx: __m256) -> __m256 {
    // SAFETY: the caller's promise.
    unsafe { _mm256_sub_ps(_mm256_mul_ps(px, qy), _mm256_mul_ps(py, qx)) }
}

/// The determinant.
///
/// # Safety
/// The processor has AVX.
#[inline(always)]
pub(super) unsafe fn determinant(e: &Edges) -> __m256 {
    // SAFETY: the caller's promise.
    unsafe { _mm256_add_ps(_mm256_add_ps(e.u, e.v), e.w) }
}

/// Writes barycentrics and parameter of each lane; gives the parameter.
///
/// # Safety
/// The processor has AVX.
#[inline(always)]
pub(super) unsafe fn resolve(e: &Edges, det: __m256, ray: &TraversalRay, out: &mut LaneHits) -> __m256 {
    // SAFETY: the caller's promise; lanes are aligned to 32 bytes.
    unsafe {
        let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), det);
        let scale = _mm256_set1_ps(ray.sheared.shear.z);
        let (b0, b1, b2) = (_mm256_mul_ps(e.u, inverse), _mm256_mul_ps(e.v, inverse), _mm256_mul_ps(e.w, inverse));
        let [az, bz, cz] = e.depths;
        let t = _mm256_add_ps(
            _mm256_add_ps(_mm256_mul_ps(b0, _mm256_mul_ps(scale, az)), _mm256_mul_ps(b1, _mm256_mul_ps(scale, bz))),
            _mm256_mul_ps(b2, _mm256_mul_ps(scale, cz)),
        );
        _mm256_store_ps(out.t.0.as_mut_ptr(), t);
        _mm256_store_ps(out.barycentrics[0].0.as_mut_ptr(), b0);
        _mm256_store_ps(out.barycentrics[1].0.as_mut_ptr(), b1);
        _mm256_store_ps(out.barycentrics[2].0.as_mut_ptr(), b2);
        t
    }
}

/// Where the first is at most the second, the hit may be on either side of the ray's origin, by rounding.
///
/// # Safety
/// The processor has AVX.
#[inline(always)]
pub(super) unsafe fn nearness(e: &Edges, det: __m256, t: __m256, ray: &TraversalRay) -> (__m256, __m256) {
    // SAFETY: the caller's promise.
    unsafe {
        let sign = _mm256_set1_ps(-0.0);
        let larger = |m: __m256, x: &__m256| _mm256_max_ps(m, _mm256_andnot_ps(sign, *x));
        let depth = e.depths.iter().fold(_mm256_setzero_ps(), larger);
        let reach = e.across.iter().fold(depth, larger);
        let det = _mm256_andnot_ps(sign, det);
        let [az, bz, cz] = e.depths;
        let (high, low) = (_mm256_max_ps(_mm256_max_ps(az, bz), cz), _mm256_min_ps(_mm256_min_ps(az, bz), cz));
        let spread = _mm256_mul_ps(_mm256_sub_ps(high, low), _mm256_mul_ps(reach, reach));
        let scale = _mm256_set1_ps(DEPTH_ERROR * ray.sheared.shear.z.abs());
        let unsure = _mm256_mul_ps(scale, _mm256_add_ps(_mm256_mul_ps(depth, det), spread));
        (_mm256_mul_ps(_mm256_andnot_ps(sign, t), det), unsure)
    }
}
