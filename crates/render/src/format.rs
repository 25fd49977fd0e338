//! Pixel formats of render buffers, and conversion to them.

use half::f16;

/// Pixel format of a render buffer; the names are `HdFormat`'s.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum BufferFormat {
    UNorm8,
    UNorm8Vec2,
    UNorm8Vec3,
    UNorm8Vec4,
    Float16,
    Float16Vec2,
    Float16Vec3,
    Float16Vec4,
    Float32,
    Float32Vec2,
    Float32Vec3,
    Float32Vec4,
    Int32,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Component {
    UNorm8,
    Float16,
    Float32,
    Int32,
}

impl BufferFormat {
    const fn parts(self) -> (Component, usize) {
        use Component::{Float16, Float32, Int32, UNorm8};
        match self {
            Self::UNorm8 => (UNorm8, 1),
            Self::UNorm8Vec2 => (UNorm8, 2),
            Self::UNorm8Vec3 => (UNorm8, 3),
            Self::UNorm8Vec4 => (UNorm8, 4),
            Self::Float16 => (Float16, 1),
            Self::Float16Vec2 => (Float16, 2),
            Self::Float16Vec3 => (Float16, 3),
            Self::Float16Vec4 => (Float16, 4),
            Self::Float32 => (Float32, 1),
            Self::Float32Vec2 => (Float32, 2),
            Self::Float32Vec3 => (Float32, 3),
            Self::Float32Vec4 => (Float32, 4),
            Self::Int32 => (Int32, 1),
        }
    }
    /// Components a pixel.
    pub const fn components(self) -> usize {
        self.parts().1
    }
    /// Bytes a pixel.
    pub const fn bytes(self) -> usize {
        let (component, count) = self.parts();
        count
            * match component {
                Component::UNorm8 => 1,
                Component::Float16 => 2,
                Component::Float32 | Component::Int32 => 4,
            }
    }
    /// Whether the components are whole numbers that are not colours.
    pub const fn is_integer(self) -> bool {
        matches!(self.parts().0, Component::Int32)
    }

    /// Writes pixels that are colours.
    pub(crate) fn write_row(self, colors: &[[f32; 4]], out: &mut [u8]) {
        if self == Self::Float32Vec4 {
            return out.copy_from_slice(bytemuck::cast_slice(colors));
        }
        for (color, out) in colors.iter().zip(out.chunks_exact_mut(self.bytes())) {
            self.write(Pixel::Float(*color, 4), out);
        }
    }
    /// Writes one pixel. Missing components are zero, an alpha that is missing is one; what the
    /// format has no room for is dropped.
    #[inline]
    pub(crate) fn write(self, value: Pixel, out: &mut [u8]) {
        let (component, count) = self.parts();
        for i in 0..count {
            match (component, value) {
                (Component::Int32, Pixel::Int(v)) => out[4 * i..4 * i + 4].copy_from_slice(&v.to_ne_bytes()),
                (Component::Int32, Pixel::Float(v, _)) => {
                    out[4 * i..4 * i + 4].copy_from_slice(&(v[i] as i32).to_ne_bytes());
                }
                (Component::UNorm8, v) => out[i] = (v.component(i).clamp(0.0, 1.0) * 255.0 + 0.5) as u8,
                (Component::Float16, v) => {
                    out[2 * i..2 * i + 2].copy_from_slice(&f16::from_f32(v.component(i)).to_ne_bytes());
                }
                (Component::Float32, v) => out[4 * i..4 * i + 4].copy_from_slice(&v.component(i).to_ne_bytes()),
            }
        }
    }
}

/// A pixel's value before it takes a format.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Pixel {
    /// Numbers, and how many of them count.
    Float([f32; 4], usize),
    /// An id.
    Int(i32),
}

impl Pixel {
    fn component(self, i: usize) -> f32 {
        match self {
            Self::Float(v, count) if i < count => v[i],
            Self::Float(..) => f32::from(i == 3),
            Self::Int(v) => v as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions() {
        let mut out = [0u8; 16];
        BufferFormat::UNorm8Vec4.write(Pixel::Float([0.5, 2.0, -1.0, 0.0], 3), &mut out);
        assert_eq!(out[..4], [128, 255, 0, 255]);
        BufferFormat::Int32.write(Pixel::Int(-7), &mut out);
        assert_eq!(i32::from_ne_bytes(out[..4].try_into().unwrap()), -7);
        BufferFormat::Float16Vec2.write(Pixel::Float([1.5, -2.0, 0.0, 0.0], 4), &mut out);
        assert_eq!(f16::from_ne_bytes([out[2], out[3]]).to_f32(), -2.0);
        BufferFormat::Float32.write(Pixel::Float([0.25; 4], 1), &mut out);
        assert_eq!(f32::from_ne_bytes(out[..4].try_into().unwrap()), 0.25);
    }
}
