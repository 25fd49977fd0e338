//! Furnace, reciprocity, densities.
