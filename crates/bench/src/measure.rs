//! Measures: peers take turns, and the median counts.

use std::time::{Duration, Instant};

use anyhow::Result;
use cpu_time::ThreadTime;
use serde::Serialize;

#[cfg(embree)]
use crate::embree::{Device, EmbreeScene};
use crate::{
    rays::{self, RaySet},
    referee::Referee,
    scenes::Scene,
    tracer::{Tracer, UmberScene},
};

/// Parameters of closest hits that are apart by more than this part count as different hits.
const SAME_T: f32 = 1e-4;

/// Who is measured, in the order of all lists below. The first is ours.
#[cfg(embree)]
pub const PEERS: &[&str] = &["Umber", "Embree", "Embree robust"];
/// Who is measured: nobody else was found.
#[cfg(not(embree))]
pub const PEERS: &[&str] = &["Umber"];

/// How much is measured.
#[derive(Clone, Copy)]
pub struct Effort {
    /// Rays of each kind.
    pub rays: usize,
    /// Rounds, of which the median counts.
    pub rounds: usize,
    /// Rounds of building.
    pub builds: usize,
}

/// Rays for which a peer's answer is another than ours.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Differing {
    /// We hit, the peer misses.
    pub only_umber: usize,
    /// The peer hits, we miss.
    pub only_peer: usize,
    /// Both hit, at different places.
    pub elsewhere: usize,
    /// Of all these, how many of our answers double precision refutes.
    pub umber_wrong: usize,
    /// Of all these, how many of the peer's answers double precision refutes.
    pub peer_wrong: usize,
}

/// What was found for one kind of ray.
#[derive(Clone, Debug, Serialize)]
pub struct KindResult {
    /// The kind of ray.
    pub kind: &'static str,
    /// Number of rays.
    pub rays: usize,
    /// Part of them that hit.
    pub hit_share: f64,
    /// Speed of each peer, millions of rays a second of processor time.
    pub mrays_per_second: Vec<f64>,
    /// Our speed over each peer's: the median over rounds of the ratio in one round.
    pub ratio: Vec<f64>,
    /// Against each peer.
    pub differing: Vec<Differing>,
}

/// What was found for one scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneResult {
    /// The scene.
    pub scene: String,
    /// Triangles stored.
    pub triangles: usize,
    /// Instances.
    pub instances: usize,
    /// Time of each peer's build on one thread, seconds.
    pub build_seconds: Vec<f64>,
    /// The same on two threads.
    pub build_seconds_two_threads: Vec<f64>,
    /// Each peer's hierarchies, bytes a triangle stored, without points and indices.
    pub bytes_per_triangle: Vec<f64>,
    /// Points and indices, bytes a triangle stored.
    pub geometry_bytes_per_triangle: f64,
    /// By kind of ray.
    pub kinds: Vec<KindResult>,
}

/// Measures one scene.
///
/// # Errors
/// A peer reports one.
pub fn scene(scene: &Scene, effort: Effort) -> Result<SceneResult> {
    let mut seconds = [vec![Vec::new(); PEERS.len()], vec![Vec::new(); PEERS.len()]];
    for _ in 0..effort.builds.max(1) {
        build(scene, 2, &mut seconds[1])?;
    }
    for _ in 1..effort.builds.max(1) {
        build(scene, 1, &mut seconds[0])?;
    }
    let (umber, peers, bytes) = build(scene, 1, &mut seconds[0])?;
    let [one_thread, two_threads] = seconds.map(|seconds| seconds.into_iter().map(median).collect());
    let tracers: Vec<&dyn Tracer> = std::iter::once(&umber as &dyn Tracer).chain(peers.iter().map(|p| &**p)).collect();
    let sets = rays::sets(scene, &umber, effort.rays);
    let (triangles, referee) = (scene.triangle_count(), Referee::new(scene));
    Ok(SceneResult {
        scene: scene.name.clone(),
        triangles,
        instances: scene.instances.len(),
        build_seconds: one_thread,
        build_seconds_two_threads: two_threads,
        bytes_per_triangle: bytes.iter().map(|&b| b as f64 / triangles.max(1) as f64).collect(),
        geometry_bytes_per_triangle: scene.geometry_bytes() as f64 / triangles.max(1) as f64,
        kinds: sets.iter().map(|set| kind(set, &tracers, &referee, effort.rounds)).collect(),
    })
}

