//! The top level: which mesh stands where, with instancers kept as instances.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use umber_bvh::{Child, Instance, InstanceBvh, MAX_DEPTH};
use umber_math::DAffine3;
use umber_scene::{Instancer, InstancerId, Mesh, MeshId};

use super::membership::Membership;
use crate::mesh::MeshShape;

/// Which of how many an instance is, within the instancer that makes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstanceNumber {
    /// Its number.
    pub position: u32,
    /// How many there are.
    pub count: u32,
}

/// A mesh that is shown.
pub struct ShownMesh<'a> {
    /// Its path.
    pub id: &'a MeshId,
    /// What the host says of it.
    pub mesh: &'a Mesh,
    /// Its shape.
    pub shape: &'a Arc<MeshShape>,
    /// Its index in the render scene.
    pub index: u32,
}

/// The placed scene.
pub struct Placed {
    /// Hierarchy over everything, render space.
    pub top: InstanceBvh,
    /// What the tags of instances mean.
    pub numbers: Vec<InstanceNumber>,
    /// Mesh instances, nested ones multiplied out.
    pub instance_count: u64,
    /// What the instances of the top level belong to, where anything has categories.
    pub membership: Option<Membership>,
}

/// Meshes and instancers that one instancer makes at the same instances.
#[derive(Default)]
struct Prototype<'a> {
    meshes: Vec<&'a ShownMesh<'a>>,
    instancers: Vec<&'a InstancerId>,
}

struct Placer<'a> {
    instancers: &'a BTreeMap<InstancerId, Instancer>,
    /// Prototypes of each instancer, by the instances that show them.
    prototypes: BTreeMap<&'a InstancerId, BTreeMap<&'a [i32], Prototype<'a>>>,
    numbers: Vec<InstanceNumber>,
    instance_count: u64,
    membership: Option<Membership>,
    older: OlderGroups,
    say: &'a mut dyn FnMut(&str, String),
}

/// The groups of an earlier placement, by what they show first and how many instances they have.
#[derive(Default)]
struct OlderGroups(HashMap<(usize, usize), Vec<Arc<InstanceBvh>>>);

impl OlderGroups {
    /// All groups below one.
    fn below(top: &InstanceBvh) -> Self {
        let mut groups = Self::default();
        groups.collect(top);
        groups
    }

    fn collect(&mut self, group: &InstanceBvh) {
        for instance in group.instances() {
            let Child::Group(inner) = &instance.child else { continue };
            let known = self.0.entry(Self::key(inner.instances())).or_default();
            if !known.iter().any(|k| Arc::ptr_eq(k, inner)) {
                known.push(Arc::clone(inner));
                self.collect(inner);
            }
        }
    }

    fn key(instances: &[Instance]) -> (usize, usize) {
        (instances.first().map_or(0, |i| i.child.address()), instances.len())
    }

    /// One with these very instances.
    fn find(&self, instances: &[Instance]) -> Option<Arc<InstanceBvh>> {
        let same = |(a, b): (&Instance, &Instance)| {
            a.child.is(&b.child) && a.tag == b.tag && a.parent_from_child == b.parent_from_child
        };
        let matches = |group: &&Arc<InstanceBvh>| group.instances().iter().zip(instances).all(same);
        self.0.get(&Self::key(instances))?.iter().find(matches).cloned()
    }
}

/// Places all shown meshes. Groups that are as they were in an older placement are taken from it, and where instances
/// only moved its top level is fitted to them.
pub fn place(
    shown: &[ShownMesh],
    instancers: &BTreeMap<InstancerId, Instancer>,
    render_from_world: DAffine3,
    older: Option<&InstanceBvh>,
    say: &mut dyn FnMut(&str, String),
) -> Placed {
    let mut prototypes: BTreeMap<&InstancerId, BTreeMap<&[i32], Prototype>> = BTreeMap::new();
    for mesh in shown {
        if let Some(id) = &mesh.mesh.instancer {
            prototypes.entry(id).or_default().entry(&mesh.mesh.instance_indices).or_default().meshes.push(mesh);
        }
    }
    for (id, instancer) in instancers.iter().filter(|(_, i)| i.visible) {
        if let Some(parent) = &instancer.parent {
            prototypes.entry(parent).or_default().entry(&instancer.parent_indices).or_default().instancers.push(id);
        }
    }
    let roots: BTreeSet<&InstancerId> =
        prototypes.keys().copied().filter(|id| instancers.get(*id).is_none_or(|i| i.parent.is_none())).collect();
    let groups = older.map(OlderGroups::below).unwrap_or_default();
    let membership = Membership::where_needed(shown, instancers);
    let mut placer =
        Placer { instancers, prototypes, numbers: Vec::new(), instance_count: 0, membership, older: groups, say };

    let lone = placer.number(0, 1);
    let mut top: Vec<Instance> = Vec::new();
    for mesh in shown.iter().filter(|m| m.mesh.instancer.is_none()) {
        top.push(instance(mesh, mesh.mesh.transform, lone));
        placer.instance_count += 1;
        if let Some(membership) = &mut placer.membership {
            membership.push(&mesh.mesh.categories);
        }
    }
    for root in roots {
        let (instances, count) = placer.expand(root, 1);
        top.extend(instances);
        placer.instance_count += count;
    }
    for (id, lost) in std::mem::take(&mut placer.prototypes) {
        let meshes: usize = lost.values().map(|prototype| prototype.meshes.len()).sum();
        if meshes > 0 && instancers.get(id).is_none_or(|i| i.visible) && placer.in_a_circle(id) {
            (placer.say)(id.path(), format!("its parents lead back to it: its {meshes} meshes are not shown"));
        }
    }
    for instance in &mut top {
        instance.parent_from_child = render_from_world * instance.parent_from_child;
    }
    let top = match older.and_then(|older| older.moved(&top)) {
        Some(moved) => moved,
        None => build(top, "the stage", placer.say),
    };
    let Placer { numbers, instance_count, membership, .. } = placer;
    Placed { top, numbers, instance_count, membership }
}

