//! Speed beside other libraries: `bench rays`.
//!
//! Measures single-ray queries on one thread beside Embree, in one run and in turn, on the same
//! triangles and rays, and compares the hits. Embree is found when this is built (see `build.rs`).

mod chart;
#[cfg(embree)]
mod embree;
mod measure;
mod random;
mod rays;
mod report;
mod scenes;
mod tracer;

use std::{fs, path::PathBuf};

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};

use measure::Effort;
use report::Report;

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
    /// Folders for rays.json; charts go there too.
    #[arg(long, default_value = "target/bench")]
    out: Vec<PathBuf>,
    /// The commit that is measured, for the record.
    #[arg(long, default_value = "unknown")]
    commit: String,
}

fn main() -> Result<()> {
    match Arguments::parse().what {
        What::Rays(arguments) => rays_beside_embree(&arguments),
    }
}

fn rays_beside_embree(arguments: &RaysArguments) -> Result<()> {
    let effort = Effort { rays: arguments.rays, rounds: arguments.rounds, builds: arguments.builds };
    let mut report = Report {
        processor: report::processor(),
        commit: arguments.commit.clone(),
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
    for folder in &arguments.out {
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
