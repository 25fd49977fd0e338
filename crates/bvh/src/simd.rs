//! Vector units: one kernel, compiled once for each.

use std::sync::LazyLock;

use crate::{instance::InstanceBvh, mesh::MeshBvh, ray::TraversalRay, search::Search, wide::WideTree};
use vector::Vector;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod instances;
mod kernel;
#[cfg(target_arch = "aarch64")]
mod neon;
mod portable;
mod stack;
mod triangles;
mod vector;
mod walk;
#[cfg(target_arch = "x86_64")]
mod x86;

/// Which vector unit traversal uses. Hits are the same on all; this is for tests and measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimdLevel {
    /// What the compiler makes of plain loops, for any processor.
    Portable,
    /// AVX2 of x86-64.
    Avx2,
    /// AVX-512 (F, VL, DQ, BW) of x86-64, on eight lanes.
    Avx512,
    /// NEON of 64-bit Arm.
    Neon,
}

impl SimdLevel {
    /// The levels that this processor has, the best last.
    pub fn available() -> &'static [Self] {
        static AVAILABLE: LazyLock<Vec<SimdLevel>> = LazyLock::new(SimdLevel::detect);
        &AVAILABLE
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn detect() -> Vec<Self> {
        if cfg!(target_arch = "aarch64") { vec![Self::Portable, Self::Neon] } else { vec![Self::Portable] }
    }

    #[cfg(target_arch = "x86_64")]
    fn detect() -> Vec<Self> {
        let mut levels = vec![Self::Portable];
        let bits = is_x86_feature_detected!("bmi1") && is_x86_feature_detected!("bmi2");
        let counts = is_x86_feature_detected!("lzcnt") && is_x86_feature_detected!("popcnt");
        if is_x86_feature_detected!("avx2") && bits && counts {
            levels.push(Self::Avx2);
            let f = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl");
            if f && is_x86_feature_detected!("avx512dq") && is_x86_feature_detected!("avx512bw") {
                levels.push(Self::Avx512);
            }
        }
        levels
    }

    /// The best that this processor has.
    #[inline]
    pub fn best() -> Self {
        static BEST: LazyLock<SimdLevel> =
            LazyLock::new(|| SimdLevel::available().last().copied().unwrap_or(SimdLevel::Portable));
        *BEST
    }

    /// This level if the processor has it, else the best that it has.
    pub(crate) fn or_best(self) -> Self {
        if Self::available().contains(&self) { self } else { Self::best() }
    }
}

/// Eight floats.
#[derive(Clone, Copy, Default)]
#[repr(C, align(32))]
pub(crate) struct Lanes(pub [f32; 8]);

/// What the triangle test writes: valid in the lanes that it reports as hits.
#[derive(Clone, Copy, Default)]
pub(crate) struct LaneHits {
    pub t: Lanes,
    pub barycentrics: [Lanes; 3],
}

/// Outcome of a triangle test, a bit a lane.
#[derive(Clone, Copy)]
pub(crate) struct LaneMasks {
    /// Lanes with a hit.
    pub hit: u32,
    /// Lanes with a hit that may be on either side of the ray's origin: their `t` is to be worked out in double
    /// precision.
    pub near: u32,
    /// Lanes to be done over by the scalar test, in double precision.
    pub again: u32,
}

impl LaneMasks {
    pub const NONE: Self = Self { hit: 0, near: 0, again: 0 };
}

/// The traversals, compiled for a vector unit.
///
/// All functions are unsafe: the processor must have the unit.
#[expect(private_bounds, reason = "what a unit can do is of this module alone")]
pub(crate) trait Isa: Vector {
    /// Closest hit in a mesh that the caller numbered `id`.
    ///
    /// # Safety
    /// The processor has the unit.
    unsafe fn mesh_closest(mesh: &MeshBvh, id: u32, ray: &TraversalRay, search: &mut Search);

    /// Whether anything of a mesh is hit up to and with `limit`.
    ///
    /// # Safety
    /// The processor has the unit.
    unsafe fn mesh_any(mesh: &MeshBvh, ray: &TraversalRay, limit: f32) -> bool;

    /// Closest hit in a group.
    ///
    /// # Safety
    /// The processor has the unit.
    unsafe fn group_closest(group: &InstanceBvh, ray: &TraversalRay, search: &mut Search);

    /// Whether anything of a group is hit up to and with `limit`.
    ///
    /// # Safety
    /// The processor has the unit.
    unsafe fn group_any(group: &InstanceBvh, ray: &TraversalRay, limit: f32) -> bool;

