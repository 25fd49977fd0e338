//! Colours, and what AOVs keep, of what is seen.

use pulp::{Arch, Simd, WithSimd};
use umber_math::{Rgb, Vec3, Vector3};
use umber_settings::RasterColor;

use super::super::tile::{keeps, kept};
use super::centers;
use super::pieces::{Piece, Seen};
use super::placement::Placement;
use super::project::Grid;
use super::square::{NOTHING, SQUARE, Square};
use super::surface::{SquarePixel, Surface, Surfaces, face_normal};
use crate::clusters::{CLUSTER, LANES};
use crate::film::{CenterHit, PixelSum, TILE, TileRect};
use crate::scene::RenderScene;

/// Shades pixels, tile by tile.
pub struct Shader<'a> {
    scene: &'a RenderScene,
    grid: &'a Grid,
    placements: &'a [Placement],
    arch: Arch,
    directions: Directions,
    /// First column and row of the square.
    square_first: [i32; 2],
    /// Numbers of what was seen in the square's tiles so far, with the pixels where it was first seen.
    found: Vec<(u32, SquarePixel)>,
    /// By number: index among what was found; [`NONE`] where it was not.
    index_of: Vec<u16>,
    /// Index among what was found of what each pixel of the tile shows; [`NONE`] where that is nothing.
    which: Vec<u16>,
    /// Surfaces of what was found, where they are lit.
    surfaces: Surfaces,
}

/// Whether surfaces are lit, and not coloured at random.
pub fn is_lit(scene: &RenderScene) -> bool {
    scene.settings.raster_color == RasterColor::Shaded
}

/// Index of nothing.
const NONE: u16 = u16::MAX;

