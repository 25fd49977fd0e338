//! Colours, and what AOVs keep, of what is seen.

use umber_bvh::Hit;
use umber_geometry::Attribute;
use umber_math::{DVec3, Normal3, Point3, Rgb, Vec3, Vector3};
use umber_settings::RasterColor;

use super::fill::Seen;
use super::placement::Placement;
use super::project::Grid;
use crate::film::CenterHit;
use crate::material::in_unit;
use crate::mesh::RenderMesh;
use crate::scene::RenderScene;
use crate::surface;

/// Shades pixels; goes on from the triangle of the pixel before, where it is the same.
pub struct Shader<'a> {
    scene: &'a RenderScene,
    grid: &'a Grid,
    placements: &'a [Placement],
    directions: Directions,
    seen: Seen,
    triangle: Option<Triangle<'a>>,
}

/// The directions of view rays, render space: linear over the film.
#[derive(Clone, Copy)]
struct Directions {
    /// Through the film's middle.
    middle: Vec3,
    /// Change by one pixel across, and one up.
    across: Vec3,
    up: Vec3,
}

/// What is the same for all pixels of a triangle.
struct Triangle<'a> {
    placement: &'a Placement,
    mesh: &'a RenderMesh,
    index: u32,
    /// Products with a film position from the middle, and one, that are as the barycentrics.
    weights: [DVec3; 3],
    points: [Vec3; 3],
    /// Of its face, object space, not of unit length.
    normal: Vec3,
    /// Of its material, where that has one for all of it.
    color: Option<Rgb>,
    emission: Rgb,
}

impl<'a> Shader<'a> {
    /// A shader of what the placements show.
    pub fn new(scene: &'a RenderScene, grid: &'a Grid, placements: &'a [Placement]) -> Self {
        let [middle, across, up] = grid.directions();
        let directions = Directions { middle, across, up };
        Self { scene, grid, placements, directions, seen: Seen::NOTHING, triangle: None }
    }

    /// Its colour at the middle of a pixel; `None` where nothing is seen.
    pub fn color(&mut self, seen: Seen, [x, y]: [i32; 2]) -> Option<Rgb> {
        if self.scene.settings.raster_color == RasterColor::Shaded {
            return self.headlit(seen, [x, y]);
        }
        let by_polygon = self.scene.settings.raster_color == RasterColor::Random;
        let Triangle { mesh, index, .. } = self.triangle(seen)?;
        let polygon = if by_polygon { mesh.shape.mesh.elements[*index as usize] } else { u32::MAX };
        Some(Rgb(random_color([mesh.prim_id as u32, polygon])))
    }

    /// Its colour, lit from the eye.
    fn headlit(&mut self, seen: Seen, pixel: [i32; 2]) -> Option<Rgb> {
        let (film, direction) = (self.film_position(pixel), self.direction(pixel));
        let triangle = self.triangle(seen)?;
        let barycentrics = triangle.barycentrics(film);
        let normal = triangle.shading_normal(barycentrics);
        let cos = normal.dot(direction).abs() / (normal.length_squared() * direction.length_squared()).sqrt();
        // what is not a number faces nothing
        let cos = if cos > 0.0 { cos.min(1.0) } else { 0.0 };
        let color = triangle.color.unwrap_or_else(|| triangle.display_color(barycentrics));
        Some(color * cos + triangle.emission)
    }

    /// What AOVs keep of it.
    pub fn center(&mut self, seen: Seen, pixel: [i32; 2]) -> Option<CenterHit> {
        let (scene, film, direction) = (self.scene, self.film_position(pixel), self.direction(pixel));
        let triangle = self.triangle(seen)?;
        let (placement, mesh) = (triangle.placement, triangle.mesh);
        let barycentrics = triangle.barycentrics(film);
        let [p, q, r] = triangle.points;
        let point = Point3(p * barycentrics[0] + q * barycentrics[1] + r * barycentrics[2]);
        let depths = scene.camera.depths_at(placement.film_from_object.apply(point).distance as f32);
        // USD's tools show normals towards the viewer; render space is world space, moved
        let normal = Normal3(triangle.shading_normal(barycentrics)).normalized().facing(Vector3(-direction));
        let hit = Hit { t: 0.0, barycentrics, mesh: placement.mesh, triangle: triangle.index, path: placement.path };
        Some(CenterHit {
            depth: depths.projected,
            camera_depth: depths.camera,
            normal: normal.0.to_array(),
            neye: scene.camera.eye_normal(normal).0.to_array(),
            prim_id: mesh.prim_id,
            instance_id: scene.instance_id(&hit),
            element_id: mesh.shape.mesh.elements[triangle.index as usize] as i32,
            st: surface::st(scene, &hit).to_array(),
        })
    }

