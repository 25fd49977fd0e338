//! Energy and bright specks from mirror to matt.

use umber_bench::stability::roughness::{White, caustic, energy_error};

#[test]
fn white_plastic_neither_loses_nor_creates_energy() {
    for roughness in [0.0, 0.1, 0.3, 0.6, 1.0] {
        let error = energy_error(White::Plastic, roughness, 1 << 15);
        println!("roughness {roughness}: {error:.1e}");
        assert!(error < 1e-3, "roughness {roughness}: {error:.1e}");
    }
}

#[test]
fn a_smooth_metal_loses_nothing_and_a_rough_one_what_is_scattered_twice() {
    let errors = [0.0, 0.2, 0.5, 1.0].map(|r| energy_error(White::Metal, r, 1 << 14));
    println!("{errors:?}");
    assert!(errors[0] < 1e-5);
    assert!(errors.is_sorted(), "{errors:?}");
    assert!(errors[3] < 0.65, "{errors:?}");
}

#[test]
fn the_clamp_bounds_specks_and_costs_light() {
    const CLAMP: f32 = 10.0;
    let [free, clamped] = [0.0, CLAMP].map(|clamp| caustic(0.2, clamp, 4));
    println!("{free:?}, clamped {clamped:?}");
    assert!(free.largest > 5.0 * f64::from(CLAMP), "{free:?}");
    assert!(clamped.largest <= f64::from(CLAMP) * 1.001, "{clamped:?}");
    assert!(clamped.mean < free.mean, "{clamped:?}");
    // Where nothing is bright, it does nothing.
    let matt = [0.0, CLAMP].map(|clamp| caustic(1.0, clamp, 1));
    assert_eq!(matt[0].mean, matt[1].mean);
}