// each pixel of a square may show another triangle
const _: () = assert!(SQUARE * SQUARE <= NONE as usize);

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
    fn set(&mut self, i: usize, surfaces: &Surfaces, surface: Option<&Surface>, pixel: SquarePixel) {
        let i = i % TILE;
        let (mut normal, mut base, mut emission, mut coverage) = (Vec3::ZERO, Rgb::BLACK, Rgb::BLACK, 0.0);
        if let Some(surface) = surface {
            (normal, base) = (surface.normal(pixel), surfaces.base(surface, pixel));
            (emission, coverage) = (surface.emission, 1.0);
        }
        self.set_normal(i, normal);
        for (lanes, value) in [(&mut self.bases, base.0), (&mut self.emissions, emission.0)] {
            for (lanes, value) in lanes.iter_mut().zip(value.to_array()) {
                lanes[i] = value;
            }
        }
        self.coverages[i] = coverage;
    }
    #[inline(always)]
    fn set_normal(&mut self, i: usize, normal: Vec3) {
        for (lanes, value) in self.normals.iter_mut().zip(normal.to_array()) {
            lanes[i] = value;
        }
    }

    /// Whether something is seen at a pixel, but has a normal that is zero or not a number.
    #[inline(always)]
    fn lacks_normal(&self, i: usize) -> bool {
        let [x, y, z] = &self.normals;
        let squared = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
        (self.coverages[i] > 0.0) & (squared.is_nan() | (squared <= 0.0))
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
        let (square_first, found, index_of, which, surfaces) = Default::default();
        Self { scene, grid, placements, arch: Arch::new(), directions, square_first, found, index_of, which, surfaces }
    }

    /// Turns to another square, which shows these pieces.
    pub fn start(&mut self, square: &Square, pieces: &[Piece<'_>]) {
        self.square_first = square.first;
        self.found.clear();
        self.surfaces.clear();
        self.index_of.clear();
        self.index_of.resize(pieces.len() * CLUSTER, NONE);
    }

    /// Finds what is seen in a tile of the square. False where nothing is.
    pub fn look(&mut self, square: &Square, pieces: &[Piece<'_>], rect: TileRect) -> bool {
        let known = self.found.len();
        let is_any = self.find(square, rect);
        if is_lit(self.scene) {
            self.arch.dispatch(Prepare { shader: self, pieces, known });
        }
        is_any
    }

    /// Fills `which`, and adds to what was `found`. Whether anything is seen.
    fn find(&mut self, square: &Square, rect: TileRect) -> bool {
        let [x0, y0] = self.tile_start(rect);
        let Self { found, index_of, which, .. } = self;
        let mut is_any = false;
        which.clear();
        for y in 0..rect.height {
            let numbers = square.row([rect.x as i32, (rect.y + y) as i32], rect.width);
            for (x, number) in numbers.iter().enumerate() {
                // that of nothing is beyond all
                let Some(index) = index_of.get_mut(*number as usize) else {
                    debug_assert_eq!(*number, NOTHING, "a number of no piece");
                    which.push(NONE);
                    continue;
                };
                if *index == NONE {
                    *index = found.len() as u16;
                    found.push((*number, [x0 + x as u8, y0 + y as u8]));
                }
                is_any = true;
                which.push(*index);
            }
        }
        is_any
    }

    /// The first pixel of a tile of the square.
    #[inline(always)]
    fn tile_start(&self, rect: TileRect) -> SquarePixel {
        [rect.x as i32 - self.square_first[0], rect.y as i32 - self.square_first[1]].map(|v| v as u8)
    }

    /// Makes the surfaces of what was found beyond what was `known`.
    #[inline(always)]
    fn prepare(&mut self, pieces: &[Piece<'_>], known: usize) {
        let Self { scene, grid, placements, surfaces, square_first, .. } = self;
        let mut found = &self.found[known..];
        while let Some((first, _)) = found.first() {
            let placement = Seen::new(pieces, *first).placement();
            let is_of_another = |(number, _): &(u32, SquarePixel)| Seen::new(pieces, *number).placement() != placement;
            let most = found.len().min(LANES);
            let (batch, rest) = found.split_at(found[..most].iter().position(is_of_another).unwrap_or(most));
            surfaces.add(scene, grid, &placements[placement as usize], *square_first, pieces, batch);
            found = rest;
        }
    }

    /// Colours of the tile that was looked at.
    pub fn colors(&mut self, pieces: &[Piece<'_>], rect: TileRect, sums: &mut Vec<PixelSum>) {
        if is_lit(self.scene) {
            return self.arch.dispatch(Headlit { shader: self, pieces, rect, sums });
        }
        sums.extend(self.which.iter().map(|which| match self.found.get(*which as usize) {
            Some((number, _)) => PixelSum::of(self.random_color(Seen::new(pieces, *number)), 1.0),
            None => PixelSum::of(Rgb::BLACK, 0.0),
        }));
    }

    /// Colours, lit from the eye.
    #[inline(always)]
    fn headlit(&self, pieces: &[Piece<'_>], rect: TileRect, sums: &mut Vec<PixelSum>) {
        let mut row = Row::EMPTY;
        let [x0, y0] = self.tile_start(rect);
        for (y, which) in self.which.chunks_exact(rect.width).enumerate() {
            for (x, which) in which.iter().enumerate() {
                row.set(x, &self.surfaces, self.surfaces.get(*which), [x0 + x as u8, y0 + y as u8]);
            }
            if (0..TILE).fold(false, |any, i| any | row.lacks_normal(i)) {
                self.mend_normals(pieces, which, &mut row);
            }
            let radiance = row.headlit(self.direction([rect.x as i32, (rect.y + y) as i32]), self.directions.across);
            let color = |i: usize| Rgb(Vec3::from(radiance.each_ref().map(|channel| channel[i])));
            let all_kept = keeps(self.scene.settings.firefly_clamp, radiance.as_flattened());
            sums.extend((0..which.len()).map(|i| {
                let color = if all_kept { color(i) } else { kept(self.scene, color(i)) };
                PixelSum::of(color, row.coverages[i])
            }));
        }
    }

    /// Gives pixels of a row the normals of their triangles where they lack others.
    #[cold]
    fn mend_normals(&self, pieces: &[Piece<'_>], which: &[u16], row: &mut Row) {
        for (i, which) in which.iter().enumerate() {
            if let Some((number, _)) = self.found.get(*which as usize).filter(|_| row.lacks_normal(i)) {
                let seen = Seen::new(pieces, *number);
                let placement = &self.placements[seen.placement() as usize];
                row.set_normal(i, face_normal(placement, placement.mesh(self.scene), seen.triangle()));
            }
        }
    }

    /// What AOVs keep of the tile that was looked at.
    pub fn centers(&self, pieces: &[Piece<'_>], rect: TileRect) -> Vec<Option<CenterHit>> {
        let center = |(i, pixel): (usize, [i32; 2])| {
            let seen = Seen::new(pieces, self.found.get(self.which[i] as usize)?.0);
            let triangle = (&self.placements[seen.placement() as usize], seen.triangle());
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
    fn random_color(&self, seen: Seen<'_, '_>) -> Rgb {
        let by_polygon = self.scene.settings.raster_color == RasterColor::Random;
        let mesh = self.placements[seen.placement() as usize].mesh(self.scene);
        let polygon = if by_polygon { mesh.shape.mesh.elements[seen.triangle() as usize] } else { u32::MAX };
        Rgb(random_color([mesh.prim_id as u32, polygon]))
    }
}

/// [`Shader::prepare`], compiled for the processor's vector unit.
struct Prepare<'s, 'a> {
    shader: &'s mut Shader<'a>,
    pieces: &'s [Piece<'s>],
    known: usize,
}

impl WithSimd for Prepare<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.shader.prepare(self.pieces, self.known);
    }
}

/// Colours of a tile, lit from the eye; compiled for the processor's vector unit.
struct Headlit<'s, 'a> {
    shader: &'s Shader<'a>,
    pieces: &'s [Piece<'s>],
    rect: TileRect,
    sums: &'s mut Vec<PixelSum>,
}

impl WithSimd for Headlit<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.shader.headlit(self.pieces, self.rect, self.sums);
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
