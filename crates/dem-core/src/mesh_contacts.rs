//! Which entry of the wall list each contact with a mesh belongs to.

use crate::forces::TOUCHES;
use crate::geometry::mesh::{CONTACTS_PER_SPHERE, Mesh, MeshContact};
use crate::geometry::{Nearest, PlacedWall, Shape, Wall};
use crate::neighbour::verlet_list::memory_of;
use crate::neighbour::wall_list::{NO_FACET, WallList};
use crate::particles::Record;
use crate::threads::View;

/// For every entry of a mesh, where the mesh is nearest: written to `nearest`, by entry.
///
/// A contact keeps its entry, and so its memory, while it stays on its facet or moves to one that
/// shares a corner.
pub(crate) fn assign(
    walls: &[Wall],
    placed: &[PlacedWall],
    position: View<'_, Record>,
    range: f64,
    list: &mut WallList,
    nearest: &mut Vec<Option<Nearest>>,
) {
    nearest.clear();
    nearest.resize(list.len(), None);
    let mut entry = 0;
    while entry < list.len() {
        let wall = list.wall[entry] as usize;
        let Shape::Mesh(mesh) = &walls[wall].shape else {
            entry += 1;
            continue;
        };
        let pose = &placed[wall].pose;
        let centre = &position[list.sphere[entry] as usize];
        let [begin, end] = list.facets_of[entry];
        let facets = &list.facets[begin as usize..end as usize];
        let local = pose.inverse_point(centre.vector());
        let contacts = mesh.contacts(local, centre.w + range, facets);
        let mut waiting: [Option<&MeshContact>; CONTACTS_PER_SPHERE] = [None; _];
        for (slot, contact) in waiting.iter_mut().zip(contacts.iter()) {
            *slot = Some(contact);
        }
        let group = entry..entry + CONTACTS_PER_SPHERE;
        let mut taken = [false; CONTACTS_PER_SPHERE];
        for rule in [same_facet, adjacent_facet, free_entry] {
            for (nth, e) in group.clone().enumerate() {
                if taken[nth] {
                    continue;
                }
                let old = (list.active[e] & TOUCHES != 0).then_some(list.facet[e]);
                let found = waiting.iter_mut().find(|c| c.is_some_and(|c| rule(mesh, old, c)));
                if let Some(contact) = found.and_then(Option::take) {
                    nearest[e] = Some(contact.nearest(pose.rotation));
                    list.facet[e] = contact.facet;
                    taken[nth] = true;
                }
            }
        }
        // What is left on lost contacts is forgotten.
        for (nth, e) in group.enumerate() {
            if !taken[nth] {
                list.facet[e] = NO_FACET;
                list.active[e] = 0;
                list.memory[memory_of(list.slots, e)].fill(0.0);
            }
        }
        entry += CONTACTS_PER_SPHERE;
    }
}

fn same_facet(_: &Mesh, old: Option<u32>, contact: &MeshContact) -> bool {
    old == Some(contact.facet)
}

fn adjacent_facet(mesh: &Mesh, old: Option<u32>, contact: &MeshContact) -> bool {
    old.is_some_and(|f| f != NO_FACET && mesh.adjacent(f, contact.facet))
}

fn free_entry(_: &Mesh, old: Option<u32>, _: &MeshContact) -> bool {
    old.is_none()
}