    /// See [`visit_boxes`].
    ///
    /// # Safety
    /// The processor has the unit.
    unsafe fn visit_boxes<F: FnMut(usize, f32) -> Option<f32>>(
        tree: &WideTree,
        ray: &TraversalRay,
        limit: f32,
        visit: F,
    );
}

/// The traversals of an [`Isa`], compiled with its features.
macro_rules! compile_traversals {
    ($($feature:literal)?) => {
        $(#[target_feature(enable = $feature)])?
        unsafe fn mesh_closest(mesh: &MeshBvh, id: u32, ray: &TraversalRay, search: &mut Search) {
            // SAFETY: the caller vouches for the unit.
            unsafe { triangles::closest::<Self>(mesh, id, ray, search) }
        }
        $(#[target_feature(enable = $feature)])?
        unsafe fn mesh_any(mesh: &MeshBvh, ray: &TraversalRay, limit: f32) -> bool {
            // SAFETY: the caller vouches for the unit.
            unsafe { triangles::any::<Self>(mesh, ray, limit) }
        }
        $(#[target_feature(enable = $feature)])?
        unsafe fn group_closest(group: &InstanceBvh, ray: &TraversalRay, search: &mut Search) {
            // SAFETY: the caller vouches for the unit.
            unsafe { instances::closest::<Self>(group, ray, search) }
        }
        $(#[target_feature(enable = $feature)])?
        unsafe fn group_any(group: &InstanceBvh, ray: &TraversalRay, limit: f32) -> bool {
            // SAFETY: the caller vouches for the unit.
            unsafe { instances::any::<Self>(group, ray, limit) }
        }
        $(#[target_feature(enable = $feature)])?
        unsafe fn visit_boxes<F: FnMut(usize, f32) -> Option<f32>>(
            tree: &WideTree,
            ray: &TraversalRay,
            limit: f32,
            visit: F,
        ) {
            // SAFETY: the caller vouches for the unit.
            unsafe { walk::each::<Self, F>(tree, ray, limit, visit) }
        }
    };
}
use compile_traversals;

/// Calls a traversal on a level.
macro_rules! on_level {
    ($level:expr, $traversal:ident($($argument:expr),*)) => {
        // SAFETY: levels other than portable come from `available`, by `best` and `or_best`.
        unsafe {
            match $level {
                #[cfg(target_arch = "x86_64")]
                SimdLevel::Avx2 => avx2::Avx2::$traversal($($argument),*),
                #[cfg(target_arch = "x86_64")]
                SimdLevel::Avx512 => avx512::Avx512::$traversal($($argument),*),
                #[cfg(target_arch = "aarch64")]
                SimdLevel::Neon => neon::Neon::$traversal($($argument),*),
                _ => portable::Portable::$traversal($($argument),*),
            }
        }
    };
}

/// Closest hit in a mesh that the caller numbered `id`.
#[inline]
pub(crate) fn mesh_closest(level: SimdLevel, mesh: &MeshBvh, id: u32, ray: &TraversalRay, search: &mut Search) {
    on_level!(level, mesh_closest(mesh, id, ray, search));
}

/// Whether anything of a mesh is hit up to and with `limit`.
#[inline]
pub(crate) fn mesh_any(level: SimdLevel, mesh: &MeshBvh, ray: &TraversalRay, limit: f32) -> bool {
    on_level!(level, mesh_any(mesh, ray, limit))
}

/// Closest hit in a group.
#[inline]
pub(crate) fn group_closest(level: SimdLevel, group: &InstanceBvh, ray: &TraversalRay, search: &mut Search) {
    on_level!(level, group_closest(group, ray, search));
}

/// Whether anything of a group is hit up to and with `limit`.
#[inline]
pub(crate) fn group_any(level: SimdLevel, group: &InstanceBvh, ray: &TraversalRay, limit: f32) -> bool {
    on_level!(level, group_any(group, ray, limit))
}

/// Calls `visit` with each primitive, by its place in the tree's order, whose box the ray meets up to the limit;
/// nearer boxes first. What it gives becomes the limit, if smaller.
#[inline]
pub(crate) fn visit_boxes(
    level: SimdLevel,
    tree: &WideTree,
    ray: &TraversalRay,
    limit: f32,
    visit: impl FnMut(usize, f32) -> Option<f32>,
) {
    on_level!(level, visit_boxes(tree, ray, limit, visit));
}
