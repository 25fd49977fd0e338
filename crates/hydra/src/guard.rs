//! The one place where panics end.

use std::any::Any;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Why a call from C++ could not be carried out. C++ receives it as an exception and posts it as a
/// Tf error.
#[derive(Debug)]
pub struct Failure(String);

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// What every function that C++ calls returns.
pub type Outcome<T = ()> = Result<T, Failure>;

/// Runs a call from C++; a panic in it becomes a failure.
///
/// What the call was changing may be left half done: prims are plain data that the next sync
/// overwrites, and the session's locks outlive a panic.
pub fn guard<T>(call: impl FnOnce() -> T) -> Outcome<T> {
    catch_unwind(AssertUnwindSafe(call)).map_err(|panic| Failure(format!("panic: {}", message(&*panic))))
}

/// As [`guard`], for a call that can be refused.
pub fn guard_refusal<T, E: fmt::Display>(call: impl FnOnce() -> Result<T, E>) -> Outcome<T> {
    guard(call)?.map_err(|refusal| Failure(refusal.to_string()))
}

fn message(panic: &(dyn Any + Send)) -> &str {
    if let Some(text) = panic.downcast_ref::<&str>() {
        text
    } else if let Some(text) = panic.downcast_ref::<String>() {
        text
    } else {
        "of unknown kind"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_become_failures() {
        let said = |outcome: Outcome| outcome.unwrap_err().to_string();
        assert_eq!(said(guard(|| panic!("plain"))), "panic: plain");
        assert_eq!(said(guard(|| panic!("number {}", 3))), "panic: number 3");
        assert_eq!(said(guard(|| std::panic::panic_any(3))), "panic: of unknown kind");
        assert_eq!(said(guard_refusal(|| Err::<(), _>("no"))), "no");
        assert_eq!(guard(|| 7).unwrap(), 7);
    }
}
