//! Threads of a process with sessions in it: those that `umber:threads` allows, while a session lives, and no others.
#![cfg(target_os = "linux")]

mod common;

use std::time::{Duration, Instant};

use common::*;
use umber_render::Session;

/// Threads of this process.
fn threads() -> usize {
    std::fs::read_dir("/proc/self/task").unwrap().count()
}

/// Whether there come to be so many threads within ten seconds: those that end are not waited for.
fn become_threads(count: usize) -> bool {
    let started = Instant::now();
    while threads() != count && started.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(5));
    }
    threads() == count
}

/// A picture with all that is done before and between passes.
fn render(threads: i64) -> Session {
    let session = metal_and_lamp(1024);
    session.edit(setting("umber:threads", threads)).unwrap();
    session.edit(number("convergedVariance", 1e-3)).unwrap();
    finish(&session);
    assert!(session.stats().light_paths > 0);
    session
}

#[test]
fn a_session_has_the_threads_it_may_have_and_takes_them_along() {
    let before = threads();
    let one = render(1);
    assert!(become_threads(before + 2), "{} of a session that may have 1 and its own", threads() - before);
    let three = render(3);
    assert!(become_threads(before + 2 + 4), "{} of two sessions", threads() - before);
    three.edit(setting("umber:threads", 2)).unwrap();
    finish(&three);
    assert!(become_threads(before + 2 + 3), "{} after another setting", threads() - before);
    drop((one, three));
    assert!(become_threads(before), "{} stay", threads() - before);
}
