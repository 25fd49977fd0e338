//! Which categories the instances of the hierarchy's top level belong to.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use umber_scene::{Category, Instancer, InstancerId};

use super::instances::ShownMesh;

/// The categories of all instances of the top level, each distinct set kept once. Only scenes with categories have one.
#[derive(Debug, Default)]
pub struct Membership {
    /// Index into `sets`, by instance of the top level.
    pub of_instance: Vec<u32>,
    /// Distinct sets, at least one instance has each.
    pub sets: Vec<Arc<[Category]>>,
    known: HashMap<Arc<[Category]>, u32>,
}

impl Membership {
    /// One without instances, where any prim has categories.
    pub fn where_needed(shown: &[ShownMesh], instancers: &BTreeMap<InstancerId, Instancer>) -> Option<Self> {
        let any = shown.iter().any(|shown| !shown.mesh.categories.is_empty())
            || instancers.values().any(|instancer| instancer.categories.iter().any(|set| !set.is_empty()));
        any.then(Self::default)
    }

    /// Adds the next instance of the top level.
    pub fn push(&mut self, categories: &Arc<[Category]>) {
        let last = self.of_instance.last().copied();
        let repeats = last.filter(|set| Arc::ptr_eq(&self.sets[*set as usize], categories));
        let set = repeats.unwrap_or_else(|| self.number(categories));
        self.of_instance.push(set);
    }

    /// Adds the next instance of the top level, number `index` of an instancer.
    pub fn push_instance(&mut self, instancer: &Instancer, index: i32) {
        let index = if instancer.categories.len() == 1 { 0 } else { index as usize };
        let none = Arc::default();
        self.push(instancer.categories.get(index).unwrap_or(&none));
    }

    fn number(&mut self, categories: &Arc<[Category]>) -> u32 {
        let next = self.sets.len() as u32;
        *self.known.entry(Arc::clone(categories)).or_insert_with(|| {
            self.sets.push(Arc::clone(categories));
            next
        })
    }
}
