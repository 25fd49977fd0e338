//! Settings that are one of a few words.

use crate::{SettingType, Value};

macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $word:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $($(#[$variant_doc])* $variant,)*
        }

        impl SettingType for $name {
            const CHOICES: &'static [&'static str] = &[$($word),*];

            fn wrap(self) -> Value {
                Value::Text(match self { $(Self::$variant => $word,)* }.to_owned())
            }
            fn unwrap(value: &Value) -> Option<Self> {
                match value {
                    Value::Text(word) => match word.as_str() {
                        $($word => Some(Self::$variant),)*
                        _ => None,
                    },
                    _ => None,
                }
            }
        }
    };
}

choice! {
    /// How a picture is made of a scene.
    Integrator {
        /// Light on all its ways.
        Path = "path",
        /// Light that was scattered once.
        Direct = "direct",
        /// Projected triangles, nearest first; no light travels.
        Raster = "raster",
        /// One reflection about each face's normal, towards one light.
        Mirror = "mirror",
    }
}

choice! {
    /// What the rasteriser shows of a surface.
    RasterColor {
        /// Its colour, lit from the eye.
        Shaded = "shaded",
        /// A colour for each polygon.
        Random = "random",
        /// A colour for each prim.
        PrimId = "primId",
    }
}
