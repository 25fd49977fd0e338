//! Orthonormal frames: from the shading frame's local space (z along the normal) and back.

use glam::Vec3;

use crate::{Normal3, Vector3};

/// A right-handed orthonormal frame whose z axis is the normal.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Local x axis.
    pub tangent: Vector3,
    /// Local y axis.
    pub bitangent: Vector3,
    /// Local z axis.
    pub normal: Normal3,
}

impl Frame {
    /// A frame around a unit normal, continuous but for one direction.
    ///
    /// Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    #[inline]
    pub fn from_normal(n: Normal3) -> Self {
        let Vec3 { x, y, z } = n.0;
        let sign = 1f32.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        Self {
            tangent: Vector3::new(1.0 + sign * x * x * a, sign * b, -sign * x),
            bitangent: Vector3::new(b, sign + y * y * a, -y),
            normal: n,
        }
    }
    /// Components of `v` along the frame's axes.
    #[inline]
    pub fn to_local(&self, v: Vector3) -> Vector3 {
        Vector3::new(v.dot(self.tangent), v.dot(self.bitangent), v.dot_normal(self.normal))
    }
    /// The vector whose local components are `v`.
    #[inline]
    pub fn from_local(&self, v: Vector3) -> Vector3 {
        self.tangent * v.x() + self.bitangent * v.y() + self.normal.as_vector() * v.z()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_trip_and_orthonormal() {
        for (x, y, z) in [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (0.6, -0.48, 0.64), (1e-8, 0.0, -1.0), (0.0, 1.0, -0.0)] {
            let n = Normal3(Vec3::new(x, y, z).normalize());
            let f = Frame::from_normal(n);
            assert!(f.tangent.dot(f.bitangent).abs() < 1e-6 && f.tangent.dot_normal(n).abs() < 1e-6);
            assert!((f.tangent.cross(f.bitangent).0 - n.0).length() < 1e-6);
            let v = Vector3::new(0.3, -0.5, 0.7);
            assert!((f.from_local(f.to_local(v)) - v).length() < 1e-6);
        }
    }
}
