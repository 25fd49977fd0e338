//! Colours, and what AOVs keep, of what is seen.

use pulp::{Arch, Simd, WithSimd};
use umber_math::{Rgb, Vec3, Vector3};
use umber_settings::RasterColor;

use super::super::tile::kept;
use super::bins::{Piece, Seen};
use super::centers;
use super::placement::Placement;
use super::project::Grid;
use super::square::{NOTHING, Square};
use super::surface::VisibleTriangle;
use crate::film::{CenterHit, PixelSum, TILE, TileRect};
use crate::scene::RenderScene;

/// Shades pixels, tile by tile.
///
/// In steps that each go over all pixels: what waits for memory does so for many triangles at once, and arithmetic is
/// done for several pixels at once.
pub struct Shader<'a> {
    scene: &'a RenderScene,
    grid: &'a Grid,
    placements: &'a [Placement],
    arch: Arch,
    directions: Directions,
    /// Numbers of what is seen in the tile, with the pixels where it was first seen.
    found: Vec<(u32, [i32; 2])>,
    /// What they are.
    seen: Vec<(Seen<'a>, [i32; 2])>,
    /// The shading normals of their corners, by index and by value.
    normal_indices: Vec<Option<[u32; 3]>>,
    normals: Vec<Option<[Vec3; 3]>>,
    /// The same triangles, ready to be shaded.
    triangles: Vec<VisibleTriangle<'a>>,
    /// Index of the triangle of each pixel; [`NONE`] where there is none.
    which: Vec<u32>,
}

/// Of a pixel in which nothing is seen.
const NONE: u32 = u32::MAX;

/// The directions of view rays, render space: linear over the film.
#[derive(Clone, Copy)]
struct Directions {
    /// Through the film's middle.
    middle: Vec3,
    /// Change by one pixel across, and one up.
    across: Vec3,
    up: Vec3,
}

/// Surfaces along a row of a tile: their vectors and colours by coordinate and channel.
struct Row {
    /// Shading normals, render space, not of unit length.
    normals: [[f32; TILE]; 3],
    bases: [[f32; TILE]; 3],
    emissions: [[f32; TILE]; 3],
    coverages: [f32; TILE],
}

impl Row {
    const EMPTY: Self = Self {
        normals: [[0.0; TILE]; 3],
        bases: [[0.0; TILE]; 3],
        emissions: [[0.0; TILE]; 3],
        coverages: [0.0; TILE],
    };

    /// Sets what is seen at a pixel.
    #[inline(always)]
    fn set(&mut self, i: usize, triangle: Option<&VisibleTriangle<'_>>, pixel: [i32; 2]) {
        let (mut normal, mut base, mut emission, mut coverage) = (Vec3::ZERO, Rgb::BLACK, Rgb::BLACK, 0.0);
        if let Some(triangle) = triangle {
            ((normal, base), emission, coverage) = (triangle.at(pixel), triangle.emission, 1.0);
        }
        for (lanes, value) in
            [(&mut self.normals, normal), (&mut self.bases, base.0), (&mut self.emissions, emission.0)]
        {
            for (lanes, value) in lanes.iter_mut().zip(value.to_array()) {
                lanes[i] = value;
            }
        }
        self.coverages[i] = coverage;
    }

    /// Radiance by channel, lit from the eye. `start`, `step`: direction of the first view ray, and its change.
    #[inline(always)]
    fn headlit(&self, start: Vec3, step: Vec3) -> [[f32; TILE]; 3] {
        let [nx, ny, nz] = &self.normals;
        let mut radiance = [[0.0; TILE]; 3];
        for i in 0..TILE {
            let d = start + step * i as f32;
            let squared = (nx[i] * nx[i] + ny[i] * ny[i] + nz[i] * nz[i]) * (d.x * d.x + d.y * d.y + d.z * d.z);
            let cos = (nx[i] * d.x + ny[i] * d.y + nz[i] * d.z).abs() / squared.sqrt();
            // what is not a number faces nothing
            let cos = if cos > 0.0 { cos.min(1.0) } else { 0.0 };
            for ((radiance, base), emission) in radiance.iter_mut().zip(&self.bases).zip(&self.emissions) {
                radiance[i] = base[i] * cos + emission[i];
            }
        }
        radiance
    }
}

