//! The one table of settings: key, type, default, range, UI name, doc.
