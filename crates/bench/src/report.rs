//! What was measured, as text and as JSON.

use std::fs;

use serde::{Deserialize, Serialize};

use umber_bench::stability::figures::{Curves, Figure};

use crate::measure::{PEERS, SceneResult};

/// Everything measured in one run.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The processor.
    pub processor: String,
    /// The commit.
    pub commit: String,
    /// What to call to measure again.
    pub command: String,
    /// What was measured beside: a version, or that nothing was found.
    pub peer: String,
    /// How speeds are taken.
    pub method: String,
    /// Who is measured, in the order of all lists.
    pub peers: Vec<&'static str>,
    /// By scene.
    pub scenes: Vec<SceneResult>,
}

/// Failures beside textbook methods, counted in one run.
#[derive(Debug, Serialize)]
pub struct Failures {
    /// The processor.
    pub processor: String,
    /// The commit.
    pub commit: String,
    /// What to call to count again.
    pub command: String,
    /// What was counted.
    pub figures: Vec<Figure>,
    /// What was measured over roughness.
    pub curves: Curves,
}

/// Error over time beside other path tracers, as `tests/accuracy/efficiency` records it; what charts show.
#[derive(Debug, Deserialize)]
pub struct Efficiency {
    /// By scene.
    pub scenes: Vec<EfficiencyScene>,
}

/// One scene's methods.
#[derive(Debug, Deserialize)]
pub struct EfficiencyScene {
    /// Name.
    pub name: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// What is taken for true.
    pub reference: String,
    /// Umber's modes, then the peers.
    pub methods: Vec<Method>,
    /// Peers that took no part, and why.
    pub absent: Vec<String>,
    /// The processor, and its cores.
    pub processor: String,
    /// The commit.
    pub commit: String,
    /// What to call to measure again.
    pub command: String,
    /// Rounds that each figure is the median of.
    pub rounds: u32,
}

/// A renderer in one mode.
#[derive(Debug, Deserialize)]
pub struct Method {
    /// Name.
    pub name: String,
    /// Renderer and version.
    pub about: String,
    /// Whether its errors are against a reference of its own.
    pub own_reference: bool,
    /// Seconds from the start of a process to its first picture of 64 samples a pixel.
    pub from_start_seconds: f64,
    /// By number of samples.
    pub points: Vec<EfficiencyPoint>,
}

impl Method {
    /// Whether it is one of Umber's modes.
    pub fn is_own(&self) -> bool {
        self.name.starts_with("Umber")
    }
}

/// One number of samples.
#[derive(Debug, Deserialize)]
pub struct EfficiencyPoint {
    /// Seconds of rendering.
    pub seconds: f64,
    /// relMSE, the reference's own noise taken off.
    pub error: f64,
    /// Whether no other picture of the scene is both faster and more exact.
    pub on_front: bool,
}

impl Report {
    /// The least ratio against a peer over all scenes and kinds of rays, and where it is.
    pub fn least_ratio(&self, peer: usize) -> Option<(f64, String)> {
        let all = self.scenes.iter().flat_map(|s| s.kinds.iter().map(move |k| (s, k)));
        let named = all.map(|(s, k)| (k.ratio[peer], format!("{}, {}", s.scene, k.kind)));
        named.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// One scene, as lines.
pub fn text(scene: &SceneResult) -> String {
    let list =
        |values: &[f64], digits: usize| values.iter().map(|v| format!("{v:9.digits$}")).collect::<Vec<_>>().join("");
    let mut lines = vec![
        format!("{}: {} triangles, {} instances", scene.scene, scene.triangles, scene.instances),
        format!(
            "  {:<12}{}",
            "",
            PEERS.iter().map(|p| format!("{:>9}", p.replace("Embree robust", "robust"))).collect::<String>()
        ),
        format!("  {:<12}{}  s, one thread", "build", list(&scene.build_seconds, 3)),
        format!("  {:<12}{}  s, two threads", "", list(&scene.build_seconds_two_threads, 3)),
        format!(
            "  {:<12}{}  bytes a triangle, beside {:.1} of points and indices",
            "memory",
            list(&scene.bytes_per_triangle, 1),
            scene.geometry_bytes_per_triangle
        ),
    ];
    for kind in &scene.kinds {
        let peers = (1..PEERS.len()).map(|i| {
            let d = kind.differing[i];
            format!(
                "; {} ratio {:.2}, hits differ {}+{}+{} (wrong {} of ours, {} of theirs)",
                PEERS[i], kind.ratio[i], d.only_umber, d.only_peer, d.elsewhere, d.umber_wrong, d.peer_wrong
            )
        });
        let (name, speeds, share) = (kind.kind, list(&kind.mrays_per_second, 2), 100.0 * kind.hit_share);
        lines.push(format!("  {name:<12}{speeds}  Mrays/s, {share:.0}% hit{}", peers.collect::<String>()));
    }
    lines.join("\n")
}

/// The processor's name, as the system tells it.
pub fn processor() -> String {
    let about = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = about.lines().find(|l| l.starts_with("model name")).and_then(|l| l.split_once(": "));
    name.map_or_else(|| "unknown processor".into(), |(_, name)| name.to_string())
}
