//! Threads of a process with sessions in it: those that `umber:threads` allows, while a session lives, and no others.
#![cfg(target_os = "linux")]

mod common;

use std::fs;
use std::time::{Duration, Instant};

use common::*;
use umber_render::Session;

/// Threads of this process that are Umber's: a thread without a name has that of the one that started it.
fn threads() -> usize {
    let tasks = fs::read_dir("/proc/self/task").unwrap().flatten();
    // one that ends meanwhile has none
    let names = tasks.flat_map(|task| fs::read_to_string(task.path().join("comm")));
    names.filter(|name| name.starts_with("umber")).count()
}

/// Threads that end are not waited for by those who end them.
fn become_threads(count: usize) -> bool {
    let started = Instant::now();
    while threads() != count && started.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(5));
    }
    threads() == count
}

/// Metal with all that is done before and between passes.
fn render(threads: i64) -> Session {
    let session = metal_and_lamp(64);
    session.edit(setting("umber:threads", threads)).unwrap();
    session.edit(number("convergedVariance", 1e-3)).unwrap();
    finish(&session);
    session
}

#[test]
fn a_session_has_the_threads_it_may_have_and_takes_them_along() {
    let one = render(1);
    assert!(become_threads(1 + 1), "{} threads of a session that may have 1 and its own", threads());
    let three = render(3);
    assert!(become_threads(1 + 1 + 3 + 1), "{} threads of two sessions", threads());
    three.edit(setting("umber:threads", 2)).unwrap();
    finish(&three);
    assert!(become_threads(1 + 1 + 2 + 1), "{} threads after another setting", threads());
    drop((one, three));
    assert!(become_threads(0), "{} threads stay", threads());
}
