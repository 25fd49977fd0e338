//! Where to split a set: costs at a few planes along each axis.
//!
//! Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies".

use glam::Vec4;

use super::primitive::{Box4, PrimitiveBox};

/// Most bins along an axis.
pub(super) const MOST_BINS: usize = 32;

/// Added to a number of up to 2²², this leaves it, rounded, in the low bits.
const ROUND: f32 = 12_582_912.0;

/// From a primitive to its bin along each axis.
#[derive(Clone, Copy)]
pub(super) struct Mapping {
    base: Vec4,
    scale: Vec4,
    pub bins: usize,
}

impl Mapping {
    /// For primitives whose doubled centers lie in a box.
    pub fn new(centers: Box4, count: usize) -> Self {
        let bins = MOST_BINS.min(4 + count / 16);
        let size = centers.high - centers.low;
        let scale = Vec4::splat(bins as f32 - 0.02) / size;
        // Along an axis without extent, and beyond what floats can divide, all fall into the first bin.
        let usable = size.cmpgt(Vec4::ZERO) & scale.cmplt(Vec4::INFINITY);
        let mut scale = Vec4::select(usable, scale, Vec4::ZERO);
        scale.w = 0.0;
        Self { base: centers.low, scale, bins }
    }

    #[inline(always)]
    pub fn bins_of(&self, p: &PrimitiveBox) -> [usize; 3] {
        let [x, y, z, _] = ((p.center2() - self.base) * self.scale - Vec4::splat(0.49) + Vec4::splat(ROUND)).to_array();
        [x, y, z].map(|v| v.to_bits() as usize & (MOST_BINS - 1))
    }
}

/// The boxes and numbers of primitives, by axis and bin.
#[derive(Clone)]
pub(super) struct Bins {
    boxes: [[Box4; MOST_BINS]; 3],
    pub counts: [[u32; MOST_BINS]; 3],
}

/// A plane between two bins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    pub axis: usize,
    /// First bin on the right.
    pub bin: usize,
}

impl Split {
    #[inline(always)]
    pub fn is_right(&self, mapping: &Mapping, p: &PrimitiveBox) -> bool {
        mapping.bins_of(p)[self.axis] >= self.bin
    }
}

impl Bins {
    pub fn new() -> Self {
        Self { boxes: [[Box4::EMPTY; MOST_BINS]; 3], counts: [[0; MOST_BINS]; 3] }
    }

    /// Empties those that a mapping uses.
    pub fn clear(&mut self, mapping: &Mapping) {
        for axis in 0..3 {
            self.boxes[axis][..mapping.bins].fill(Box4::EMPTY);
            self.counts[axis][..mapping.bins].fill(0);
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
    }

    pub fn merge(&mut self, other: &Self) {
        for axis in 0..3 {
            for i in 0..MOST_BINS {
                self.boxes[axis][i] = self.boxes[axis][i].union(other.boxes[axis][i]);
                self.counts[axis][i] += other.counts[axis][i];
            }
        }
    }

    /// The split of least cost; none where all are in one bin along each axis. `block` primitives cost as much as one.
    pub fn best_split(&self, mapping: &Mapping, block: usize) -> Option<Split> {
        let round_up = block as u32 - 1;
        let shift = block.trailing_zeros();
        let blocks = |count: u32| ((count + round_up) >> shift) as f32;
        let mut best = (f32::INFINITY, None);
        let mut right_costs = [0.0; MOST_BINS];
        for axis in 0..3 {
            let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
            let (mut right, mut count) = (Box4::EMPTY, 0);
            for i in (1..mapping.bins).rev() {
                right = right.union(boxes[i]);
                count += counts[i];
                // A side without primitives is no split.
                right_costs[i] = if count == 0 { f32::INFINITY } else { right.half_area() * blocks(count) };
            }
            let (mut left, mut count) = (Box4::EMPTY, 0);
            for i in 1..mapping.bins {
                left = left.union(boxes[i - 1]);
                count += counts[i - 1];
                let cost = left.half_area() * blocks(count) + right_costs[i];
                if count > 0 && cost < best.0 {
                    best = (cost, Some(Split { axis, bin: i }));
                }
            }
        }
        best.1
    }
}
