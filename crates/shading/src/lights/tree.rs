//! A tree of lights, each node bounding place, direction and power of those below it.
//!
//! Conty Estevez & Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting"; the
//! surface-area orientation heuristic builds it, without the adaptive splitting.

use std::f32::consts::PI;

use umber_math::{Bounds3, Vec3};

use super::Light;
use super::shaping::Beam;

/// A finite light as seen by the sampler.
#[derive(Clone, Debug)]
pub(crate) struct Emitter {
    /// Index among all lights.
    pub light: u32,
    bounds: Bounds3,
    center: Vec3,
    /// Square of half the diagonal of the bounds.
    radius_squared: f32,
    /// Radiant intensity along the brightest direction, relative.
    intensity: f32,
    /// Unit; `None` for a light that shines all around.
    facing: Option<Vec3>,
    /// Where it shines, if it is shaped.
    beam: Option<Box<Beam>>,
}

impl Emitter {
    /// `weight`: the light's power over 4 π, relative to that of the other lights.
    pub fn new(index: u32, light: &Light, weight: f32) -> Self {
        let bounds = light.bounds().unwrap_or_default();
        let facing = light.facing().map(|v| v.0);
        let shaping = light.emission().shaping.as_ref();
        let beam = shaping.map(|s| Box::new(s.beam()));
        // What a shaped light lacks in power it does not lack along its beam.
        let weight = match (shaping, &beam) {
            (Some(s), Some(beam)) => finite(weight / s.power_share() * beam.peak),
            _ => weight,
        };
        Self {
            light: index,
            bounds,
            center: bounds.center().0,
            radius_squared: bounds.size().length_squared() * 0.25,
            // A flat light sends its power into a cosine lobe: a fourth of the steradians of the sphere.
            intensity: if facing.is_some() { 4.0 * weight } else { weight },
            facing,
            beam,
        }
    }
    /// Irradiance to expect at a point, relative; zero only where none of its light arrives.
    #[inline]
    pub fn importance(&self, p: Vec3) -> f32 {
        let to_point = p - self.center;
        let softened = to_point.length_squared() + self.radius_squared;
        let cos = self.facing.map_or(1.0, |n| {
            let height = to_point.dot(n);
            // Low above the light's plane its far side counts as well.
            if height > 0.0 { (height + 0.5 * self.radius_squared.sqrt()) / softened.sqrt() } else { 0.0 }
        });
        let plain = finite(self.intensity * cos / softened);
        self.beam.as_ref().map_or(plain, |beam| plain * beam.toward(to_point, self.radius_squared))
    }
    /// Directions in which it shines.
    fn cone(&self) -> Cone {
        let right_angle = PI * 0.5;
        match (self.facing, &self.beam) {
            (Some(axis), Some(beam)) if axis.dot(beam.axis) > 0.9999 => {
                Cone { axis, cos: 1.0, edge: beam.end.min(right_angle) }
            }
            (Some(axis), _) => Cone { axis, cos: 1.0, edge: right_angle },
            (None, Some(beam)) if beam.end < 0.9 * PI => Cone { axis: beam.axis, cos: 1.0, edge: beam.end },
            (None, _) => Cone::ALL,
        }
    }
}

#[inline]
fn finite(importance: f32) -> f32 {
    if importance.is_nan() { 0.0 } else { importance.min(1e30) }
}

/// Directions within θ of an axis; θ = π for all.
#[derive(Clone, Copy, Debug)]
struct Cone {
    axis: Vec3,
    cos: f32,
    /// How far off its own axis each light shines at most, radians.
    edge: f32,
}

impl Cone {
    const ALL: Self = Self { axis: Vec3::Z, cos: -1.0, edge: PI };

