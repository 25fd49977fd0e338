//! Photometric profiles: IES LM-63 files, of 1986, 1991, 1995, 2002 and 2019, type C.

mod parse;

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why a profile could not be read.
#[derive(Clone, Debug, thiserror::Error)]
pub enum IesError {
    /// The file is missing or cannot be read.
    #[error("{path}: cannot be read: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: Arc<std::io::Error>,
    },
    /// The text is no profile, a broken one, or of a kind that is not read.
    #[error("{path}: not a usable IES profile: {reason}")]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// How the tabulated half or quarter planes stand for those all around.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Symmetry {
    /// One plane for all.
    Axial,
    /// 0° to 90°, mirrored at both axes.
    Quadrants,
    /// 0° to 180°, mirrored at the plane through both.
    AboutZero,
    /// 90° to 270°, mirrored at the plane through both (LM-63-1995).
    AboutNinety,
    /// All around; between the last plane and the first it is interpolated.
    None,
}

/// Luminous intensity over all directions, in candela as the file has it: tabulated by vertical and horizontal
/// angle, linear in both between, zero at vertical angles that are not tabulated.
///
/// The vertical angle counts from straight down (0) to straight up (π); the horizontal one anticlockwise as seen
/// from above.
#[derive(Clone, Debug)]
pub struct IesProfile {
    /// Radians, ascending within 0 … π; at least two.
    vertical: Vec<f32>,
    /// Radians, ascending; at least one.
    horizontal: Vec<f32>,
    /// One plane after the other, each as long as `vertical`; finite, not negative.
    candela: Vec<f32>,
    symmetry: Symmetry,
    mean: f32,
}

impl IesProfile {
    /// Reads a file.
    ///
    /// # Errors
    /// Where it cannot be read, is broken, or is of type A or B photometry.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, IesError> {
        let path = path.as_ref();
        let io = |e: std::io::Error| IesError::Io { path: path.to_owned(), source: Arc::new(e) };
        // Names in the header may be in any code page; what counts is ASCII.
        let text = String::from_utf8_lossy(&std::fs::read(path).map_err(io)?).into_owned();
        parse::parse(&text).map_err(|reason| IesError::Content { path: path.to_owned(), reason })
    }
    /// From a file's text.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn from_text(text: &str) -> Result<Self, IesError> {
        parse::parse(text).map_err(|reason| IesError::Content { path: "(text)".into(), reason })
    }
    /// Candela towards a vertical and a horizontal angle, radians; zero outside the vertical angles tabulated.
    #[inline]
    pub fn intensity(&self, vertical: f32, horizontal: f32) -> f32 {
        let (first, last) = self.vertical_range();
        // An angle that was computed may miss the poles by its rounding.
        if !(vertical >= first - ROUNDING && vertical <= last + ROUNDING) {
            return 0.0;
        }
        let (v0, v1, v) = bracket(&self.vertical, vertical);
        let (h0, h1, h) = self.planes(horizontal);
        let at = |plane: usize| {
            let plane = &self.candela[plane * self.vertical.len()..];
            plane[v0] + (plane[v1] - plane[v0]) * v
        };
        if h0 == h1 { at(h0) } else { at(h0) * (1.0 - h) + at(h1) * h }
    }
    /// Mean intensity over the sphere; over half of it where the vertical angles span no more than a right angle.
    ///
    /// What `inputs:shaping:ies:normalize` divides by.
    pub fn mean(&self) -> f32 {
        self.mean
    }
    /// The first and the last tabulated vertical angle, radians.
    pub fn vertical_range(&self) -> (f32, f32) {
        (self.vertical[0], self.vertical[self.vertical.len() - 1])
    }
    /// Whether it is the same all around.
    pub fn is_axial(&self) -> bool {
        self.symmetry == Symmetry::Axial
    }
    /// Whether no intensity is above zero.
    pub fn is_black(&self) -> bool {
        self.candela.iter().all(|&c| c == 0.0)
    }
    /// Two planes on either side of a horizontal angle, and how far it is from the first to the second.
    #[inline]
    fn planes(&self, angle: f32) -> (usize, usize, f32) {
        use std::f32::consts::{FRAC_PI_2, PI, TAU};
        let around = angle.rem_euclid(TAU);
        let mirrored = if around > PI { TAU - around } else { around };
        match self.symmetry {
            Symmetry::Axial => (0, 0, 0.0),
            Symmetry::Quadrants => bracket(&self.horizontal, mirrored.min(PI - mirrored)),
            Symmetry::AboutZero => bracket(&self.horizontal, mirrored),
            Symmetry::AboutNinety => {
                let from_ninety = (around - FRAC_PI_2).rem_euclid(TAU);
                bracket(&self.horizontal, FRAC_PI_2 + from_ninety.min(TAU - from_ninety))
            }
            Symmetry::None => {
                let last = self.horizontal.len() - 1;
                let end = self.horizontal[last];
                if around > end {
                    return (last, 0, (around - end) / (self.horizontal[0] + TAU - end));
                }
                bracket(&self.horizontal, around)
            }
        }
    }
    /// The integral of the interpolated intensity over the directions of its vertical angles, over 4 π or 2 π.
    fn integrated_mean(&self) -> f64 {
        let step = self.vertical.len();
        let around: Vec<f64> = (0..step).map(|v| self.mean_around(v)).collect();
        let integral: f64 = (1..step)
            .map(|v| {
                let (a, b) = (f64::from(self.vertical[v - 1]), f64::from(self.vertical[v]));
                let (from, to) = (around[v - 1], around[v]);
                let slope = if b > a { (to - from) / (b - a) } else { 0.0 };
                // ∫ f sin, f linear: −f cos + slope · sin
                from * a.cos() - to * b.cos() + slope * (b.sin() - a.sin())
            })
            .sum();
        let (first, last) = self.vertical_range();
        let is_half = f64::from(last - first) <= FRAC_PI_2 + HALF_SPHERE_SLACK;
        2.0 * PI * integral / (PI * if is_half { 2.0 } else { 4.0 })
    }
    /// Mean over all horizontal angles at a tabulated vertical one.
    fn mean_around(&self, v: usize) -> f64 {
        let at = |plane: usize| f64::from(self.candela[plane * self.vertical.len() + v]);
        let angles = &self.horizontal;
        let trapezoid = |i: usize| f64::from(angles[i] - angles[i - 1]) * 0.5 * (at(i) + at(i - 1));
        let sum: f64 = (1..angles.len()).map(trapezoid).sum();
        let last = angles.len() - 1;
        let span = f64::from(angles[last] - angles[0]);
        if self.symmetry == Symmetry::None {
            let gap = 2.0 * PI - span;
            return (sum + gap.max(0.0) * 0.5 * (at(last) + at(0))) / (2.0 * PI);
        }
        if last == 0 { at(0) } else { sum / span }
    }
}

/// Radians by which a vertical angle may be outside the table.
const ROUNDING: f32 = 1e-5;
/// Radians over a right angle up to which a profile counts as one of half the sphere.
const HALF_SPHERE_SLACK: f64 = 0.1;

/// The two neighbours of `x` among ascending values, and how far it is from the first to the second, 0 to 1.
#[inline]
fn bracket(values: &[f32], x: f32) -> (usize, usize, f32) {
    let above = values.partition_point(|&v| v <= x);
    if above == 0 {
        return (0, 0, 0.0);
    }
    if above == values.len() {
        return (above - 1, above - 1, 0.0);
    }
    let (a, b) = (values[above - 1], values[above]);
    (above - 1, above, (x - a) / (b - a))
}
