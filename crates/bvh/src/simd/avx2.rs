//! Eight lanes of AVX2.

use std::arch::x86_64::*;

use super::{Isa, compile_traversals, instances, triangles, vector::Vector, walk, x86};
use crate::{instance::InstanceBvh, mesh::MeshBvh, ray::TraversalRay, search::Search, wide::WideTree};

/// A register of AVX2, used with the bit instructions that come with it.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(__m256);

impl Vector for Avx2 {
    type Mask = __m256;

    x86::arithmetic!();

    #[inline(always)]
    unsafe fn less(self, b: Self) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    unsafe fn at_most(self, b: Self) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    unsafe fn equal(self, b: Self) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    unsafe fn or(a: __m256, b: __m256) -> __m256 {
        // SAFETY: the caller vouches for the unit.
        unsafe { _mm256_or_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn and(a: __m256, b: __m256) -> __m256 {
        // SAFETY: the caller vouches for the unit.
        unsafe { _mm256_and_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn bits(mask: __m256) -> u32 {
        // SAFETY: the caller vouches for the unit.
        unsafe { _mm256_movemask_ps(mask) as u32 }
    }
}

impl Isa for Avx2 {
    compile_traversals!("avx2,bmi1,bmi2,lzcnt,popcnt");
}
