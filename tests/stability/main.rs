//! Where ray tracing methods fail: each case a number, beside the textbook method that fails there.
//!
//! The counting is `umber_bench::stability`'s. `UMBER_STABILITY_RAYS` sets the number of rays of each case: 10⁸ is
//! the full measure, the default a sample of it. With `--nocapture` each test prints its numbers.

mod boxes;
mod far_and_small;
mod mean_depth;
mod roughness;
mod self_intersection;
mod slivers;
mod watertight;

/// Rays of each case: `default`, unless the environment says another number.
fn rays(default: usize) -> usize {
    let set = std::env::var("UMBER_STABILITY_RAYS").ok().and_then(|n| n.parse().ok());
    set.unwrap_or(default)
}
