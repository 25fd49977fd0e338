//! What the trials before a picture have in common: how the errors of several ways to make it compare.

use glam::DVec3;

use crate::film;

/// What a part of a picture found: its mean radiance, and the variance of each way to make it.
pub(super) type Found<const N: usize> = (DVec3, [DVec3; N]);

/// Squared errors of each way, relative to each part's brightness, summed over all parts.
///
/// Where the largest of a part is above `limit`, in any channel, all of its are scaled down to it: a few bright specks do
/// not decide, and how the ways compare stays.
pub(super) fn errors<const N: usize>(parts: impl ExactSizeIterator<Item = Found<N>> + Clone, limit: f64) -> [f64; N] {
    let mean = parts.clone().map(|(mean, _)| mean).sum::<DVec3>() / parts.len() as f64;
    let floor = film::error_floor(film::luminance(mean));
    parts.fold([0.0; N], |sums, (mean, variances)| {
        let relative = variances.map(|variance| variance / (mean * mean + floor));
        let largest = relative.iter().fold(0.0, |largest: f64, error| largest.max(error.max_element()));
        let scale = if largest > limit { limit / largest } else { 1.0 };
        std::array::from_fn(|way| sums[way] + scale * relative[way].dot(DVec3::ONE))
    })
}
