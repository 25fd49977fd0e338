//! Where to split a set: costs at a few planes along each axis, and at a few sizes.
//!
//! Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies". That sorts by position alone, which
//! spreads the large primitives of a set, as the walls around a fine mesh, over boxes that overlap from then on. So
//! large sets are binned by size as well: the heuristic itself tells where to set the large ones apart.

use glam::Vec4;

use super::primitive::{Box4, PrimitiveBox};

/// Most bins along an axis.
const MOST_BINS: usize = 32;

/// What primitives are binned by: the axes, and size.
const KEYS: usize = 4;
/// The key that is no axis.
const SIZE: usize = 3;
/// Sets of at least as many primitives are binned by size as well.
const SIZED_SET: usize = 1024;

/// Added to a number of up to 2²², this leaves it, rounded, in the low bits.
const ROUND: f32 = 12_582_912.0;

/// From a primitive to its bin along each axis.
#[derive(Clone, Copy)]
pub(super) struct Mapping {
    base: Vec4,
    scale: Vec4,
    bins: usize,
    /// One over the set's extent, where size counts.
    per_extent: Option<f32>,
}

impl Mapping {
    /// For primitives with these bounds, whose doubled centers lie in a box.
    pub fn new(bounds: Box4, centers: Box4, count: usize) -> Self {
        let bins = MOST_BINS.min(4 + count / 16);
        let size = centers.high - centers.low;
        let scale = Vec4::splat(bins as f32 - 0.02) / size;
        // Along an axis without extent, and beyond what floats can divide, all fall into the first bin.
        let usable = size.cmpgt(Vec4::ZERO) & scale.cmplt(Vec4::INFINITY);
        let mut scale = Vec4::select(usable, scale, Vec4::ZERO);
        scale.w = 0.0;
        let per_extent = bounds.extent().recip();
        let per_extent = (count >= SIZED_SET && per_extent.is_finite()).then_some(per_extent);
        Self { base: centers.low, scale, bins, per_extent }
    }

    fn bins_by(&self, key: usize) -> usize {
        if key == SIZE { MOST_BINS } else { self.bins }
    }

    /// What primitives are binned by.
    fn keys(&self) -> std::ops::Range<usize> {
        0..if self.per_extent.is_some() { KEYS } else { SIZE }
    }

    /// The bin along an axis, or by size.
    #[inline(always)]
    fn bin_of(&self, p: &PrimitiveBox, key: usize) -> usize {
        match self.per_extent {
            Some(per_extent) if key == SIZE => size_bin(p, per_extent),
            _ => self.bins_of(p)[key % SIZE],
        }
    }

    #[inline(always)]
    fn bins_of(&self, p: &PrimitiveBox) -> [usize; 3] {
        let [x, y, z, _] = ((p.center2() - self.base) * self.scale - Vec4::splat(0.49) + Vec4::splat(ROUND)).to_array();
        [x, y, z].map(|v| v.to_bits() as usize & (MOST_BINS - 1))
    }
}

/// A bin for each halving of the size; the largest are in the first.
#[inline(always)]
fn size_bin(p: &PrimitiveBox, per_extent: f32) -> usize {
    let exponent = (p.extent() * per_extent).to_bits() >> 23;
    127u32.saturating_sub(exponent).min(MOST_BINS as u32 - 1) as usize
}

/// The boxes and numbers of primitives, by key and bin.
#[derive(Clone)]
pub(super) struct Bins {
    boxes: [[Box4; MOST_BINS]; KEYS],
    counts: [[u32; MOST_BINS]; KEYS],
}

/// A limit between two bins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    key: usize,
    /// First bin on the right.
    bin: usize,
}

impl Split {
    #[inline(always)]
    pub fn is_right(&self, mapping: &Mapping, p: &PrimitiveBox) -> bool {
        mapping.bin_of(p, self.key) >= self.bin
    }
}

impl Bins {
    pub fn new() -> Self {
        Self { boxes: [[Box4::EMPTY; MOST_BINS]; KEYS], counts: [[0; MOST_BINS]; KEYS] }
    }

    /// Empties those that a mapping uses.
    pub fn clear(&mut self, mapping: &Mapping) {
        for key in mapping.keys() {
            let bins = mapping.bins_by(key);
            self.boxes[key][..bins].fill(Box4::EMPTY);
            self.counts[key][..bins].fill(0);
        }
    }

    #[inline]
    pub fn add_all(&mut self, primitives: &[PrimitiveBox], mapping: &Mapping) {
        for p in primitives {
            let [x, y, z] = mapping.bins_of(p);
            self.boxes[0][x].add(p);
            self.counts[0][x] += 1;
            self.boxes[1][y].add(p);
            self.counts[1][y] += 1;
            self.boxes[2][z].add(p);
            self.counts[2][z] += 1;
        }
        if let Some(per_extent) = mapping.per_extent {
            for p in primitives {
                let bin = size_bin(p, per_extent);
                self.boxes[SIZE][bin].add(p);
                self.counts[SIZE][bin] += 1;
            }
        }
    }

    pub fn merge(&mut self, other: &Self) {
        for key in 0..KEYS {
            for i in 0..MOST_BINS {
                self.boxes[key][i] = self.boxes[key][i].union(other.boxes[key][i]);
                self.counts[key][i] += other.counts[key][i];
            }
        }
    }

    /// Number of primitives on the left of a split.
    pub fn count_left(&self, split: Split) -> usize {
        self.counts[split.key][..split.bin].iter().sum::<u32>() as usize
    }

    /// The split of least cost; none where all are in one bin by each key. `block` primitives cost as much as one.
    pub fn best_split(&self, mapping: &Mapping, block: usize) -> Option<Split> {
        let round_up = block as u32 - 1;
        let shift = block.trailing_zeros();
        let blocks = |count: u32| ((count + round_up) >> shift) as f32;
        let mut best = (f32::INFINITY, None);
        let mut right_costs = [0.0; MOST_BINS];
        for key in mapping.keys() {
            let (boxes, counts, bins) = (&self.boxes[key], &self.counts[key], mapping.bins_by(key));
            let (mut right, mut count) = (Box4::EMPTY, 0);
            for i in (1..bins).rev() {
                right = right.union(boxes[i]);
                count += counts[i];
                // A side without primitives is no split.
                right_costs[i] = if count == 0 { f32::INFINITY } else { right.half_area() * blocks(count) };
            }
            let (mut left, mut count) = (Box4::EMPTY, 0);
            for i in 1..bins {
                left = left.union(boxes[i - 1]);
                count += counts[i - 1];
                let cost = left.half_area() * blocks(count) + right_costs[i];
                if count > 0 && cost < best.0 {
                    best = (cost, Some(Split { key, bin: i }));
                }
            }
        }
        best.1
    }
}
