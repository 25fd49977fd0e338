//! Cameras.

use std::sync::Arc;

use glam::{DAffine3, DMat4, DVec2};
use umber_scene::{CameraId, ConformPolicy, Projection, SceneEdit};

use crate::bridge::ffi;
use crate::convert::affine;
use crate::delegate::Delegate;
use crate::guard::{Outcome, guard, guard_refusal};
use crate::host::Host;

/// One `HdCamera`.
pub struct Camera {
    host: Arc<Host>,
    id: CameraId,
    camera: umber_scene::Camera,
    /// The window policy of the render pass that looks through it.
    policy: Option<ConformPolicy>,
}

pub fn new_camera(delegate: &Delegate, path: &str) -> Outcome<Box<Camera>> {
    guard(|| {
        let camera = umber_scene::Camera::default();
        Box::new(Camera { host: delegate.host(), id: CameraId::new(path), camera, policy: None })
    })
}

impl Camera {
    pub fn set(&mut self, a: &ffi::CameraAttributes) -> Outcome {
        let wide = |x: f32, y: f32| DVec2::new(f64::from(x), f64::from(y));
        guard_refusal(|| {
            self.camera = umber_scene::Camera {
                world_from_camera: affine(&a.transform),
                projection: if a.orthographic { Projection::Orthographic } else { Projection::Perspective },
                aperture: wide(a.horizontal_aperture, a.vertical_aperture),
                aperture_offset: wide(a.horizontal_aperture_offset, a.vertical_aperture_offset),
                focal_length: f64::from(a.focal_length),
                clipping_range: [a.near, a.far],
                conform_policy: conform_policy(a.window_policy),
            };
            self.send()
        })
    }

    pub fn look_through(&mut self, policy: ffi::WindowPolicy) -> Outcome {
        guard_refusal(|| {
            let policy = Some(conform_policy(policy));
            if self.policy != policy {
                self.policy = policy;
                self.send()?;
            }
            self.host.edit(SceneEdit::RenderCamera(self.id.clone()))
        })
    }

    pub fn remove(&self) -> Outcome {
        guard_refusal(|| self.host.edit(SceneEdit::RemoveCamera(self.id.clone())))
    }

    fn send(&self) -> Result<(), umber_settings::SettingError> {
        let conform_policy = self.policy.unwrap_or(self.camera.conform_policy);
        let camera = umber_scene::Camera { conform_policy, ..self.camera.clone() };
        self.host.edit(SceneEdit::Camera(self.id.clone(), camera))
    }
}

/// The scene's word for a window policy.
pub fn conform_policy(policy: ffi::WindowPolicy) -> ConformPolicy {
    match policy {
        ffi::WindowPolicy::MatchVertically => ConformPolicy::MatchVertically,
        ffi::WindowPolicy::MatchHorizontally => ConformPolicy::MatchHorizontally,
        ffi::WindowPolicy::Crop => ConformPolicy::Crop,
        ffi::WindowPolicy::DontConform => ConformPolicy::DontConform,
        _ => ConformPolicy::Fit,
    }
}

/// The camera that a view and an OpenGL projection matrix describe, both for row vectors.
pub fn camera_of_matrices(view: &[f64; 16], projection: &[f64; 16], policy: ConformPolicy) -> umber_scene::Camera {
    let p = DMat4::from_cols_array(projection);
    let perspective = p.w_axis.w == 0.0;
    // in the middle of the frustum x/w and y/w are zero: that is the window's centre, and the unit
    // interval on both sides its half size
    let size = DVec2::new(2.0 / p.x_axis.x, 2.0 / p.y_axis.y);
    let (center, near, far) = if perspective {
        let center = DVec2::new(p.z_axis.x / p.x_axis.x, p.z_axis.y / p.y_axis.y);
        (center, p.w_axis.z / (p.z_axis.z - 1.0), p.w_axis.z / (p.z_axis.z + 1.0))
    } else {
        let center = DVec2::new(-p.w_axis.x / p.x_axis.x, -p.w_axis.y / p.y_axis.y);
        (center, (p.w_axis.z + 1.0) / p.z_axis.z, (p.w_axis.z - 1.0) / p.z_axis.z)
    };
    let world_from_camera: DAffine3 = affine(view).inverse();
    umber_scene::Camera {
        world_from_camera,
        projection: if perspective { Projection::Perspective } else { Projection::Orthographic },
        aperture: size,
        aperture_offset: center,
        focal_length: 1.0,
        clipping_range: [near as f32, far as f32],
        conform_policy: policy,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// As `GfFrustum::ComputeProjectionMatrix` lays it out.
    fn projection(perspective: bool, [l, r, b, t, n, f]: [f64; 6]) -> [f64; 16] {
        let (w, h, d) = (r - l, t - b, f - n);
        let mut m = [0.0; 16];
        if perspective {
            (m[0], m[5]) = (2.0 * n / w, 2.0 * n / h);
            (m[8], m[9], m[10], m[11]) = ((r + l) / w, (t + b) / h, -(f + n) / d, -1.0);
            m[14] = -2.0 * n * f / d;
        } else {
            (m[0], m[5], m[10]) = (2.0 / w, 2.0 / h, -2.0 / d);
            (m[12], m[13], m[14], m[15]) = (-(r + l) / w, -(t + b) / h, -(f + n) / d, 1.0);
        }
        m
    }

    #[test]
    fn matrices_give_the_frustum_back() {
        let view = DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0)).to_cols_array();
        let camera = |perspective, window| {
            camera_of_matrices(&view, &projection(perspective, window), ConformPolicy::DontConform)
        };
        let near = |a: DVec2, x: f64, y: f64| assert!((a - DVec2::new(x, y)).length() < 1e-12, "{a}");

        let c = camera(true, [-0.1, 0.3, -0.2, 0.2, 0.5, 100.0]);
        near(c.aperture, 0.8, 0.8);
        near(c.aperture_offset, 0.2, 0.0);
        assert_eq!(c.world_from_camera.translation, DVec3::new(-1.0, -2.0, -3.0));
        assert!((c.clipping_range[0] - 0.5).abs() < 1e-6 && (c.clipping_range[1] - 100.0).abs() < 1e-4);

        let c = camera(false, [-1.0, 3.0, -2.0, 2.0, 0.5, 100.0]);
        assert_eq!(c.projection, Projection::Orthographic);
        near(c.aperture, 4.0, 4.0);
        near(c.aperture_offset, 1.0, 0.0);
        assert!((c.clipping_range[0] - 0.5).abs() < 1e-6 && (c.clipping_range[1] - 100.0).abs() < 1e-4);
    }
}
