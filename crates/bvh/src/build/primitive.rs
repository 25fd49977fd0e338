//! What is sorted into the tree.

use glam::Vec4;
use umber_math::{Bounds3, Vec3};

/// A primitive's box and its index, in two vector registers.
#[derive(Clone, Copy)]
pub(crate) struct PrimitiveBox {
    /// Smaller corner; the last component holds the index, as bits of a normal number.
    low: Vec4,
    /// Larger corner; the last component is one.
    high: Vec4,
}

/// Makes the bits of an index those of a normal number: arithmetic on others is slow.
const NORMAL: u32 = 0x4000_0000;

impl PrimitiveBox {
    /// What is left out.
    pub const NONE: Self = Self { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    /// Whether it is left out.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.high.w < 0.0
    }
    /// Indices are below 2²⁸.
    #[inline]
    pub fn new(bounds: Bounds3, index: u32) -> Self {
        let index = f32::from_bits(NORMAL | index);
        Self { low: bounds.min.extend(index), high: bounds.max.extend(1.0) }
    }
    /// The caller's index.
    #[inline]
    pub fn index(&self) -> u32 {
        self.low.w.to_bits() & !NORMAL
    }
    /// Its box.
    #[inline]
    pub fn bounds(&self) -> Bounds3 {
        Bounds3 { min: self.low.truncate(), max: self.high.truncate() }
    }
    /// Longest edge of the box.
    #[inline(always)]
    pub fn extent(&self) -> f32 {
        (self.high - self.low).truncate().max_element()
    }
    /// Twice the middle of the box.
    #[inline(always)]
    pub(super) fn center2(&self) -> Vec4 {
        self.low + self.high
    }
}

/// A box in two vector registers; the last components mean nothing.
#[derive(Clone, Copy)]
pub(super) struct Box4 {
    pub low: Vec4,
    pub high: Vec4,
}

impl Box4 {
    pub const EMPTY: Self = Self { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    /// Around primitives, and around their doubled centers.
    #[inline]
    pub fn around(primitives: &[PrimitiveBox]) -> (Self, Self) {
        let (mut bounds, mut centers) = (Self::EMPTY, Self::EMPTY);
        for p in primitives {
            bounds.add(p);
            centers.add_point(p.center2());
        }
        (bounds, centers)
    }
    #[inline(always)]
    pub fn add(&mut self, p: &PrimitiveBox) {
        self.low = self.low.min(p.low);
        self.high = self.high.max(p.high);
    }
    #[inline(always)]
    fn add_point(&mut self, p: Vec4) {
        self.low = self.low.min(p);
        self.high = self.high.max(p);
    }
    #[inline(always)]
    pub fn union(self, o: Self) -> Self {
        Self { low: self.low.min(o.low), high: self.high.max(o.high) }
    }
    /// Longest edge.
    pub fn extent(self) -> f32 {
        (self.high - self.low).truncate().max_element()
    }
    /// Half the surface; zero where empty.
    #[inline(always)]
    pub fn half_area(self) -> f32 {
        let s: Vec3 = (self.high - self.low).max(Vec4::ZERO).truncate();
        s.x * (s.y + s.z) + s.y * s.z
    }
    pub fn bounds(self) -> Bounds3 {
        Bounds3 { min: self.low.truncate(), max: self.high.truncate() }
    }
}
