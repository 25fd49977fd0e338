//! The camera as rays need it: from film positions to render space.

use umber_math::{DAffine3, DVec2, DVec3, Normal3, Point3, Ray, Transform, Vec2, Vector3, keeps_angles};
use umber_scene::{Camera, Projection};

use crate::FilmDesc;

/// A camera bound to a film.
#[derive(Clone, Debug)]
pub struct RenderCamera {
    render_from_camera: Transform,
    projection: Projection,
    /// Screen position of the film's corner (0, 0) and of one pixel's step, on the plane one unit
    /// before a perspective camera, or in camera space.
    screen_min: DVec2,
    screen_step: DVec2,
    near: f32,
    far: f32,
}

/// A hit's depths.
#[derive(Clone, Copy, Debug)]
pub struct Depths {
    /// Distance along the view axis.
    pub camera: f32,
    /// As the projection maps it: 0 at the near plane, 1 at the far plane.
    pub projected: f32,
}

/// How a camera projects: what a rasteriser needs.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// From render to camera space.
    pub camera_from_render: DAffine3,
    /// Whether that mirrors.
    pub mirrored: bool,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Screen position of the film's corner (0, 0), as for [`RenderCamera`].
    pub screen_min: DVec2,
    /// The step of one pixel there.
    pub screen_step: DVec2,
    /// Least distance along the view axis.
    pub near: f64,
    /// Largest distance along the view axis.
    pub far: f64,
}

impl RenderCamera {
    /// Binds a camera to a film. `None` where its transform is singular or its window is empty or
    /// not finite.
    pub fn new(camera: &Camera, film: &FilmDesc, render_from_world: DAffine3) -> Option<Self> {
        let [x0, y0, x1, y1] = film.view();
        let pixels = DVec2::new(x1 - x0, y1 - y0);
        let window = camera.screen_window(pixels.x * film.pixel_aspect / pixels.y);
        let screen_step = (window.max - window.min) / pixels;
        let data_min = DVec2::new(film.data_window_min[0].into(), film.data_window_min[1].into());
        let screen_min = window.min + (data_min - DVec2::new(x0, y0)) * screen_step;
        let render_from_camera = Transform::from_affine(render_from_world * camera.world_from_camera)?;
        let [near, far] = camera.clipping_range;
        let usable = screen_min.is_finite() && screen_step.is_finite() && screen_step.min_element() > 0.0;
        usable.then_some(Self {
            render_from_camera,
            projection: camera.projection,
            screen_min,
            screen_step,
            near: if near.is_finite() { near } else { 0.0 },
            far: if far.is_nan() { f32::INFINITY } else { far },
        })
    }

    /// The ray through a film position in pixels, y up; its direction is of unit length and it is
    /// bounded by the clipping range.
    pub fn ray(&self, film: Vec2) -> Ray {
        let screen = self.screen_min + film.as_dvec2() * self.screen_step;
        let (origin, direction) = match self.projection {
            Projection::Perspective => (DVec3::ZERO, DVec3::new(screen.x, screen.y, -1.0)),
            Projection::Orthographic => (DVec3::new(screen.x, screen.y, 0.0), DVec3::NEG_Z),
        };
        let direction = self.render_from_camera.vector(Vector3(direction.as_vec3()));
        // stretches distances along the view axis, in the camera's units, to distances along the ray
        let stretch = direction.length();
        Ray {
            origin: self.render_from_camera.point(Point3(origin.as_vec3())),
            direction: direction / stretch,
            // what lies on the near plane is seen, whatever the rounding
            t_min: self.near * stretch * (1.0 - 16.0 * f32::EPSILON),
            t_max: self.far * stretch,
        }
    }

    /// Where on the film a point is seen, and the ray from the camera that ends there; `None` where it is behind.
    pub fn seen(&self, point: Point3) -> Option<(Vec2, Ray)> {
        let p = self.render_from_camera.inverse_point(point).0.as_dvec3();
        let screen = match self.projection {
            Projection::Perspective if p.z < 0.0 => DVec2::new(p.x, p.y) / -p.z,
            Projection::Orthographic => DVec2::new(p.x, p.y),
            Projection::Perspective => return None,
        };
        let film = ((screen - self.screen_min) / self.screen_step).as_vec2();
        let ray = self.ray(film);
        let distance = (point - ray.origin).dot(ray.direction);
        (distance > ray.t_min && distance < ray.t_max).then_some((film, Ray { t_max: distance, ..ray }))
    }

    /// Whether it sees all angles as they are.
    pub fn keeps_angles(&self) -> bool {
        keeps_angles(&glam::Mat3::from(self.render_from_camera.forward().matrix3).as_dmat3())
    }

    /// Pixels to a unit of area that lies across a ray, unit direction, at a distance; where
    /// [angles are kept](Self::keeps_angles).
    pub fn pixels_over_area(&self, direction: Vector3, distance: f32) -> f32 {
        let m = &self.render_from_camera.forward().matrix3;
        let along = self.render_from_camera.inverse_vector(direction);
        // of a camera that is not squeezed: a unit of its own space
        let unit = m.z_axis.length();
        let step = (self.screen_step.x * self.screen_step.y) as f32;
        match self.projection {
            Projection::Perspective => {
                let cosine = -along.z() * unit;
                1.0 / (step * cosine * cosine * cosine * distance * distance)
            }
            Projection::Orthographic => 1.0 / (step * unit * unit),
        }
    }

