//! What went wrong, said to the user by the host's means.

use std::fmt;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Severity {
    /// The frame renders, without the thing named.
    Warning,
    /// Nothing can be rendered.
    Error,
}

/// A warning or an error, naming the prim it is about.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Message {
    /// How bad it is.
    pub severity: Severity,
    /// Path of the prim, where it is about one.
    pub prim: Option<String>,
    /// What happened.
    pub text: String,
}

impl Message {
    /// A warning.
    pub fn warning(prim: Option<&str>, text: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, prim: prim.map(str::to_owned), text: text.into() }
    }
    /// An error.
    pub fn error(prim: Option<&str>, text: impl Into<String>) -> Self {
        Self { severity: Severity::Error, prim: prim.map(str::to_owned), text: text.into() }
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.prim {
            Some(prim) => write!(f, "<{prim}>: {}", self.text),
            None => f.write_str(&self.text),
        }
    }
}
