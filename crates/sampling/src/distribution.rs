//! Piecewise-constant distributions over an interval and a square.
//!
//! Bins are looked up in cumulative tables, from where a coarse table over the numbers says they start ("guide table",
//! Chen & Asau 1974): one look and few steps, and the same bins as a search of the whole table finds.

use glam::Vec2;

/// A piecewise-constant density over [0, 1) with bins of equal width; also a discrete distribution over the bins.
#[derive(Clone, Debug)]
pub struct Distribution1D {
    /// Cumulative probabilities, from 0 to 1, one more than there are bins.
    cdf: Vec<f32>,
    /// Where bins of the table start, see [`push_guide`].
    guide: Vec<u32>,
    integral: f64,
}

impl Distribution1D {
    /// Proportional to `weights`. Negative, NaN and infinite weights count as zero; if all are zero (or none given), uniform.
    pub fn new(weights: &[f32]) -> Self {
        let mut cdf = Vec::with_capacity(weights.len().max(1) + 1);
        let integral = push_cdf(&mut cdf, weights);
        let mut guide = Vec::new();
        push_guide(&mut guide, &cdf);
        Self { cdf, guide, integral }
    }
    /// Number of bins, at least one.
    #[inline]
    pub fn bins(&self) -> usize {
        self.cdf.len() - 1
    }
    /// Mean of the weights: the integral of the unnormalised function over [0, 1].
    #[inline]
    pub fn integral(&self) -> f64 {
        self.integral
    }
    /// A bin, its probability, and `u` stretched to the whole of [0, 1) for further use.
    #[inline]
    pub fn sample_discrete(&self, u: f32) -> (usize, f32, f32) {
        sample_cdf(&self.cdf, &self.guide, u)
    }
    /// Probability of a bin; zero beyond the last.
    #[inline]
    pub fn pmf(&self, bin: usize) -> f32 {
        if bin < self.bins() { self.cdf[bin + 1] - self.cdf[bin] } else { 0.0 }
    }
    /// A number in [0, 1) and its density.
    #[inline]
    pub fn sample(&self, u: f32) -> (f32, f32) {
        let (bin, pmf, rest) = self.sample_discrete(u);
        let n = self.bins() as f32;
        (((bin as f32 + rest) / n).min(ONE_MINUS_EPSILON), pmf * n)
    }
    /// Density at `x`; zero outside [0, 1).
    #[inline]
    pub fn pdf(&self, x: f32) -> f32 {
        if !(0.0..1.0).contains(&x) {
            return 0.0;
        }
        let n = self.bins();
        self.pmf(((x * n as f32) as usize).min(n - 1)) * n as f32
    }
}

/// A bin of a [`Distribution2D`], and where in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellSample {
    /// Column (along u) and row (along v).
    pub cell: [usize; 2],
    /// Uniform position within the cell, in [0, 1)².
    pub within: Vec2,
    /// Probability of the cell.
    pub pmf: f32,
}

/// A piecewise-constant density over [0, 1)², a grid of equal cells.
///
/// Its densities are differences of the very tables it samples by, so that the two agree exactly.
#[derive(Clone, Debug)]
pub struct Distribution2D {
    columns: usize,
    rows: Distribution1D,
    /// Row by row, `columns + 1` cumulative probabilities each.
    conditional: Vec<f32>,
    /// Row by row, the guide tables, [`guide_len`] of `columns` entries each.
    guides: Vec<u32>,
}

