//! Sample sequences, warps, distributions and MIS weights.
//!
//! Nothing here knows of surfaces, lights or scenes: numbers in the unit square go in, points, directions
//! and their densities come out. Densities carry their measure in the name.

mod blue_noise;
#[cfg(feature = "test-support")]
pub mod chi2;
mod distribution;
mod hash;
mod mis;
mod sampler;
pub mod warp;

pub use distribution::{CellSample, Distribution1D, Distribution2D};
pub use mis::{balance_heuristic, power_heuristic};
pub use sampler::Sampler;
