//! Plain loops over eight floats, for any processor.

use super::{Isa, compile_traversals, instances, triangles, vector::Vector, walk};
use crate::{instance::InstanceBvh, mesh::MeshBvh, ray::TraversalRay, search::Search, wide::WideTree};

/// Eight floats that the compiler keeps where it will.
#[derive(Clone, Copy)]
pub(crate) struct Portable([f32; 8]);

impl Portable {
    #[inline(always)]
    fn each(self, b: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], b.0[i])))
    }
    #[inline(always)]
    fn compare(self, b: Self, f: impl Fn(f32, f32) -> bool) -> u32 {
        (0..8).fold(0, |mask, i| mask | u32::from(f(self.0[i], b.0[i])) << i)
    }
}

impl Vector for Portable {
    type Mask = u32;

    #[inline(always)]
    unsafe fn splat(x: f32) -> Self {
        Self([x; 8])
    }
    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: the caller vouches for eight floats.
        Self(unsafe { from.cast::<[f32; 8]>().read_unaligned() })
    }
    #[inline(always)]
    unsafe fn store(self, to: &mut [f32; 8]) {
        *to = self.0;
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        self.each(b, |a, b| a + b)
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        self.each(b, |a, b| a - b)
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        self.each(b, |a, b| a * b)
    }
    #[inline(always)]
    unsafe fn div(self, b: Self) -> Self {
        self.each(b, |a, b| a / b)
    }
    #[inline(always)]
    unsafe fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }
    #[inline(always)]
    unsafe fn max(self, b: Self) -> Self {
        self.each(b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    unsafe fn min(self, b: Self) -> Self {
        self.each(b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    unsafe fn less(self, b: Self) -> u32 {
        self.compare(b, |a, b| a < b)
    }
    #[inline(always)]
    unsafe fn at_most(self, b: Self) -> u32 {
        self.compare(b, |a, b| a <= b)
    }
    #[inline(always)]
    unsafe fn equal(self, b: Self) -> u32 {
        self.compare(b, |a, b| a == b)
    }
    #[inline(always)]
    unsafe fn or(a: u32, b: u32) -> u32 {
        a | b
    }
    #[inline(always)]
    unsafe fn and(a: u32, b: u32) -> u32 {
        a & b
    }
    #[inline(always)]
    unsafe fn bits(mask: u32) -> u32 {
        mask
    }
}

impl Isa for Portable {
    compile_traversals!();
}
