//! Compiles a scene store to a frozen render scene, integrates it, and keeps the film.
//!
//! [`Session`] is the façade: both front ends use it and nothing else.

mod adaptive;
mod aov;
mod camera;
mod caustics;
mod clusters;
mod compile;
mod emitter_index;
mod film;
mod format;
mod integrator;
mod light_set;
mod light_tracing;
mod linking;
mod material;
mod mesh;
mod message;
mod numbering;
mod scene;
mod session;
mod shadow;
mod stats;
mod surface;

pub use aov::{Accumulation, Aov, AovRow, TABLE as AOVS};
pub use film::{Film, FilmDesc};
pub use format::BufferFormat;
pub use message::{Message, Severity};
pub use session::Session;
pub use stats::Stats;