    /// A pixel's middle, from the film's.
    fn film_position(&self, [x, y]: [i32; 2]) -> [f64; 2] {
        [f64::from(x) + 0.5 - 0.5 * f64::from(self.grid.width), f64::from(y) + 0.5 - 0.5 * f64::from(self.grid.height)]
    }

    /// Of the view ray through a pixel's middle, not of unit length.
    fn direction(&self, pixel: [i32; 2]) -> Vec3 {
        let [x, y] = self.film_position(pixel).map(|v| v as f32);
        self.directions.middle + self.directions.across * x + self.directions.up * y
    }

    #[inline]
    fn triangle(&mut self, seen: Seen) -> Option<&Triangle<'a>> {
        if self.seen != seen {
            self.seen = seen;
            self.triangle = self
                .placements
                .get(seen.placement as usize)
                .map(|placement| Triangle::new(self.scene, self.grid, placement, seen.triangle));
        }
        self.triangle.as_ref()
    }
}

impl<'a> Triangle<'a> {
    fn new(scene: &'a RenderScene, grid: &Grid, placement: &'a Placement, index: u32) -> Self {
        let mesh = placement.mesh(scene);
        let corners = mesh.shape.triangle(index);
        let points = corners.map(|p| p.0);
        let material = scene.materials.get(mesh.material_of(index) as usize);
        Self {
            placement,
            mesh,
            index,
            weights: weights(grid, placement, corners),
            points,
            normal: (points[1] - points[0]).cross(points[2] - points[0]),
            color: material.and_then(|m| m.base_color),
            emission: material.map_or(Rgb::BLACK, |m| m.emission),
        }
    }

    fn barycentrics(&self, [x, y]: [f64; 2]) -> [f32; 3] {
        barycentrics(&self.weights, [x, y])
    }

    /// Not of unit length; render space.
    fn shading_normal(&self, barycentrics: [f32; 3]) -> Vec3 {
        let authored = self.mesh.attributes.normals.as_ref();
        let normal = authored.map(|n| n.eval(&self.mesh.shape.mesh, self.index, barycentrics));
        let usable = normal.filter(|n| *n != Vec3::ZERO && n.is_finite());
        self.placement.render_from_normal * usable.unwrap_or(self.normal)
    }

    fn display_color(&self, barycentrics: [f32; 3]) -> Rgb {
        let color: Option<&Attribute<Vec3>> = self.mesh.attributes.display_color.as_ref();
        let color = color.map_or(surface::FALLBACK_COLOR, |c| c.eval(&self.mesh.shape.mesh, self.index, barycentrics));
        in_unit(Rgb(color))
    }
}

/// The barycentrics that a triangle has at a film position are as the products of these with it: each is
/// perpendicular to the homogeneous positions of the two other corners.
pub fn weights(grid: &Grid, placement: &Placement, corners: [Point3; 3]) -> [DVec3; 3] {
    let [a, b, c] = corners.map(|p| {
        let p = placement.film_from_object.apply(p);
        DVec3::new(p.x, p.y, grid.weight(&p))
    });
    [b.cross(c), c.cross(a), a.cross(b)]
}

/// The barycentrics at a film position from the film's middle; each between 0 and 1.
#[inline]
pub fn barycentrics(weights: &[DVec3; 3], [x, y]: [f64; 2]) -> [f32; 3] {
    let b = weights.map(|w| w.x * x + w.y * y + w.z);
    let sum = b[0] + b[1] + b[2];
    let b = b.map(|w| (w / sum) as f32);
    // seen edge on, by rounding alone
    if b.iter().all(|w| w.is_finite()) { b.map(|w| w.clamp(0.0, 1.0)) } else { [1.0 / 3.0; 3] }
}

/// A colour that looks like no other's.
fn random_color(of: [u32; 2]) -> Vec3 {
    // Murmur3's mixing (Appleby 2011)
    let mix = |mut h: u32| {
        h = (h ^ h >> 16).wrapping_mul(0x85eb_ca6b);
        h = (h ^ h >> 13).wrapping_mul(0xc2b2_ae35);
        h ^ h >> 16
    };
    let hash = of.into_iter().fold(0x9e37_79b9, |h: u32, v| mix(h.rotate_left(5) ^ v).wrapping_add(h));
    let channel = |shift: u32| 0.05 + 0.95 / 1023.0 * (hash >> shift & 1023) as f32;
    Vec3::new(channel(0), channel(10), channel(20))
}
