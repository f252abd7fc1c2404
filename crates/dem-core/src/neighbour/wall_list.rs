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

/// Walls near the spheres of some bodies.
#[derive(Debug, Clone, Default)]
pub(crate) struct NearWalls {
    /// Sphere, wall and what is told of the gap between them.
    entries: Vec<(u32, u16, f32)>,
    /// Which of `facets` are in reach of an entry, if any are of meshes.
    facets_of: Vec<[u32; 2]>,
    pub(crate) facets: Vec<u32>,
    /// Walls in reach of a clump.
    pub(crate) in_reach: Vec<usize>,
}

impl NearWalls {
    /// Begin anew, with room for one wall a body.
    pub(crate) fn begin(&mut self, bodies: usize) {
        self.entries.clear();
        self.entries.reserve(bodies);
        self.facets_of.clear();
        self.facets.clear();
        self.in_reach.clear();
    }

    /// A sphere is near a wall, by this gap: of a mesh, near these of its facets.
    pub(crate) fn push(&mut self, sphere: u32, wall: u16, gap: f32, facets: Option<[u32; 2]>) {
        if facets.is_some() || !self.facets_of.is_empty() {
            self.facets_of.resize(self.entries.len(), [0; 2]);
            self.facets_of.push(facets.unwrap_or_default());
        }
        self.entries.push((sphere, wall, gap));
    }

    /// What is told of the gaps, and spheres.
    pub(crate) fn gaps(&self) -> impl Iterator<Item = (f32, u32)> {
        self.entries.iter().map(|(sphere, _, gap)| (*gap, *sphere))
    }
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

    /// Go on with the walls near the next spheres.
    pub(crate) fn append(&mut self, near: &NearWalls) {
        let before = self.facets.len() as u32;
        for (k, &(sphere, wall, _)) in near.entries.iter().enumerate() {
            let facets = near.facets_of.get(k).copied().unwrap_or_default();
            self.close(sphere as usize);
            self.sphere.push(sphere);
            self.wall.push(wall);
            self.facet.push(NO_FACET);
            self.active.push(0);
            let of_mesh = facets[0] < facets[1];
            self.facets_of.push(if of_mesh { facets.map(|f| before + f) } else { facets });
        }
        self.facets.extend_from_slice(&near.facets);
    }

    /// Say where the entries of spheres up to this one begin, of which those before it have all theirs; behind the last sphere, where
    /// all entries end.
    pub(crate) fn close(&mut self, sphere: usize) {
        let now = self.len() as u32;
        self.start.resize(self.start.len().max(sphere + 1), now);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_near_runs_of_spheres_follow_each_other_with_their_facets() {
        let (mut first, mut second) = (NearWalls::default(), NearWalls::default());
        first.begin(3);
        first.push(0, 1, 5.0, None);
        first.facets.extend([7, 8]);
        first.push(2, 2, -1.0, Some([0, 2]));
        first.push(2, 1, 3.0, None);
        second.begin(3);
        second.facets.push(9);
        second.push(4, 2, -1.0, Some([0, 1]));
        assert!(first.gaps().eq([(5.0, 0), (-1.0, 2), (3.0, 2)]));
        let mut list = WallList::default();
        list.clear(4);
        list.append(&first);
        list.append(&second);
        list.close(6);
        assert_eq!((list.sphere, list.wall), (vec![0, 2, 2, 4], vec![1, 2, 1, 2]));
        assert_eq!(list.start, [0, 1, 1, 3, 3, 4, 4]);
        assert_eq!(list.facets_of, [[0, 0], [0, 2], [0, 0], [2, 3]]);
        assert_eq!(list.facets, [7, 8, 9]);
    }
}
