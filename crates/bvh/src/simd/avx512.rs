//! Eight lanes of AVX-512: as AVX2, with mask registers.

use std::arch::x86_64::*;

use umber_geometry::watertight::DETERMINANT_RANGE;

use super::{Isa, LaneHits, LaneMasks, Lanes, compile_traversals, instances, triangles, x86};
use crate::{instance::InstanceBvh, mesh::MeshBvh, ray::TraversalRay, search::Search, wide::WideNode};

/// AVX-512 F, VL, DQ and BW, and all of AVX2.
pub(crate) struct Avx512;

/// Range operations: the smaller and the larger, with their own sign.
const SMALLER: i32 = 0b0100;
const LARGER: i32 = 0b0101;

/// Lanes where a comparison with `limit` holds for any of three.
macro_rules! any {
    ($compare:ident, $e:expr, $limit:expr) => {{
        let (u, v) = (_mm256_cmp_ps_mask::<$compare>($e.u, $limit), _mm256_cmp_ps_mask::<$compare>($e.v, $limit));
        u | v | _mm256_cmp_ps_mask::<$compare>($e.w, $limit)
    }};
}

impl Isa for Avx512 {
    #[inline(always)]
    unsafe fn boxes(node: &WideNode, ray: &TraversalRay, reach: f32, near: &mut Lanes) -> u32 {
        // SAFETY: the caller vouches for the unit.
        unsafe {
            let (x, y, z) = (x86::slab(node, ray, 0), x86::slab(node, ray, 1), x86::slab(node, ray, 2));
            // Of a NaN and a number, ranges give the number, the others do if it comes second.
            let enter =
                _mm256_max_ps(_mm256_range_ps::<LARGER>(y.0, z.0), _mm256_max_ps(x.0, _mm256_set1_ps(ray.t_min)));
            let leave = _mm256_min_ps(_mm256_range_ps::<SMALLER>(y.1, z.1), _mm256_min_ps(x.1, _mm256_set1_ps(reach)));
            _mm256_store_ps(near.0.as_mut_ptr(), enter);
            u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(enter, leave))
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
            let outside = any!(_CMP_LT_OQ, e, zero) & any!(_CMP_GT_OQ, e, zero);
            let candidates = !u32::from(outside) & ((1 << count) - 1);
            if candidates == 0 {
                return LaneMasks::NONE;
            }
            let det = x86::determinant(&e);
            let size = _mm256_andnot_ps(_mm256_set1_ps(-0.0), det);
            let small = _mm256_cmp_ps_mask::<_CMP_NGE_UQ>(size, _mm256_set1_ps(*DETERMINANT_RANGE.start()));
            let large = _mm256_cmp_ps_mask::<_CMP_NLE_UQ>(size, _mm256_set1_ps(*DETERMINANT_RANGE.end()));
            let t = x86::resolve(&e, det, ray, out);
            let again = u32::from(any!(_CMP_EQ_OQ, e, zero) | small | large) & candidates;
            let (distance, error) = x86::nearness(&e, det, t, ray);
            let near = u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(distance, error)) & candidates & !again;
            let after = _mm256_cmp_ps_mask::<_CMP_GT_OQ>(t, _mm256_set1_ps(ray.t_min));
            let before = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(t, _mm256_set1_ps(limit));
            let hit = u32::from(after & before) & candidates & !(again | near);
            LaneMasks { hit, near, again }
        }
    }

    compile_traversals!("avx2,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512vl,avx512dq,avx512bw");
}
