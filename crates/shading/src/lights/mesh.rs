//! Light from the triangles of a mesh: one that stands somewhere, of those that share its triangles.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{DAffine3, Vec2};
use umber_math::{Bounds3, Normal3, Point3, Rgb, Vec3, Vector3, keeps_angles};

use super::LightSample;
use super::cluster::{Cluster, Cone};
use super::params::{Emission, LightParams, LightProblem};
use super::receiver::{Receiver, View};
use super::tree::LightTree;
use super::triangle::Triangle;

/// A triangle that emits.
#[derive(Clone, Copy, Debug)]
pub struct EmitterTriangle {
    /// Its number in the mesh.
    pub index: u32,
    /// Object space.
    pub corners: [Point3; 3],
    /// Radiance, times what the light that it belongs to has.
    pub radiance: Rgb,
    /// Probability that a ray meets it instead of passing through, 0 … 1.
    pub presence: f32,
}

/// The triangles of a mesh that emit, in object space, and a tree over them; shared by all that show the mesh.
#[derive(Clone, Debug)]
pub struct EmitterMesh {
    triangles: Vec<EmitterTriangle>,
    tree: LightTree,
    /// Position in `triangles` by number in the mesh; [`NONE`] for those that do not emit.
    positions: Vec<u32>,
    /// Whether the side that the winding turns away from emits as well.
    two_sided: bool,
    /// Sum of area times radiance, object space.
    emission: f64,
    bounds: Bounds3,
}

const NONE: u32 = u32::MAX;
/// By how much the end of a ray is off, relative to its length, as its direction and its parameter are rounded.
const ROUNDED_DIRECTION: f64 = 4.0 * f32::EPSILON as f64;

impl EmitterMesh {
    /// Triangles without area, or black, are left out; `None` where no other is left.
    pub fn new(triangles: impl IntoIterator<Item = EmitterTriangle>, two_sided: bool) -> Option<Self> {
        let area = |t: &EmitterTriangle| Triangle::new(t.corners.map(|c| c.0.as_dvec3())).map(|made| made.area);
        let weighed: Vec<(EmitterTriangle, f64)> = triangles
            .into_iter()
            .filter_map(|t| Some((t, area(&t)? * f64::from(t.radiance.luminance() * t.presence))))
            .filter(|(_, w)| *w > 0.0 && w.is_finite())
            .collect();
        let brightest = weighed.iter().map(|(_, w)| *w).fold(0.0, f64::max);
        let clusters: Vec<Cluster> = weighed
            .iter()
            .map(|(t, w)| {
                let [a, b, c] = t.corners.map(|c| c.0.as_dvec3());
                let axis = (b - a).cross(c - a).normalize_or_zero().as_vec3();
                let weight = ((w / brightest) as f32).max(1e-30);
                Cluster::new(Bounds3::of_points(t.corners), Cone::flat(axis, two_sided), weight)
            })
            .collect();
        let tree = LightTree::new(&clusters)?;
        let triangles: Vec<EmitterTriangle> = weighed.iter().map(|(t, _)| *t).collect();
        let mut positions = vec![NONE; triangles.iter().map(|t| t.index as usize + 1).max().unwrap_or(0)];
        for (position, triangle) in (0..).zip(&triangles) {
            positions[triangle.index as usize] = position;
        }
        let bounds = tree.root().bounds();
        let emission = weighed.iter().map(|(_, w)| w).sum();
        Some(Self { triangles, tree, positions, two_sided, emission, bounds })
    }
    /// How many triangles emit.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }
    /// Never: there is at least one.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }
    /// The box around them, object space.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }
    fn of(&self, index: u32) -> Option<(usize, &EmitterTriangle)> {
        let position = *self.positions.get(index as usize)?;
        Some((position as usize, self.triangles.get(position as usize)?))
    }
    /// Area where a transform puts it.
    fn area(&self, render_from_object: &DAffine3) -> f64 {
        let placed = |t: &EmitterTriangle| t.corners.map(|c| render_from_object.transform_point3(c.0.as_dvec3()));
        self.triangles.iter().filter_map(|t| Triangle::new(placed(t))).map(|t| t.area).sum()
    }
}

/// A mesh that emits, at its place.
#[derive(Clone, Debug)]
pub struct MeshLight {
    pub(crate) emission: Emission,
    mesh: Arc<EmitterMesh>,
    render_from_object: DAffine3,
    object_from_render: DAffine3,
    /// Sign of the transform's determinant: mirrored, the winding turns away from the side that emits.
    handedness: f64,
    /// How far, by rounding, rays that are to end on a triangle may meet it elsewhere; render-space units.
    clearance: f32,
}

