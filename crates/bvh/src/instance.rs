//! Meshes and groups placed by transforms.

use std::sync::Arc;

use glam::DAffine3;
use rayon::prelude::*;
use umber_math::{Bounds3, Ray, Transform};

use crate::{
    cover::Covers,
    mesh::MeshBvh,
    path::{InstancePath, MAX_DEPTH},
    ray::{ChildFromParent, TraversalRay},
    search::{Hit, Search},
    simd::{self, SimdLevel},
    wide::{MAX_PRIMITIVES, MOST_GROWTH, WideTree},
};

/// What an instance shows.
#[derive(Clone)]
pub enum Child {
    /// A mesh.
    Mesh {
        /// Its triangles.
        bvh: Arc<MeshBvh>,
        /// The caller's number for it, returned in hits.
        mesh: u32,
    },
    /// A group of instances.
    Group(Arc<InstanceBvh>),
}

impl Child {
    pub(crate) fn bounds(&self) -> Bounds3 {
        match self {
            Self::Mesh { bvh, .. } => bvh.bounds(),
            Self::Group(group) => group.bounds(),
        }
    }
    /// Boxes that together hold it, closer around it than one.
    pub(crate) fn cover(&self) -> Vec<Bounds3> {
        match self {
            Self::Mesh { bvh, .. } => bvh.tree().cover(),
            Self::Group(group) => group.tree.cover(),
        }
    }
    /// Tells apart what is shown; the same for all instances of one mesh or group.
    pub fn address(&self) -> usize {
        match self {
            Self::Mesh { bvh, .. } => Arc::as_ptr(bvh) as usize,
            Self::Group(group) => Arc::as_ptr(group) as usize,
        }
    }
    /// Whether both are the same mesh or group, not merely alike.
    pub fn is(&self, other: &Self) -> bool {
        let numbers = match (self, other) {
            (Self::Mesh { mesh: a, .. }, Self::Mesh { mesh: b, .. }) => a == b,
            _ => true,
        };
        numbers && self.address() == other.address()
    }
    /// Levels of groups below.
    fn depth(&self) -> usize {
        match self {
            Self::Mesh { .. } => 0,
            Self::Group(group) => group.depth,
        }
    }
}

/// A child at a place.
#[derive(Clone)]
pub struct Instance {
    /// What is shown.
    pub child: Child,
    /// Where: from the child's space to the group's.
    pub parent_from_child: DAffine3,
    /// The caller's own; found by [`InstanceBvh::instance_at`].
    pub tag: u32,
}

/// An instance that rays can meet: all that its visit needs, in two cache lines.
#[derive(Clone)]
#[repr(C, align(64))]
pub(crate) struct Placed {
    child_from_parent: ChildFromParent,
    /// What is shown.
    pub child: Child,
    /// Its place in the list that the caller gave.
    pub index: u32,
    /// Whether the transform is the identity.
    is_identity: bool,
}

const _: () = assert!(size_of::<Placed>() == 128);

impl Placed {
    /// `None` where it is the identity.
    #[inline(always)]
    pub fn child_from_parent(&self) -> Option<&ChildFromParent> {
        (!self.is_identity).then_some(&self.child_from_parent)
    }
    /// A ray of the group's space, made ready in the child's.
    #[inline(always)]
    fn ready(&self, ray: &Ray) -> Option<TraversalRay> {
        match self.child_from_parent() {
            None => TraversalRay::new(ray),
            Some(matrix) => TraversalRay::in_child(ray, matrix),
        }
    }
}

/// Where a path leads: most lead through one level, which is then all there is to know.
#[derive(Clone, Copy)]
pub enum Placement<'a> {
    /// To where it is in its own space.
    AsItIs,
    /// Through one instance.
    Once {
        /// From the instance's space.
        exact: &'a DAffine3,
        /// The same, in single precision.
        rounded: &'a Transform,
    },
    /// Through several: see [`InstanceBvh::transforms`].
    Nested,
}

/// A group of instances; the outermost one is the scene.
#[derive(Clone)]
pub struct InstanceBvh {
    tree: WideTree,
    instances: Vec<Instance>,
    /// Each instance's transform with its inverse, rounded: what hits that end there need. `None`: the identity.
    rounded: Vec<Option<Transform>>,
    /// In the tree's order.
    placed: Vec<Placed>,
    skipped: Vec<u32>,
    /// Levels of groups, with this one.
    depth: usize,
    /// What the tree cost when it was built, if it was fitted since.
    built_cost: Option<f64>,
}

