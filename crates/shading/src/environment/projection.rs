//! Environment maps that are not latitude-longitude: which direction a place of the image looks along.
//!
//! UsdLux names the formats and leaves their orientation open. Here the middle of each looks along +Z, as that of a
//! latitude-longitude map does, with +Y up.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};
use umber_math::Vector3;

use super::TextureFormat;
use crate::texels::Texels;

/// How an image is laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Projection {
    /// Within the disk that touches the edges, the distance from the middle is in proportion to the angle from +Z.
    /// Debevec's light probes: u = x r, v = y r with r = acos(z) / (π √(x² + y²)), +X to the right.
    Angular,
    /// An orthographic photo, taken from +Z, of a mirror ball that touches the edges; +X to the right.
    MirroredBall,
    /// A cube unfolded, three faces wide and four high, seen from inside: +Z in the middle of the second row between
    /// +X (left) and −X, above it +Y, below it −Y, and below that −Z, upside down. The front face is OpenEXR's.
    VerticalCross,
}

impl Projection {
    pub fn of(format: TextureFormat) -> Option<Self> {
        match format {
            TextureFormat::LatLong => None,
            TextureFormat::Angular => Some(Self::Angular),
            TextureFormat::MirroredBall => Some(Self::MirroredBall),
            TextureFormat::CubeMapVerticalCross => Some(Self::VerticalCross),
        }
    }
    /// The place of a direction, unit: u to the right, v down, 0 … 1.
    #[inline]
    pub fn uv(self, w: Vector3) -> Vec2 {
        let aside = Vec2::new(w.x(), w.y());
        let length = aside.length();
        let on_disk = |r: f32| {
            let p = if length > 0.0 { aside * (r / length) } else { Vec2::new(r, 0.0) };
            Vec2::new(0.5 + 0.5 * p.x, 0.5 - 0.5 * p.y).clamp(Vec2::ZERO, Vec2::ONE)
        };
        match self {
            Self::Angular => on_disk(length.atan2(w.z()) / PI),
            // Half the angle; by its sine and by its cosine, each where it is exact.
            Self::MirroredBall if w.z() > 0.0 => on_disk(length / (2.0 * (1.0 + w.z())).sqrt()),
            Self::MirroredBall => on_disk((0.5 * (1.0 - w.z())).sqrt()),
            Self::VerticalCross => cross_uv(w.0),
        }
    }
    /// The direction of a place, unit, and the steradians per unit of u v there; `None` where the image has none.
    #[inline]
    pub fn direction(self, uv: Vec2) -> Option<(Vector3, f32)> {
        let p = Vec2::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
        let r2 = p.length_squared();
        match self {
            Self::VerticalCross => cross_direction(uv),
            _ if r2 > 1.0 => None,
            Self::Angular => {
                let r = r2.sqrt();
                let (sin, cos) = (PI * r).sin_cos();
                let sin_over_r = if r > 0.0 { sin / r } else { PI };
                Some((Vector3::new(p.x * sin_over_r, p.y * sin_over_r, cos), 4.0 * PI * sin_over_r))
            }
            Self::MirroredBall => {
                let s = 2.0 * (1.0 - r2).sqrt();
                Some((Vector3::new(p.x * s, p.y * s, 1.0 - 2.0 * r2), 16.0))
            }
        }
    }
    /// The place in pixels at which to look up a direction: not so near a border that pixels beyond it come in.
    #[inline]
    pub fn place(self, uv: Vec2, size: Vec2) -> Vec2 {
        let place = uv * size;
        if self != Self::VerticalCross {
            return place;
        }
        let face = size / CELLS;
        let half = Vec2::splat(0.5).min(0.5 * face);
        let corner = cell(uv) * face;
        place.clamp(corner + half, corner + face - half)
    }
    /// Fills what lies outside the disk of a probe or a ball with the pixels at its rim.
    pub fn extend(self, texels: &mut Texels) {
        if self == Self::VerticalCross {
            return;
        }
        let (width, height, size) = (texels.width, texels.height, texels.size());
        // A pixel inside the rim, along the shorter side.
        let rim = (1.0 - 1.5 / size.min_element()).max(0.0);
        let source = texels.pixels.clone();
        for (i, pixel) in texels.pixels.iter_mut().enumerate() {
            let p = (Vec2::new((i % width) as f32, (i / width) as f32) + 0.5) / size * 2.0 - 1.0;
            if p.length_squared() > 1.0 {
                let from = ((p.normalize() * rim * 0.5 + 0.5) * size).as_uvec2();
                *pixel = source[(from.y as usize).min(height - 1) * width + (from.x as usize).min(width - 1)];
            }
        }
    }
    /// Steradians that a pixel covers, nearly; positive wherever it covers any.
    pub fn pixel_solid_angle(self, cell: [usize; 2], size: Vec2) -> f32 {
        const STEPS: usize = 4;
        let corner = Vec2::new(cell[0] as f32, cell[1] as f32);
        let density = |at: Vec2| self.direction((corner + at) / size).map_or(0.0, |d| d.1);
        let lattice = (0..=STEPS).flat_map(|y| (0..=STEPS).map(move |x| Vec2::new(x as f32, y as f32)));
        let sum: f32 = lattice.map(|at| density(at / STEPS as f32)).sum();
        // Of a disk the point of the pixel nearest to the middle may be all that lies within.
        let nearest = density((size * 0.5 - corner).clamp(Vec2::ZERO, Vec2::ONE));
        (sum + nearest) / ((STEPS + 1) * (STEPS + 1) + 1) as f32 / (size.x * size.y)
    }
}

