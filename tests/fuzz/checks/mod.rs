//! What the fuzz targets check. The ordinary test `seeds.rs` checks the same on the seeds.

pub mod bounds;
pub mod instances;
pub mod mesh;
mod scene;
mod values;

/// Lets builds run on the calling thread, for the whole process: thousands of small ones a second.
#[cfg(not(test))]
pub fn stay_on_this_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    assert!(pool.build_global().is_ok(), "the pool is there already");
}
