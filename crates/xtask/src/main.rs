//! Automation: `cargo xtask help`.
//!
//! One file a command. A command says what it does in a line or two, keeps the output of the tools it
//! calls to itself unless they fail, and leaves nothing half done: run it again after any failure.

mod bench;
mod hydra;
mod lint;
mod process;
mod python;
mod render;
mod sdk;
mod test;
mod usd;
mod workspace;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Set up, build, render, test and check Umber.")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Assemble an OpenUSD with imaging in the per-user cache, to build and test the delegate against.
    Sdk(sdk::Arguments),
    /// Build the Hydra delegate into target/hydra/plugin/usd, for PXR_PLUGINPATH_NAME.
    Hydra,
    /// Render a stage: STAGE OUT [flags of usdrecord] [--host usd-core|hydra|blender].
    Render(render::Arguments),
    /// Run every test: Rust, Python on usd-core, and the hosts where an OpenUSD with imaging is found.
    Test,
    /// Measure beside other libraries, into target/bench and docs/charts: `bench rays`, `bench efficiency`.
    Bench(bench::Arguments),
    /// Check formatting, lints, documentation, the order of the crates, C++ warnings and Python.
    Lint,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Sdk(arguments) => sdk::run(&arguments),
        Command::Hydra => hydra::run(),
        Command::Render(arguments) => render::run(arguments),
        Command::Test => test::run(),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Lint => lint::run(),
    };
    done.unwrap_or_else(|error| {
        eprintln!("{error:#}");
        ExitCode::FAILURE
    })
}