    fn union(self, o: Self) -> Self {
        let (a, b) = if self.cos <= o.cos { (self, o) } else { (o, self) };
        let (theta_a, theta_b) = (a.cos.clamp(-1.0, 1.0).acos(), b.cos.clamp(-1.0, 1.0).acos());
        let between = a.axis.angle_between(b.axis);
        let edge = a.edge.max(b.edge);
        if (between + theta_b).min(PI) <= theta_a {
            return Self { edge, ..a };
        }
        let theta = (theta_a + between + theta_b) * 0.5;
        let perpendicular = a.axis.cross(b.axis);
        if theta >= PI || perpendicular.length_squared() < 1e-12 {
            return Self::ALL;
        }
        let turn = glam::Quat::from_axis_angle(perpendicular.normalize(), theta - theta_a);
        Self { axis: (turn * a.axis).normalize(), cos: theta.cos(), edge }
    }
    /// Solid angle that lights facing within the cone shine into, weighted by how much.
    fn measure(self) -> f32 {
        let theta = self.cos.clamp(-1.0, 1.0).acos();
        let edge = (theta + self.edge).min(PI);
        let sin = theta.sin();
        2.0 * PI * (1.0 - self.cos)
            + PI * 0.5 * (2.0 * edge * sin - (theta - 2.0 * edge).cos() - 2.0 * theta * sin + self.cos)
    }
}

/// What is known of all lights below a node.
#[derive(Clone, Copy, Debug)]
struct Cluster {
    bounds: Bounds3,
    cone: Cone,
    intensity: f32,
}

impl Cluster {
    const EMPTY: Self = Self { bounds: Bounds3::EMPTY, cone: Cone::ALL, intensity: 0.0 };

    fn of(e: &Emitter) -> Self {
        Self { bounds: e.bounds, cone: e.cone(), intensity: e.intensity }
    }
    fn union(self, o: Self) -> Self {
        if self.intensity == 0.0 {
            return o;
        }
        if o.intensity == 0.0 {
            return self;
        }
        let cone = self.cone.union(o.cone);
        Self { bounds: self.bounds.union(o.bounds), cone, intensity: self.intensity + o.intensity }
    }
    fn cost(&self) -> f32 {
        let s = self.bounds.size();
        self.intensity * self.cone.measure() * (s.x * s.y + s.y * s.z + s.z * s.x)
    }
    #[inline]
    fn importance(&self, p: Vec3) -> f32 {
        let to_point = p - self.bounds.center().0;
        let distance_squared = to_point.length_squared();
        let radius_squared = self.bounds.size().length_squared() * 0.25;
        let softened = distance_squared + radius_squared;
        if self.cone.cos <= -1.0 || distance_squared <= radius_squared {
            return finite(self.intensity / softened);
        }
        // The least angle between a light's facing and a direction from it to the point: bounds of both taken off.
        let cos_axis = (self.cone.axis.dot(to_point) / distance_squared.sqrt()).clamp(-1.0, 1.0);
        let slack = self.cone.cos.acos() + (radius_squared / distance_squared).sqrt().asin();
        let angle = (cos_axis.acos() - slack).max(0.0);
        // A little more than the edge: rounding must not hide a light.
        if angle >= self.cone.edge + 1e-3 { 0.0 } else { finite(self.intensity * angle.cos().max(1e-3) / softened) }
    }
}

#[derive(Clone, Debug)]
enum Node {
    /// Index of the emitter.
    Leaf(u32),
    /// The second child; the first follows the node.
    Inner(Cluster, u32),
}

/// The tree over at least one emitter.
#[derive(Clone, Debug)]
pub(crate) struct LightTree {
    nodes: Vec<Node>,
    emitters: Vec<Emitter>,
    /// For each emitter the turns from the root to it, first turn in the lowest bit.
    trails: Vec<u64>,
}

const BUCKETS: usize = 12;
/// Deeper than this, lights are halved by number: with 2³² lights a trail has at most 64 turns.
const HEURISTIC_DEPTH: u32 = 32;

