//! The render thread.

use super::control::Shared;

/// Takes up jobs until the session ends.
pub(super) fn run(shared: &Shared) {
    while let Some(job) = shared.next_job() {
        shared.end_job(job.epoch, true);
    }
}
