//! The render thread: takes up jobs, compiles what is dirty, and goes on with the picture.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuilder};
use umber_settings::Settings;

use super::control::{Job, Shared};
use super::picture::Picture;
use crate::compile::{Compiler, NoScene};
use crate::film::{Film, FilmDesc};
use crate::scene::RenderScene;
use crate::{Message, Stats};

/// Takes up jobs until the session ends.
pub(super) fn run(shared: &Shared) {
    let mut worker = Worker::default();
    while let Some(job) = shared.next_job() {
        // a panic is a bug of ours: the host is told, keeps running, and does not wait for a picture
        let finished = catch_unwind(AssertUnwindSafe(|| worker.work(shared, &job))).unwrap_or_else(|panic| {
            worker = Worker::default();
            shared.say(Message::error(None, format!("rendering ended by an internal error: {}", text_of(&*panic))));
            true
        });
        shared.end_job(job.epoch, finished);
    }
}

fn text_of(panic: &(dyn std::any::Any + Send)) -> &str {
    let as_str = panic.downcast_ref::<&str>().copied();
    as_str.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("unknown")
}

/// What stays from job to job.
#[derive(Default)]
struct Worker {
    compiler: Compiler,
    /// Threads as the settings ask for them, and the pool that has them.
    pool: Option<(u32, Arc<ThreadPool>)>,
    picture: Option<Picture>,
}

impl Worker {
    /// True where the picture is finished, false where the job was cancelled.
    fn work(&mut self, shared: &Shared, job: &Job) -> bool {
        let Some(desc) = job.desc.as_ref().filter(|desc| desc.width > 0 && desc.height > 0) else { return true };
        if self.picture.as_ref().is_none_or(|picture| picture.epoch() != job.epoch) {
            match self.begin(shared, desc, job.epoch) {
                Ok(picture) => self.picture = Some(picture),
                Err(NoScene::Cancelled) => return false,
                Err(NoScene::Unrenderable(message)) => {
                    self.picture = None;
                    shared.show(Arc::new(Film::new(desc.clone())));
                    shared.say(message);
                    return true;
                }
            }
        }
        match (&mut self.picture, &self.pool) {
            (Some(picture), Some((_, pool))) => picture.render(shared, pool),
            _ => true,
        }
    }

    /// Compiles the scene and shows an empty film.
    fn begin(&mut self, shared: &Shared, desc: &FilmDesc, epoch: u64) -> Result<Picture, NoScene> {
        // the old picture goes first: its film and scene need not stand beside the new ones
        self.picture = None;
        let started = Instant::now();
        // the bulk of a store is shared: the host goes on editing its own while this one is compiled
        let (store, dirty) = {
            let mut store = shared.store();
            (store.clone(), store.take_dirty())
        };
        let pool = self.pool(store.settings())?;
        let compiler = &mut self.compiler;
        let compile = || compiler.compile(&store, dirty, desc, shared.cancelled(), &mut |message| shared.say(message));
        let scene = pool.install(compile)?;
        let film = shared.renew_film(desc.clone());
        self.describe(shared, &scene, &film, started.elapsed().as_secs_f64());
        Ok(Picture::new(epoch, scene, film))
    }

    /// The threads that the settings ask for.
    fn pool(&mut self, settings: &Settings) -> Result<Arc<ThreadPool>, NoScene> {
        if let Some((threads, pool)) = &self.pool
            && *threads == settings.threads
        {
            return Ok(Arc::clone(pool));
        }
        let builder = ThreadPoolBuilder::new().num_threads(settings.threads as usize);
        let pool = builder.thread_name(|i| format!("umber-{i}")).build().map_err(|error| {
            NoScene::Unrenderable(Message::error(None, format!("no render threads could be started: {error}")))
        })?;
        Ok(Arc::clone(&self.pool.insert((settings.threads, Arc::new(pool))).1))
    }

    fn describe(&self, shared: &Shared, scene: &RenderScene, film: &Film, compile_seconds: f64) {
        let built = self.compiler.built();
        let shapes = || scene.meshes.iter().map(|mesh| &mesh.shape);
        let stats = Stats {
            target_samples_per_pixel: scene.settings.converged_samples_per_pixel,
            compile_seconds,
            threads: self.pool.as_ref().map_or(0, |(_, pool)| pool.current_num_threads() as u32),
            meshes: scene.meshes.len() as u64,
            triangles: shapes().map(|shape| shape.mesh.len() as u64).sum(),
            instances: scene.instance_count,
            lights: scene.lights.lights().len() as u64,
            // the black one is the compiler's own
            materials: scene.materials.len().saturating_sub(1) as u64,
            geometry_bytes: (shapes().map(|shape| shape.memory_bytes()).sum::<usize>()
                + scene.meshes.iter().map(|mesh| mesh.attributes.raster_bytes()).sum::<usize>()
                + scene.top.memory_bytes()) as u64,
            film_bytes: film.memory_bytes(if scene.settings.converged_variance >= 0.0 { 2 } else { 1 }) as u64,
            relative_variance: -1.0,
            path_group: 1,
            samples_a_ray: 1,
            built_meshes: built.meshes,
            built_top_level: built.top_level,
            ..Stats::default()
        };
        shared.update_stats(|s| *s = stats);
    }
}
