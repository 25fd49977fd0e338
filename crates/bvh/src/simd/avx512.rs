//! Eight lanes of AVX-512: as AVX2, with mask registers.

use std::arch::x86_64::*;

use super::{Isa, compile_traversals, instances, triangles, vector::Vector, walk, x86};
use crate::{instance::InstanceBvh, mesh::MeshBvh, ray::TraversalRay, search::Search, wide::WideTree};

/// A register of AVX-512 F, VL, DQ and BW, used with all of AVX2.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(__m256);

/// Range operations: the smaller and the larger, with their own sign.
const SMALLER: i32 = 0b0100;
const LARGER: i32 = 0b0101;

impl Vector for Avx512 {
    type Mask = __mmask8;

    x86::arithmetic!();

    #[inline(always)]
    unsafe fn less(self, b: Self) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LT_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    unsafe fn at_most(self, b: Self) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    unsafe fn equal(self, b: Self) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { _mm256_cmp_ps_mask::<_CMP_EQ_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    unsafe fn or(a: __mmask8, b: __mmask8) -> __mmask8 {
        a | b
    }
    #[inline(always)]
    unsafe fn and(a: __mmask8, b: __mmask8) -> __mmask8 {
        a & b
    }
    #[inline(always)]
    unsafe fn bits(mask: __mmask8) -> u32 {
        u32::from(mask)
    }
    /// In two steps instead of three: of a NaN and a number, ranges give the number.
    #[inline(always)]
    unsafe fn largest(three: [Self; 3], start: Self) -> Self {
        let [x, y, z] = three;
        // SAFETY: the caller vouches for the unit.
        unsafe { Self(_mm256_range_ps::<LARGER>(y.0, z.0)).max(x.max(start)) }
    }
    /// See [`Vector::largest`].
    #[inline(always)]
    unsafe fn smallest(three: [Self; 3], start: Self) -> Self {
        let [x, y, z] = three;
        // SAFETY: the caller vouches for the unit.
        unsafe { Self(_mm256_range_ps::<SMALLER>(y.0, z.0)).min(x.min(start)) }
    }
}

impl Isa for Avx512 {
    compile_traversals!("avx2,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512vl,avx512dq,avx512bw");
}
