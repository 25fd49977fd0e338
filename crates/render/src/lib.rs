//! Compiles a scene store to a frozen render scene, integrates it, and keeps the film.
//!
//! [`Session`] is the façade: both front ends use it and nothing else.

mod aov;
mod film;
mod format;
mod message;
mod session;
mod stats;

pub use aov::{Accumulation, Aov, AovRow, TABLE as AOVS};
pub use film::{Film, FilmDesc};
pub use format::BufferFormat;
pub use message::{Message, Severity};
pub use session::Session;
pub use stats::Stats;
pub use umber_scene as scene;
pub use umber_settings as settings;
