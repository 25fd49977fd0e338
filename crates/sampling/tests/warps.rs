//! Chi-squared and inverses of the warps, and of the distributions.

use glam::Vec2;
use umber_math::Vector3;
use umber_sampling::chi2::{Chi2Options, Chi2Outcome, test_sphere, test_square};
use umber_sampling::{Distribution2D, warp};

const TESTS: usize = 9;

fn check(name: &str, outcome: Chi2Outcome) {
    assert!(outcome.accepted(0.01, TESTS), "{name}: {outcome:?}");
    assert!((outcome.integral - 1.0).abs() < 2e-3, "{name}: {outcome:?}");
}

#[test]
fn directions_follow_their_densities() {
    let o = Chi2Options::default();
    let cosine = |w: Vector3| warp::cosine_hemisphere_pdf_solid_angle(w.z());
    check("cosine hemisphere", test_sphere(o, |u| Some(warp::cosine_hemisphere(u)), cosine));
    check("sphere", test_sphere(o, |u| Some(warp::uniform_sphere(u)), |_| warp::UNIFORM_SPHERE_PDF_SOLID_ANGLE));
    for one_minus_cos in [0.13f32, 0.9, 1.7] {
        let inside = |w: Vector3| {
            if 1.0 - w.z() <= one_minus_cos { warp::uniform_cone_pdf_solid_angle(one_minus_cos) } else { 0.0 }
        };
        check("cone", test_sphere(o, |u| Some(warp::uniform_cone(u, one_minus_cos)), inside));
    }
}

#[test]
fn points_follow_their_densities() {
    let o = Chi2Options { bins: [30, 30], ..Chi2Options::default() };
    let disk = |p: Vec2| if (p * 2.0 - Vec2::ONE).length() < 1.0 { 4.0 * warp::UNIFORM_DISK_PDF_AREA } else { 0.0 };
    check("disk", test_square(o, |u| Some(warp::concentric_disk(u) * 0.5 + Vec2::splat(0.5)), disk));
    let triangle = |p: Vec2| if p.x + p.y < 1.0 { 2.0 } else { 0.0 };
    check("triangle", test_square(o, |u| Some(warp::uniform_triangle(u).truncate()), triangle));
    let weights: Vec<f32> = (0..7 * 5).map(|i| ((i * 31) % 11) as f32).collect();
    let grid = Distribution2D::new(&weights, 7).unwrap();
    let o = Chi2Options { bins: [14, 10], ..o };
    check("grid", test_square(o, |u| Some(grid.sample(u).0), |p| grid.pdf(p)));
    let empty = Distribution2D::new(&[0.0; 4], 2).unwrap();
    check("empty grid", test_square(o, |u| Some(empty.sample(u).0), |p| empty.pdf(p)));
}

#[test]
fn the_disk_map_inverts() {
    for i in 0..64 {
        for j in 0..64 {
            let u = Vec2::new(i as f32, j as f32) / 63.0;
            let back = warp::concentric_disk_inverse(warp::concentric_disk(u));
            assert!((back - u).abs().max_element() < 1e-5, "{u} → {back}");
        }
    }
}

#[test]
fn narrow_cones_keep_their_width() {
    // At a half angle of 10⁻⁵ rad the cosine rounds to one: computed from it, all directions would be the axis.
    for half_angle in [1e-2f32, 1e-5, 1e-8] {
        let sin_squared = half_angle * half_angle;
        let one_minus_cos = warp::one_minus_cos_from_sin_squared(sin_squared);
        let edge = warp::uniform_cone(Vec2::new(1.0, 0.5), one_minus_cos);
        let got = edge.x().hypot(edge.y());
        assert!((got / half_angle - 1.0).abs() < 1e-3, "{half_angle}: {got}");
        let solid_angle = 1.0 / warp::uniform_cone_pdf_solid_angle(one_minus_cos);
        assert!((solid_angle / (std::f32::consts::PI * sin_squared) - 1.0).abs() < 1e-3);
    }
}
