//! Spheres near walls, with what their wall contacts remember.
//!
//! One entry for each sphere and wall in reach, sorted by sphere; a mesh has as many consecutive
//! entries a sphere as it can have contacts with it.

use super::verlet_list::{memory_of, whole_blocks};
use crate::particles::Column;

/// No facet: the wall is analytic, or the entry is free.
pub(crate) const NO_FACET: u32 = u32::MAX;

/// The list.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WallList {
    pub(crate) slots: usize,
    pub(crate) sphere: Vec<u32>,
    pub(crate) wall: Vec<u16>,
    /// Facet of a mesh that the entry's contact belongs to.
    pub(crate) facet: Vec<u32>,
    pub(crate) active: Column<u8>,
    pub(crate) memory: Column<f64>,
    /// First entry of each sphere.
    pub(crate) start: Vec<u32>,
    /// Facets in reach of a mesh entry: a range of `facets` for the first entry of each mesh.
    pub(crate) facets_of: Vec<[u32; 2]>,
    pub(crate) facets: Vec<u32>,
}

impl WallList {
    pub(crate) fn clear(&mut self, slots: usize) {
        self.slots = slots;
        self.sphere.clear();
        self.wall.clear();
        self.facet.clear();
        self.active.clear();
        self.start.clear();
        self.facets_of.clear();
        self.facets.clear();
    }

    pub(crate) fn len(&self) -> usize {
        self.sphere.len()
    }

    pub(crate) fn push(&mut self, sphere: u32, wall: u16, facets: [u32; 2]) {
        self.sphere.push(sphere);
        self.wall.push(wall);
        self.facet.push(NO_FACET);
        self.active.push(0);
        self.facets_of.push(facets);
    }

    /// Take over what the contacts of `old` remember.
    pub(crate) fn take_over(&mut self, old: &WallList, old_place: Option<&[u32]>) {
        self.memory.clear();
        self.memory.resize(whole_blocks(self.len()) * self.slots, 0.0);
        if old.start.len() != self.start.len() {
            return;
        }
        for entry in 0..self.len() {
            let sphere = self.sphere[entry];
            let was_at = old_place.map_or(sphere, |o| o[sphere as usize]) as usize;
            // The n-th entry of a wall takes over the n-th.
            let nth = |list: &WallList, begin: u32, e: usize| {
                list.wall[begin as usize..e].iter().filter(|&&w| w == list.wall[e]).count()
            };
            let own = nth(self, self.start[sphere as usize], entry);
            let old_range = old.start[was_at] as usize..old.start[was_at + 1] as usize;
            let was = old_range.filter(|&e| old.wall[e] == self.wall[entry]).nth(own);
            let Some(was) = was else { continue };
            self.facet[entry] = old.facet[was];
            self.active[entry] = old.active[was];
            if old.active[was] != 0 {
                self.memory[memory_of(self.slots, entry)]
                    .copy_from_slice(&old.memory[memory_of(self.slots, was)]);
            }
        }
    }
}