impl InstanceBvh {
    /// Builds the hierarchy.
    ///
    /// Instances with a singular or non-finite transform, or that would make more than
    /// [`MAX_DEPTH`] levels, can't be hit and are told by [`InstanceBvh::skipped`].
    pub fn build(instances: Vec<Instance>) -> Self {
        let (mut boxes, mut placed, mut skipped) = (Vec::new(), Vec::new(), Vec::new());
        let (mut depth, mut covers) = (1, Covers::default());
        for (index, instance) in instances.iter().enumerate() {
            let index = index as u32;
            let fits = instance.child.depth() < MAX_DEPTH && placed.len() < MAX_PRIMITIVES;
            match place(instance, index, &mut covers).filter(|_| fits) {
                None => skipped.push(index),
                Some((_, bounds)) if bounds.is_empty() => {}
                Some((p, bounds)) => {
                    depth = depth.max(instance.child.depth() + 1);
                    placed.push(p);
                    boxes.push(bounds);
                }
            }
        }
        let (tree, order) = WideTree::build(boxes.len(), 1, |i| Some(boxes[i as usize]));
        let mut by_index: Vec<Option<Placed>> = placed.into_iter().map(Some).collect();
        let placed = order.iter().filter_map(|&i| by_index[i as usize].take()).collect();
        let rounded = |i: &Instance| round(i.parent_from_child).unwrap_or_default();
        let rounded = instances.par_iter().with_min_len(256).map(rounded).collect();
        Self { tree, instances, rounded, placed, skipped, depth, built_cost: None }
    }

    /// The hierarchy after some of its instances moved, in a fraction of the time that building takes; those that did
    /// not cost next to nothing. None where building would pay, as for [`MeshBvh::refitted`], or where other things
    /// are shown than before, or not all of them.
    pub fn moved(&self, instances: &[Instance]) -> Option<Self> {
        let same = |(a, b): (&Instance, &Instance)| a.child.is(&b.child) && a.tag == b.tag;
        let all_placed = self.placed.len() == self.instances.len();
        if !all_placed || instances.len() != self.instances.len() || !self.instances.iter().zip(instances).all(same) {
            return None;
        }
        let mut moved = self.clone();
        let mut boxes = self.tree.leaf_boxes(self.placed.len());
        let mut covers = Covers::default();
        for (slot, bounds) in boxes.iter_mut().enumerate() {
            let index = self.placed[slot].index;
            let instance = &instances[index as usize];
            if instance.parent_from_child != self.instances[index as usize].parent_from_child {
                (moved.placed[slot], *bounds) = place(instance, index, &mut covers)?;
                moved.rounded[index as usize] = round(instance.parent_from_child)?;
                moved.instances[index as usize] = instance.clone();
            }
        }
        let built = self.built_cost.unwrap_or_else(|| self.tree.cost());
        moved.built_cost = Some(built);
        moved.tree.fit(|start, _| boxes[start]);
        (moved.tree.cost() <= MOST_GROWTH * built).then_some(moved)
    }

    /// Indices of the instances that can't be hit: transform singular or not finite, or nested too deep.
    pub fn skipped(&self) -> &[u32] {
        &self.skipped
    }

    /// A box around all that can be hit, in this group's space.
    pub fn bounds(&self) -> Bounds3 {
        self.tree.bounds
    }

