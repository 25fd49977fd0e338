//! Which sample dimensions are for what, in one place.
//!
//! The sampler has 2³² sets of one or two dimensions. They are dealt out in ranges that never meet: a new
//! use takes a free number of its range, and shifts no other.

/// Film position within the pixel.
pub const FILM: u32 = 0;
/// From which of the surfaces that several rays met a path goes on.
pub const RAY_CHOICE: u32 = 1;
/// Sets of the camera; those of the path's vertices follow.
const CAMERA_SETS: u32 = 4;
/// Sets of one path vertex.
const VERTEX_SETS: u32 = 8;
/// First set for partly present surfaces, which lies behind those of all vertices.
const PRESENCE_SETS: u32 = 1 << 16;
/// Sets of one path segment for partly present surfaces.
const PRESENCE_SETS_PER_SEGMENT: u32 = 1 << 10;

/// What a path vertex draws numbers for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Draw {
    /// Which light is asked.
    LightChoice = 0,
    /// Where on it.
    LightPoint = 1,
    /// Which lobe is sampled.
    LobeChoice = 2,
    /// In which direction.
    LobeDirection = 3,
    /// Whether the path goes on.
    Roulette = 4,
    /// Two numbers of the vector that makes a mirror rough.
    MirrorNoise = 5,
    /// The third of them.
    MirrorNoiseThird = 6,
    /// Whether a path aims at a place that a caustic comes from, and at which.
    Aim = 7,
}

/// The set of a draw at a path's vertex number `vertex`, counted from 0 behind the camera.
pub const fn vertex(vertex: u32, draw: Draw) -> u32 {
    CAMERA_SETS + vertex * VERTEX_SETS + draw as u32
}

/// The set that decides about the partly present surface number `pass` on the segment before a vertex.
pub const fn presence(vertex: u32, pass: u32) -> u32 {
    PRESENCE_SETS + vertex * PRESENCE_SETS_PER_SEGMENT + pass
}

const _: () = assert!((Draw::Aim as u32) < VERTEX_SETS && FILM < CAMERA_SETS && RAY_CHOICE < CAMERA_SETS);
// as many bounces as the settings allow
const _: () = assert!(vertex(1024, Draw::Aim) < PRESENCE_SETS);
