//! Colour of a blackbody, as UsdLux's `inputs:colorTemperature` defines it.

use crate::Rgb;

/// Linear Rec.709 colour of a blackbody every 500 K from 1000 K on, largest channel one: the knots
/// of `UsdLuxBlackbodyTemperatureAsRgb` (OpenUSD `usdLux/blackbody.cpp`).
const KNOTS: [[f32; 3]; 19] = [
    [1.000000, 0.027490, 0.000000],
    [1.000000, 0.149664, 0.000000],
    [1.000000, 0.256644, 0.008095],
    [1.000000, 0.372033, 0.067450],
    [1.000000, 0.476725, 0.153601],
    [1.000000, 0.570376, 0.259196],
    [1.000000, 0.653480, 0.377155],
    [1.000000, 0.726878, 0.501606],
    [1.000000, 0.791543, 0.628050],
    [1.000000, 0.848462, 0.753228],
    [1.000000, 0.898581, 0.874905],
    [1.000000, 0.942771, 0.991642],
    [0.906947, 0.890456, 1.000000],
    [0.828247, 0.841838, 1.000000],
    [0.765791, 0.801896, 1.000000],
    [0.715255, 0.768579, 1.000000],
    [0.673683, 0.740423, 1.000000],
    [0.638992, 0.716359, 1.000000],
    [0.609681, 0.695588, 1.000000],
];

/// Colour of a blackbody at a temperature in kelvin, of luminance one.
///
/// Clamped to 1000 … 10000 K; between the knots a Catmull-Rom spline, its ends repeated.
pub fn blackbody_rgb(kelvin: f32) -> Rgb {
    let last = KNOTS.len() - 1;
    let kelvin = if kelvin.is_nan() { 6500.0 } else { kelvin };
    let x = ((kelvin - 1000.0) / 500.0).clamp(0.0, last as f32);
    let segment = (x as usize).min(last - 1);
    let u = x - segment as f32;
    let knot = |i: isize| glam::Vec3::from(KNOTS[(segment as isize + i).clamp(0, last as isize) as usize]);
    let (before, start, end, after) = (knot(-1), knot(0), knot(1), knot(2));
    let slope_start = (end - before) * 0.5;
    let slope_end = (after - start) * 0.5;
    let (u2, u3) = (u * u, u * u * u);
    let spline = start * (2.0 * u3 - 3.0 * u2 + 1.0)
        + slope_start * (u3 - 2.0 * u2 + u)
        + end * (3.0 * u2 - 2.0 * u3)
        + slope_end * (u3 - u2);
    let rgb = Rgb(spline);
    Rgb((rgb / rgb.luminance()).0.max(glam::Vec3::ZERO))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Temperature in kelvin and its colour, as printed by `UsdLux.BlackbodyTemperatureAsRgb` of usd-core 26.11.
    const USDLUX: [(f32, [f32; 3]); 8] = [
        (500.0, [4.3055043, 0.1183583, 0.0000000]),
        (1000.0, [4.3055043, 0.1183583, 0.0000000]),
        (1300.0, [3.5557542, 0.3414378, 0.0000000]),
        (2856.0, [1.8452538, 0.826_112, 0.2335701]),
        (5000.0, [1.2135086, 0.9605443, 0.7621441]),
        (6500.0, [1.0433334, 0.9836245, 1.0346133]),
        (9999.0, [0.871_857, 0.9946876, 1.4299527]),
        (20000.0, [0.8718413, 0.9946879, 1.4299959]),
    ];

    #[test]
    fn agrees_with_usdlux() {
        for (kelvin, want) in USDLUX {
            let got = blackbody_rgb(kelvin);
            assert!((got.0 - glam::Vec3::from(want)).abs().max_element() < 2e-5, "{kelvin} K: {got:?}, not {want:?}");
        }
    }
}
