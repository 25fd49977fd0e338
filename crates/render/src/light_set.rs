//! All lights of a render scene, ready to be sampled and met by rays.

use umber_bvh::{BoundsBvh, Hit};
use umber_math::{Bounds3, Ray, Rgb};
use umber_shading::{Light, LightSampler, Receiver};

use crate::compile::Emitters;
use crate::emitter_index::{EmitterIndex, FoundEmitter};

/// Up to so many shapes are tried one by one.
const FEW: usize = 4;

/// The lights and the structures over them.
pub struct LightSet {
    lights: Vec<Light>,
    sampler: LightSampler,
    /// Lights that have a place and a size, and the hierarchy over their boxes.
    shapes: Vec<u32>,
    shapes_bvh: BoundsBvh,
    /// Lights that rays meet when they leave the scene.
    infinite: Vec<u32>,
    /// Radius of a sphere around the scene, as the samplers want it.
    scene_radius: f32,
    /// Lights that are geometry.
    emitters: EmitterIndex,
}

/// A ray's hit with a light.
#[derive(Clone, Copy, Debug)]
pub struct ShapeHit {
    /// Which light.
    pub light: u32,
    /// Radiance towards the ray's origin.
    pub radiance: Rgb,
}

impl Default for LightSet {
    fn default() -> Self {
        Self::new(Vec::new(), Bounds3::EMPTY)
    }
}

impl LightSet {
    /// Lights of a scene with these bounds, both in render space. Lights that emit nothing are left out.
    pub fn new(lights: Vec<Light>, scene_bounds: Bounds3) -> Self {
        Self::with_emitters(lights, Emitters::default(), scene_bounds)
    }

    /// As [`new`](Self::new), with the lights of meshes beside the others.
    pub fn with_emitters(lights: Vec<Light>, emitters: Emitters, scene_bounds: Bounds3) -> Self {
        let mut lights: Vec<Light> = lights.into_iter().filter(|light| !light.is_black()).collect();
        let mut index = emitters.index;
        for light in emitters.lights {
            let light = light.filter(|light| !light.is_black());
            index.push_light(light.is_some().then_some(lights.len() as u32));
            lights.extend(light);
        }
        let numbered = || lights.iter().zip(0u32..);
        let has_shape = |l: &Light| l.bounds().is_some() && !l.is_delta() && l.as_mesh().is_none();
        let shapes: Vec<u32> = numbered().filter(|(l, _)| has_shape(l)).map(|l| l.1).collect();
        let boxes: Vec<Bounds3> = shapes.iter().filter_map(|i| lights[*i as usize].bounds()).collect();
        let infinite = numbered().filter(|(l, _)| l.is_infinite() && !l.is_delta()).map(|l| l.1).collect();
        let all = boxes.iter().fold(scene_bounds, |a, b| a.union(*b));
        let radius = 0.5 * all.size().length();
        let scene_radius = if radius.is_finite() { radius } else { 1.0 };
        let sampler = LightSampler::new(&lights, scene_radius);
        Self { shapes_bvh: BoundsBvh::build(&boxes), sampler, shapes, infinite, lights, scene_radius, emitters: index }
    }

    /// All lights, by index.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }
    /// Lights that rays meet when they leave the scene.
    pub fn infinite(&self) -> &[u32] {
        &self.infinite
    }
    /// A sampler over some of the lights alone; it numbers them by their place in the list.
    pub fn sampler_of(&self, lights: &[u32]) -> LightSampler {
        let chosen: Vec<Light> = lights.iter().map(|light| self.lights[*light as usize].clone()).collect();
        LightSampler::new(&chosen, self.scene_radius)
    }
    /// What emits at a hit with geometry; `None` where nothing does.
    #[inline]
    pub fn emitter_at(&self, hit: &Hit) -> Option<FoundEmitter> {
        self.emitters.find(hit)
    }
    /// Chooses a light for a receiver: its index and the probability of the choice. See [`LightSampler::sample_with`].
    #[inline]
    pub fn choose(&self, receiver: &Receiver, u: impl FnOnce() -> f32) -> Option<(u32, f32)> {
        self.sampler.sample_with(receiver, u).map(|(index, pmf)| (index as u32, pmf))
    }
    /// Probability with which [`choose`](Self::choose) takes a light.
    #[inline]
    pub fn pmf(&self, receiver: &Receiver, light: u32) -> f32 {
        self.sampler.pmf(receiver, light as usize)
    }

    /// Those of some lights that have a place and a size; `None` where they are too many to be tried one by one.
    pub fn few_shapes(&self, among: impl Fn(u32) -> bool) -> Option<Box<[u32]>> {
        let shapes: Box<[u32]> = self.shapes.iter().copied().filter(|light| among(*light)).take(FEW + 1).collect();
        (shapes.len() <= FEW).then_some(shapes)
    }

    /// The nearest light shape on a ray. A side that does not emit is black; the camera looks through it.
    #[inline]
    pub fn intersect(&self, ray: &Ray, camera: bool) -> Option<ShapeHit> {
        let mut nearest = None;
        self.each_shape(ray, |light, t_max| self.meet(light, &Ray { t_max, ..*ray }, camera, &mut nearest));
        nearest
    }

