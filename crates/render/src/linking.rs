//! Light and shadow linking: which lights reach a surface, and what stands in their way.
//!
//! For a surface that a light is not linked to the light is not there: it is not chosen, and rays from the surface
//! pass through its shape. The camera sees all lights. A light with a shadow link is shadowed by the meshes of its
//! collection alone; as rays that look for the light by chance know nothing of that, such a light is found by light
//! samples alone, and its shape is seen by the camera and in mirrors, where nothing at all is in between.

use std::collections::HashMap;
use std::sync::Arc;

use umber_bvh::Hit;
use umber_math::Ray;
use umber_scene::Category;
use umber_shading::{LightSampler, Receiver};

use crate::compile::Membership;
use crate::light_set::{LightSet, ShapeHit};
use crate::scene::{MAX_PASSES, RenderScene};
use crate::surface;

/// Most lights that the samplers of all sets hold together: beyond it one sampler serves all surfaces, and a light that
/// it chooses in vain counts as dark.
const MOST_ENTRIES: usize = 1 << 22;

/// The links of one light, as the host says them.
#[derive(Clone, Debug, Default)]
pub struct LightLinks {
    /// Category of what it illuminates.
    pub light: Option<Category>,
    /// Category of what casts shadows in its light.
    pub shadow: Option<Category>,
}

/// What of a scene's linking concerns the things at the end of a ray.
#[derive(Clone, Copy, Debug, Default)]
pub struct Links(u32);

/// A link that leaves something out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Link {
    All,
    /// What has this bit in its set.
    Bit(u32),
    Nothing,
}

/// Categories of some instances, and how they choose lights.
struct Set {
    /// One bit a category that a light's link names.
    bits: Box<[u64]>,
    /// Index of the sampler over the lights that reach them; `None`: the one over all.
    chooser: Option<u32>,
    /// The lights with a place and a size that reach them, where those are few.
    shapes: Option<Box<[u32]>>,
}

/// A sampler over some lights.
struct Chooser {
    sampler: LightSampler,
    /// The lights that it knows.
    lights: Vec<u32>,
    /// By light: where it is among them.
    positions: Vec<Option<u32>>,
}

/// The linking of a scene. Scenes without links, or whose links all cover everything, have none.
pub struct Linking {
    /// Index of the set of each instance of the hierarchy's top level.
    of_instance: Vec<u32>,
    sets: Vec<Set>,
    /// By light: what it illuminates, and what casts shadows in its light.
    lights: Vec<[Link; 2]>,
    choosers: Vec<Chooser>,
}

impl Set {
    #[inline]
    fn has(&self, link: Link) -> bool {
        match link {
            Link::All => true,
            Link::Bit(bit) => self.bits[bit as usize / 64] >> (bit % 64) & 1 == 1,
            Link::Nothing => false,
        }
    }
    /// Whether a light reaches it. `links`: of the lights that a host links.
    #[inline]
    fn is_lit(&self, links: &[[Link; 2]], light: u32) -> bool {
        self.has(of_light(links, light)[0])
    }
}

/// What a light illuminates, and what casts shadows in its light. Lights that no host links reach all.
#[inline]
fn of_light(links: &[[Link; 2]], light: u32) -> [Link; 2] {
    links.get(light as usize).copied().unwrap_or([Link::All; 2])
}