    /// Where it is, render space.
    pub fn position(&self) -> Point3 {
        self.render_from_camera.point(Point3(umber_math::Vec3::ZERO))
    }

    /// The way back from render space to film positions: the inverse of the very matrix that makes rays.
    pub fn view(&self) -> View {
        let forward = self.render_from_camera.forward();
        let (m, t) = (forward.matrix3, forward.translation);
        let render_from_camera = DAffine3::from_mat3_translation(glam::Mat3::from(m).as_dmat3(), t.as_dvec3());
        View {
            camera_from_render: render_from_camera.inverse(),
            mirrored: self.render_from_camera.flips_handedness(),
            projection: self.projection,
            screen_min: self.screen_min,
            screen_step: self.screen_step,
            near: self.near.into(),
            far: self.far.into(),
        }
    }

    /// Depths of a point in render space.
    pub fn depths(&self, p: Point3) -> Depths {
        self.depths_at(-self.render_from_camera.inverse_point(p).z())
    }

    /// Depths of what lies `distance` before the camera, along the view axis.
    pub fn depths_at(&self, distance: f32) -> Depths {
        let (n, f) = (self.near, self.far);
        let projected = match self.projection {
            Projection::Perspective if f.is_infinite() => 1.0 - n / distance,
            Projection::Perspective => f / (f - n) * (1.0 - n / distance),
            Projection::Orthographic => (distance - n) / (f - n),
        };
        Depths { camera: distance, projected: projected.clamp(0.0, 1.0) }
    }

    /// A unit normal in render space, in camera space.
    pub fn eye_normal(&self, n: Normal3) -> Normal3 {
        // the inverse transpose of the inverse
        let m = &self.render_from_camera.forward().matrix3;
        let n = umber_math::Vec3::new(m.x_axis.dot(n.0.into()), m.y_axis.dot(n.0.into()), m.z_axis.dot(n.0.into()));
        Normal3(n).normalized()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umber_math::Vec3;

    fn camera() -> Camera {
        Camera {
            aperture: DVec2::new(2.0, 1.0),
            focal_length: 1.0,
            clipping_range: [1.0, 101.0],
            world_from_camera: DAffine3::from_translation(DVec3::new(0.0, 0.0, 5.0)),
            ..Camera::default()
        }
    }

    #[test]
    fn perspective_rays_and_depths() {
        let film = FilmDesc::new(200, 100, &[]);
        let c = RenderCamera::new(&camera(), &film, DAffine3::IDENTITY).unwrap();
        let middle = c.ray(Vec2::new(100.0, 50.0));
        assert_eq!(middle.direction.0, Vec3::NEG_Z);
        assert!(middle.t_min < 1.0 && middle.t_min > 0.9999 && middle.t_max == 101.0);
        let corner = c.ray(Vec2::new(200.0, 100.0));
        let at_one = corner.at(corner.t_min).0;
        assert!((at_one - Vec3::new(1.0, 0.5, 4.0)).length() < 1e-5, "{at_one}");
        let near = c.depths(Point3::new(0.3, 0.0, 4.0));
        assert_eq!((near.camera, near.projected), (1.0, 0.0));
        assert!((c.depths(Point3::new(0.0, 0.0, -96.0)).projected - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_data_window_shows_its_part_of_the_view() {
        let whole = RenderCamera::new(&camera(), &FilmDesc::new(200, 100, &[]), DAffine3::IDENTITY).unwrap();
        let film = FilmDesc {
            display_window: Some([0.0, 0.0, 200.0, 100.0]),
            data_window_min: [150, 20],
            ..FilmDesc::new(50, 30, &[])
        };
        let part = RenderCamera::new(&camera(), &film, DAffine3::IDENTITY).unwrap();
        let (a, b) = (part.ray(Vec2::new(3.5, 4.5)), whole.ray(Vec2::new(153.5, 24.5)));
        assert!((a.direction - b.direction).length() < 1e-6);
    }

    #[test]
    fn orthographic_rays_are_parallel() {
        let camera = Camera { projection: Projection::Orthographic, ..camera() };
        let c = RenderCamera::new(&camera, &FilmDesc::new(200, 100, &[]), DAffine3::IDENTITY).unwrap();
        let r = c.ray(Vec2::new(0.0, 0.0));
        assert_eq!((r.origin.0, r.direction.0), (Vec3::new(-1.0, -0.5, 5.0), Vec3::NEG_Z));
        assert!((c.depths(r.at(51.0)).projected - 0.5).abs() < 1e-6);
    }

    #[test]
    fn unusable_cameras_are_refused() {
        let flat = Camera { world_from_camera: DAffine3::ZERO, ..camera() };
        assert!(RenderCamera::new(&flat, &FilmDesc::new(2, 2, &[]), DAffine3::IDENTITY).is_none());
        let empty = Camera { aperture: DVec2::ZERO, ..camera() };
        assert!(RenderCamera::new(&empty, &FilmDesc::new(2, 2, &[]), DAffine3::IDENTITY).is_none());
    }
}
