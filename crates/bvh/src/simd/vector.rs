//! What the tests ask of a vector unit.

/// Eight floats in the registers of a vector unit.
///
/// All functions are unsafe: the processor must have the unit. The arithmetic is that of single floats, multiplication
/// and addition never fused, so that hits are the same on all units and those of the scalar test.
pub(super) trait Vector: Copy {
    /// A yes or no for each lane.
    type Mask: Copy;

    /// Eight times the same.
    unsafe fn splat(x: f32) -> Self;
    /// Eight floats from memory, aligned or not.
    unsafe fn load(from: *const f32) -> Self;
    /// Eight floats to memory.
    unsafe fn store(self, to: &mut [f32; 8]);
    unsafe fn add(self, b: Self) -> Self;
    unsafe fn sub(self, b: Self) -> Self;
    unsafe fn mul(self, b: Self) -> Self;
    unsafe fn div(self, b: Self) -> Self;
    unsafe fn abs(self) -> Self;
    /// The larger; the second where either is NaN.
    unsafe fn max(self, b: Self) -> Self;
    /// The smaller; the second where either is NaN.
    unsafe fn min(self, b: Self) -> Self;
    /// Comparisons: no where either is NaN.
    unsafe fn less(self, b: Self) -> Self::Mask;
    /// See [`Vector::less`].
    unsafe fn at_most(self, b: Self) -> Self::Mask;
    /// See [`Vector::less`].
    unsafe fn equal(self, b: Self) -> Self::Mask;
    unsafe fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    unsafe fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// A bit a lane.
    unsafe fn bits(mask: Self::Mask) -> u32;

    /// The largest of `start`, which is no NaN, and of those of the three that are none.
    #[inline(always)]
    unsafe fn largest(three: [Self; 3], start: Self) -> Self {
        let [x, y, z] = three;
        // SAFETY: the caller vouches for the unit.
        unsafe { z.max(y.max(x.max(start))) }
    }
    /// The smallest of `start`, which is no NaN, and of those of the three that are none.
    #[inline(always)]
    unsafe fn smallest(three: [Self; 3], start: Self) -> Self {
        let [x, y, z] = three;
        // SAFETY: the caller vouches for the unit.
        unsafe { z.min(y.min(x.min(start))) }
    }
}
