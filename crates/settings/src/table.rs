//! The rows, and the typed struct made from them.

use crate::{Integrator, RasterColor, Setting, SettingError, SettingType, Value, parse};

macro_rules! settings {
    ($($field:ident: $type:ty = $default:expr, $key:literal, $range:expr, $label:literal, $doc:literal;)*) => {
        /// Every setting with its type; one field a row of [`TABLE`].
        #[derive(Clone, Debug, PartialEq)]
        pub struct Settings {
            $(#[doc = $doc] pub $field: $type,)*
        }

        impl Default for Settings {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        /// All settings, in the order in which a user should meet them.
        pub static TABLE: std::sync::LazyLock<Vec<Setting>> = std::sync::LazyLock::new(|| {
            vec![$(Setting {
                key: $key,
                default: <$type as SettingType>::wrap($default),
                range: $range,
                choices: <$type as SettingType>::CHOICES,
                label: $label,
                doc: $doc,
            },)*]
        });

        impl Settings {
            /// Value of the setting named `key`.
            pub fn get(&self, key: &str) -> Option<Value> {
                match key {
                    $($key => Some(SettingType::wrap(self.$field)),)*
                    _ => None,
                }
            }

            fn assign(&mut self, key: &str, value: &Value) {
                match key {
                    $($key => if let Some(v) = SettingType::unwrap(value) { self.$field = v },)*
                    _ => {}
                }
            }
        }
    };
}

settings! {
    converged_samples_per_pixel: u32 = 64, "convergedSamplesPerPixel", Some((1.0, 16_777_216.0)),
        "Samples Per Pixel", "Samples a pixel at which the picture is finished.";
    converged_variance: f32 = -1.0, "convergedVariance", Some((-1.0, 1.0)),
        "Variance Threshold", "Mean relative variance of the pixels at which the picture is finished earlier, with more samples where the error is, as cheaply as that can be had, without bias; negative: every pixel gets the same.";
    time_limit: f32 = 0.0, "umber:timeLimit", Some((0.0, 31_536_000.0)),
        "Time Limit", "Seconds of rendering after which the picture is finished as it stands; 0: no limit.";
    enable_interactive: bool = true, "enableInteractive", None,
        "Interactive", "Show every pass as soon as it is done; off: fewer, larger passes for final frames.";
    dome_light_camera_visibility: bool = true, "domeLightCameraVisibility", None,
        "Dome Light Camera Visibility", "Whether the camera sees dome lights, and the disks of distant ones, in the background.";
    integrator: Integrator = Integrator::Path, "umber:integrator", None,
        "Integrator", "How the picture is made: path follows light over all bounces, direct over one; raster projects triangles, without light, and is finished after one sample; mirror gives the cosine between the view ray, reflected about the face's normal, and one direction to a light.";
    raster_color: RasterColor = RasterColor::Shaded, "umber:rasterColor", None,
        "Raster Color", "What the integrator raster shows: shaded is the surface's colour lit from the eye, random one colour a polygon, primId one a prim.";
    mirror_roughness: f32 = 0.0, "umber:mirrorRoughness", Some((0.0, 1e6)),
        "Mirror Roughness", "Scale of the normally distributed vector that the integrator mirror adds to each reflected direction.";
    max_bounces: u32 = 8, "umber:maxBounces", Some((0.0, 1024.0)),
        "Max Bounces", "Scattering events a path may have; 0 shows emission alone, 1 direct light.";
    roulette_bounces: u32 = 1, "umber:rouletteBounces", Some((0.0, 1024.0)),
        "Russian Roulette From", "Scattering events after which dim paths may be ended at random, without bias.";
    path_reuse: bool = true, "umber:pathReuse", None,
        "Path Reuse", "Whether neighbouring pixels share what their paths find, without bias, where a trial at the start shows that it pays.";
    path_splitting: bool = true, "umber:pathSplitting", None,
        "Path Splitting", "Whether several samples of a pixel begin with the same ray from the camera, without bias, where a trial at the start shows that it pays.";
    edge_rays: bool = true, "umber:edgeRays", None,
        "Edge Rays", "Whether samples take more rays from the camera, without bias, in pixels that the rim of something bright runs through.";
    light_tracing: bool = true, "umber:lightTracing", None,
        "Light Tracing", "Whether caustics are made by paths from smooth surfaces in the light, too, and paths from the camera are led to them, without bias, where a search at the start finds any.";
    firefly_clamp: f32 = 0.0, "umber:fireflyClamp", Some((0.0, 1e30)),
        "Firefly Clamp (Biased)", "Largest radiance that one sample of a pixel may have: hides bright specks, but is biased, as their light is lost; 0: off.";
    seed: u32 = 0, "umber:seed", Some((0.0, 4_294_967_295.0)),
        "Seed", "Start of the sample sequence: same seed, same picture.";
    threads: u32 = 0, "umber:threads", Some((0.0, 4096.0)),
        "Threads", "Render threads; 0 takes every core.";
}

impl Settings {
    /// Sets `key` to `value`, converting between kinds where nothing is lost (Hydra hosts send an
    /// int for a float, or a bool for an int). True where the value is now another one.
    ///
    /// # Errors
    /// Unknown key (the nearest known one is named), wrong kind, out of range; nothing changes then.
    pub fn set(&mut self, key: &str, value: &Value) -> Result<bool, SettingError> {
        let row = parse::row(key)?;
        let value = parse::convert(row, value)?;
        let changed = self.get(key).as_ref() != Some(&value);
        self.assign(key, &value);
        Ok(changed && self.get(key).is_some())
    }

    /// Sets `key` from text, as on a command line. True where the value is now another one.
    ///
    /// # Errors
    /// As [`Settings::set`], and where the text is no value of the setting's type.
    pub fn set_from_text(&mut self, key: &str, text: &str) -> Result<bool, SettingError> {
        let value = parse::parse(parse::row(key)?, text)?;
        self.set(key, &value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_and_struct_agree() {
        let defaults = Settings::default();
        for row in TABLE.iter() {
            assert_eq!(defaults.get(row.key).as_ref(), Some(&row.default), "{}", row.key);
            assert!(!row.doc.is_empty() && !row.label.is_empty(), "{}", row.key);
            assert_eq!(row.range.is_none(), matches!(row.default, Value::Bool(_) | Value::Text(_)), "{}", row.key);
            match &row.default {
                Value::Text(word) => assert!(row.choices.contains(&word.as_str()), "{}", row.key),
                _ => assert!(row.choices.is_empty(), "{}", row.key),
            }
            assert_eq!(TABLE.iter().filter(|r| r.key == row.key).count(), 1, "{}", row.key);
        }
    }

    #[test]
    fn set_reports_change_by_value() {
        let mut s = Settings::default();
        assert_eq!(s.set("domeLightCameraVisibility", &Value::Bool(true)), Ok(false));
        assert_eq!(s.set("domeLightCameraVisibility", &Value::Int(0)), Ok(true));
        assert!(!s.dome_light_camera_visibility);
        assert_eq!(s.set("convergedVariance", &Value::Int(0)), Ok(true));
        assert_eq!(s.set_from_text("umber:maxBounces", "8"), Ok(false));
    }

    #[test]
    fn words_are_taken_by_name() {
        let mut s = Settings::default();
        for row in TABLE.iter() {
            for word in row.choices {
                s.set_from_text(row.key, word).unwrap();
                assert_eq!(s.get(row.key), Some(Value::Text((*word).to_owned())));
            }
        }
        assert_eq!(s.set("umber:integrator", &Value::Text("direct".into())), Ok(true));
        assert_eq!(s.integrator, Integrator::Direct);
        for value in [Value::Text("Path".into()), Value::Int(0), Value::Text(String::new())] {
            let said = s.set("umber:integrator", &value).unwrap_err().to_string();
            assert_eq!(
                said,
                format!("setting 'umber:integrator' takes one of path, direct, raster, mirror, not '{value}'")
            );
        }
        assert!(s.set("umber:maxBounces", &Value::Text("8".into())).is_err());
        assert_eq!(s.integrator, Integrator::Direct);
    }

    #[test]
    fn errors_name_key_and_value() {
        let mut s = Settings::default();
        let said = |e: Result<bool, SettingError>| e.unwrap_err().to_string();
        assert!(said(s.set_from_text("umber:maxBounce", "8")).contains("umber:maxBounces"));
        assert!(said(s.set_from_text("umber:maxBounces", "-1")).contains("-1"));
        assert!(said(s.set_from_text("umber:maxBounces", "many")).contains("many"));
        assert!(said(s.set("umber:maxBounces", &Value::Float(0.5))).contains("0.5"));
        assert!(said(s.set("convergedVariance", &Value::Float(f64::NAN))).contains("NaN"));
        assert_eq!(s, Settings::default());
    }
}
