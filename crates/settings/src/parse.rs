//! From what hosts and users say to a value of the row's type.

use thiserror::Error;

use crate::{Setting, TABLE, Value};

/// Why a setting was not taken.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SettingError {
    /// No such key.
    #[error("unknown setting '{key}' (did you mean '{nearest}'?)")]
    UnknownKey {
        /// The key that was given.
        key: String,
        /// The most similar key that exists.
        nearest: &'static str,
    },
    /// The value has the wrong type.
    #[error("setting '{key}' takes {wanted}, not '{value}'")]
    WrongType {
        /// The key.
        key: &'static str,
        /// What it takes, in words.
        wanted: String,
        /// The value that was given.
        value: String,
    },
    /// The value lies outside the row's range.
    #[error("setting '{key}' must lie between {min} and {max}: {value} does not")]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
        /// The value that was given.
        value: String,
    },
}

/// The known key most similar to `key`.
pub fn nearest_key(key: &str) -> &'static str {
    let short = |k: &str| k.rsplit(':').next().unwrap_or(k).to_lowercase();
    let similarity = |row: &&Setting| strsim::jaro_winkler(&short(key), &short(row.key));
    TABLE.iter().max_by(|a, b| similarity(a).total_cmp(&similarity(b))).map_or("", |row| row.key)
}

pub(crate) fn row(key: &str) -> Result<&'static Setting, SettingError> {
    TABLE
        .iter()
        .find(|row| row.key == key)
        .ok_or_else(|| SettingError::UnknownKey { key: key.to_owned(), nearest: nearest_key(key) })
}

fn wanted(row: &Setting) -> String {
    match row.default {
        Value::Bool(_) => "true or false".to_owned(),
        Value::Int(_) => "a whole number".to_owned(),
        Value::Float(_) => "a number".to_owned(),
        Value::Text(_) => format!("one of {}", row.choices.join(", ")),
    }
}

fn wrong_type(row: &'static Setting, value: String) -> SettingError {
    SettingError::WrongType { key: row.key, wanted: wanted(row), value }
}

pub(crate) fn parse(row: &'static Setting, text: &str) -> Result<Value, SettingError> {
    let parsed = match row.default {
        Value::Bool(_) => match text.to_lowercase().as_str() {
            "true" | "1" | "on" | "yes" => Some(Value::Bool(true)),
            "false" | "0" | "off" | "no" => Some(Value::Bool(false)),
            _ => None,
        },
        Value::Int(_) => text.parse().ok().map(Value::Int),
        Value::Float(_) => text.parse().ok().map(Value::Float),
        Value::Text(_) => Some(Value::Text(text.to_owned())),
    };
    parsed.ok_or_else(|| wrong_type(row, text.to_owned()))
}

pub(crate) fn convert(row: &'static Setting, value: &Value) -> Result<Value, SettingError> {
    let converted = match (&row.default, value) {
        (Value::Bool(_), Value::Int(v)) => Value::Bool(*v != 0),
        (Value::Int(_), Value::Bool(v)) => Value::Int(i64::from(*v)),
        (Value::Int(_), Value::Float(v)) if v.fract() == 0.0 && v.abs() < 1e15 => Value::Int(*v as i64),
        (Value::Float(_), Value::Int(v)) => Value::Float(*v as f64),
        // rounded once to the precision that the renderer keeps, so that "unchanged" means that
        (Value::Float(_), Value::Float(v)) => Value::Float(f64::from(*v as f32)),
        (Value::Bool(_), Value::Bool(_)) | (Value::Int(_), Value::Int(_)) => value.clone(),
        (Value::Text(_), Value::Text(word)) if row.choices.contains(&word.as_str()) => value.clone(),
        _ => return Err(wrong_type(row, value.to_string())),
    };
    let number = match converted {
        Value::Int(v) => v as f64,
        Value::Float(v) => v,
        Value::Bool(_) | Value::Text(_) => return Ok(converted),
    };
    match row.range {
        Some((min, max)) if !(min..=max).contains(&number) => {
            Err(SettingError::OutOfRange { key: row.key, min, max, value: number.to_string() })
        }
        _ => Ok(converted),
    }
}