    /// Memory held, in bytes, without that of the children.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + self.tree.memory_bytes()
            + self.instances.capacity() * size_of::<Instance>()
            + self.rounded.capacity() * size_of::<Option<Transform>>()
            + self.placed.capacity() * size_of::<Placed>()
            + self.skipped.capacity() * 4
    }

    /// Number of instances, with those that can't be hit.
    pub fn instance_count(&self) -> usize {
        self.instances.len()
    }

    /// The instances as they were given.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The closest hit with `t_min < t < t_max`. A negative `t_min` is taken as zero.
    #[inline]
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.closest(ray, SimdLevel::best())
    }

    /// Whether anything is hit with `t_min < t < t_max`. A negative `t_min` is taken as zero.
    #[inline]
    pub fn any_hit(&self, ray: &Ray) -> bool {
        self.any(ray, SimdLevel::best())
    }

    /// As [`InstanceBvh::closest_hit`], on a chosen vector unit (the best one where that is lacking).
    #[inline]
    pub fn closest_hit_on(&self, level: SimdLevel, ray: &Ray) -> Option<Hit> {
        self.closest(ray, level.or_best())
    }

    /// As [`InstanceBvh::any_hit`], on a chosen vector unit (the best one where that is lacking).
    #[inline]
    pub fn any_hit_on(&self, level: SimdLevel, ray: &Ray) -> bool {
        self.any(ray, level.or_best())
    }

    #[inline]
    fn closest(&self, ray: &Ray, level: SimdLevel) -> Option<Hit> {
        let mut search = Search::new(ray.t_max);
        match self.only_mesh() {
            Some((placed, mesh, number)) => {
                search.path.push(placed.index);
                simd::mesh_closest(level, mesh, number, &placed.ready(ray)?, &mut search);
            }
            None => simd::group_closest(level, self, &TraversalRay::new(ray)?, &mut search),
        }
        search.best
    }

    #[inline]
    fn any(&self, ray: &Ray, level: SimdLevel) -> bool {
        let limit = ray.t_max.next_down();
        match self.only_mesh() {
            Some((placed, mesh, _)) => placed.ready(ray).is_some_and(|r| simd::mesh_any(level, mesh, &r, limit)),
            None => TraversalRay::new(ray).is_some_and(|r| simd::group_any(level, self, &r, limit)),
        }
    }

    /// The instance at a level of a path that starts at this group; level 0 is the outermost.
    /// `None` where the path does not go there.
    pub fn instance_at(&self, path: &InstancePath, level: usize) -> Option<&Instance> {
        let mut group = self;
        for &index in path.as_slice().get(..level)? {
            group = match &group.instances.get(index as usize)?.child {
                Child::Group(inner) => inner,
                Child::Mesh { .. } => return None,
            };
        }
        group.instances.get(*path.as_slice().get(level)? as usize)
    }

    /// How a path places what it ends at.
    #[inline]
    pub fn placement(&self, path: &InstancePath) -> Placement<'_> {
        let [only] = path.as_slice() else { return Placement::Nested };
        match (self.rounded.get(*only as usize), self.instances.get(*only as usize)) {
            (Some(Some(rounded)), Some(instance)) => Placement::Once { exact: &instance.parent_from_child, rounded },
            _ => Placement::AsItIs,
        }
    }

    /// From the space of what the path ends at to this group's, which is render space for the
    /// outermost; composed in double precision.
    #[inline]
    pub fn render_from_object(&self, path: &InstancePath) -> Transform {
        if let [only] = path.as_slice()
            && let Some(rounded) = self.rounded.get(*only as usize)
        {
            return rounded.unwrap_or_default();
        }
        Transform::from_affine(self.render_from_object_double(path)).unwrap_or_default()
    }

    /// The transforms along a path, outermost first, each from a child's space to its group's; as many as there are
    /// where the path leads nowhere.
    #[inline]
    pub fn transforms(&self, path: &InstancePath) -> impl DoubleEndedIterator<Item = &DAffine3> + Clone + use<'_> {
        let (mut transforms, mut count) = ([&DAffine3::IDENTITY; MAX_DEPTH], 0);
        let mut group = Some(self);
        for (&index, slot) in path.as_slice().iter().zip(&mut transforms) {
            let Some(instance) = group.and_then(|g| g.instances.get(index as usize)) else { break };
            (*slot, count) = (&instance.parent_from_child, count + 1);
            group = match &instance.child {
                Child::Group(inner) => Some(&**inner),
                Child::Mesh { .. } => None,
            };
        }
        transforms.into_iter().take(count)
    }

    /// As [`InstanceBvh::render_from_object`], before rounding.
    pub fn render_from_object_double(&self, path: &InstancePath) -> DAffine3 {
        self.transforms(path).fold(DAffine3::IDENTITY, |m, t| m * *t)
    }

    #[inline(always)]
    pub(crate) fn tree(&self) -> &WideTree {
        &self.tree
    }

    /// The instance where it is all there is, and of a mesh: then no level of instances is paid for.
    #[inline(always)]
    fn only_mesh(&self) -> Option<(&Placed, &MeshBvh, u32)> {
        match &self.placed[..] {
            [placed @ Placed { child: Child::Mesh { bvh, mesh }, .. }] => Some((placed, bvh, *mesh)),
            _ => None,
        }
    }

    #[inline(always)]
    pub(crate) fn placed(&self, slot: usize) -> &Placed {
        &self.placed[slot]
    }
}

/// A transform with its inverse, rounded; `Some(None)` for the identity, `None` where it has no inverse.
fn round(m: DAffine3) -> Option<Option<Transform>> {
    if m == DAffine3::IDENTITY { Some(None) } else { Transform::from_affine(m).map(Some) }
}

/// An instance made ready, and its box. `None` where its transform can't be inverted.
fn place(instance: &Instance, index: u32, covers: &mut Covers) -> Option<(Placed, Bounds3)> {
    let m = instance.parent_from_child;
    Transform::from_affine(m)?;
    let bounds = instance.child.bounds();
    let is_identity = m == DAffine3::IDENTITY;
    let bounds = if bounds.is_empty() || is_identity { bounds } else { covers.of(&instance.child).placed(&m) };
    let finite = bounds.is_empty() || is_identity || bounds.min.is_finite() && bounds.max.is_finite();
    let placed = || Placed {
        child_from_parent: ChildFromParent::new(m.inverse()),
        child: instance.child.clone(),
        index,
        is_identity,
    };
    finite.then(|| (placed(), bounds))
}
