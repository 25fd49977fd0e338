//! Other programs, called so that a failure shows what was run and what it said.

use std::{
    ffi::OsStr,
    io::{BufRead, BufReader},
    process::{Command, Stdio},
};

use anyhow::{Context, Result, bail};

/// A command for `cargo`: the one that runs us.
pub fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Runs `command` with its output kept back; gives its standard output.
///
/// # Errors
/// It did not start, or it failed: the error then holds the command line and all of its output.
pub fn quiet(command: &mut Command) -> Result<String> {
    let output = command.stdin(Stdio::null()).output().with_context(|| format!("could not start {}", line(command)))?;
    let said = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        let errors = String::from_utf8_lossy(&output.stderr);
        bail!("{}\n{}{}failed: {}", line(command), said, errors, output.status);
    }
    Ok(said.into_owned())
}

/// Runs `command` in the terminal of the user; gives its exit code, 1 where it crashed.
///
/// # Errors
/// It did not start.
pub fn status(command: &mut Command) -> Result<i32> {
    let status = command.status().with_context(|| format!("could not start {}", line(command)))?;
    if status.code().is_none() {
        eprintln!("{} crashed: {status}", line(command));
    }
    Ok(status.code().unwrap_or(1))
}

/// Runs `command` in the terminal of the user.
///
/// # Errors
/// It did not start, or it failed.
pub fn run(command: &mut Command) -> Result<()> {
    match status(command)? {
        0 => Ok(()),
        code => bail!("{} failed with exit code {code}", line(command)),
    }
}

/// Runs `command`, passes each line of its standard output on, and gives the lines that `keep` picks,
/// with its exit code.
///
/// # Errors
/// It did not start, or its output is not text.
pub fn watch(command: &mut Command, keep: impl Fn(&str) -> bool) -> Result<(i32, Vec<String>)> {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("could not start {}", line(command)))?;
    let mut kept = Vec::new();
    if let Some(output) = child.stdout.take() {
        for text in BufReader::new(output).lines() {
            let text = text.with_context(|| format!("output of {}", line(command)))?;
            println!("{text}");
            if keep(&text) {
                kept.push(text);
            }
        }
    }
    let status = child.wait().with_context(|| line(command))?;
    Ok((status.code().unwrap_or(1), kept))
}

/// The command line, to show.
fn line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(OsStr::to_string_lossy).collect::<Vec<_>>().join(" ")
}
