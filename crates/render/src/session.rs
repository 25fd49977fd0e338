//! The façade that both front ends use, and nothing else: edit, start, stop, read.

mod control;
mod picture;
mod worker;

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use umber_scene::SceneEdit;
use umber_settings::{SettingError, Settings};

use crate::{Aov, BufferFormat, FilmDesc, Message, Stats};
use control::Shared;

/// A scene, its film and the thread that renders it.
///
/// All methods take `&self` and may be called from any thread. An edit that changes something
/// stops the rendering of what is stale; only [`start`](Self::start) begins again.
#[derive(Debug)]
pub struct Session {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Default for Session {
    fn default() -> Self {
        Self::new()
    }
}

impl Session {
    /// An empty scene with an idle render thread.
    pub fn new() -> Self {
        let shared = Arc::new(Shared::default());
        let for_thread = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name("umber-render".into()).spawn(move || worker::run(&for_thread));
        if let Err(error) = &thread {
            shared.give_up();
            shared.say(Message::error(None, format!("no render thread could be started: {error}")));
        }
        Self { shared, thread: thread.ok() }
    }

    /// Carries out an edit. True where it changed anything that the picture depends on.
    ///
    /// # Errors
    /// A setting that does not exist or cannot have that value; nothing changes then.
    pub fn edit(&self, edit: SceneEdit) -> Result<bool, SettingError> {
        let changed = self.shared.store().apply(edit)?;
        if changed {
            self.shared.interrupt();
        }
        Ok(changed)
    }

    /// Sets size and content of the picture. True where it is another one than before: then the old
    /// samples are forgotten.
    pub fn set_film(&self, desc: FilmDesc) -> bool {
        self.shared.set_film(desc.sanitized())
    }

    /// Renders on: from the first sample where anything changed, else from where it stands.
    /// Returns at once.
    pub fn start(&self) {
        self.shared.start();
    }

    /// Stops and waits until no thread renders. The film keeps its samples.
    pub fn stop(&self) {
        self.shared.stop();
    }

    /// Holds rendering (true) or lets it go on. Waits as [`stop`](Self::stop) does.
    pub fn set_paused(&self, paused: bool) {
        self.shared.set_paused(paused);
    }

    /// Whether rendering is held.
    pub fn is_paused(&self) -> bool {
        self.shared.is_paused()
    }

    /// Stops without waiting and forgets all samples; [`start`](Self::start) then begins anew.
    pub fn restart(&self) {
        self.shared.restart();
    }

    /// Whether the picture of everything said so far is finished.
    pub fn is_converged(&self) -> bool {
        self.shared.is_converged()
    }

    /// Waits until the picture is finished or the time is over. True where it is finished.
    pub fn wait(&self, timeout: Duration) -> bool {
        self.shared.wait(timeout)
    }

    /// Writes an AOV as it stands into `out`: row after row from the lowest, `width · height`
    /// pixels of `format`. May be called while rendering goes on.
    ///
    /// False, and nothing written, where the film does not keep the AOV or `out` has another size.
    pub fn resolve(&self, aov: Aov, format: BufferFormat, out: &mut [u8]) -> bool {
        self.shared.film().resolve(aov, format, out)
    }

    /// How far it is and what it costs.
    pub fn stats(&self) -> Stats {
        self.shared.stats()
    }

    /// Warnings and errors since the last call.
    pub fn take_messages(&self) -> Vec<Message> {
        self.shared.take_messages()
    }

    /// The settings as they stand.
    pub fn settings(&self) -> Settings {
        self.shared.store().settings().clone()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.shared.shut_down();
        if let Some(thread) = self.thread.take() {
            // the worker catches panics itself; there is nobody left to tell
            let _ = thread.join();
        }
    }
}
