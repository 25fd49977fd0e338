//! The Hydra delegate's Rust half: what the C++ classes of `cpp_shim` forward to.
//!
//! `bridge` declares everything that C++ may call; each of those functions goes through `guard`, so
//! that no panic reaches the host. One module a Hydra prim collects what a sync pulled and sends it
//! to the session as one edit.

#![allow(non_snake_case)] // the library's name is the plugin's

mod bridge;
mod buffer;
mod camera;
mod convert;
mod delegate;
mod frame;
mod guard;
mod host;
mod instancer;
mod light;
mod light_apis;
mod material;
mod mesh;
mod preview_surface;
