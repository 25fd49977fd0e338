//! Cameras, by UsdGeomCamera.

use umber_math::{DAffine3, DVec2};

/// `UsdGeomCamera.projection`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// Rays through one point.
    #[default]
    Perspective,
    /// Parallel rays.
    Orthographic,
}

/// What happens where the aperture's shape is not the picture's (`CameraUtilConformWindowPolicy`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ConformPolicy {
    /// Keep the vertical aperture.
    MatchVertically,
    /// Keep the horizontal aperture.
    MatchHorizontally,
    /// Show at least the aperture.
    #[default]
    Fit,
    /// Show at most the aperture.
    Crop,
    /// Stretch the aperture onto the picture.
    DontConform,
}

/// A camera. It looks along -Z with +Y up.
#[derive(Clone, Debug)]
pub struct Camera {
    /// World from camera, as authored. A scale stretches the view as it stretches a model.
    pub world_from_camera: DAffine3,
    /// Projection.
    pub projection: Projection,
    /// Width and height of the aperture. Only ratios to the focal length matter for a perspective
    /// camera; for an orthographic one these are scene units.
    pub aperture: DVec2,
    /// Offset of the aperture's middle from the optical axis, in the aperture's unit.
    pub aperture_offset: DVec2,
    /// Focal length, in the aperture's unit.
    pub focal_length: f64,
    /// Near and far distance along the view axis, scene units: nothing else is seen.
    pub clipping_range: [f32; 2],
    /// What happens where the aperture's shape is not the picture's.
    pub conform_policy: ConformPolicy,
}

/// Bit by bit: a NaN that a host repeats at every redraw is no change.
impl PartialEq for Camera {
    fn eq(&self, o: &Self) -> bool {
        (self.projection, self.conform_policy) == (o.projection, o.conform_policy)
            && self.world_from_camera.to_cols_array().map(f64::to_bits)
                == o.world_from_camera.to_cols_array().map(f64::to_bits)
            && self.lens().map(f64::to_bits) == o.lens().map(f64::to_bits)
    }
}

impl Camera {
    fn lens(&self) -> [f64; 7] {
        let [near, far] = self.clipping_range.map(f64::from);
        let (a, o) = (self.aperture, self.aperture_offset);
        [a.x, a.y, o.x, o.y, self.focal_length, near, far]
    }
}

impl Default for Camera {
    /// UsdGeomCamera's fallbacks.
    fn default() -> Self {
        Self {
            world_from_camera: DAffine3::IDENTITY,
            projection: Projection::Perspective,
            aperture: DVec2::new(20.955, 15.2908),
            aperture_offset: DVec2::ZERO,
            focal_length: 50.0,
            clipping_range: [1.0, 1_000_000.0],
            conform_policy: ConformPolicy::Fit,
        }
    }
}

/// A window on the plane one unit before a perspective camera, or (orthographic) in scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenWindow {
    /// Lower left corner.
    pub min: DVec2,
    /// Upper right corner.
    pub max: DVec2,
}

impl Camera {
    /// What the picture shows where its width over height is `aspect`, conformed as
    /// `CameraUtilConformedWindow` does it. `aspect` already holds the pixels' own aspect ratio.
    pub fn screen_window(&self, aspect: f64) -> ScreenWindow {
        let scale = match self.projection {
            Projection::Perspective if self.focal_length > 0.0 => 1.0 / self.focal_length,
            _ => 1.0,
        };
        let center = self.aperture_offset * scale;
        let mut half = self.aperture * (0.5 * scale);
        let own_aspect = if half.y > 0.0 { half.x / half.y } else { 1.0 };
        let match_vertically = match self.conform_policy {
            ConformPolicy::DontConform => return ScreenWindow { min: center - half, max: center + half },
            ConformPolicy::MatchVertically => true,
            ConformPolicy::MatchHorizontally => false,
            ConformPolicy::Fit => own_aspect < aspect,
            ConformPolicy::Crop => own_aspect > aspect,
        };
        if match_vertically {
            half.x = half.y * aspect;
        } else {
            half.y = half.x / aspect;
        }
        ScreenWindow { min: center - half, max: center + half }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_nan_is_no_change() {
        let broken = || Camera { focal_length: f64::NAN, ..Camera::default() };
        assert_eq!(broken(), broken());
        assert_ne!(broken(), Camera::default());
    }

    #[test]
    fn conform_policies() {
        let camera = |conform_policy| Camera {
            aperture: DVec2::new(40.0, 20.0),
            aperture_offset: DVec2::new(5.0, 0.0),
            focal_length: 10.0,
            conform_policy,
            ..Camera::default()
        };
        let size = |policy, aspect| {
            let w = camera(policy).screen_window(aspect);
            assert_eq!((w.min + w.max) * 0.5, DVec2::new(0.5, 0.0));
            w.max - w.min
        };
        assert_eq!(size(ConformPolicy::MatchHorizontally, 1.0), DVec2::new(4.0, 4.0));
        assert_eq!(size(ConformPolicy::MatchVertically, 1.0), DVec2::new(2.0, 2.0));
        assert_eq!(size(ConformPolicy::Fit, 1.0), DVec2::new(4.0, 4.0));
        assert_eq!(size(ConformPolicy::Fit, 4.0), DVec2::new(8.0, 2.0));
        assert_eq!(size(ConformPolicy::Crop, 1.0), DVec2::new(2.0, 2.0));
        assert_eq!(size(ConformPolicy::DontConform, 1.0), DVec2::new(4.0, 2.0));
    }
}
