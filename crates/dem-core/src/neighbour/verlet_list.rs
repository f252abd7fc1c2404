//! The Verlet list: pairs in reach, touching ones first, with what their contacts remember.
//!
//! Pairs that touch (or nearly so) when the list is made come first, then those that are merely
//! near; both runs are sorted by their earlier sphere, the one that lies first in memory: it owns the
//! pair. So all pairs of a sphere are computed once those are that it owns. (Which sphere of a pair is
//! `first` is a matter of names.) What a contact remembers is stored in one piece, so that any eight
//! pairs can be computed together. The list also holds the touching pairs by their later sphere, so
//! that any run of spheres can collect its forces in the order of the list, whichever thread computed
//! them.

use crate::contact_stage::CHUNK;
use crate::particles::Column;
use crate::spheres::Seats;

/// Pairs in one block of the list.
pub(crate) const LANES: usize = 8;

/// Place of number `slot` of contact `pair`.
#[inline(always)]
pub(crate) fn memory_index(slots: usize, pair: usize, slot: usize) -> usize {
    pair * slots + slot
}

/// Places of all that contact `pair` remembers.
#[inline(always)]
pub(crate) fn memory_of(slots: usize, pair: usize) -> std::ops::Range<usize> {
    pair * slots..(pair + 1) * slots
}

/// Round up to whole blocks.
pub(crate) fn whole_blocks(pairs: usize) -> usize {
    pairs.div_ceil(LANES) * LANES
}

/// The list.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PairList {
    /// Numbers that a contact remembers.
    pub(crate) slots: usize,
    /// Spheres of each pair; the places between the two runs are padding, which repeats a pair.
    pub(crate) first: Column<u32>,
    pub(crate) second: Column<u32>,
    /// 1 for a pair in contact.
    pub(crate) active: Column<u8>,
    /// What contacts remember, contact by contact.
    pub(crate) memory: Column<f64>,
    /// Number of touching pairs: they are `0..touching`.
    pub(crate) touching: usize,
    /// Near pairs are `near_begin..first.len()`.
    pub(crate) near_begin: usize,
    /// First touching, first near pair that each sphere owns.
    pub(crate) touching_start: Vec<u32>,
    pub(crate) near_start: Vec<u32>,
    /// Touching pairs by the body of their later sphere, and where those of each body's first sphere begin: the pair, twice,
    /// plus one where the later sphere is its second, and that sphere.
    pub(crate) later_start: Vec<u32>,
    pub(crate) by_later: Vec<[u32; 2]>,
    /// Most bodies from that of the owner of the first pair of a chunk to that of any sphere in the chunk, both included.
    pub(crate) window: usize,
}

/// A pair found by the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Found {
    pub(crate) first: u32,
    pub(crate) second: u32,
    pub(crate) touching: bool,
}

impl Found {
    /// Spheres `i` and `j` in the order of their names, `ids` by place.
    #[inline(always)]
    pub(crate) fn pair(ids: &[u32], i: u32, j: u32, touching: bool) -> Self {
        let (first, second) = if ids[i as usize] < ids[j as usize] { (i, j) } else { (j, i) };
        Self { first, second, touching }
    }

    fn owner(&self) -> usize {
        self.first.min(self.second) as usize
    }
}

impl PairList {
    /// The sphere that owns a pair.
    pub(crate) fn owner(&self, pair: usize) -> usize {
        self.first[pair].min(self.second[pair]) as usize
    }

    pub(crate) fn near(&self) -> std::ops::Range<usize> {
        self.near_begin..self.first.len()
    }