impl MeshLight {
    /// `clearance`: as far as the rounding of places moves the triangles for rays.
    pub(crate) fn new(
        p: &LightParams,
        mesh: Arc<EmitterMesh>,
        clearance: f32,
        problems: &mut Vec<LightProblem>,
    ) -> Result<Self, LightProblem> {
        let m = p.render_from_light;
        let (object_from_render, determinant) = (m.inverse(), m.matrix3.determinant());
        if determinant == 0.0 || !object_from_render.is_finite() {
            return Err(LightProblem::SingularTransform);
        }
        let area = if p.normalize { mesh.area(&m) } else { 1.0 };
        if area <= 0.0 || !area.is_finite() {
            return Err(LightProblem::NoArea);
        }
        let emission = Emission::new(p, area, 1.0, problems);
        let handedness = determinant.signum();
        Ok(Self { emission, mesh, render_from_object: m, object_from_render, handedness, clearance })
    }
    #[inline]
    fn placed(&self, triangle: &EmitterTriangle) -> Option<Triangle> {
        Triangle::new(triangle.corners.map(|c| self.render_from_object.transform_point3(c.0.as_dvec3())))
    }
    /// A receiver in object space.
    #[inline]
    fn view(&self, receiver: &Receiver) -> View {
        let point = self.object_from_render.transform_point3(receiver.point.0.as_dvec3()).as_vec3();
        // Normals go by the inverse transpose, here of the inverse.
        let normal = self.render_from_object.matrix3.transpose() * receiver.normal.0.as_dvec3();
        View { point, normal: normal.normalize_or_zero().as_vec3() }
    }
    #[inline]
    pub(crate) fn sample(&self, receiver: &Receiver, u: Vec2) -> Option<LightSample> {
        let leaf = self.mesh.tree.sample(&self.view(receiver), u.x)?;
        let emitter = &self.mesh.triangles[leaf.index as usize];
        let triangle = self.placed(emitter)?;
        let p = receiver.point.0.as_dvec3();
        if !self.mesh.two_sided && triangle.height(p) * self.handedness <= 0.0 {
            return None;
        }
        let sample = triangle.sample(p, Vec2::new(leaf.rest, u.y))?;
        // A ray towards it starts beside the point, has a rounded direction, and meets the triangle where rounding
        // puts it.
        let height = f64::from(self.clearance + 2.0 * receiver.clearance) + sample.distance * ROUNDED_DIRECTION;
        let distance = (sample.distance - height / sample.wi.dot(triangle.normal).abs()).max(0.0);
        let pdf_solid_angle = (sample.pdf_solid_angle * f64::from(leaf.pmf)) as f32;
        let radiance = self.emission.radiance * emitter.radiance * emitter.presence;
        let usable = pdf_solid_angle.is_normal() && (radiance / pdf_solid_angle).is_finite();
        let wi = Vector3(sample.wi.as_vec3());
        usable.then_some(LightSample { wi, radiance, pdf_solid_angle, distance: distance as f32, is_delta: false })
    }
    /// Density with which `sample` makes `wi`, unit, by way of the triangle that it leads to.
    #[inline]
    pub fn pdf_solid_angle(&self, receiver: &Receiver, triangle: u32, wi: Vector3) -> f32 {
        let Some((position, emitter)) = self.mesh.of(triangle) else { return 0.0 };
        let Some(placed) = self.placed(emitter) else { return 0.0 };
        let pdf = placed.pdf_solid_angle(receiver.point.0.as_dvec3(), wi.0.as_dvec3());
        let pdf = pdf as f32 * self.mesh.tree.pmf(&self.view(receiver), position);
        if pdf.is_finite() { pdf } else { 0.0 }
    }
    /// Radiance of a triangle against `wi`, the direction of a ray that meets it. `normal`: in render space, by the winding.
    #[inline]
    pub fn radiance(&self, triangle: u32, wi: Vector3, normal: Normal3) -> Rgb {
        let Some((_, emitter)) = self.mesh.of(triangle) else { return Rgb::BLACK };
        let is_front = f64::from(wi.dot_normal(normal)) * self.handedness < 0.0;
        if is_front || self.mesh.two_sided { self.emission.radiance * emitter.radiance } else { Rgb::BLACK }
    }
    pub(crate) fn bounds(&self) -> Bounds3 {
        let corner = |c: Point3| Point3(self.render_from_object.transform_point3(c.0.as_dvec3()).as_vec3());
        Bounds3::of_points(self.mesh.bounds.corners().map(corner))
    }
    /// Luminance of the radiant flux, an estimate where the transform stretches.
    pub(crate) fn power(&self) -> f32 {
        let scale = self.render_from_object.matrix3.determinant().abs().powf(2.0 / 3.0);
        let sides = if self.mesh.two_sided { 2.0 } else { 1.0 };
        self.emission.radiance.luminance() * (self.mesh.emission * scale) as f32 * (sides * PI)
    }
    /// Directions that the triangles face within.
    pub(crate) fn cone(&self) -> Cone {
        let cone = self.mesh.tree.root().cone();
        let m = self.object_from_render.matrix3;
        let axis = (m.transpose() * cone.axis.as_dvec3()).normalize_or_zero().as_vec3();
        let flat = cone.cos >= 1.0 && axis != Vec3::ZERO;
        if keeps_angles(&m) || flat { Cone { axis, ..cone } } else { Cone::ALL }
    }
}