impl<'a> Shader<'a> {
    /// A shader of what placements show.
    pub fn new(scene: &'a RenderScene, grid: &'a Grid, placements: &'a [Placement]) -> Self {
        let [middle, across, up] = grid.directions();
        let directions = Directions { middle, across, up };
        let arch = Arch::new();
        let (found, seen, normal_indices, normals, triangles, which) = Default::default();
        Self { scene, grid, placements, arch, directions, found, seen, normal_indices, normals, triangles, which }
    }

    /// Finds what is seen in a tile. False where nothing is.
    ///
    /// Step by step for all of it: each step reads far memory that the step before has named, and waits for much of it
    /// at once.
    pub fn look(&mut self, square: &Square, pieces: &[Piece<'a>], rect: TileRect) -> bool {
        self.find(square, rect);
        self.seen.clear();
        self.seen.extend(self.found.iter().map(|(number, pixel)| (Seen::new(pieces, *number), *pixel)));
        let (scene, placements) = (self.scene, self.placements);
        let mesh = |(seen, _): &(Seen<'a>, [i32; 2])| placements[seen.placement as usize].mesh(scene);
        let normals = |at: &(Seen<'a>, [i32; 2])| Some((mesh(at), mesh(at).attributes.normals.as_ref()?));
        self.normal_indices.clear();
        self.normal_indices.extend(self.seen.iter().map(|at| {
            normals(at).and_then(|(mesh, normals)| normals.indices_at_vertices(&mesh.shape.mesh, at.0.triangle))
        }));
        self.normals.clear();
        let indexed = self.seen.iter().zip(&self.normal_indices);
        self.normals.extend(indexed.map(|(at, indices)| Some(normals(at)?.1.of_indices(*indices))));
        self.arch.dispatch(Prepare(self));
        !self.triangles.is_empty()
    }

    /// Fills `which` and `found`.
    fn find(&mut self, square: &Square, rect: TileRect) {
        let Self { found, which, .. } = self;
        found.clear();
        which.clear();
        which.resize(rect.width * rect.height, NONE);
        let (mut numbers_below, mut below) = (&[NOTHING; TILE][..rect.width], &[NONE; TILE][..rect.width]);
        for (y, row) in (rect.y as i32..).zip(which.chunks_exact_mut(rect.width)) {
            let numbers = square.row([rect.x as i32, y], rect.width);
            let mut before = (NOTHING, NONE);
            for (i, (number, which)) in numbers.iter().zip(&mut *row).enumerate() {
                // mostly the triangle of the pixel before or below
                if *number != before.0 {
                    before = match *number {
                        number if number == numbers_below[i] => (number, below[i]),
                        NOTHING => (NOTHING, NONE),
                        number => {
                            found.push((number, [(rect.x + i) as i32, y]));
                            (number, found.len() as u32 - 1)
                        }
                    };
                }
                *which = before.1;
            }
            (numbers_below, below) = (numbers, row);
        }
    }

    /// Prepares what is seen to be shaded.
    #[inline(always)]
    fn prepare(&mut self) {
        self.triangles.clear();
        for ((seen, pixel), normals) in self.seen.iter().zip(&self.normals) {
            let placement = &self.placements[seen.placement as usize];
            self.triangles.push(VisibleTriangle::new(self.scene, self.grid, placement, seen, normals, *pixel));
        }
    }

    /// Colours of the tile that was looked at.
    pub fn colors(&mut self, rect: TileRect, sums: &mut Vec<PixelSum>) {
        if self.scene.settings.raster_color == RasterColor::Shaded {
            return self.arch.dispatch(Headlit { shader: self, rect, sums });
        }
        let triangles = self.which.iter().map(|which| self.triangles.get(*which as usize));
        sums.extend(triangles.map(|triangle| match triangle {
            Some(triangle) => PixelSum::of(self.random_color(triangle), 1.0),
            None => PixelSum::of(Rgb::BLACK, 0.0),
        }));
    }

    /// Colours, lit from the eye.
    #[inline(always)]
    fn headlit(&self, rect: TileRect, sums: &mut Vec<PixelSum>) {
        let mut row = Row::EMPTY;
        for (y, which) in (rect.y as i32..).zip(self.which.chunks_exact(rect.width)) {
            for (i, which) in which.iter().enumerate() {
                row.set(i, self.triangles.get(*which as usize), [(rect.x + i) as i32, y]);
            }
            let [r, g, b] = row.headlit(self.direction([rect.x as i32, y]), self.directions.across);
            let sum = |i: usize| PixelSum::of(kept(self.scene, Rgb(Vec3::new(r[i], g[i], b[i]))), row.coverages[i]);
            sums.extend((0..which.len()).map(sum));
        }
    }

    /// What AOVs keep of the tile that was looked at.
    pub fn centers(&self, rect: TileRect) -> Vec<Option<CenterHit>> {
        let center = |(i, pixel): (usize, [i32; 2])| {
            let triangle = self.triangles.get(self.which[i] as usize)?;
            Some(centers::center(self.scene, self.grid, triangle, pixel, Vector3(self.direction(pixel))))
        };
        pixels(rect).enumerate().map(center).collect()
    }

    /// Of the view ray through a pixel's middle, not of unit length.
    #[inline(always)]
    fn direction(&self, pixel: [i32; 2]) -> Vec3 {
        let [x, y] = self.grid.film_position(pixel).map(|v| v as f32);
        self.directions.middle + self.directions.across * x + self.directions.up * y
    }

    /// A colour that looks like no other polygon's, or no other prim's.
    fn random_color(&self, triangle: &VisibleTriangle<'_>) -> Rgb {
        let by_polygon = self.scene.settings.raster_color == RasterColor::Random;
        let mesh = triangle.mesh;
        let polygon = if by_polygon { mesh.shape.mesh.elements[triangle.index as usize] } else { u32::MAX };
        Rgb(random_color([mesh.prim_id as u32, polygon]))
    }
}

/// [`Shader::prepare`], compiled for the processor's vector unit.
struct Prepare<'s, 'a>(&'s mut Shader<'a>);

impl WithSimd for Prepare<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.0.prepare();
    }
}

/// Colours of a tile, lit from the eye; compiled for the processor's vector unit.
struct Headlit<'s, 'a> {
    shader: &'s Shader<'a>,
    rect: TileRect,
    sums: &'s mut Vec<PixelSum>,
}

impl WithSimd for Headlit<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.shader.headlit(self.rect, self.sums);
    }
}

/// The pixels of a tile, row by row.
fn pixels(rect: TileRect) -> impl Iterator<Item = [i32; 2]> {
    let row = move |y: usize| (rect.x..rect.x + rect.width).map(move |x| [x as i32, y as i32]);
    (rect.y..rect.y + rect.height).flat_map(row)
}

/// A colour from a hash.
fn random_color(of: [u32; 2]) -> Vec3 {
    // Murmur3's mixing (Appleby 2011)
    let mix = |mut h: u32| {
        h = (h ^ h >> 16).wrapping_mul(0x85eb_ca6b);
        h = (h ^ h >> 13).wrapping_mul(0xc2b2_ae35);
        h ^ h >> 16
    };
    let hash = of.into_iter().fold(0x9e37_79b9, |h: u32, v| mix(h.rotate_left(5) ^ v).wrapping_add(h));
    let channel = |shift: u32| 0.05 + 0.95 / 1023.0 * (hash >> shift & 1023) as f32;
    Vec3::new(channel(0), channel(10), channel(20))
}