    /// Fill the list with `found`, and take over what the contacts of `old` remember. `new_place`
    /// tells where a sphere of `old` is now, if places changed.
    pub(crate) fn fill(
        &mut self,
        spheres: usize,
        slots: usize,
        found: &[Vec<Found>],
        old: &PairList,
        new_place: Option<&[u32]>,
        seats: Seats<'_>,
    ) {
        self.slots = slots;
        for start in [&mut self.touching_start, &mut self.near_start] {
            start.clear();
            start.resize(spheres + 1, 0);
        }
        for f in found.iter().flatten() {
            let start = if f.touching { &mut self.touching_start } else { &mut self.near_start };
            start[f.owner()] += 1;
        }
        let touching = ends_from_counts(&mut self.touching_start, 0);
        self.touching = touching;
        self.near_begin = whole_blocks(touching);
        let total = ends_from_counts(&mut self.near_start, self.near_begin);
        for places in [&mut self.first, &mut self.second] {
            places.clear();
            places.resize(total, 0);
        }
        // From the back, so that pairs keep the order in which they were found and the counters
        // end at the beginnings.
        for f in found.iter().rev().flat_map(|f| f.iter().rev()) {
            let start = if f.touching { &mut self.touching_start } else { &mut self.near_start };
            let place = &mut start[f.owner()];
            *place -= 1;
            self.first[*place as usize] = f.first;
            self.second[*place as usize] = f.second;
        }
        // Padding repeats the last pair, so that whoever reads it reads nothing else than that pair.
        if let Some(last) = touching.checked_sub(1) {
            for places in [&mut self.first, &mut self.second] {
                let place = places[last];
                places[touching..self.near_begin].fill(place);
            }
        }
        self.sort_by_later(seats);
        self.active.clear();
        self.active.resize(total, 0);
        self.memory.clear();
        self.memory.resize(whole_blocks(total) * slots, 0.0);
        self.take_over(spheres, old, new_place);
    }

    /// Sort the touching pairs by the body of their later sphere, those of one body as in the list.
    pub(crate) fn sort_by_later(&mut self, seats: Seats<'_>) {
        self.later_start.clear();
        self.later_start.resize(self.touching_start.len(), 0);
        let pairs = || self.first[..self.touching].iter().zip(&self.second[..self.touching]);
        let (mut begin, mut window) = (0, 0);
        for (pair, (&a, &b)) in pairs().enumerate() {
            if pair.is_multiple_of(CHUNK) {
                begin = seats.body(a.min(b) as usize);
            }
            let body = seats.body(a.max(b) as usize);
            self.later_start[seats.first(body)] += 1;
            window = window.max(body - begin + 1);
        }
        self.window = window;
        let total = ends_from_counts(&mut self.later_start, 0);
        self.by_later.clear();
        self.by_later.resize(total, [0; 2]);
        for (pair, (&a, &b)) in pairs().enumerate().rev() {
            let later = a.max(b);
            let place = &mut self.later_start[seats.first(seats.body(later as usize))];
            *place -= 1;
            self.by_later[*place as usize] = [2 * pair as u32 + u32::from(b > a), later];
        }
    }

    /// Most places from the owner of the first near pair of a chunk to any sphere in the chunk, both included.
    pub(crate) fn near_window(&self) -> usize {
        let near = self.near();
        let chunks = self.first[near.clone()].chunks(CHUNK).zip(self.second[near].chunks(CHUNK));
        let windows = chunks.filter_map(|(first, second)| {
            let latest = first.iter().chain(second).max()?;
            Some((latest - first[0].min(second[0])) as usize + 1)
        });
        windows.max().unwrap_or_default()
    }

    /// Drop what `sort_by_later` made.
    pub(crate) fn forget_later(&mut self) {
        self.by_later.clear();
        self.later_start.clear();
        self.window = 0;
    }

    fn take_over(&mut self, spheres: usize, old: &PairList, new_place: Option<&[u32]>) {
        if old.touching_start.len() != spheres + 1 {
            return;
        }
        let now = |place: u32| new_place.map_or(place, |n| n[place as usize]);
        for (was, _) in old.active.iter().enumerate().filter(|(_, active)| **active != 0) {
            let (a, b) = (now(old.first[was]), now(old.second[was]));
            let Some(pair) = self.find(a, b) else { continue };
            self.active[pair] = 1;
            self.memory[memory_of(self.slots, pair)]
                .copy_from_slice(&old.memory[memory_of(self.slots, was)]);
        }
    }

    /// Place of the pair (`first`, `second`).
    pub(crate) fn find(&self, first: u32, second: u32) -> Option<usize> {
        let owner = first.min(second) as usize;
        let runs = [&self.touching_start, &self.near_start];
        runs.into_iter().find_map(|start| {
            (start[owner] as usize..start[owner + 1] as usize)
                .find(|&p| self.first[p] == first && self.second[p] == second)
        })
    }
}

/// Turn counts into ends (to be counted down to beginnings); the last entry is the total.
fn ends_from_counts(counts: &mut [u32], begin: usize) -> usize {
    let mut sum = begin as u32;
    for c in counts.iter_mut() {
        sum += *c;
        *c = sum;
    }
    sum as usize
}
