//! Bounding volume hierarchies: built by obvhs, laid out wide, traversed with instances.
