//! `cargo xtask test`: every test there is.

use std::process::{Command, ExitCode};

use anyhow::Result;

use crate::{hydra, process, render, usd, usd::UsdBuild, workspace};

/// Pytest's exit code where there are no tests.
const NO_TESTS: i32 = 5;

/// What ran, and what the runners said at the end.
#[derive(Default)]
struct Report {
    closing: Vec<String>,
    failed: bool,
}

/// Runs the command.
///
/// # Errors
/// A test runner could not be set up.
pub fn run() -> Result<ExitCode> {
    let mut report = Report::default();
    // A part that cannot be set up has failed; the others still have something to say.
    for (name, part) in [("rust", rust as Part), ("python", python), ("hosts", hosts)] {
        if let Err(error) = part(&mut report) {
            eprintln!("{error:#}");
            report.add(name, "could not run", false);
        }
    }
    println!("\n{}", report.closing.join("\n"));
    Ok(if report.failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

type Part = fn(&mut Report) -> Result<()>;

impl Report {
    fn add(&mut self, name: &str, said: &str, passed: bool) {
        self.closing.push(format!("{name}: {said}{}", if passed { "" } else { " (FAILED)" }));
        self.failed |= !passed;
    }
}

/// Tests of the crates, those in their documentation among them.
fn rust(report: &mut Report) -> Result<()> {
    let mut cargo = process::cargo();
    cargo.args(["test", "--workspace", "--no-fail-fast"]).current_dir(workspace::root());
    let (code, results) = process::watch(&mut cargo, |line| line.starts_with("test result:"))?;
    let sum = |what| results.iter().map(|line| count(line, what)).sum::<u64>();
    let said = format!("{} passed, {} failed, {} ignored", sum("passed"), sum("failed"), sum("ignored"));
    report.add("rust", &said, code == 0);
    Ok(())
}

/// The number before the word `what` in a line such as "test result: ok. 3 passed; 0 failed".
fn count(line: &str, what: &str) -> u64 {
    let words: Vec<_> = line.split([' ', ';', '.']).filter(|word| !word.is_empty()).collect();
    words.windows(2).find(|pair| pair[1] == what).and_then(|pair| pair[0].parse().ok()).unwrap_or(0)
}

/// Tests of the Python front end, on usd-core.
fn python(report: &mut Report) -> Result<()> {
    let mut command = render::usd_core_venv()?.command();
    command.args(["-m", "pytest", "-q", "--ignore=tests/hosts", "tests", "crates/python"]);
    pytest("python", &mut command, report)
}

/// Tests in the hosts that load the delegate.
fn hosts(report: &mut Report) -> Result<()> {
    let Some(usd) = UsdBuild::find()? else {
        println!("{}", usd::MISSING);
        report.add("hosts", "not run, for want of an OpenUSD with imaging", true);
        return Ok(());
    };
    let plugins = hydra::build(&usd)?;
    let mut command = hydra::host_command(&usd, &plugins)?;
    command.env("UMBER_USD_CORE_PYTHON", render::usd_core_venv()?.python());
    command.args(["-m", "pytest", "-q", "tests/hosts"]);
    pytest("hosts", &mut command, report)
}

fn pytest(name: &str, command: &mut Command, report: &mut Report) -> Result<()> {
    command.args(["-p", "no:cacheprovider", "-ra"]).current_dir(workspace::root());
    let (code, closing) = process::watch(command, is_closing_line)?;
    let said = closing.last().map_or("no closing line", |line| line.trim_matches(['=', ' ']));
    report.add(name, said, code == 0 || code == NO_TESTS);
    Ok(())
}

/// Whether pytest says `line` at the end: "3 passed, 1 skipped in 2.10s".
fn is_closing_line(line: &str) -> bool {
    let line = line.trim_matches(['=', ' ']);
    let counts = line.split_once(" in ").map_or("", |(counts, _)| counts);
    counts.split(", ").all(|count| count.starts_with(|c: char| c.is_ascii_digit()) || count == "no tests ran")
}

#[cfg(test)]
mod tests {
    use super::{count, is_closing_line};

    #[test]
    fn results_are_counted() {
        let line = "test result: FAILED. 12 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.52s";
        assert_eq!([count(line, "passed"), count(line, "failed"), count(line, "ignored")], [12, 3, 0]);
    }

    #[test]
    fn closing_line_of_pytest_is_known() {
        assert!(is_closing_line("12 passed, 1 skipped in 83.10s (0:01:23)"));
        assert!(is_closing_line("==== 1 failed, 2 errors in 0.10s ===="));
        assert!(is_closing_line("no tests ran in 0.01s"));
        assert!(!is_closing_line("SKIPPED [1] tests/x.py: there are 2 passed in it"));
        assert!(!is_closing_line(""));
    }
}
