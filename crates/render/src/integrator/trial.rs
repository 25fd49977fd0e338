//! What trials before a picture have in common.

use glam::DVec3;

/// Squared errors of several ways to make a part of a picture, relative to its `mean` with `floor` added to the square,
/// the sum of the channels'. Where the largest channel of any is above `limit`, all are scaled down to it: bright specks
/// do not decide alone, and how the ways compare stays.
pub(super) fn relative_errors<const N: usize>(mean: DVec3, variances: [DVec3; N], floor: f64, limit: f64) -> [f64; N] {
    let relative = variances.map(|variance| variance / (mean * mean + floor));
    let largest = relative.iter().fold(0.0, |largest: f64, error| largest.max(error.max_element()));
    let scale = if largest > limit { limit / largest } else { 1.0 };
    relative.map(|error| scale * error.dot(DVec3::ONE))
}
