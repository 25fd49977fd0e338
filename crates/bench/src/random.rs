//! Numbers that look random and are the same each time.

use umber_math::{Point3, Vec3};

/// A small generator (Marsaglia 2003, "Xorshift RNGs"), enough to scatter rays. Its state is never zero.
pub struct Random(pub u64);

impl Random {
    /// One of many that have little to do with each other (the finaliser of Steele, Lea and Flood 2014,
    /// "Fast Splittable Pseudorandom Number Generators").
    pub fn stream(seed: u64, stream: u64) -> Self {
        let mut z = seed.wrapping_add(stream.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Self((z ^ (z >> 31)).max(1))
    }
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    /// From 0 to 1, without 1.
    pub fn float(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }
    /// From 0 to `n`, without `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() >> 16) as usize % n
    }
    /// From −1 to 1 in each axis.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.float(), self.float(), self.float()) * 2.0 - 1.0
    }
    /// A unit vector, uniform over the sphere.
    pub fn direction(&mut self) -> Vec3 {
        let z = 1.0 - 2.0 * self.float();
        let (r, a) = ((1.0 - z * z).max(0.0).sqrt(), std::f32::consts::TAU * self.float());
        Vec3::new(r * a.cos(), r * a.sin(), z)
    }
    /// A point of a triangle; on an edge where `at_edge`.
    pub fn point_of(&mut self, [a, b, c]: [Point3; 3], at_edge: bool) -> Vec3 {
        let (u, v) = (self.float(), if at_edge { 0.0 } else { self.float() });
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        a.0 + (b.0 - a.0) * u + (c.0 - a.0) * v
    }
}
