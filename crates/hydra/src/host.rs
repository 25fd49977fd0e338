//! What all prims of one delegate share: the session, and what was said to the host.

use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use umber_render::{FilmDesc, Message, Session};
use umber_scene::SceneEdit;
use umber_settings::SettingError;

/// One delegate's session, with what Hydra needs beside it.
#[derive(Debug, Default)]
pub struct Host {
    session: Session,
    /// The host stopped rendering; the next change or a restart lets it go on.
    stopped: AtomicBool,
    messages: Mutex<Messages>,
}

#[derive(Debug, Default)]
struct Messages {
    /// Found out on this side of the session, not yet taken.
    waiting: Vec<Message>,
    /// Texts that the host has seen.
    said: HashSet<String>,
}

impl Host {
    /// The session.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Carries out an edit.
    pub fn edit(&self, edit: SceneEdit) -> Result<(), SettingError> {
        self.note_change(self.session.edit(edit)?);
        Ok(())
    }

    /// Renders this film, unless the host stopped rendering and nothing changed since.
    pub fn render(&self, film: FilmDesc) {
        self.note_change(self.session.set_film(film));
        if !self.is_stopped() {
            self.session.start();
        }
    }

    /// Whether the host stopped rendering.
    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Acquire)
    }

    /// Stops rendering until something changes.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Release);
        self.session.stop();
    }

    /// Renders the picture from its first sample.
    pub fn restart(&self) {
        self.stopped.store(false, Ordering::Release);
        self.session.restart();
        self.session.start();
    }

    /// Keeps a message until the host asks.
    pub fn say(&self, message: Message) {
        self.messages().waiting.push(message);
    }

    /// Messages that the host has not seen, each once.
    pub fn take_messages(&self) -> Vec<Message> {
        let from_session = self.session.take_messages();
        let mut messages = self.messages();
        let waiting = std::mem::take(&mut messages.waiting);
        waiting.into_iter().chain(from_session).filter(|m| messages.said.insert(m.to_string())).collect()
    }

    fn note_change(&self, changed: bool) {
        if changed {
            self.stopped.store(false, Ordering::Release);
        }
    }

    fn messages(&self) -> MutexGuard<'_, Messages> {
        self.messages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umber_scene::CameraId;

    #[test]
    fn a_message_is_said_once() {
        let host = Host::default();
        let lost = || Message::warning(Some("/a"), "lost");
        host.say(lost());
        host.say(lost());
        assert_eq!(host.take_messages(), [lost()]);
        host.say(lost());
        assert!(host.take_messages().is_empty());
    }

    #[test]
    fn a_stop_holds_until_something_changes() {
        let host = Host::default();
        let look = |path| host.edit(SceneEdit::RenderCamera(CameraId::new(path))).unwrap();
        look("/a");
        host.stop();
        look("/a");
        assert!(host.is_stopped());
        look("/b");
        assert!(!host.is_stopped());
        host.stop();
        host.restart();
        assert!(!host.is_stopped());
    }
}
