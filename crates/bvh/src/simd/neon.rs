//! Twice four lanes of NEON, which every 64-bit Arm processor has.

use std::arch::aarch64::*;

use super::{Isa, compile_traversals, instances, triangles, vector::Vector, walk};
use crate::{instance::InstanceBvh, mesh::MeshBvh, ray::TraversalRay, search::Search, wide::WideTree};

/// Two registers of NEON.
#[derive(Clone, Copy)]
pub(crate) struct Neon(float32x4_t, float32x4_t);

impl Vector for Neon {
    type Mask = (uint32x4_t, uint32x4_t);

    #[inline(always)]
    unsafe fn splat(x: f32) -> Self {
        // SAFETY: the caller vouches for the unit.
        unsafe { Self(vdupq_n_f32(x), vdupq_n_f32(x)) }
    }
    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: the caller vouches for the unit and for eight floats.
        unsafe { Self(vld1q_f32(from), vld1q_f32(from.add(4))) }
    }
    #[inline(always)]
    unsafe fn store(self, to: &mut [f32; 8]) {
        // SAFETY: the caller vouches for the unit.
        unsafe {
            vst1q_f32(to.as_mut_ptr(), self.0);
            vst1q_f32(to.as_mut_ptr().add(4), self.1);
        }
    }
    #[inline(always)]
    unsafe fn abs(self) -> Self {
        // SAFETY: the caller vouches for the unit.
        unsafe { Self(vabsq_f32(self.0), vabsq_f32(self.1)) }
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        // SAFETY: the caller vouches for the unit.
        unsafe { Self(vaddq_f32(self.0, b.0), vaddq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        // SAFETY: the caller vouches for the unit.
        unsafe { Self(vsubq_f32(self.0, b.0), vsubq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        // SAFETY: the caller vouches for the unit.
        unsafe { Self(vmulq_f32(self.0, b.0), vmulq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    unsafe fn div(self, b: Self) -> Self {
        // SAFETY: the caller vouches for the unit.
        unsafe { Self(vdivq_f32(self.0, b.0), vdivq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    unsafe fn max(self, b: Self) -> Self {
        // Chosen by comparison: the instruction of that name gives NaN where either is.
        // SAFETY: the caller vouches for the unit.
        unsafe {
            let first = vbslq_f32(vcgtq_f32(self.0, b.0), self.0, b.0);
            Self(first, vbslq_f32(vcgtq_f32(self.1, b.1), self.1, b.1))
        }
    }
    #[inline(always)]
    unsafe fn min(self, b: Self) -> Self {
        // Chosen by comparison: the instruction of that name gives NaN where either is.
        // SAFETY: the caller vouches for the unit.
        unsafe {
            let first = vbslq_f32(vcltq_f32(self.0, b.0), self.0, b.0);
            Self(first, vbslq_f32(vcltq_f32(self.1, b.1), self.1, b.1))
        }
    }
    #[inline(always)]
    unsafe fn less(self, b: Self) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { (vcltq_f32(self.0, b.0), vcltq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    unsafe fn at_most(self, b: Self) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { (vcleq_f32(self.0, b.0), vcleq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    unsafe fn equal(self, b: Self) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { (vceqq_f32(self.0, b.0), vceqq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    unsafe fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { (vorrq_u32(a.0, b.0), vorrq_u32(a.1, b.1)) }
    }
    #[inline(always)]
    unsafe fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        // SAFETY: the caller vouches for the unit.
        unsafe { (vandq_u32(a.0, b.0), vandq_u32(a.1, b.1)) }
    }
    #[inline(always)]
    unsafe fn bits(mask: Self::Mask) -> u32 {
        const PLACES: [u32; 4] = [1, 2, 4, 8];
        // SAFETY: the caller vouches for the unit; the places are four numbers.
        unsafe {
            let places = vld1q_u32(PLACES.as_ptr());
            vaddvq_u32(vandq_u32(mask.0, places)) | vaddvq_u32(vandq_u32(mask.1, places)) << 4
        }
    }
    /// Without comparisons: of a NaN and a number, these instructions give the number.
    #[inline(always)]
    unsafe fn largest(three: [Self; 3], start: Self) -> Self {
        let [x, y, z] = three;
        // SAFETY: the caller vouches for the unit.
        unsafe {
            let first = vmaxnmq_f32(vmaxnmq_f32(x.0, y.0), vmaxnmq_f32(z.0, start.0));
            Self(first, vmaxnmq_f32(vmaxnmq_f32(x.1, y.1), vmaxnmq_f32(z.1, start.1)))
        }
    }
    /// See [`Vector::largest`].
    #[inline(always)]
    unsafe fn smallest(three: [Self; 3], start: Self) -> Self {
        let [x, y, z] = three;
        // SAFETY: the caller vouches for the unit.
        unsafe {
            let first = vminnmq_f32(vminnmq_f32(x.0, y.0), vminnmq_f32(z.0, start.0));
            Self(first, vminnmq_f32(vminnmq_f32(x.1, y.1), vminnmq_f32(z.1, start.1)))
        }
    }
}

impl Isa for Neon {
    compile_traversals!();
}