    /// As [`intersect`](Self::intersect) for others than the camera, among some lights: the others are not there.
    #[inline]
    pub fn intersect_among(&self, ray: &Ray, among: impl Fn(u32) -> bool) -> Option<ShapeHit> {
        let mut nearest = None;
        let meet = |light: u32, t_max| self.meet(light, &Ray { t_max, ..*ray }, false, &mut nearest);
        self.each_shape(ray, only(among, meet));
        nearest
    }

    /// The same, among [`few_shapes`](Self::few_shapes). Of shapes that lie in one another the first is met, as where
    /// all are few; a hierarchy may come to another one first.
    #[inline]
    pub fn intersect_few(&self, ray: &Ray, shapes: &[u32]) -> Option<ShapeHit> {
        let mut nearest = None;
        each_of(shapes, ray.t_max, |light, t_max| self.meet(light, &Ray { t_max, ..*ray }, false, &mut nearest));
        nearest
    }

    /// Sets the nearest shape where a ray meets a light. Gives the ray's new end.
    #[inline]
    fn meet(&self, index: u32, ray: &Ray, camera: bool, nearest: &mut Option<ShapeHit>) -> Option<f32> {
        let light = &self.lights[index as usize];
        if camera && !light.camera_visible() {
            return None;
        }
        let hit = light.intersect(ray)?;
        if camera && !hit.is_front {
            return None;
        }
        *nearest = Some(ShapeHit { light: index, radiance: hit.radiance });
        Some(hit.t)
    }

    /// Whether a light shape other than `target` lies on a ray.
    #[inline]
    pub fn occluded(&self, ray: &Ray, target: u32) -> bool {
        if self.shapes[..] == [target] {
            return false;
        }
        let mut occluded = false;
        self.each_shape(ray, |light, t_max| self.find_occluder(light, &Ray { t_max, ..*ray }, target, &mut occluded));
        occluded
    }

    /// As [`occluded`](Self::occluded), among some lights: the others are not there.
    #[inline]
    pub fn occluded_among(&self, ray: &Ray, target: u32, among: impl Fn(u32) -> bool) -> bool {
        let mut occluded = false;
        let find = |light: u32, t_max| self.find_occluder(light, &Ray { t_max, ..*ray }, target, &mut occluded);
        self.each_shape(ray, only(among, find));
        occluded
    }

    /// The same, among [`few_shapes`](Self::few_shapes).
    #[inline]
    pub fn occluded_few(&self, ray: &Ray, target: u32, shapes: &[u32]) -> bool {
        if *shapes == [target] {
            return false;
        }
        let mut occluded = false;
        each_of(shapes, ray.t_max, |light, t_max| {
            self.find_occluder(light, &Ray { t_max, ..*ray }, target, &mut occluded)
        });
        occluded
    }

    /// Sets `occluded` where a ray, if nothing was on it so far, meets a light other than `target`. Gives its new end.
    #[inline]
    fn find_occluder(&self, light: u32, ray: &Ray, target: u32, occluded: &mut bool) -> Option<f32> {
        if *occluded || light == target {
            return None;
        }
        *occluded = self.lights[light as usize].intersect(ray).is_some();
        occluded.then_some(ray.t_min)
    }

    /// Calls `visit` for each light whose shape a ray may meet, with the ray's end so far; what it gives becomes the
    /// new end. A few are not worth a hierarchy.
    #[inline]
    fn each_shape(&self, ray: &Ray, mut visit: impl FnMut(u32, f32) -> Option<f32>) {
        if self.shapes.len() > FEW {
            self.shapes_bvh.traverse(ray, |slot, t_max| visit(self.shapes[slot as usize], t_max));
        } else {
            each_of(&self.shapes, ray.t_max, visit);
        }
    }

    /// The distance along a ray to the nearest light shape other than `target`, among some lights.
    pub fn nearest_occluder(&self, ray: &Ray, target: u32, among: impl Fn(u32) -> bool) -> Option<f32> {
        let mut nearest = None;
        self.each_shape(ray, |index, t_max| {
            if index == target || !among(index) {
                return None;
            }
            nearest = self.lights[index as usize].intersect(&Ray { t_max, ..*ray }).map(|hit| hit.t).or(nearest);
            nearest
        });
        nearest
    }
}

/// Calls `visit` for some lights, as [`LightSet::each_shape`]. `end`: the ray's.
#[inline]
fn each_of(shapes: &[u32], mut end: f32, mut visit: impl FnMut(u32, f32) -> Option<f32>) {
    for &light in shapes {
        end = visit(light, end).unwrap_or(end);
    }
}

/// Visits some lights alone.
#[inline]
fn only(
    among: impl Fn(u32) -> bool,
    mut visit: impl FnMut(u32, f32) -> Option<f32>,
) -> impl FnMut(u32, f32) -> Option<f32> {
    move |light, end| if among(light) { visit(light, end) } else { None }
}
