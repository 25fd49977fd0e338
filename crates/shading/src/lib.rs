//! Textures, BSDF lobes, materials and lights.
