//! Which pixels of a tile share paths.

use std::ops::Range;

use umber_sampling::Sampler;

/// Distinguishes the random numbers of groups from those of the picture.
const STREAM: u64 = 4;

/// So many samples in a row have the same groups: points of a pixel are stratified over such runs, and so are then
/// those that a group shares. Measured in a Cornell box at 64 samples, the variance is 22 % larger with 1 than with 16,
/// and 8 % larger with 4; but with 16, groups show in a picture of 16 samples.
pub(super) const RUN: u32 = 4;

/// The runs that samples of some numbers belong to, whole ones.
pub(in crate::integrator) fn runs(numbers: Range<u32>) -> impl Iterator<Item = Range<u32>> {
    (numbers.start / RUN..numbers.end.div_ceil(RUN)).map(|run| run * RUN..(run + 1) * RUN)
}

/// A tile's pixels, dealt out anew for each run of samples.
pub(in crate::integrator) struct Groups {
    size: usize,
    seed: u64,
    /// Which tile it is, by its first pixel.
    place: [u32; 2],
}

impl Groups {
    /// Of up to `size` pixels, for the sequence of `seed` in the tile at a place of the view.
    pub fn new(size: usize, seed: u64, place: [u32; 2]) -> Self {
        Self { size, seed: seed ^ (STREAM << 32), place }
    }

    /// Calls `visit` for each group of `pixels`, columns and rows, for sample number `sample`, until it says no; true
    /// where it never does.
    ///
    /// A rectangle is cut across its longer side, at a place that leaves both parts about as many groups, and so on:
    /// groups are compact and nearly all as large, wherever the pixels lie. Where the cuts are is random.
    pub fn each(&self, pixels: &mut [[usize; 2]], sample: u32, visit: &mut impl FnMut(&[[usize; 2]]) -> bool) -> bool {
        let mut sampler = Sampler::new(self.seed, self.place, sample / RUN);
        split(pixels, pixels.len().div_ceil(self.size), &mut sampler, visit)
    }
}

fn split(
    pixels: &mut [[usize; 2]],
    groups: usize,
    sampler: &mut Sampler,
    visit: &mut impl FnMut(&[[usize; 2]]) -> bool,
) -> bool {
    if groups <= 1 {
        return pixels.is_empty() || visit(pixels);
    }
    let extent = |axis: usize| {
        let range = pixels.iter().fold((usize::MAX, 0), |(low, high), p| (low.min(p[axis]), high.max(p[axis])));
        range.1 - range.0
    };
    let axis = usize::from(extent(1) > extent(0) || extent(1) == extent(0) && sampler.next_1d() < 0.5);
    // about between three and five eighths
    let least = (3 * groups / 8).max(1);
    let most = groups - least;
    let before = least + (sampler.next_1d() * (most - least + 1) as f32) as usize;
    let cut = pixels.len() * before / groups;
    pixels.select_nth_unstable_by_key(cut, |p| (p[axis], p[1 - axis]));
    let (left, right) = pixels.split_at_mut(cut);
    split(left, before, sampler, visit) && split(right, groups - before, sampler, visit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::TILE;
    use std::collections::{HashMap, HashSet};

    fn tile() -> Vec<[usize; 2]> {
        (0..TILE * TILE).map(|i| [i % TILE, i / TILE]).collect()
    }

    fn groups(pixels: &[[usize; 2]], size: usize, sample: u32) -> Vec<Vec<[usize; 2]>> {
        let mut all = Vec::new();
        Groups::new(size, 7, [32, 48]).each(&mut pixels.to_vec(), sample, &mut |group| {
            all.push(group.to_vec());
            true
        });
        all
    }

    #[test]
    fn every_pixel_is_in_one_group_and_none_is_too_large() {
        let sparse: Vec<_> = tile().into_iter().filter(|[x, y]| (x * 7 + y * 3) % 5 == 0).collect();
        for pixels in [tile(), sparse, tile()[..5].to_vec(), Vec::new()] {
            for (size, sample) in [(2, 0), (4, 1), (16, 2), (16, 3)] {
                let groups = groups(&pixels, size, sample);
                assert!(groups.iter().all(|group| group.len() <= size && !group.is_empty()));
                let mut members: Vec<_> = groups.concat();
                members.sort_by_key(|[x, y]| (*y, *x));
                let mut want = pixels.clone();
                want.sort_by_key(|[x, y]| (*y, *x));
                assert_eq!(members, want);
            }
        }
    }

    #[test]
    fn groups_of_a_whole_tile_are_compact_and_full() {
        for sample in (0..1024).step_by(RUN as usize) {
            for group in groups(&tile(), 16, sample) {
                assert_eq!(group.len(), 16);
                for axis in 0..2 {
                    let (low, high) = (group.iter().map(|p| p[axis]).min(), group.iter().map(|p| p[axis]).max());
                    assert!(high.unwrap() - low.unwrap() < 10, "{group:?}");
                }
            }
        }
    }

    #[test]
    fn neighbours_are_together_in_some_runs_and_apart_in_others() {
        let runs = 256;
        let mut together: HashMap<[[usize; 2]; 2], u32> = HashMap::new();
        for sample in (0..runs * RUN).step_by(RUN as usize) {
            for group in groups(&tile(), 16, sample) {
                let members: HashSet<_> = group.iter().copied().collect();
                for [x, y] in group {
                    for neighbour in [[x + 1, y], [x, y + 1]].into_iter().filter(|p| members.contains(p)) {
                        *together.entry([[x, y], neighbour]).or_default() += 1;
                    }
                }
            }
        }
        assert_eq!(together.len(), 2 * TILE * (TILE - 1));
        // nothing parts pixels in a corner of the tile
        let is_inside = |p: &[usize; 2]| p.iter().all(|c| (2..TILE - 2).contains(c));
        for (pair, n) in together {
            assert!(n > runs / 8 && (n < runs || !pair.iter().all(is_inside)), "{pair:?}: {n}");
        }
    }
}
