//! Compiles a scene store to a frozen render scene, integrates it, and keeps the film.
