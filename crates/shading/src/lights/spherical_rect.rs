//! Uniform sampling of the directions in which a rectangle is seen.
//!
//! Ureña, Fajardo & King 2013, "An Area-Preserving Parametrization for Spherical Rectangles". In double
//! precision: the solid angle is a difference of angles, which single precision loses for small rectangles.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, Vec2};

/// A rectangle, one corner and two perpendicular edges, as seen from a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphericalRect {
    axes: [DVec3; 3],
    /// Corners in the local frame: x0, x1, y0, y1, all at depth z0 < 0.
    x: [f64; 2],
    y: [f64; 2],
    z: f64,
    /// z components of the normals of the bottom and top sides' planes.
    b0: f64,
    b1: f64,
    /// Cosine and sine of the angle from which the samples' angles are counted.
    k: DVec2,
    pub solid_angle: f64,
}

impl SphericalRect {
    /// `corner` relative to the point of view; `edge_x` and `edge_y` perpendicular, with unit axes `x` and `y`.
    /// `None` from within the rectangle's plane.
    #[inline]
    pub fn new(corner: DVec3, [x_axis, y_axis]: [DVec3; 2], [width, height]: [f64; 2]) -> Option<Self> {
        let mut z_axis = x_axis.cross(y_axis);
        let mut z = corner.dot(z_axis);
        if z > 0.0 {
            (z, z_axis) = (-z, -z_axis);
        }
        let (x0, y0) = (corner.dot(x_axis), corner.dot(y_axis));
        let (x1, y1) = (x0 + width, y0 + height);
        // Normals of the planes through the sides and the eye; each has one zero component.
        let side = |c: f64| c / (c * c + z * z).sqrt();
        let (n_bottom, n_right, n_top, n_left) = (-side(y0), side(x1), side(y1), -side(x0));
        // The angles of the corners as turns of the plane: their products are the sums of the angles.
        let corner_angle = |a: f64, b: f64| DVec2::new(-a * b, (1.0 - (a * b) * (a * b)).max(0.0).sqrt());
        let right = corner_angle(n_bottom, n_right).rotate(corner_angle(n_right, n_top));
        let left = corner_angle(n_top, n_left).rotate(corner_angle(n_left, n_bottom));
        // All four angles together are a whole turn more than the solid angle.
        let whole = right.rotate(left);
        let turn = whole.y.atan2(whole.x);
        let solid_angle = if turn < 0.0 { turn + 2.0 * PI } else { turn };
        let usable = z < 0.0 && solid_angle > 0.0 && solid_angle.is_finite();
        usable.then_some(Self {
            axes: [x_axis, y_axis, z_axis],
            x: [x0, x1],
            y: [y0, y1],
            z,
            b0: n_bottom,
            b1: n_top,
            k: DVec2::new(left.x, -left.y),
            solid_angle,
        })
    }
    /// A point of the rectangle, relative to the point of view, uniform in solid angle.
    #[inline]
    pub fn sample(&self, u: Vec2) -> DVec3 {
        let (ux, uy) = (f64::from(u.x), f64::from(u.y));
        let au = DVec2::from_angle(ux * self.solid_angle).rotate(self.k);
        let fu = (au.x * self.b0 - self.b1) / au.y;
        let cu = (1.0 / (fu * fu + self.b0 * self.b0).sqrt()).copysign(fu).clamp(-1.0, 1.0);
        let xu = (-(cu * self.z) / (1.0 - cu * cu).max(1e-300).sqrt()).clamp(self.x[0], self.x[1]);
        let d2 = xu * xu + self.z * self.z;
        let h = |y: f64| y / (d2 + y * y).sqrt();
        let (h0, h1) = (h(self.y[0]), h(self.y[1]));
        let hv = h0 + uy * (h1 - h0);
        let rest = (1.0 - hv * hv).max(1e-300);
        let yv = (hv * (d2 / rest).sqrt()).clamp(self.y[0], self.y[1]);
        self.axes[0] * xu + self.axes[1] * yv + self.axes[2] * self.z
    }
}
