//! Numbers that look random and are the same each time.

use umber_math::Vec3;

/// A small generator (Marsaglia 2003, "Xorshift RNGs"), enough to scatter rays.
pub struct Random(pub u64);

impl Random {
    /// From 0 to 1, without 1.
    pub fn float(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
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
}
