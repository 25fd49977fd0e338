//! A tree of lights, each node bounding place, direction and power of those below it.
//!
//! Conty Estevez & Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting"; the
//! surface-area orientation heuristic builds it, without the adaptive splitting.

use umber_math::Bounds3;

use super::cluster::Cluster;
use super::receiver::View;

/// Two nodes of the same parent: they are weighed together.
#[derive(Clone, Debug)]
struct Pair {
    clusters: [Cluster; 2],
    links: [Link; 2],
}

#[derive(Clone, Copy, Debug)]
enum Link {
    /// Index of a light.
    Leaf(u32),
    /// Index of a pair.
    Inner(u32),
}

/// The tree over at least one light.
#[derive(Clone, Debug)]
pub(crate) struct LightTree {
    root: Cluster,
    first: Link,
    pairs: Vec<Pair>,
    /// For each light the turns from the root to it, first turn in the lowest bit.
    trails: Vec<u64>,
}

/// A light of a tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaf {
    pub index: u32,
    pub pmf: f32,
    /// The number that chose it, stretched to [0, 1) for further use.
    pub rest: f32,
}

const BUCKETS: usize = 12;
/// Up to this many lights are halved without asking what it costs.
const FEW: usize = 3;
/// Deeper than this, lights are halved by number: with 2³² lights a trail has at most 64 turns.
const HEURISTIC_DEPTH: u32 = 32;

const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON * 0.5;

impl LightTree {
    /// `None` without lights.
    pub fn new(lights: &[Cluster]) -> Option<Self> {
        let all = (0..lights.len() as u32).map(|i| (i, lights[i as usize].center()));
        let mut order: Vec<u32> = all.filter(|(_, center)| center.is_finite()).map(|(i, _)| i).collect();
        let root = lights.iter().copied().reduce(Cluster::union)?;
        let mut builder = Builder { lights, pairs: Vec::with_capacity(lights.len()), trails: vec![0; lights.len()] };
        if order.len() < lights.len() {
            // Far beyond numbers: place decides nothing.
            order = (0..lights.len() as u32).collect();
        }
        let first = builder.build(&mut order, 0, 0);
        Some(Self { root, first, pairs: builder.pairs, trails: builder.trails })
    }
    /// Irradiance to expect of all lights, relative.
    #[inline]
    pub fn importance(&self, view: &View) -> f32 {
        self.root.importance(view)
    }
    /// Of all lights.
    pub fn root(&self) -> &Cluster {
        &self.root
    }
    /// What to expect of each of a pair.
    #[inline]
    fn weights(pair: &Pair, view: &View) -> [f32; 2] {
        [pair.clusters[0].importance(view), pair.clusters[1].importance(view)]
    }
    /// A light and its probability; `None` where the way led to lights that do not reach the point.
    #[inline]
    pub fn sample(&self, view: &View, mut u: f32) -> Option<Leaf> {
        let (mut link, mut pmf) = (self.first, 1.0);
        loop {
            let pair = match link {
                Link::Leaf(index) => return Some(Leaf { index, pmf, rest: u }),
                Link::Inner(pair) => &self.pairs[pair as usize],
            };
            let [first, second] = Self::weights(pair, view);
            let total = first + second;
            if total <= 0.0 {
                return None;
            }
            // A branch, which is guessed ahead: what lies below is fetched before the weights are known.
            let x = u * total;
            if x < first || second <= 0.0 {
                (link, u, pmf) = (pair.links[0], x / first, pmf * (first / total));
            } else {
                (link, u, pmf) = (pair.links[1], (x - first) / second, pmf * (second / total));
            }
            u = u.min(ONE_MINUS_EPSILON);
        }
    }
    /// Probability with which [`LightTree::sample`] chooses a light.
    #[inline]
    pub fn pmf(&self, view: &View, light: usize) -> f32 {
        let (mut link, mut pmf, mut trail) = (self.first, 1.0, self.trails[light]);
        while let Link::Inner(index) = link {
            let pair = &self.pairs[index as usize];
            let weights = Self::weights(pair, view);
            let total = weights[0] + weights[1];
            if total <= 0.0 {
                return 0.0;
            }
            let side = (trail & 1) as usize;
            pmf *= weights[side] / total;
            link = pair.links[side];
            trail >>= 1;
        }
        pmf
    }
}