impl Distribution2D {
    /// Proportional to `weights`, `columns` to a row, rows by increasing v; bad weights as in [`Distribution1D::new`].
    ///
    /// `None` where `columns` is zero or does not divide the number of weights, or there are none.
    pub fn new(weights: &[f32], columns: usize) -> Option<Self> {
        if columns == 0 || weights.is_empty() || !weights.len().is_multiple_of(columns) {
            return None;
        }
        let mut conditional = Vec::with_capacity(weights.len() / columns * (columns + 1));
        let integrals: Vec<f32> =
            weights.chunks_exact(columns).map(|row| push_cdf(&mut conditional, row) as f32).collect();
        let mut guides = Vec::with_capacity(integrals.len() * guide_len(columns));
        conditional.chunks_exact(columns + 1).for_each(|cdf| push_guide(&mut guides, cdf));
        Some(Self { columns, rows: Distribution1D::new(&integrals), conditional, guides })
    }
    /// Numbers of columns and rows.
    #[inline]
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows.bins()]
    }
    /// Mean of the weights: the integral of the unnormalised function over the square.
    #[inline]
    pub fn integral(&self) -> f64 {
        self.rows.integral()
    }
    /// A cell and a uniform position in it.
    #[inline]
    pub fn sample_cell(&self, u: Vec2) -> CellSample {
        let (row, pmf_row, y) = self.rows.sample_discrete(u.y);
        let len = guide_len(self.columns);
        let guide = &self.guides[row * len..(row + 1) * len];
        let (column, pmf_column, x) = sample_cdf(self.conditional_cdf(row), guide, u.x);
        CellSample { cell: [column, row], within: Vec2::new(x, y), pmf: pmf_row * pmf_column }
    }
    /// Probability of a cell; zero outside the grid.
    #[inline]
    pub fn pmf(&self, cell: [usize; 2]) -> f32 {
        if cell[0] >= self.columns || cell[1] >= self.rows.bins() {
            return 0.0;
        }
        let cdf = self.conditional_cdf(cell[1]);
        self.rows.pmf(cell[1]) * (cdf[cell[0] + 1] - cdf[cell[0]])
    }
    /// A point in [0, 1)² and its density.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let s = self.sample_cell(u);
        let size = self.size().map(|n| n as f32);
        let uv = (Vec2::new(s.cell[0] as f32, s.cell[1] as f32) + s.within) / Vec2::from(size);
        (uv.min(Vec2::splat(ONE_MINUS_EPSILON)), s.pmf * (size[0] * size[1]))
    }
    /// Density at `uv`; zero outside [0, 1)².
    #[inline]
    pub fn pdf(&self, uv: Vec2) -> f32 {
        if !((0.0..1.0).contains(&uv.x) && (0.0..1.0).contains(&uv.y)) {
            return 0.0;
        }
        let [columns, rows] = self.size();
        let (x, y) = (uv.x * columns as f32, uv.y * rows as f32);
        self.pmf([(x as usize).min(columns - 1), (y as usize).min(rows - 1)]) * (columns as f32 * rows as f32)
    }
    #[inline]
    fn conditional_cdf(&self, row: usize) -> &[f32] {
        let width = self.columns + 1;
        &self.conditional[row * width..(row + 1) * width]
    }
}

const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON * 0.5;

/// Appends the normalised prefix sums of the weights; returns their mean. Sums in double precision.
fn push_cdf(cdf: &mut Vec<f32>, weights: &[f32]) -> f64 {
    let usable = |w: f32| if w.is_finite() && w > 0.0 { f64::from(w) } else { 0.0 };
    let total: f64 = weights.iter().map(|&w| usable(w)).sum();
    let n = weights.len().max(1);
    cdf.push(0.0);
    let mut sum = 0.0;
    for &w in weights.iter().take(n - 1) {
        sum += if total > 0.0 { usable(w) / total } else { 1.0 / n as f64 };
        cdf.push(sum.min(1.0) as f32);
    }
    let last_is_empty = total > 0.0 && usable(weights[n - 1]) == 0.0;
    cdf.push(1.0);
    if last_is_empty {
        // Trailing bins of weight zero must not receive what rounding left over.
        let last_used = (0..n).rev().find(|&i| usable(weights[i]) > 0.0).unwrap_or(n - 1);
        let start = cdf.len() - (n - last_used);
        cdf[start..].fill(1.0);
    }
    total / n as f64
}

/// Bins to an entry of a guide table, at most.
const BINS_PER_GUIDE: usize = 8;

/// Length of the guide table over so many bins: a power of two, so that numbers fall exactly between its entries, and
/// one more.
fn guide_len(bins: usize) -> usize {
    bins.div_ceil(BINS_PER_GUIDE).next_power_of_two() + 1
}

/// Appends the bins that hold 0, 1/n, 2/n … (n − 1)/n, and the last bin.
fn push_guide(guide: &mut Vec<u32>, cdf: &[f32]) {
    let parts = guide_len(cdf.len() - 1) - 1;
    let mut bin = 0;
    for part in 0..parts {
        let u = part as f32 / parts as f32;
        while bin + 2 < cdf.len() && cdf[bin + 1] <= u {
            bin += 1;
        }
        guide.push(bin as u32);
    }
    guide.push(cdf.len() as u32 - 2);
}

