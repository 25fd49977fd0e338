//! From a render pass' state to a film and the purposes shown.

use umber_render::{Aov, FilmDesc};
use umber_scene::Purpose;

use crate::bridge::ffi;

/// The film of a frame. Hydra's windows count rows downwards from the buffer's top, the film's
/// upwards from its lowest row.
pub fn film(frame: &ffi::Frame) -> FilmDesc {
    let mut aovs: Vec<Aov> = frame.aovs.iter().filter_map(|name| Aov::from_name(name)).collect();
    aovs.sort();
    aovs.dedup();
    let height = frame.height as f64;
    let display_window = match *frame.display_window.as_slice() {
        [min_x, min_y, max_x, max_y] => Some([min_x, height - max_y, max_x, height - min_y]),
        _ => None,
    };
    // a view that fills the film has one description, whichever way the host put it
    let whole = [0.0, 0.0, frame.width as f64, height];
    FilmDesc {
        display_window: display_window.filter(|window| *window != whole),
        pixel_aspect: frame.pixel_aspect,
        clear_color: frame.clear_color,
        ..FilmDesc::new(frame.width, frame.height, &aovs)
    }
}

/// The purpose that a render tag stands for; `None` where prims with it are never shown.
pub fn purpose(tag: &str) -> Option<Purpose> {
    match tag {
        "" | "geometry" => Some(Purpose::Default),
        "render" => Some(Purpose::Render),
        "proxy" => Some(Purpose::Proxy),
        "guide" => Some(Purpose::Guide),
        _ => None,
    }
}

/// Purposes shown by a pass with these render tags: all where there are no tags.
pub fn purposes(tags: &[String]) -> Vec<Purpose> {
    if tags.is_empty() {
        return vec![Purpose::Render, Purpose::Proxy, Purpose::Guide];
    }
    tags.iter().filter_map(|tag| purpose(tag)).filter(|p| *p != Purpose::Default).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(display_window: &[f64]) -> ffi::Frame {
        ffi::Frame {
            width: 40,
            height: 30,
            display_window: display_window.to_vec(),
            pixel_aspect: 1.0,
            aovs: ["depth", "color", "nothing", "color"].map(str::to_owned).to_vec(),
            clear_color: [0.0; 4],
            render_tags: Vec::new(),
        }
    }

    #[test]
    fn windows_turn_over() {
        assert_eq!(film(&frame(&[])).display_window, None);
        assert_eq!(film(&frame(&[0.0, 0.0, 40.0, 30.0])).display_window, None);
        let film = film(&frame(&[0.0, 5.0, 40.0, 20.0]));
        assert_eq!(film.display_window, Some([0.0, 10.0, 40.0, 25.0]));
        assert_eq!(film.aovs, [Aov::Color, Aov::Depth]);
    }

    #[test]
    fn tags_name_purposes() {
        let of = |tags: &[&str]| purposes(&tags.iter().map(|t| (*t).to_owned()).collect::<Vec<_>>());
        assert_eq!(of(&[]).len(), 3);
        assert_eq!(of(&["geometry", "proxy", "hidden"]), [Purpose::Proxy]);
    }
}