/// Cells of the cross.
const CELLS: Vec2 = Vec2::new(3.0, 4.0);

#[inline]
fn cell(uv: Vec2) -> Vec2 {
    (uv * CELLS).floor().clamp(Vec2::ZERO, CELLS - 1.0)
}

fn cross_direction(uv: Vec2) -> Option<(Vector3, f32)> {
    let cell = cell(uv);
    let within = (uv * CELLS - cell) * 2.0 - 1.0;
    let (a, b) = (within.x, -within.y);
    let w = match (cell.x as u32, cell.y as u32) {
        (1, 0) => Vec3::new(-a, 1.0, -b),
        (0, 1) => Vec3::new(1.0, b, a),
        (1, 1) => Vec3::new(-a, b, 1.0),
        (2, 1) => Vec3::new(-1.0, b, -a),
        (1, 2) => Vec3::new(-a, -1.0, b),
        (1, 3) => Vec3::new(-a, -b, -1.0),
        _ => return None,
    };
    let length = w.length();
    // A face is 2 × 2 at distance one.
    Some((Vector3(w / length), 4.0 * CELLS.x * CELLS.y / length.powi(3)))
}

fn cross_uv(w: Vec3) -> Vec2 {
    let m = w.abs();
    let (cell, a, b) = if m.z >= m.x && m.z >= m.y {
        let z = m.z.max(f32::MIN_POSITIVE);
        if w.z >= 0.0 { ([1.0, 1.0], -w.x / z, w.y / z) } else { ([1.0, 3.0], -w.x / z, -w.y / z) }
    } else if m.x >= m.y {
        if w.x > 0.0 { ([0.0, 1.0], w.z / m.x, w.y / m.x) } else { ([2.0, 1.0], -w.z / m.x, w.y / m.x) }
    } else if w.y > 0.0 {
        ([1.0, 0.0], -w.x / m.y, -w.z / m.y)
    } else {
        ([1.0, 2.0], -w.x / m.y, w.z / m.y)
    };
    // Not onto the border of the next cell.
    let within = Vec2::new(0.5 + 0.5 * a, 0.5 - 0.5 * b).clamp(Vec2::splat(1e-6), Vec2::splat(1.0 - 1e-6));
    (Vec2::from(cell) + within) / CELLS
}
