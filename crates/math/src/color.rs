//! Scene-linear colour: Rec.709 primaries, D65 white.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub};

use glam::Vec3;

/// A scene-linear Rec.709 triple: a reflectance, or radiance in the stage's units.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Rgb(pub Vec3);

impl Rgb {
    /// Black.
    pub const BLACK: Self = Self(Vec3::ZERO);
    /// White: one in each channel.
    pub const WHITE: Self = Self(Vec3::ONE);

    /// From its channels.
    #[inline]
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self(Vec3::new(r, g, b))
    }
    /// The same value in each channel.
    #[inline]
    pub const fn splat(v: f32) -> Self {
        Self(Vec3::splat(v))
    }
    /// Relative luminance, Y of Rec.709 (ITU-R BT.709-6).
    #[inline]
    pub fn luminance(self) -> f32 {
        self.0.dot(Vec3::new(0.2126, 0.7152, 0.0722))
    }
    /// The largest channel.
    #[inline]
    pub fn max_channel(self) -> f32 {
        self.0.max_element()
    }
    /// Whether every channel is exactly zero.
    #[inline]
    pub fn is_black(self) -> bool {
        self.0 == Vec3::ZERO
    }
    /// Whether no channel is NaN or infinite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }
    /// `self + (other − self) · t`, channel by channel.
    #[inline]
    pub fn lerp(self, other: Self, t: f32) -> Self {
        Self(self.0.lerp(other.0, t))
    }
}

impl From<[f32; 3]> for Rgb {
    fn from(v: [f32; 3]) -> Self {
        Self(v.into())
    }
}
impl Add for Rgb {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self(self.0 + o.0)
    }
}
impl AddAssign for Rgb {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        self.0 += o.0;
    }
}
impl Sub for Rgb {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self(self.0 - o.0)
    }
}
impl Mul for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self(self.0 * o.0)
    }
}
impl MulAssign for Rgb {
    #[inline]
    fn mul_assign(&mut self, o: Self) {
        self.0 *= o.0;
    }
}
impl Mul<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, s: f32) -> Self {
        Self(self.0 * s)
    }
}
impl MulAssign<f32> for Rgb {
    #[inline]
    fn mul_assign(&mut self, s: f32) {
        self.0 *= s;
    }
}
impl Div<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn div(self, s: f32) -> Self {
        Self(self.0 / s)
    }
}

/// Linear value of an sRGB-encoded one, IEC 61966-2-1.
#[inline]
pub fn linear_from_srgb(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// sRGB encoding of a linear value, IEC 61966-2-1.
#[inline]
pub fn srgb_from_linear(v: f32) -> f32 {
    if v <= 0.0031308 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}
