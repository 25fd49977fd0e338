//! Points, vectors and normals as distinct types over [`glam::Vec3`].
//!
//! They transform differently (a point is moved, a vector only turned and scaled, a normal goes by
//! the inverse transpose), so the compiler keeps them apart.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use glam::Vec3;

macro_rules! triple {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(transparent)]
        pub struct $name(pub Vec3);

        impl $name {
            /// All components zero.
            pub const ZERO: Self = Self(Vec3::ZERO);

            /// From its components.
            #[inline]
            pub const fn new(x: f32, y: f32, z: f32) -> Self {
                Self(Vec3::new(x, y, z))
            }
            /// First component.
            #[inline]
            pub fn x(self) -> f32 {
                self.0.x
            }
            /// Second component.
            #[inline]
            pub fn y(self) -> f32 {
                self.0.y
            }
            /// Third component.
            #[inline]
            pub fn z(self) -> f32 {
                self.0.z
            }
            /// Whether no component is NaN or infinite.
            #[inline]
            pub fn is_finite(self) -> bool {
                self.0.is_finite()
            }
        }

        impl From<Vec3> for $name {
            #[inline]
            fn from(v: Vec3) -> Self {
                Self(v)
            }
        }

        impl From<[f32; 3]> for $name {
            #[inline]
            fn from(v: [f32; 3]) -> Self {
                Self(Vec3::from(v))
            }
        }
    };
}

triple! {
    /// A position.
    Point3
}
triple! {
    /// A direction with length.
    Vector3
}
triple! {
    /// A surface normal.
    Normal3
}

macro_rules! linear {
    ($name:ident) => {
        impl $name {
            /// Euclidean length.
            #[inline]
            pub fn length(self) -> f32 {
                self.0.length()
            }
            /// Squared Euclidean length.
            #[inline]
            pub fn length_squared(self) -> f32 {
                self.0.length_squared()
            }
            /// The unit vector of the same direction; zero where the length is zero or not finite.
            #[inline]
            pub fn normalized(self) -> Self {
                Self(self.0.normalize_or_zero())
            }
        }
        impl Neg for $name {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }
        impl Add for $name {
            type Output = Self;
            #[inline]
            fn add(self, o: Self) -> Self {
                Self(self.0 + o.0)
            }
        }
        impl AddAssign for $name {
            #[inline]
            fn add_assign(&mut self, o: Self) {
                self.0 += o.0;
            }
        }
        impl Sub for $name {
            type Output = Self;
            #[inline]
            fn sub(self, o: Self) -> Self {
                Self(self.0 - o.0)
            }
        }
        impl Mul<f32> for $name {
            type Output = Self;
            #[inline]
            fn mul(self, s: f32) -> Self {
                Self(self.0 * s)
            }
        }
        impl Mul<$name> for f32 {
            type Output = $name;
            #[inline]
            fn mul(self, v: $name) -> $name {
                $name(self * v.0)
            }
        }
        impl Div<f32> for $name {
            type Output = Self;
            #[inline]
            fn div(self, s: f32) -> Self {
                Self(self.0 / s)
            }
        }
    };
}

linear!(Vector3);
linear!(Normal3);

impl Vector3 {
    /// Dot product.
    #[inline]
    pub fn dot(self, o: Self) -> f32 {
        self.0.dot(o.0)
    }
    /// Dot product with a normal.
    #[inline]
    pub fn dot_normal(self, n: Normal3) -> f32 {
        self.0.dot(n.0)
    }
    /// Cross product.
    #[inline]
    pub fn cross(self, o: Self) -> Self {
        Self(self.0.cross(o.0))
    }
}

impl Normal3 {
    /// Dot product of two normals.
    #[inline]
    pub fn dot(self, o: Self) -> f32 {
        self.0.dot(o.0)
    }
    /// This normal, turned to the side of `v`.
    #[inline]
    pub fn facing(self, v: Vector3) -> Self {
        if self.0.dot(v.0) < 0.0 { -self } else { self }
    }
    /// The same components read as a vector.
    #[inline]
    pub fn as_vector(self) -> Vector3 {
        Vector3(self.0)
    }
}

impl Point3 {
    /// Distance to another point.
    #[inline]
    pub fn distance(self, o: Self) -> f32 {
        self.0.distance(o.0)
    }
}

impl Sub for Point3 {
    type Output = Vector3;
    #[inline]
    fn sub(self, o: Self) -> Vector3 {
        Vector3(self.0 - o.0)
    }
}
impl Add<Vector3> for Point3 {
    type Output = Self;
    #[inline]
    fn add(self, v: Vector3) -> Self {
        Self(self.0 + v.0)
    }
}
impl Sub<Vector3> for Point3 {
    type Output = Self;
    #[inline]
    fn sub(self, v: Vector3) -> Self {
        Self(self.0 - v.0)
    }
}