fn instance(mesh: &ShownMesh, parent_from_child: DAffine3, tag: u32) -> Instance {
    Instance { child: Child::Mesh { bvh: Arc::clone(&mesh.shape.bvh), mesh: mesh.index }, parent_from_child, tag }
}

fn build(instances: Vec<Instance>, of: &str, say: &mut dyn FnMut(&str, String)) -> InstanceBvh {
    let bvh = InstanceBvh::build(instances);
    if let Some(first) = bvh.skipped().first() {
        let count = bvh.skipped().len();
        say(of, format!("{count} instances skipped: their transform is singular or not finite (first: {first})"));
    }
    bvh
}

impl<'a> Placer<'a> {
    /// Whether an instancer's parents never end.
    fn in_a_circle(&self, id: &InstancerId) -> bool {
        let parent = |id: &InstancerId| self.instancers.get(id).and_then(|i| i.parent.clone());
        let mut next = parent(id);
        for _ in 0..=self.instancers.len() {
            let Some(id) = next else { return false };
            next = parent(&id);
        }
        true
    }

    fn number(&mut self, position: usize, count: usize) -> u32 {
        self.numbers.push(InstanceNumber { position: position as u32, count: count as u32 });
        (self.numbers.len() - 1) as u32
    }

    /// All instances that an instancer makes, in its parent's space, and how many meshes they show.
    /// `depth` is the number of levels around it.
    fn expand(&mut self, id: &'a InstancerId, depth: usize) -> (Vec<Instance>, u64) {
        let Some(instancer) = self.instancers.get(id) else {
            (self.say)(id.path(), "no such instancer: what it instances is not shown".into());
            return (Vec::new(), 0);
        };
        // taken out, so that instancers that name each other as parents end
        let Some(prototypes) = self.prototypes.remove(id) else { return (Vec::new(), 0) };
        if !instancer.visible {
            return (Vec::new(), 0);
        }
        let (mut instances, mut shown) = (Vec::new(), 0);
        for (indices, prototype) in prototypes {
            let (members, count) = self.members(&prototype, depth);
            if members.is_empty() {
                continue;
            }
            let members = self.group(members, id, depth);
            let known = |i: &i32| usize::try_from(*i).ok().and_then(|i| instancer.transforms.get(i));
            let mut unknown = 0usize;
            for (position, index) in indices.iter().enumerate() {
                let Some(transform) = known(index) else {
                    unknown += 1;
                    continue;
                };
                let tag = self.number(position, indices.len());
                for member in &members {
                    let parent_from_child = *transform * member.parent_from_child;
                    let tag = if self.is_lone(member.tag) { tag } else { self.nested_number(tag, member.tag) };
                    instances.push(Instance { child: member.child.clone(), parent_from_child, tag });
                    if let Some(membership) = self.membership.as_mut().filter(|_| depth == 1) {
                        membership.push_instance(instancer, *index);
                    }
                }
                shown += count;
            }
            if unknown > 0 {
                let have = instancer.transforms.len();
                (self.say)(id.path(), format!("{unknown} instances skipped: index beyond its {have} transforms"));
            }
        }
        (instances, shown)
    }

    /// What one instance of a prototype consists of, in prototype space.
    fn members(&mut self, prototype: &Prototype<'a>, depth: usize) -> (Vec<Instance>, u64) {
        let lone = self.number(0, 1);
        let mut members: Vec<Instance> =
            prototype.meshes.iter().map(|mesh| instance(mesh, mesh.mesh.transform, lone)).collect();
        let mut count = members.len() as u64;
        for nested in &prototype.instancers {
            let (instances, shown) = self.expand(nested, depth + 1);
            members.extend(instances);
            count += shown;
        }
        (members, count)
    }

    /// One instance in place of several, unless that nests too deep: then they stay several.
    fn group(&mut self, members: Vec<Instance>, id: &InstancerId, depth: usize) -> Vec<Instance> {
        let lone = matches!(members[..], [Instance { child: Child::Mesh { .. }, tag, .. }] if self.is_lone(tag));
        if lone || depth >= MAX_DEPTH {
            return members;
        }
        let tag = self.number(0, 1);
        let group = match self.older.find(&members) {
            Some(group) => group,
            None => Arc::new(build(members, id.path(), self.say)),
        };
        vec![Instance { child: Child::Group(group), parent_from_child: DAffine3::IDENTITY, tag }]
    }

    fn is_lone(&self, tag: u32) -> bool {
        self.numbers[tag as usize].count == 1
    }

    /// The number of an instance within an instance, where both share one level.
    fn nested_number(&mut self, outer: u32, inner: u32) -> u32 {
        let (o, i) = (self.numbers[outer as usize], self.numbers[inner as usize]);
        self.number((o.position * i.count + i.position) as usize, (o.count * i.count) as usize)
    }
}
