//! The one table of settings: key, type, default, range, UI name, doc.
//!
//! Hydra's descriptors, the command line's `--set` and the documentation are made from [`TABLE`];
//! the renderer reads the typed [`Settings`]. A new setting is one row of `settings!` in `table.rs`.

mod choice;
mod parse;
mod table;

pub use choice::{Integrator, RasterColor};
pub use parse::{SettingError, nearest_key};
pub use table::{Settings, TABLE};

/// A setting's value, of the kinds that Hydra's setting descriptors know.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A switch.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A number.
    Float(f64),
    /// A word.
    Text(String),
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Bool(v) => v.fmt(f),
            Self::Int(v) => v.fmt(f),
            Self::Float(v) => v.fmt(f),
            Self::Text(v) => v.fmt(f),
        }
    }
}

/// One row of the table.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Hydra token where one exists, `umber:…` otherwise.
    pub key: &'static str,
    /// Value where nobody says anything; its variant is the setting's type.
    pub default: Value,
    /// Smallest and largest allowed value, where the type is a number.
    pub range: Option<(f64, f64)>,
    /// The allowed words, where the type is a word; else empty.
    pub choices: &'static [&'static str],
    /// Name in a user interface.
    pub label: &'static str,
    /// One sentence for help texts.
    pub doc: &'static str,
}

/// Types that a setting can have.
pub trait SettingType: Copy {
    /// The allowed words, where it is one.
    const CHOICES: &'static [&'static str] = &[];
    /// Wraps a value.
    fn wrap(self) -> Value;
    /// Unwraps a value of the matching kind.
    fn unwrap(value: &Value) -> Option<Self>;
}

macro_rules! setting_type {
    ($type:ty, $variant:ident, $wide:ty) => {
        impl SettingType for $type {
            fn wrap(self) -> Value {
                Value::$variant(self as $wide)
            }
            fn unwrap(value: &Value) -> Option<Self> {
                match value {
                    Value::$variant(v) => Some(*v as $type),
                    _ => None,
                }
            }
        }
    };
}
setting_type!(bool, Bool, bool);
setting_type!(u32, Int, i64);
setting_type!(f32, Float, f64);
