//! What the session's callers and its render thread share.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use umber_scene::SceneStore;

use crate::{Film, FilmDesc, Message, Stats};

/// What the render thread is to do. Every wait is on [`Shared::changed`].
#[derive(Debug, Default)]
pub(super) struct Control {
    /// Render, as soon as not paused.
    running: bool,
    paused: bool,
    shut_down: bool,
    /// A job is under way.
    busy: bool,
    /// No thread takes up jobs.
    no_thread: bool,
    /// Counts restarts.
    epoch: u64,
    /// Last restart whose picture is finished.
    finished: Option<u64>,
    /// Wanted film; the render thread makes it.
    desc: Option<FilmDesc>,
}

/// What the render thread takes up.
#[derive(Debug)]
pub(super) struct Job {
    /// A new epoch is a new picture.
    pub epoch: u64,
    /// The film to render; `None` before the host named one.
    pub desc: Option<FilmDesc>,
}

#[derive(Debug, Default)]
pub(super) struct Shared {
    store: Mutex<SceneStore>,
    control: Mutex<Control>,
    changed: Condvar,
    cancel: AtomicBool,
    film: Mutex<Arc<Film>>,
    messages: Mutex<Vec<Message>>,
    stats: Mutex<Stats>,
}

impl Default for Film {
    fn default() -> Self {
        Self::new(FilmDesc::new(0, 0, &[]))
    }
}

/// A panic is caught and reported where it happens; what it left behind is still usable.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    pub fn store(&self) -> MutexGuard<'_, SceneStore> {
        lock(&self.store)
    }
    pub fn film(&self) -> Arc<Film> {
        Arc::clone(&lock(&self.film))
    }
    pub fn stats(&self) -> Stats {
        lock(&self.stats).clone()
    }
    pub fn update_stats(&self, update: impl FnOnce(&mut Stats)) {
        update(&mut lock(&self.stats));
    }
    pub fn take_messages(&self) -> Vec<Message> {
        std::mem::take(&mut lock(&self.messages))
    }
    pub fn say(&self, message: Message) {
        lock(&self.messages).push(message);
    }

    /// Stops the rendering of a stale scene without waiting.
    pub fn interrupt(&self) {
        let mut control = lock(&self.control);
        control.running = false;
        self.cancel.store(true, Ordering::Relaxed);
    }

    pub fn set_film(&self, desc: FilmDesc) -> bool {
        let mut control = lock(&self.control);
        if control.desc.as_ref() == Some(&desc) {
            return false;
        }
        control.desc = Some(desc);
        control.epoch += 1;
        control.running = false;
        self.cancel.store(true, Ordering::Relaxed);
        true
    }

    pub fn start(&self) {
        let stale = self.store().dirty().any();
        let mut control = lock(&self.control);
        if stale {
            control.epoch += 1;
            self.cancel.store(true, Ordering::Relaxed);
        }
        control.running = true;
        self.changed.notify_all();
    }

    pub fn stop(&self) {
        let mut control = lock(&self.control);
        control.running = false;
        self.wait_idle(control);
    }

    pub fn set_paused(&self, paused: bool) {
        let mut control = lock(&self.control);
        control.paused = paused;
        self.changed.notify_all();
        if paused {
            self.wait_idle(control);
        }
    }

    pub fn is_paused(&self) -> bool {
        lock(&self.control).paused
    }

    pub fn restart(&self) {
        let mut control = lock(&self.control);
        control.epoch += 1;
        control.running = false;
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// There is no render thread: nothing is ever to be waited for.
    pub fn give_up(&self) {
        lock(&self.control).no_thread = true;
    }

    pub fn shut_down(&self) {
        let mut control = lock(&self.control);
        control.shut_down = true;
        self.cancel.store(true, Ordering::Relaxed);
        self.changed.notify_all();
    }

    fn wait_idle(&self, mut control: MutexGuard<'_, Control>) {
        self.cancel.store(true, Ordering::Relaxed);
        while control.busy {
            control = self.changed.wait(control).unwrap_or_else(PoisonError::into_inner);
        }
    }

    pub fn is_converged(&self) -> bool {
        let stale = self.store().dirty().any();
        let control = lock(&self.control);
        control.no_thread || !stale && control.finished == Some(control.epoch)
    }

    pub fn wait(&self, timeout: Duration) -> bool {
        let deadline = Instant::now() + timeout;
        if self.store().dirty().any() && !lock(&self.control).running {
            // nobody is going to render what was said: there is nothing to wait for
            return false;
        }
        let mut control = lock(&self.control);
        while control.finished != Some(control.epoch) && !control.no_thread {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return false;
            }
            control = self.changed.wait_timeout(control, left).unwrap_or_else(PoisonError::into_inner).0;
        }
        true
    }

    // ---- the render thread's side ----

    /// Whether the job under way is to end.
    pub fn cancelled(&self) -> &AtomicBool {
        &self.cancel
    }

    /// Waits for something to do; `None` at the end of the session.
    pub fn next_job(&self) -> Option<Job> {
        let mut control = lock(&self.control);
        loop {
            if control.shut_down {
                return None;
            }
            if control.running && !control.paused && control.finished != Some(control.epoch) {
                control.busy = true;
                self.cancel.store(false, Ordering::Relaxed);
                return Some(Job { epoch: control.epoch, desc: control.desc.clone() });
            }
            control = self.changed.wait(control).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Ends a job: its picture is finished, or it was cancelled.
    pub fn end_job(&self, epoch: u64, finished: bool) {
        let mut control = lock(&self.control);
        control.busy = false;
        if finished {
            control.finished = Some(epoch);
        }
        self.changed.notify_all();
    }

    /// Shows an empty film, in the memory of the one before if nobody reads that; who asks meanwhile waits.
    pub fn renew_film(&self, desc: FilmDesc) -> Arc<Film> {
        let mut shown = lock(&self.film);
        let old = Arc::try_unwrap(std::mem::take(&mut *shown)).ok();
        *shown = Arc::new(Film::renewed(desc, old));
        Arc::clone(&shown)
    }

    /// Shows a new film in place of the old one.
    pub fn show(&self, film: Arc<Film>) {
        *lock(&self.film) = film;
    }
}
