//! What the trials before a picture have in common: how the errors of two ways to make it compare.

use glam::DVec3;

use crate::film;

/// What a part of a picture found: its mean radiance, and the variances by two ways to make it.
pub(super) type Found = (DVec3, [DVec3; 2]);

/// How much larger errors are by the second of two ways than by the first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Comparison {
    /// The one's sum over the other's. Not a number where nothing is off.
    pub ratio: f64,
    /// Standard deviation of that ratio, as the parts show it.
    pub deviation: f64,
}

impl Comparison {
    /// The same with each error times what it costs, `cost` by the second way over the first.
    pub fn times(self, cost: f64) -> Self {
        Self { ratio: cost * self.ratio, deviation: cost * self.deviation }
    }
    /// Whether the second way is better than `ratio` times the first by more than a standard deviation.
    pub fn is_clearly_below(self, ratio: f64) -> bool {
        self.ratio + self.deviation < ratio
    }
}

/// Compares squared errors relative to each part's brightness, summed over all parts.
///
/// Where one of a part's is above `limit`, in any channel, both of its are scaled down until none is: a few bright specks
/// do not decide, and how the ways compare stays.
pub(super) fn compare(parts: impl ExactSizeIterator<Item = Found> + Clone, limit: f64) -> Comparison {
    let mean = parts.clone().map(|(mean, _)| mean).sum::<DVec3>() / parts.len() as f64;
    let floor = film::error_floor(film::luminance(mean));
    let of_part = |(mean, variances): Found| {
        let relative = variances.map(|variance| variance / (mean * mean + floor));
        let largest = relative[0].max_element().max(relative[1].max_element());
        let scale = if largest > limit { limit / largest } else { 1.0 };
        relative.map(|errors| scale * errors.dot(DVec3::ONE))
    };
    let errors: Vec<[f64; 2]> = parts.map(of_part).collect();
    let [first, second] = [0, 1].map(|way| errors.iter().map(|of_part| of_part[way]).sum::<f64>());
    let ratio = second / first;
    // of a ratio of two sums of the same parts (Cochran 1977, "Sampling Techniques", section 2.11)
    let squares: f64 = errors.iter().map(|[first, second]| (second - ratio * first).powi(2)).sum();
    Comparison { ratio, deviation: squares.sqrt() / first }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compared(errors: &[[f64; 2]]) -> Comparison {
        compare(errors.iter().map(|errors| (DVec3::ONE, errors.map(DVec3::splat))), 0.5)
    }

    #[test]
    fn errors_are_relative_to_brightness() {
        let [dark, bright] = [(1.0, 1.0), (4.0, 16.0)]
            .map(|(mean, scale)| (DVec3::splat(mean), [0.01, 0.02].map(|error| DVec3::splat(error * scale))));
        let other = (DVec3::ONE, [0.01, 0.04].map(DVec3::splat));
        for part in [dark, bright] {
            let Comparison { ratio, .. } = compare([part, other].into_iter(), 0.5);
            assert!((ratio - 3.0).abs() < 1e-2, "{ratio}");
        }
    }

    #[test]
    fn specks_count_no_more_than_the_limit() {
        let speck = [100.0, 50.0];
        let Comparison { ratio, .. } = compared(&[&[speck][..], &[[0.1, 0.2]; 10]].concat());
        assert!((ratio - 2.25 / 1.5).abs() < 1e-2, "{ratio}");
        assert!((compared(&[speck]).ratio - 0.5).abs() < 1e-9);
    }

    #[test]
    fn the_deviation_is_that_of_as_many_parts() {
        let same = compared(&[[0.1, 0.2]; 10]);
        assert!((same.ratio - 2.0).abs() < 1e-9 && same.deviation < 1e-9, "{same:?}");
        // ratios of 1 and 3, four of each: their mean is off by the root of their variance over eight
        let apart = compared(&[[0.1, 0.1], [0.1, 0.3]].repeat(4));
        assert!((apart.ratio - 2.0).abs() < 1e-9 && (apart.deviation - 0.125f64.sqrt()).abs() < 1e-3, "{apart:?}");
        assert!(compared(&[[0.0, 0.0]]).ratio.is_nan());
    }
}