/// The bin that holds `u`, its width, and the position of `u` within it.
#[inline]
fn sample_cdf(cdf: &[f32], guide: &[u32], u: f32) -> (usize, f32, f32) {
    let u = if u >= 0.0 { u.min(ONE_MINUS_EPSILON) } else { 0.0 };
    let part = (u * (guide.len() - 1) as f32) as usize;
    let [first, last] = [guide[part] as usize, guide[part + 1] as usize];
    // The last entry is 1 > u and the first 0 <= u, so the bin exists and has positive width.
    let bin = first + cdf[first + 1..last + 1].partition_point(|&c| c <= u);
    let (start, width) = (cdf[bin], cdf[bin + 1] - cdf[bin]);
    (bin, width, ((u - start) / width).min(ONE_MINUS_EPSILON))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_follow_the_weights() {
        let d = Distribution1D::new(&[1.0, 0.0, 3.0, 0.0]);
        assert_eq!([0, 1, 2, 3, 4].map(|i| d.pmf(i)), [0.25, 0.0, 0.75, 0.0, 0.0]);
        assert_eq!(d.integral(), 1.0);
        assert_eq!(d.sample_discrete(0.25), (2, 0.75, 0.0));
        assert_eq!(d.sample(0.125), (0.125, 1.0));
        assert_eq!((d.pdf(0.6), d.pdf(0.3), d.pdf(1.0), d.pdf(-0.1), d.pdf(f32::NAN)), (3.0, 0.0, 0.0, 0.0, 0.0));
    }

    #[test]
    fn empty_bins_are_never_chosen_and_bad_numbers_are_survived() {
        let mut weights = vec![0.0; 1000];
        for (i, w) in weights.iter_mut().enumerate().skip(1).step_by(3).take(300) {
            *w = 0.1 * (i as f32 + 1.0).recip();
        }
        weights[5] = f32::NAN;
        weights[6] = -4.0;
        weights[8] = f32::INFINITY;
        let d = Distribution1D::new(&weights);
        for u in (0..4096).map(|i| i as f32 / 4096.0).chain([0.0, ONE_MINUS_EPSILON, 1.0, 2.0, -1.0, f32::NAN]) {
            let (bin, pmf, rest) = d.sample_discrete(u);
            assert!(weights[bin] > 0.0 && pmf > 0.0 && (0.0..1.0).contains(&rest), "{u}: bin {bin}, {pmf}, {rest}");
            assert_eq!(pmf, d.pmf(bin));
        }
    }

    #[test]
    fn the_guide_finds_what_a_search_of_the_whole_table_finds() {
        let mut state = 9u32;
        let mut number = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        for bins in [1, 2, 7, 8, 9, 64, 1000, 1024] {
            let empty = [0.0, 0.6, 0.95][bins % 3];
            let weights: Vec<f32> = (0..bins).map(|_| if number() < empty { 0.0 } else { number().powi(9) }).collect();
            let d = Distribution1D::new(&weights);
            let edges = d.cdf.iter().flat_map(|c| [*c, c.next_down(), c.next_up()]);
            for u in edges.chain((0..2000).map(|i| i as f32 / 2000.0)).map(|u| u.clamp(0.0, ONE_MINUS_EPSILON)) {
                let searched = d.cdf.partition_point(|c| *c <= u) - 1;
                assert_eq!(d.sample_discrete(u).0, searched, "{bins} bins at {u}");
            }
        }
    }

    #[test]
    fn all_zero_is_uniform() {
        for d in [Distribution1D::new(&[0.0; 4]), Distribution1D::new(&[f32::NAN, -1.0, 0.0, 0.0])] {
            assert!((0..4).all(|i| (d.pmf(i) - 0.25).abs() < 1e-7));
        }
        assert_eq!(Distribution1D::new(&[]).sample(0.5), (0.5, 1.0));
        let d = Distribution2D::new(&[0.0; 6], 3).unwrap();
        assert!((d.pdf(Vec2::new(0.9, 0.1)) - 1.0).abs() < 1e-6);
        assert!(Distribution2D::new(&[1.0; 5], 3).is_none() && Distribution2D::new(&[], 3).is_none());
        assert!(Distribution2D::new(&[1.0], 0).is_none());
    }

    #[test]
    fn density_of_a_grid_integrates_to_one_and_matches_what_sampling_reports() {
        let weights: Vec<f32> =
            (0..15 * 7).map(|i| ((i * 7919) % 101) as f32 * if i / 15 == 2 { 0.0 } else { 1.0 }).collect();
        let d = Distribution2D::new(&weights, 15).unwrap();
        assert_eq!(d.size(), [15, 7]);
        let total: f32 = (0..15 * 7).map(|i| d.pmf([i % 15, i / 15])).sum();
        assert!((total - 1.0).abs() < 1e-5);
        for i in 0..1000 {
            let u = Vec2::new((i as f32 * 0.618_034).fract(), (i as f32 + 0.5) / 1000.0);
            let (uv, pdf) = d.sample(u);
            assert!(pdf > 0.0 && (pdf - d.pdf(uv)).abs() <= 1e-4 * pdf, "{uv}: {pdf} {}", d.pdf(uv));
        }
    }
}