struct Builder<'a> {
    lights: &'a [Cluster],
    pairs: Vec<Pair>,
    trails: Vec<u64>,
}

impl Builder<'_> {
    fn cluster(&self, order: &[u32]) -> Option<Cluster> {
        order.iter().map(|&i| self.lights[i as usize]).reduce(Cluster::union)
    }
    fn build(&mut self, order: &mut [u32], depth: u32, trail: u64) -> Link {
        if let [only] = *order {
            self.trails[only as usize] = trail;
            return Link::Leaf(only);
        }
        let by_cost = depth < HEURISTIC_DEPTH && order.len() > FEW;
        let split = if by_cost { self.split(order) } else { None };
        let middle = split.unwrap_or_else(|| self.halve(order));
        let (first, second) = order.split_at_mut(middle);
        let clusters = [self.cluster(first), self.cluster(second)];
        let at = self.pairs.len();
        if let [Some(a), Some(b)] = clusters {
            self.pairs.push(Pair { clusters: [a, b], links: [Link::Leaf(0); 2] });
        }
        let links = [self.build(first, depth + 1, trail), self.build(second, depth + 1, trail | 1 << depth)];
        self.pairs[at].links = links;
        Link::Inner(at as u32)
    }
    fn centers(&self, order: &[u32]) -> Bounds3 {
        Bounds3::of_points(order.iter().map(|&i| self.lights[i as usize].center().into()))
    }
    /// Sorts lights along the longest axis.
    fn halve(&self, order: &mut [u32]) -> usize {
        let axis = self.centers(order).size().max_position();
        let middle = order.len() / 2;
        let key = |i: &u32| self.lights[*i as usize].center()[axis];
        order.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        middle
    }
    /// Sorts lights to two sides of the cheapest plane; how many are on the first side.
    fn split(&self, order: &mut [u32]) -> Option<usize> {
        let centers = self.centers(order);
        let size = centers.size();
        let bucket = |i: u32, axis: usize| {
            let x = (self.lights[i as usize].center()[axis] - centers.min[axis]) / size[axis];
            ((x * BUCKETS as f32) as usize).min(BUCKETS - 1)
        };
        let join = |a: Option<Cluster>, b: Option<Cluster>| match (a, b) {
            (Some(a), Some(b)) => Some(a.union(b)),
            (a, b) => a.or(b),
        };
        let mut best: Option<(f32, usize, usize)> = None;
        for axis in (0..3).filter(|&axis| size[axis] > 0.0) {
            let mut buckets = [None; BUCKETS];
            for &i in order.iter() {
                let b = &mut buckets[bucket(i, axis)];
                *b = join(*b, Some(self.lights[i as usize]));
            }
            let mut high = [None; BUCKETS];
            let mut above = None;
            for plane in (1..BUCKETS).rev() {
                above = join(above, buckets[plane]);
                high[plane] = above;
            }
            // Long boxes should be cut across.
            let stretch = size.max_element() / size[axis];
            let mut below = None;
            for plane in 1..BUCKETS {
                below = join(below, buckets[plane - 1]);
                let (Some(low), Some(high)) = (below, high[plane]) else { continue };
                let cost = stretch * (low.cost() + high.cost());
                if best.is_none_or(|b| cost < b.0) {
                    best = Some((cost, axis, plane));
                }
            }
        }
        let (_, axis, plane) = best?;
        order.sort_by_key(|&i| bucket(i, axis) >= plane);
        Some(order.partition_point(|&i| bucket(i, axis) < plane))
    }
}
