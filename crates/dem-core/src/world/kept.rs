//! Which wrenches of touching pairs are kept, and the memory that a large bed does without meanwhile.

use super::Scratch;
use crate::neighbour::cell_list::CellList;
use crate::neighbour::verlet_list::PairList;
use crate::neighbour::wall_list::WallList;
use crate::particles::{Column, Record};
use crate::tier::Tier;

/// Bodies above which a bed is large: it holds at no time both what lists are made with and the wrenches of all its contacts, but asks
/// for either memory anew. All others ask for none once they have run for a while.
pub(crate) const LARGE: usize = 200_000;

/// Of which touching pairs wrenches are kept.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Kept {
    /// Of none: the list has changed, or steps went in a sweep.
    #[default]
    None,
    /// Of those that the strips of one pass keep.
    Some,
    All,
}

impl Scratch {
    /// Have room for the wrenches of all touching pairs; in a `large` bed the list-making gives its memory back for it.
    pub(crate) fn keep_all(&mut self, count: usize, large: bool) {
        if large && !self.wrenches.pair_force.has_room(count) {
            self.give_back();
        }
        let none = self.kept != Kept::All;
        for v in self.wrenches.touching() {
            if none {
                // The kernel passes over pairs that neither touch nor touched: theirs begin at zero.
                v.clear();
            }
            v.resize(count, Record::ZERO);
        }
        self.kept = Kept::All;
    }

    /// Give back the memory of what lists are made with and of sweeps.
    fn give_back(&mut self) {
        (self.cells, self.found) = (CellList::default(), Vec::new());
        (self.old_pairs, self.old_walls) = (PairList::default(), WallList::default());
        (self.near_walls, self.sorted_reserve) = (Vec::new(), Column::default());
        self.tiers.fill_with(Tier::default);
        for places in [&mut self.order, &mut self.old_sphere_place, &mut self.new_sphere_place] {
            *places = Vec::new();
        }
    }

    /// Hold as many wrenches of the chunks that the strips keep, and have room for so many: a later step keeps all.
    pub(crate) fn keep_some(&mut self, kept: usize, room: usize) {
        let anew = self.kept != Kept::Some;
        for v in self.wrenches.touching() {
            if anew {
                v.make_empty(room);
            }
            v.resize(kept, Record::ZERO);
        }
        self.kept = Kept::Some;
    }

    /// Give back the memory of the wrenches of all touching pairs, if there is such, of so many.
    pub(crate) fn keep_none(&mut self, count: usize) {
        // What strips keep is far less, and stays.
        if self.wrenches.pair_force.has_room(count / 2) {
            self.wrenches.touching().into_iter().for_each(|v| *v = Column::default());
            self.kept = Kept::None;
        }
    }

    /// Let nobody look at the wrenches of some pairs only.
    pub(crate) fn drop_some(&mut self) {
        if self.kept != Kept::All {
            self.wrenches.touching().into_iter().for_each(Column::clear);
            self.kept = Kept::None;
        }
    }
}