impl LightTree {
    pub fn new(emitters: Vec<Emitter>) -> Self {
        let mut tree = Self { nodes: Vec::new(), trails: vec![0; emitters.len()], emitters };
        let mut order: Vec<u32> = (0..tree.emitters.len() as u32).collect();
        tree.build(&mut order, 0, 0);
        tree
    }
    fn build(&mut self, order: &mut [u32], depth: u32, trail: u64) {
        if let [only] = *order {
            self.trails[only as usize] = trail;
            self.nodes.push(Node::Leaf(only));
            return;
        }
        let of = |i: &u32| Cluster::of(&self.emitters[*i as usize]);
        let cluster = order.iter().map(of).fold(Cluster::EMPTY, Cluster::union);
        let middle = if depth < HEURISTIC_DEPTH { self.split(order) } else { None }.unwrap_or(order.len() / 2);
        let at = self.nodes.len();
        self.nodes.push(Node::Inner(cluster, 0));
        let (first, second) = order.split_at_mut(middle);
        self.build(first, depth + 1, trail);
        self.nodes[at] = Node::Inner(cluster, self.nodes.len() as u32);
        self.build(second, depth + 1, trail | 1 << depth);
    }
    /// Sorts lights to two sides of the cheapest plane; how many are on the first side.
    fn split(&self, order: &mut [u32]) -> Option<usize> {
        let centers = Bounds3::of_points(order.iter().map(|&i| self.emitters[i as usize].center.into()));
        let size = centers.size();
        let bucket = |i: u32, axis: usize| {
            let x = (self.emitters[i as usize].center[axis] - centers.min[axis]) / size[axis];
            ((x * BUCKETS as f32) as usize).min(BUCKETS - 1)
        };
        let mut best: Option<(f32, usize, usize)> = None;
        for axis in (0..3).filter(|&axis| size[axis] > 0.0) {
            let mut buckets = [Cluster::EMPTY; BUCKETS];
            for &i in order.iter() {
                let b = &mut buckets[bucket(i, axis)];
                *b = b.union(Cluster::of(&self.emitters[i as usize]));
            }
            // Long boxes should be cut across.
            let stretch = size.max_element() / size[axis];
            for plane in 1..BUCKETS {
                let side = |b: &[Cluster]| b.iter().copied().fold(Cluster::EMPTY, Cluster::union);
                let (low, high) = (side(&buckets[..plane]), side(&buckets[plane..]));
                let cost = stretch * (low.cost() + high.cost());
                let is_split = low.intensity > 0.0 && high.intensity > 0.0;
                if is_split && best.is_none_or(|b| cost < b.0) {
                    best = Some((cost, axis, plane));
                }
            }
        }
        let (_, axis, plane) = best?;
        order.sort_by_key(|&i| bucket(i, axis) >= plane);
        Some(order.partition_point(|&i| bucket(i, axis) < plane))
    }
    #[inline]
    fn node_importance(&self, node: u32, p: Vec3) -> f32 {
        match &self.nodes[node as usize] {
            Node::Leaf(emitter) => self.emitters[*emitter as usize].importance(p),
            Node::Inner(cluster, _) => cluster.importance(p),
        }
    }
    /// Irradiance to expect of all lights, relative.
    #[inline]
    pub fn importance(&self, p: Vec3) -> f32 {
        self.node_importance(0, p)
    }
    /// Probability of taking the first child.
    #[inline]
    fn first_probability(&self, node: u32, second: u32, p: Vec3) -> Option<f32> {
        let (a, b) = (self.node_importance(node + 1, p), self.node_importance(second, p));
        (a + b > 0.0).then(|| a / (a + b))
    }
    /// A light's index and its probability; `None` where the way led to lights that do not reach the point.
    #[inline]
    pub fn sample(&self, p: Vec3, mut u: f32) -> Option<(u32, f32)> {
        let (mut node, mut pmf) = (0, 1.0);
        loop {
            match self.nodes[node as usize] {
                Node::Leaf(emitter) => return Some((self.emitters[emitter as usize].light, pmf)),
                Node::Inner(_, second) => {
                    let first = self.first_probability(node, second, p)?;
                    if u < first {
                        (node, u, pmf) = (node + 1, u / first, pmf * first);
                    } else {
                        (node, u, pmf) =
                            (second, ((u - first) / (1.0 - first)).min(1.0 - f32::EPSILON), pmf * (1.0 - first));
                    }
                }
            }
        }
    }
    /// Probability with which [`LightTree::sample`] chooses an emitter.
    #[inline]
    pub fn pmf(&self, p: Vec3, emitter: usize) -> f32 {
        let (mut node, mut pmf, mut trail) = (0, 1.0, self.trails[emitter]);
        while let Node::Inner(_, second) = self.nodes[node as usize] {
            let Some(first) = self.first_probability(node, second, p) else { return 0.0 };
            (node, pmf) = if trail & 1 == 0 { (node + 1, pmf * first) } else { (second, pmf * (1.0 - first)) };
            trail >>= 1;
        }
        pmf
    }
}
