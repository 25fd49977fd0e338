//! Eight lanes of AVX2.

use std::arch::x86_64::*;

use umber_geometry::watertight::DETERMINANT_RANGE;

use super::{Isa, LaneHits, LaneMasks, Lanes, compile_traversals, instances, triangles, x86};
use crate::{instance::InstanceBvh, mesh::MeshBvh, ray::TraversalRay, search::Search, wide::WideNode};

/// AVX2 and the bit instructions that come with it.
pub(crate) struct Avx2;

/// Lanes where a comparison with `limit` holds for any of three.
macro_rules! any {
    ($compare:ident, $e:expr, $limit:expr) => {{
        let (u, v) = (_mm256_cmp_ps::<$compare>($e.u, $limit), _mm256_cmp_ps::<$compare>($e.v, $limit));
        _mm256_or_ps(_mm256_or_ps(u, v), _mm256_cmp_ps::<$compare>($e.w, $limit))
    }};
}

impl Isa for Avx2 {
    #[inline(always)]
    unsafe fn boxes(node: &WideNode, ray: &TraversalRay, reach: f32, near: &mut Lanes) -> u32 {
        // SAFETY: the caller vouches for the unit.
        unsafe {
            let (x, y, z) = (x86::slab(node, ray, 0), x86::slab(node, ray, 1), x86::slab(node, ray, 2));
            // Of a NaN and a number, these give the number if it comes second.
            let enter = _mm256_max_ps(z.0, _mm256_max_ps(y.0, _mm256_max_ps(x.0, _mm256_set1_ps(ray.t_min))));
            let leave = _mm256_min_ps(z.1, _mm256_min_ps(y.1, _mm256_min_ps(x.1, _mm256_set1_ps(reach))));
            _mm256_store_ps(near.0.as_mut_ptr(), enter);
            _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave)) as u32
        }
    }

    #[inline(always)]
    unsafe fn triangles(
        rows: *const f32,
        count: usize,
        ray: &TraversalRay,
        limit: f32,
        out: &mut LaneHits,
    ) -> LaneMasks {
        // SAFETY: the caller vouches for the unit and for the floats.
        unsafe {
            let e = x86::edges(rows, count, ray);
            let zero = _mm256_setzero_ps();
            let outside = _mm256_and_ps(any!(_CMP_LT_OQ, e, zero), any!(_CMP_GT_OQ, e, zero));
            let candidates = !(_mm256_movemask_ps(outside) as u32) & ((1 << count) - 1);
            if candidates == 0 {
                return LaneMasks::NONE;
            }
            let det = x86::determinant(&e);
            let size = _mm256_andnot_ps(_mm256_set1_ps(-0.0), det);
            let small = _mm256_cmp_ps::<_CMP_NGE_UQ>(size, _mm256_set1_ps(*DETERMINANT_RANGE.start()));
            let large = _mm256_cmp_ps::<_CMP_NLE_UQ>(size, _mm256_set1_ps(*DETERMINANT_RANGE.end()));
            let unsure = _mm256_or_ps(any!(_CMP_EQ_OQ, e, zero), _mm256_or_ps(small, large));
            let t = x86::resolve(&e, det, ray, out);
            let again = _mm256_movemask_ps(unsure) as u32 & candidates;
            let (distance, error) = x86::nearness(&e, det, t, ray);
            let near = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(distance, error)) as u32 & candidates & !again;
            let after = _mm256_cmp_ps::<_CMP_GT_OQ>(t, _mm256_set1_ps(ray.t_min));
            let before = _mm256_cmp_ps::<_CMP_LE_OQ>(t, _mm256_set1_ps(limit));
            let hit = _mm256_movemask_ps(_mm256_and_ps(after, before)) as u32 & candidates & !(again | near);
            LaneMasks { hit, near, again }
        }
    }

    compile_traversals!("avx2,bmi1,bmi2,lzcnt,popcnt");
}
