//! Weights of multiple importance sampling, one sample a technique.
//!
//! Veach 1997, "Robust Monte Carlo Methods for Light Transport Simulation", chapter 9.

/// Weight of a sample drawn with density `pdf_a` where the other technique has density `pdf_b`.
///
/// Both in the same measure. Infinite densities (a delta) are allowed; zero where `pdf_a` is zero or NaN.
#[inline]
pub fn balance_heuristic(pdf_a: f32, pdf_b: f32) -> f32 {
    ratio_weight(pdf_a, pdf_b, |r| r)
}

/// The power heuristic with exponent two: `a² / (a² + b²)`, without overflow.
///
/// Both in the same measure. Infinite densities (a delta) are allowed; zero where `pdf_a` is zero or NaN.
#[inline]
pub fn power_heuristic(pdf_a: f32, pdf_b: f32) -> f32 {
    ratio_weight(pdf_a, pdf_b, |r| r * r)
}

#[inline]
fn ratio_weight(pdf_a: f32, pdf_b: f32, of_ratio: impl Fn(f32) -> f32) -> f32 {
    if pdf_a.is_nan() || pdf_a <= 0.0 {
        return 0.0;
    }
    if pdf_b.is_nan() || pdf_b <= 0.0 {
        return 1.0;
    }
    if pdf_a.is_infinite() {
        return if pdf_b.is_infinite() { 0.5 } else { 1.0 };
    }
    // An infinite ratio gives the weight zero, as it should.
    1.0 / (1.0 + of_ratio(pdf_b / pdf_a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_the_two_techniques_sum_to_one() {
        let densities = [1e-38, 1e-20, 0.3, 1.0, 7.0, 1e20, 3e38, f32::INFINITY];
        for a in densities {
            for b in densities {
                for weight in [balance_heuristic, power_heuristic] {
                    let sum = weight(a, b) + weight(b, a);
                    assert!((sum - 1.0).abs() < 1e-6, "{a} {b}: {sum}");
                }
            }
        }
        assert!((power_heuristic(2.0, 1.0) - 0.8).abs() < 1e-6);
        assert!((balance_heuristic(2.0, 1.0) - 2.0 / 3.0).abs() < 1e-6);
    }

    #[test]
    fn a_technique_that_cannot_make_the_sample_has_no_weight() {
        for weight in [balance_heuristic, power_heuristic] {
            assert_eq!((weight(0.0, 1.0), weight(1.0, 0.0), weight(0.0, 0.0)), (0.0, 1.0, 0.0));
            assert_eq!((weight(f32::NAN, 1.0), weight(1.0, f32::NAN), weight(-1.0, 1.0)), (0.0, 1.0, 0.0));
        }
    }
}