type Built = (UmberScene, Vec<Box<dyn Tracer>>, Vec<usize>);

/// Builds everything once on a number of threads and notes the time of each.
fn build(scene: &Scene, threads: usize, seconds: &mut [Vec<f64>]) -> Result<Built> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let start = Instant::now();
    let umber = pool.install(|| UmberScene::build(scene));
    seconds[0].push(start.elapsed().as_secs_f64());
    #[allow(unused_mut)]
    let (mut peers, mut bytes): (Vec<Box<dyn Tracer>>, _) = (Vec::new(), vec![umber.hierarchy_bytes()]);
    #[cfg(embree)]
    {
        let device = Device::new(threads)?;
        for (robust, seconds) in [false, true].into_iter().zip(&mut seconds[1..]) {
            // The buffers of points and indices are filled meanwhile: a few milliseconds a million.
            let start = Instant::now();
            let built = EmbreeScene::build(&device, scene, robust)?;
            seconds.push(start.elapsed().as_secs_f64());
            bytes.push(built.hierarchy_bytes);
            peers.push(Box::new(built));
        }
    }
    Ok((umber, peers, bytes))
}

fn kind(set: &RaySet, tracers: &[&dyn Tracer], referee: &Referee<'_>, rounds: usize) -> KindResult {
    let mut seconds = vec![Vec::new(); tracers.len()];
    let mut hits = 0;
    for _ in 0..rounds.max(1) {
        for (i, tracer) in tracers.iter().enumerate() {
            let (time, count) =
                timed(|| if set.any { tracer.count_any(&set.rays) } else { tracer.count_closest(&set.rays) });
            seconds[i].push(time.as_secs_f64());
            hits = if i == 0 { count } else { hits };
        }
    }
    let rays = set.rays.len();
    let ratio = |peer: &Vec<f64>| median(peer.iter().zip(&seconds[0]).map(|(peer, ours)| peer / ours).collect());
    KindResult {
        kind: set.name,
        rays,
        hit_share: hits as f64 / rays.max(1) as f64,
        mrays_per_second: seconds.iter().map(|s| rays as f64 / median(s.clone()) / 1e6).collect(),
        ratio: seconds.iter().map(ratio).collect(),
        differing: tracers.iter().map(|t| differing(set, tracers[0], *t, referee)).collect(),
    }
}

fn differing(set: &RaySet, ours: &dyn Tracer, peer: &dyn Tracer, referee: &Referee<'_>) -> Differing {
    let mut sum = Differing::default();
    for ray in &set.rays {
        let answer = |who: &dyn Tracer| if set.any { who.any(ray).then_some(0.0) } else { who.closest(ray) };
        let (a, b) = (answer(ours), answer(peer));
        if same(a, b) {
            continue;
        }
        let exact = referee.closest(ray).map(|t| if set.any { 0.0 } else { t as f32 });
        sum.umber_wrong += usize::from(!same(a, exact));
        sum.peer_wrong += usize::from(!same(b, exact));
        match (a, b) {
            (Some(_), None) => sum.only_umber += 1,
            (None, _) => sum.only_peer += 1,
            _ => sum.elsewhere += 1,
        }
    }
    sum
}

/// Whether two answers tell the same.
fn same(a: Option<f32>, b: Option<f32>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= SAME_T * a.abs().max(b.abs()),
        (a, b) => a.is_none() && b.is_none(),
    }
}

/// Processor time of this thread: what other programs take does not count.
fn timed<T>(work: impl FnOnce() -> T) -> (Duration, T) {
    let start = ThreadTime::now();
    let result = std::hint::black_box(work());
    (start.elapsed(), result)
}

/// The middle one; the mean of both where there are two; zero of none.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[middle],
        _ => (values[middle - 1] + values[middle]) / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::median;

    #[test]
    fn median_is_the_middle() {
        assert_eq!([median(vec![]), median(vec![3.0]), median(vec![4.0, 1.0])], [0.0, 3.0, 2.5]);
        assert_eq!(median(vec![9.0, 1.0, 2.0]), 2.0);
    }
}
