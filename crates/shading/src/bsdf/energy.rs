//! How much of a white environment a specular lobe reflects: what is left is for the layers under it.
//!
//! Schlick's Fresnel makes the reflectance linear in `f0`: `E(μ) = f0 · a(μ, α) + b(μ, α)`, with
//! `a + b` the reflectance of white. Tabulated once, when the first layered material is met.

use std::sync::LazyLock;

use glam::{DVec2, Vec2};
use umber_math::{Rgb, Vector3};

use super::ggx::{self, DELTA_ALPHA, Ggx};

const COSINES: usize = 64;
const WIDTHS: usize = 32;
const AZIMUTHS: usize = 8;
const TILTS: usize = 32;

/// `a` and `b` of `f0 · a + b`.
#[derive(Clone, Copy, Debug, Default)]
struct Pair(Vec2);

struct Table {
    /// By width, then cosine.
    directional: Vec<Pair>,
    /// Cosine-weighted mean over the hemisphere, by width.
    average: Vec<Pair>,
}

static TABLE: LazyLock<Table> = LazyLock::new(Table::compute);

impl Table {
    fn compute() -> Self {
        let mut directional = Vec::with_capacity(COSINES * WIDTHS);
        let mut average = Vec::with_capacity(WIDTHS);
        for width in 0..WIDTHS {
            let row: Vec<Pair> = (0..COSINES).map(|c| integrate(cosine_of(c), alpha_of(width))).collect();
            let mean = cosine_mean(&row);
            average.push(Pair(mean));
            directional.extend(row);
        }
        Self { directional, average }
    }
}

/// Finer towards grazing: there the reflectance bends where the cosine is about the width.
fn cosine_of(index: usize) -> f32 {
    let t = index as f32 / (COSINES - 1) as f32;
    t * t * t
}

/// Evenly spaced in the logarithm, from [`DELTA_ALPHA`] to 1.
fn alpha_of(row: usize) -> f32 {
    DELTA_ALPHA.powf(1.0 - row as f32 / (WIDTHS - 1) as f32)
}

/// The row of a width, with its fraction; within the table for any width.
pub(super) fn row_of(alpha: f32) -> f32 {
    let t = 1.0 - alpha.max(DELTA_ALPHA).ln() / DELTA_ALPHA.ln();
    t.min(1.0) * (WIDTHS - 1) as f32
}

/// `∫ 2 μ E dμ` of what the table interpolates: linear in `t`, where `μ = t³`.
fn cosine_mean(row: &[Pair]) -> Vec2 {
    let power = |c: usize, n: i32| (c as f64 / (COSINES - 1) as f64).powi(n);
    let pieces = row.windows(2).enumerate().map(|(c, e)| {
        let (e0, e1) = (e[0].0.as_dvec2(), e[1].0.as_dvec2());
        let slope = (e1 - e0) * (COSINES - 1) as f64;
        let at_zero = e0 - slope * power(c, 1);
        // 2 μ dμ = 6 t⁵ dt.
        at_zero * (power(c + 1, 6) - power(c, 6)) + slope * (power(c + 1, 7) - power(c, 7)) * (6.0 / 7.0)
    });
    pieces.sum::<DVec2>().as_vec2()
}

/// Reflectance towards a direction, by midpoints over half the visible normals (the other half mirrors them).
///
/// The steep normals, few and all at `u.y` near one, decide what is lost at normal incidence: midpoints crowd there.
fn integrate(cos: f32, alpha: f32) -> Pair {
    let cos = cos.max(1e-4);
    let wo = Vector3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut sum = Vec2::ZERO;
    for i in 0..AZIMUTHS * TILTS {
        let azimuth = 0.5 * ((i % AZIMUTHS) as f32 + 0.5) / AZIMUTHS as f32;
        let t = ((i / AZIMUTHS) as f32 + 0.5) / TILTS as f32;
        let h = ggx::visible_normal(wo, alpha, Vec2::new(azimuth, 1.0 - t * t * t));
        let wi = h * (2.0 * wo.dot(h)) - wo;
        if wi.z() > 0.0 {
            let weight = 3.0 * t * t / (1.0 + ggx::lambda(wi, alpha));
            let s = ggx::schlick_weight(wo.dot(h));
            sum += Vec2::new(weight * (1.0 - s), weight * s);
        }
    }
    // The midpoints of 3 t² sum to a little less than one.
    Pair(sum / (AZIMUTHS as f32 * (TILTS as f32 - 0.25 / TILTS as f32)))
}

impl Ggx {
    /// Fraction of a white environment that this lobe reflects towards a direction of the given cosine.
    #[inline]
    pub fn albedo(&self, cos: f32) -> Rgb {
        if self.is_delta() {
            return self.fresnel(cos);
        }
        let x = cos.clamp(0.0, 1.0).cbrt() * (COSINES - 1) as f32;
        let column = (x as usize).min(COSINES - 2);
        let ((row, v), t) = (self.row(), x - column as f32);
        let at = |row: usize| {
            let row = &TABLE.directional[row * COSINES..];
            row[column].0.lerp(row[column + 1].0, t)
        };
        self.combine(at(row).lerp(at(row + 1), v))
    }
    /// Mean of [`Ggx::albedo`] over the hemisphere, weighted by the cosine.
    #[inline]
    pub fn average_albedo(&self) -> Rgb {
        if self.is_delta() {
            // ∫ 2μ (1 − μ)⁵ dμ = 1/21.
            return self.combine(Vec2::new(20.0 / 21.0, 1.0 / 21.0));
        }
        let (row, v) = self.row();
        self.combine(TABLE.average[row].0.lerp(TABLE.average[row + 1].0, v))
    }
    #[inline]
    fn row(&self) -> (usize, f32) {
        let row = (self.energy_row as usize).min(WIDTHS - 2);
        (row, self.energy_row - row as f32)
    }
    #[inline]
    fn combine(&self, pair: Vec2) -> Rgb {
        Rgb(self.f0.0 * pair.x + pair.y)
    }
}
