//! Render buffers: memory that the film is written into when a host looks.
//!
//! The render thread never touches this memory, so that allocating and freeing it need not wait.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use umber_render::{Aov, BufferFormat, Film, FilmDesc, Message};

use crate::bridge::ffi;
use crate::delegate::Delegate;
use crate::guard::{Outcome, guard};
use crate::host::Host;

/// One `HdRenderBuffer`.
pub struct RenderBuffer {
    host: Arc<Host>,
    path: String,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    pixels: Vec<u8>,
    format: Option<BufferFormat>,
    shows: Shows,
    clear_value: Vec<f32>,
    mappers: usize,
}

#[derive(Clone, Copy, Default, PartialEq)]
enum Shows {
    /// Not bound yet.
    #[default]
    Nothing,
    /// An AOV of the film.
    Film(Aov),
    /// An AOV that Umber does not have.
    Unknown,
}

pub fn new_render_buffer(delegate: &Delegate, path: &str) -> Outcome<Box<RenderBuffer>> {
    guard(|| Box::new(RenderBuffer { host: delegate.host(), path: path.to_owned(), state: Mutex::default() }))
}

impl RenderBuffer {
    pub fn allocate(&self, width: usize, height: usize, format: ffi::Format) -> Outcome<bool> {
        guard(|| {
            let mut state = self.state();
            state.format = buffer_format(format);
            let bytes = state.format.map_or(0, |f| width * height * f.bytes());
            state.pixels = vec![0; bytes];
            state.clear();
            state.format.is_some()
        })
    }

    pub fn deallocate(&self) -> Outcome {
        guard(|| *self.state() = State::default())
    }

    pub fn bind(&self, aov: &str, clear_value: &[f32]) -> Outcome<bool> {
        guard(|| {
            let mut state = self.state();
            let shows = Aov::from_name(aov).map_or(Shows::Unknown, Shows::Film);
            if shows != state.shows || clear_value != state.clear_value {
                state.shows = shows;
                state.clear_value = clear_value.to_vec();
                if state.mappers == 0 {
                    state.clear();
                }
            }
            if shows == Shows::Unknown {
                self.host.say(Message::warning(Some(&self.path), format!("Umber has no AOV '{aov}'")));
            }
            shows != Shows::Unknown
        })
    }

    pub fn map(&self) -> Outcome<*mut u8> {
        guard(|| {
            let mut state = self.state();
            state.mappers += 1;
            if state.mappers == 1 {
                self.fill(&mut state);
            }
            if state.pixels.is_empty() { std::ptr::null_mut() } else { state.pixels.as_mut_ptr() }
        })
    }

    pub fn unmap(&self) -> Outcome {
        guard(|| {
            let mut state = self.state();
            state.mappers = state.mappers.saturating_sub(1);
        })
    }

    pub fn is_mapped(&self) -> Outcome<bool> {
        guard(|| self.state().mappers > 0)
    }

    pub fn is_converged(&self) -> Outcome<bool> {
        guard(|| match self.state().shows {
            Shows::Nothing => false,
            Shows::Film(_) => self.host.session().is_converged(),
            Shows::Unknown => true,
        })
    }

    /// Writes the film as it stands. Before the first sample of a new size or AOV the film is still
    /// another one: the buffer then keeps its clear value.
    fn fill(&self, state: &mut State) {
        if let (Shows::Film(aov), Some(format)) = (state.shows, state.format) {
            self.host.session().resolve(aov, format, &mut state.pixels);
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Gives every pixel the clear value; components it lacks are zero.
    fn clear(&mut self) {
        let Some(format) = self.format else { return };
        let mut value = [0.0; 4];
        for (to, from) in value.iter_mut().zip(&self.clear_value) {
            *to = *from;
        }
        // a film without samples shows its clear colour, in any format
        let film = Film::new(FilmDesc { clear_color: value, ..FilmDesc::new(1, 1, &[Aov::Color]) });
        let mut pixel = vec![0; format.bytes()];
        film.resolve(Aov::Color, format, &mut pixel);
        for out in self.pixels.chunks_exact_mut(pixel.len()) {
            out.copy_from_slice(&pixel);
        }
    }
}

macro_rules! formats {
    ($($name:ident),*) => {
        fn buffer_format(format: ffi::Format) -> Option<BufferFormat> {
            match format {
                $(ffi::Format::$name => Some(BufferFormat::$name),)*
                _ => None,
            }
        }

        /// Hydra's word for a format.
        pub fn hydra_format(format: BufferFormat) -> ffi::Format {
            match format {
                $(BufferFormat::$name => ffi::Format::$name,)*
            }
        }
    };
}
formats!(
    UNorm8,
    UNorm8Vec2,
    UNorm8Vec3,
    UNorm8Vec4,
    Float16,
    Float16Vec2,
    Float16Vec3,
    Float16Vec4,
    Float32,
    Float32Vec2,
    Float32Vec3,
    Float32Vec4,
    Int32
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delegate::new_delegate;

    #[test]
    fn an_unknown_aov_shows_its_clear_value() {
        let delegate = new_delegate().unwrap();
        let buffer = new_render_buffer(&delegate, "/b").unwrap();
        assert!(buffer.allocate(3, 2, ffi::Format::Float32Vec2).unwrap());
        assert!(!buffer.bind("glow", &[0.5, 2.0]).unwrap());
        assert!(buffer.is_converged().unwrap());
        assert!(!buffer.map().unwrap().is_null() && buffer.is_mapped().unwrap());
        assert_eq!(bytemuck::pod_collect_to_vec::<u8, f32>(&buffer.state().pixels)[..4], [0.5, 2.0, 0.5, 2.0]);
        buffer.unmap().unwrap();
        assert!(!buffer.is_mapped().unwrap());
        assert!(delegate.host().take_messages()[0].text.contains("glow"));
        assert!(!buffer.allocate(3, 2, ffi::Format::Other).unwrap());
        assert!(buffer.map().unwrap().is_null());
    }
}
