//! How much of a white environment a specular lobe reflects: what is left is for the layers under it.
//!
//! Schlick's Fresnel makes the reflectance linear in `f0`: `E(μ) = f0 · a(μ, α) + b(μ, α)`, with
//! `a + b` the reflectance of white. Tabulated once, when the first layered material is met.

use std::sync::LazyLock;

use glam::Vec2;
use umber_math::{Rgb, Vector3};

use super::ggx::{self, Ggx};

const COSINES: usize = 64;
const WIDTHS: usize = 32;
const STRATA: usize = 16;

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
            let roughness = width as f32 / (WIDTHS - 1) as f32;
            let row: Vec<Pair> = (0..COSINES).map(|c| integrate(cosine_of(c), roughness * roughness)).collect();
            // ∫ 2μ E(μ) dμ of the piecewise-linear interpolant, each piece by Simpson's rule (exact).
            let mean: Vec2 = (0..COSINES - 1)
                .map(|c| {
                    let (m0, m1) = (cosine_of(c), cosine_of(c + 1));
                    let (e0, e1) = (row[c].0, row[c + 1].0);
                    (e0 * m0 + e1 * m1 + (e0 + e1) * (m0 + m1)) * ((m1 - m0) / 3.0)
                })
                .sum();
            average.push(Pair(mean));
            directional.extend(row);
        }
        Self { directional, average }
    }
}

/// Finer towards grazing, where the reflectance bends.
fn cosine_of(index: usize) -> f32 {
    let t = index as f32 / (COSINES - 1) as f32;
    t * t
}

/// Reflectance towards a direction, by midpoints over the visible normals.
fn integrate(cos: f32, alpha: f32) -> Pair {
    let cos = cos.max(1e-4);
    let wo = Vector3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut sum = Vec2::ZERO;
    for i in 0..STRATA * STRATA {
        let u = (Vec2::new((i % STRATA) as f32, (i / STRATA) as f32) + 0.5) / STRATA as f32;
        let h = if alpha == 0.0 { Vector3::new(0.0, 0.0, 1.0) } else { ggx::visible_normal(wo, alpha, u) };
        let wi = h * (2.0 * wo.dot(h)) - wo;
        if wi.z() > 0.0 {
            let (lo, li) = (ggx::lambda(wo, alpha), ggx::lambda(wi, alpha));
            let (weight, s) = ((1.0 + lo) / (1.0 + lo + li), ggx::schlick_weight(wo.dot(h)));
            sum += Vec2::new(weight * (1.0 - s), weight * s);
        }
    }
    Pair(sum / (STRATA * STRATA) as f32)
}

impl Ggx {
    /// Fraction of a white environment that this lobe reflects towards a direction of the given cosine.
    #[inline]
    pub fn albedo(&self, cos: f32) -> Rgb {
        if self.is_delta() {
            return self.fresnel(cos);
        }
        let x = (cos.clamp(0.0, 1.0).sqrt() * (COSINES - 1) as f32).min((COSINES - 1) as f32 - 1e-3);
        let (row, v) = self.row();
        let (column, t) = (x as usize, x.fract());
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
        let y = (self.alpha.sqrt() * (WIDTHS - 1) as f32).min((WIDTHS - 1) as f32 - 1e-3);
        (y as usize, y.fract())
    }
    #[inline]
    fn combine(&self, pair: Vec2) -> Rgb {
        Rgb(self.f0.0 * pair.x + pair.y)
    }
}
