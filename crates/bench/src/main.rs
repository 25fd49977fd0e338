//! Speed beside other libraries: `bench rays`. Failures beside textbook methods: `bench stability`.
//! Error over time: `bench efficiency` draws what was measured elsewhere.
//!
//! The first measures single-ray queries on one thread beside Embree, in one run and in turn, on the same
//! triangles and rays, and compares the hits. Embree is found when this is built (see `build.rs`).

mod chart;
#[cfg(embree)]
mod embree;
mod measure;
mod rays;
mod referee;
mod report;
mod scenes;
mod tracer;

use std::{fs, path::PathBuf};

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};

use measure::Effort;
use report::Report;
use umber_bench::{random, stability::figures};

#[derive(Parser)]
#[command(about = "Measure Umber beside its peers.")]
struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Rays a second beside Embree.
    Rays(RaysArguments),
    /// Rays that fail, over size and distance from the origin.
    Stability(StabilityArguments),
    /// Charts of error over time, from what `tests/accuracy/efficiency/measure.py` recorded.
    Efficiency(EfficiencyArguments),
}

#[derive(clap::Args)]
struct RaysArguments {
    /// Rays of each kind.
    #[arg(long, default_value_t = 1 << 17)]
    rays: usize,
    /// Rounds; the median counts.
    #[arg(long, default_value_t = 5)]
    rounds: usize,
    /// Rounds of building.
    #[arg(long, default_value_t = 3)]
    builds: usize,
    /// Only scenes whose name contains this.
    #[arg(long, default_value = "")]
    scene: String,
    /// Splits each triangle into this number squared.
    #[arg(long, default_value_t = 1)]
    refine: u32,
    /// Folder of dumped triangles (*.tri).
    #[arg(long, default_value = "target/bench")]
    dumps: PathBuf,
    #[command(flatten)]
    record: RecordArguments,
}

#[derive(clap::Args)]
struct StabilityArguments {
    /// Rays at each point of a chart.
    #[arg(long, default_value_t = 1_000_000)]
    rays: usize,
    #[command(flatten)]
    record: RecordArguments,
}

#[derive(clap::Args)]
struct EfficiencyArguments {
    /// The record.
    measured: PathBuf,
    /// What the copy of the record and the charts are called.
    #[arg(long, default_value = "efficiency")]
    name: String,
    /// Folders for the record and its charts.
    #[arg(long, default_value = "target/bench")]
    out: Vec<PathBuf>,
}

#[derive(clap::Args)]
struct RecordArguments {
    /// Folders for what was measured, as JSON, and its charts.
    #[arg(long, default_value = "target/bench")]
    out: Vec<PathBuf>,
    /// The commit that is measured, for the record.
    #[arg(long, default_value = "unknown")]
    commit: String,
}

fn main() -> Result<()> {
    match Arguments::parse().what {
        What::Rays(arguments) => rays_beside_embree(&arguments),
        What::Stability(arguments) => failures(&arguments),
        What::Efficiency(arguments) => efficiency(&arguments),
    }
}

fn efficiency(arguments: &EfficiencyArguments) -> Result<()> {
    let text = fs::read_to_string(&arguments.measured).with_context(|| arguments.measured.display().to_string())?;
    let report: report::Efficiency = serde_json::from_str(&text)?;
    for folder in &arguments.out {
        let named = || folder.display().to_string();
        fs::create_dir_all(folder).with_context(named)?;
        fs::write(folder.join(&arguments.name).with_extension("json"), &text).with_context(named)?;
        for scene in &report.scenes {
            let file = folder.join(format!("{}_{}.svg", arguments.name, scene.name));
            chart::efficiency(scene, &file).with_context(|| file.display().to_string())?;
        }
    }
    Ok(())
}

fn failures(arguments: &StabilityArguments) -> Result<()> {
    let report = report::Failures {
        processor: report::processor(),
        commit: arguments.record.commit.clone(),
        command: format!("cargo xtask bench stability --rays {}", arguments.rays),
        figures: figures::all(arguments.rays),
        curves: figures::over_roughness(arguments.rays),
    };
    for figure in &report.figures {
        println!("{}", figures::text(figure));
    }
    println!("{}", figures::curves_text(&report.curves));
    for folder in &arguments.record.out {
        let named = || folder.display().to_string();
        fs::create_dir_all(folder).with_context(named)?;
        fs::write(folder.join("stability.json"), serde_json::to_string_pretty(&report)? + "\n").with_context(named)?;
        for figure in &report.figures {
            let file = folder.join(figure.name).with_extension("svg");
            chart::failures(figure, &report, &file).with_context(|| file.display().to_string())?;
        }
        let file = folder.join(report.curves.name).with_extension("svg");
        chart::curves(&report.curves, &report, &file).with_context(|| file.display().to_string())?;
    }
    Ok(())
}

fn rays_beside_embree(arguments: &RaysArguments) -> Result<()> {
    let effort = Effort { rays: arguments.rays, rounds: arguments.rounds, builds: arguments.builds };
    let mut report = Report {
        processor: report::processor(),
        commit: arguments.record.commit.clone(),
        command: format!("cargo xtask bench rays --rays {} --rounds {}", effort.rays, effort.rounds),
        peer: peer()?,
        method: "one thread, single-ray queries, processor time of the thread, median of rounds taken in turn".into(),
        peers: measure::PEERS.to_vec(),
        scenes: Vec::new(),
    };
    println!("{}; {}\n{}", report.processor, report.peer, report.method);
    for scene in scenes::all(&arguments.dumps)?.into_iter().filter(|s| s.name.contains(&arguments.scene)) {
        let result = measure::scene(&scene.refined(arguments.refine), effort)?;
        println!("{}", report::text(&result));
        report.scenes.push(result);
    }
    for (i, peer) in measure::PEERS.iter().enumerate().skip(1) {
        if let Some((ratio, place)) = report.least_ratio(i) {
            println!("least ratio to {peer}: {ratio:.2} ({place})");
        }
    }
    for folder in &arguments.record.out {
        let named = || folder.display().to_string();
        fs::create_dir_all(folder).with_context(named)?;
        fs::write(folder.join("rays.json"), serde_json::to_string_pretty(&report)? + "\n").with_context(named)?;
        chart::rays(&report, &folder.join("rays.svg")).with_context(named)?;
    }
    Ok(())
}

/// What is measured beside.
#[cfg(embree)]
fn peer() -> Result<String> {
    Ok(format!("Embree {}", embree::Device::new(1)?.version()))
}

/// What is measured beside.
#[cfg(not(embree))]
fn peer() -> Result<String> {
    Ok("Embree is not installed: Umber is measured alone (Debian: libembree-dev; elsewhere EMBREE_LIB_DIR)".into())
}