impl Linking {
    /// The linking of a scene, `None` where nothing is left out. `links`: those of the set's lights, by index.
    pub fn new(membership: Option<&Membership>, links: &[LightLinks], lights: &LightSet) -> Option<Self> {
        let named = links.iter().flat_map(|links| [&links.light, &links.shadow]).flatten();
        let mut bits: HashMap<&Category, u32> = HashMap::new();
        for category in named {
            let next = bits.len() as u32;
            bits.entry(category).or_insert(next);
        }
        if bits.is_empty() {
            return None;
        }
        let nobody: [Arc<[Category]>; 1] = Default::default();
        let sets = membership.map_or(&nobody[..], |m| &m.sets[..]);
        let words = bits.len().div_ceil(64);
        let mut sets: Vec<Set> = sets
            .iter()
            .map(|categories| {
                let mut set = vec![0u64; words];
                for bit in categories.iter().filter_map(|category| bits.get(category)) {
                    set[*bit as usize / 64] |= 1 << (bit % 64);
                }
                Set { bits: set.into(), chooser: None, shapes: None }
            })
            .collect();
        let link = |category: &Option<Category>| {
            let bit = category.as_ref().map_or(Link::All, |category| Link::Bit(bits[category]));
            match sets.iter().filter(|set| set.has(bit)).count() {
                0 => Link::Nothing,
                n if n == sets.len() => Link::All,
                _ => bit,
            }
        };
        let links: Vec<[Link; 2]> = links.iter().map(|links| [link(&links.light), link(&links.shadow)]).collect();
        if links.iter().flatten().all(|link| *link == Link::All) {
            return None;
        }
        for set in &mut sets {
            set.shapes = lights.few_shapes(|light| set.is_lit(&links, light));
        }
        let choosers = choosers(&mut sets, &links, lights);
        let of_instance = membership.map(|m| m.of_instance.clone()).unwrap_or_default();
        Some(Self { of_instance, sets, lights: links, choosers })
    }

    #[inline]
    fn set_at(&self, hit: &Hit) -> &Set {
        &self.sets[self.links_at(hit).0 as usize]
    }
    #[inline]
    fn links_at(&self, hit: &Hit) -> Links {
        let outermost = hit.path.as_slice().first().and_then(|index| self.of_instance.get(*index as usize));
        Links(outermost.copied().unwrap_or(0))
    }
    #[inline]
    fn of_light(&self, light: u32) -> [Link; 2] {
        of_light(&self.lights, light)
    }
    #[inline]
    fn is_lit(&self, links: Links, light: u32) -> bool {
        self.sets[links.0 as usize].is_lit(&self.lights, light)
    }
    /// The lights with a place and a size that reach a surface, where those are few.
    #[inline]
    fn shapes(&self, links: Links) -> Option<&[u32]> {
        self.sets[links.0 as usize].shapes.as_deref()
    }
    #[inline]
    fn chooser(&self, links: Links) -> Option<&Chooser> {
        self.sets[links.0 as usize].chooser.map(|chooser| &self.choosers[chooser as usize])
    }
}

/// Gives the sets their samplers; sets that the same lights reach share one.
fn choosers(sets: &mut [Set], links: &[[Link; 2]], lights: &LightSet) -> Vec<Chooser> {
    let count = lights.lights().len();
    let mut choosers: Vec<Chooser> = Vec::new();
    let mut known: HashMap<Vec<u32>, u32> = HashMap::new();
    for set in sets {
        let reaches = |light: &u32| set.is_lit(links, *light);
        let reaching: Vec<u32> = (0..count as u32).filter(reaches).collect();
        if reaching.len() == count {
            continue;
        }
        if let Some(chooser) = known.get(&reaching) {
            set.chooser = Some(*chooser);
        } else if (choosers.len() + 1) * count <= MOST_ENTRIES {
            let mut positions = vec![None; count];
            reaching.iter().zip(0..).for_each(|(light, position)| positions[*light as usize] = Some(position));
            let chooser = Chooser { sampler: lights.sampler_of(&reaching), lights: reaching.clone(), positions };
            set.chooser = Some(choosers.len() as u32);
            known.insert(reaching, choosers.len() as u32);
            choosers.push(chooser);
        }
    }
    choosers
}

impl RenderScene {
    /// The links of what a ray met.
    #[inline]
    pub fn links_at(&self, hit: &Hit) -> Links {
        self.linking.as_ref().map_or(Links::default(), |linking| linking.links_at(hit))
    }

    /// Chooses a light for a surface: its index and the probability of the choice. `u` gives a number in [0, 1) where
    /// there is a choice.
    #[inline]
    pub fn choose_light(&self, links: Links, receiver: &Receiver, u: impl FnOnce() -> f32) -> Option<(u32, f32)> {
        let Some(linking) = &self.linking else { return self.lights.choose(receiver, u) };
        let Some(chooser) = linking.chooser(links) else {
            return self.lights.choose(receiver, u).filter(|(light, _)| linking.is_lit(links, *light));
        };
        chooser.sampler.sample_with(receiver, u).map(|(position, pmf)| (chooser.lights[position], pmf))
    }

    /// Probability with which [`choose_light`](Self::choose_light) takes a light.
    #[inline]
    pub fn light_pmf(&self, links: Links, receiver: &Receiver, light: u32) -> f32 {
        let Some(chooser) = self.linking.as_ref().and_then(|linking| linking.chooser(links)) else {
            return self.lights.pmf(receiver, light);
        };
        let position = chooser.positions.get(light as usize).copied().flatten();
        position.map_or(0.0, |position| chooser.sampler.pmf(receiver, position as usize))
    }

    /// Whether a light illuminates a surface.
    #[inline]
    pub fn is_lit(&self, links: Links, light: u32) -> bool {
        self.linking.as_ref().is_none_or(|linking| linking.is_lit(links, light))
    }

    /// Whether rays that follow the BSDF find what a light gives: not where it shines through some things, or all.
    #[inline]
    pub fn is_found_by_rays(&self, light: u32) -> bool {
        let all_shadow = || self.linking.as_ref().is_none_or(|linking| linking.of_light(light)[1] == Link::All);
        !self.lights.lights()[light as usize].found_by_samples_alone() && all_shadow()
    }

    /// The nearest light shape on a ray from a surface with these links; `None`: from the camera.
    #[inline]
    pub fn light_on(&self, ray: &Ray, links: Option<Links>) -> Option<ShapeHit> {
        match (links, &self.linking) {
            (None, _) => self.lights.intersect(ray, true),
            (Some(_), None) => self.lights.intersect(ray, false),
            (Some(links), Some(linking)) => match linking.shapes(links) {
                Some(shapes) => self.lights.intersect_few(ray, shapes),
                None => self.lights.intersect_among(ray, |light| linking.is_lit(links, light)),
            },
        }
    }

    /// How much of a light's radiance arrives at a surface along a ray that ends at the light.
    #[inline]
    pub fn arriving(&self, ray: Ray, light: u32, links: Links, rays: &mut u64) -> f32 {
        let occluded = match &self.linking {
            None => self.lights.occluded(&ray, light),
            Some(linking) => match linking.of_light(light)[1] {
                Link::Nothing => return 1.0,
                Link::All => match linking.shapes(links) {
                    Some(shapes) => self.lights.occluded_few(&ray, light, shapes),
                    None => self.lights.occluded_among(&ray, light, |other| linking.is_lit(links, other)),
                },
                link @ Link::Bit(_) => return self.transmittance_of(linking, link, ray, rays),
            },
        };
        if occluded { 0.0 } else { self.transmittance(ray, rays) }
    }

    /// Whether what a ray met casts shadows in a light.
    #[inline]
    pub fn casts_shadow(&self, hit: &Hit, light: u32) -> bool {
        self.linking.as_ref().is_none_or(|linking| linking.set_at(hit).has(linking.of_light(light)[1]))
    }

    /// The distance along a ray from a surface to the nearest light shape that casts shadows in a light.
    pub fn nearest_casting_shape(&self, ray: &Ray, light: u32, links: Links) -> Option<f32> {
        match &self.linking {
            None => self.lights.nearest_occluder(ray, light, |_| true),
            Some(linking) if linking.of_light(light)[1] == Link::All => {
                self.lights.nearest_occluder(ray, light, |other| linking.is_lit(links, other))
            }
            Some(_) => None,
        }
    }

    /// As [`transmittance`](Self::transmittance), where only what is linked stands in the way.
    fn transmittance_of(&self, linking: &Linking, link: Link, mut ray: Ray, rays: &mut u64) -> f32 {
        let mut through = 1.0;
        for _ in 0..MAX_PASSES {
            *rays += 1;
            let Some(hit) = self.top.closest_hit(&ray) else { return through };
            if linking.set_at(&hit).has(link) {
                through *= if self.partly_present { 1.0 - surface::presence(self, &hit) } else { 0.0 };
            }
            if through <= 0.0 {
                return 0.0;
            }
            ray.t_min = hit.t;
        }
        0.0
    }
}
