//! The Verlet list: pairs in reach, touching ones first, with what their contacts remember.
//!
//! Pairs that touch (or nearly so) when the list is made come first, then those that are merely
//! near; both runs are sorted by their earlier sphere, the one that lies first in memory: it owns the
//! pair. So all pairs of a sphere are computed once those are that it owns. (Which sphere of a pair is
//! `first` is a matter of names.) What a contact remembers is stored in one piece, so that any eight
//! pairs can be computed together. The list also holds the touching pairs by their later sphere, so
//! that any run of spheres can collect its forces in the order of the list, whichever thread computed
//! them.

use std::sync::atomic::Ordering;

use crate::contact_stage::CHUNK;
use crate::particles::Column;
use crate::spheres::Seats;
use crate::threads::{EVEN, NO_PARTS, Stage, Team, cells, cut};

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

/// Pairs found by the search, each the places of two spheres in the order of their names.
#[derive(Debug, Clone, Default)]
pub(crate) struct Found {
    /// Those that count as touching.
    pub(crate) touching: Vec<[u32; 2]>,
    /// Those that are merely near.
    pub(crate) near: Vec<[u32; 2]>,
}

impl Found {
    /// Spheres `i` and `j` in the order of their names, `ids` by place.
    #[inline(always)]
    pub(crate) fn pair(ids: &[u32], i: u32, j: u32) -> [u32; 2] {
        if ids[i as usize] < ids[j as usize] { [i, j] } else { [j, i] }
    }

    pub(crate) fn push(&mut self, pair: [u32; 2], touching: bool) {
        (if touching { &mut self.touching } else { &mut self.near }).push(pair);
    }

    /// Begin anew, with the room that so many bodies usually need.
    pub(crate) fn begin(&mut self, bodies: usize) {
        for pairs in [&mut self.touching, &mut self.near] {
            pairs.clear();
            pairs.reserve(3 * bodies);
        }
    }
}

/// The pairs of one kind.
type Kind = fn(&Found) -> &Vec<[u32; 2]>;

/// The earlier of two spheres owns their pair.
fn owner(pair: [u32; 2]) -> usize {
    pair[0].min(pair[1]) as usize
}

/// Numbers that a contact of the usual laws remembers.
const RECORD: usize = 4;

/// No pair.
const NONE: u64 = u64::MAX;

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
        found: &[Found],
        (old, new_place): (&PairList, Option<&[u32]>),
        seats: Seats<'_>,
        team: &Team,
    ) {
        self.slots = slots;
        let all = |of: Kind| found.iter().map(|f| of(f).len()).sum::<usize>();
        self.touching = all(|f| &f.touching);
        self.near_begin = whole_blocks(self.touching);
        let total = self.near_begin + all(|f| &f.near);
        for places in [&mut self.first, &mut self.second] {
            places.make_room(total, 0);
        }
        let begin = self.near_begin;
        let [first, second] = [&mut self.first, &mut self.second].map(|v| v.split_at_mut(begin));
        let touching =
            Placing { start: &mut self.touching_start, first: first.0, second: second.0 };
        let near = Placing { start: &mut self.near_start, first: first.1, second: second.1 };
        let of: [Kind; 2] = [|f| &f.touching, |f| &f.near];
        let (begins, mut both) = ([0, begin], [touching, near]);
        self.active.make_room(total, 0);
        self.memory.make_room(whole_blocks(total) * slots, 0.0);
        let place = Stage {
            count: 2,
            shares: EVEN,
            parts: cut(&mut both, 1),
            work: |kind: usize, placing: &mut [Placing<'_>]| {
                placing[0].place(spheres, found, of[kind], begins[kind]);
            },
        };
        // Until it is known, the first number that a pair remembers tells which pair of the old list it was.
        let forget = Stage {
            count: total.div_ceil(CHUNK),
            shares: EVEN,
            parts: cut(&mut self.memory, CHUNK * slots),
            work: |_, memory: &mut [f64]| {
                memory.iter_mut().step_by(slots).for_each(|was| *was = f64::from_bits(NONE));
            },
        };
        team.run(&[&place, &forget]);
        // Padding repeats the last pair, so that whoever reads it reads nothing else than that pair.
        if let Some(last) = self.touching.checked_sub(1) {
            for places in [&mut self.first, &mut self.second] {
                let place = places[last];
                places[self.touching..begin].fill(place);
            }
        }
        self.take_over(spheres, (old, new_place), seats, team);
    }

    /// Take over what the contacts of `old` remember, and sort the touching pairs by their later spheres.
    fn take_over(
        &mut self,
        spheres: usize,
        (old, new_place): (&PairList, Option<&[u32]>),
        seats: Seats<'_>,
        team: &Team,
    ) {
        let (total, slots) = (self.first.len(), self.slots);
        let mut memory = std::mem::take(&mut self.memory);
        let now = |place: u32| new_place.map_or(place, |n| n[place as usize]);
        let known = if old.touching_start.len() == spheres + 1 { &old.active[..] } else { &[] };
        let mut by_later = std::mem::take(&mut self.by_later);
        let mut later_start = std::mem::take(&mut self.later_start);
        let mut window = 0;
        {
            let (list, came_from) = (&*self, cells(&mut memory));
            let sort = Stage {
                count: 1,
                shares: EVEN,
                parts: (
                    cut(std::slice::from_mut(&mut by_later), 1),
                    cut(std::slice::from_mut(&mut later_start), 1),
                    cut(std::slice::from_mut(&mut window), 1),
                ),
                work: |_, (pairs, start, window): LaterParts<'_>| {
                    window[0] = list.by_later(&mut pairs[0], &mut start[0], seats);
                },
            };
            // Each contact of the old list finds its pair, if it is listed still: no two find the same.
            let find = Stage {
                count: known.len().div_ceil(CHUNK),
                shares: EVEN,
                parts: NO_PARTS,
                work: |c: usize, ()| {
                    let begin = c * CHUNK;
                    let marks = &known[begin..(begin + CHUNK).min(known.len())];
                    // Put side by side first: every other pair touches, which nobody foretells.
                    let (mut acting, mut count) = ([0u16; CHUNK], 0);
                    for (k, mark) in marks.iter().enumerate() {
                        acting[count] = k as u16;
                        count += usize::from(*mark != 0);
                    }
                    for k in &acting[..count] {
                        let was = begin + usize::from(*k);
                        let (a, b) = (now(old.first[was]), now(old.second[was]));
                        if let Some(pair) = list.find(a, b) {
                            came_from[slots * pair].store(was as u64, Ordering::Relaxed);
                        }
                    }
                },
            };
            team.run(&[&sort, &find]);
        }
        (self.by_later, self.later_start, self.window) = (by_later, later_start, window);
        let parts = (cut(&mut self.active, CHUNK), cut(&mut memory, CHUNK * slots));
        team.each(total.div_ceil(CHUNK), parts, |_, (active, memory): (&mut [u8], &mut [f64])| {
            // Behind the last pair nothing is remembered.
            memory[active.len() * slots..].fill(0.0);
            if slots == RECORD {
                // As long as a record: one load and one store, and nothing that branches on whether a pair is new.
                let old = old.memory.as_chunks::<RECORD>().0;
                let own = memory.as_chunks_mut::<RECORD>().0;
                for (active, memory) in active.iter_mut().zip(own) {
                    let was = memory[0].to_bits();
                    *active = u8::from(was != NONE);
                    *memory = *old.get(was as usize).unwrap_or(&[0.0; RECORD]);
                }
                return;
            }
            for (active, memory) in active.iter_mut().zip(memory.chunks_exact_mut(slots)) {
                let was = memory[0].to_bits();
                *active = u8::from(was != NONE);
                match was {
                    NONE => memory.fill(0.0),
                    was => memory.copy_from_slice(&old.memory[memory_of(slots, was as usize)]),
                }
            }
        });
        self.memory = memory;
    }

    /// Sort the touching pairs by the body of their later sphere, those of one body as in the list.
    pub(crate) fn sort_by_later(&mut self, seats: Seats<'_>) {
        let (mut pairs, mut start) =
            (std::mem::take(&mut self.by_later), std::mem::take(&mut self.later_start));
        self.window = self.by_later(&mut pairs, &mut start, seats);
        (self.by_later, self.later_start) = (pairs, start);
    }

    /// The touching pairs by the body of their later sphere, and where those of each begin; returns the window.
    fn by_later(
        &self,
        by_later: &mut Vec<[u32; 2]>,
        later_start: &mut Vec<u32>,
        seats: Seats<'_>,
    ) -> usize {
        later_start.clear();
        later_start.resize(self.touching_start.len(), 0);
        let pairs = || self.first[..self.touching].iter().zip(&self.second[..self.touching]);
        let (mut begin, mut window) = (0, 0);
        for (pair, (&a, &b)) in pairs().enumerate() {
            if pair.is_multiple_of(CHUNK) {
                begin = seats.body(a.min(b) as usize);
            }
            let body = seats.body(a.max(b) as usize);
            later_start[seats.first(body)] += 1;
            window = window.max(body - begin + 1);
        }
        let total = ends_from_counts(later_start, 0);
        by_later.resize(total, [0; 2]);
        for (pair, (&a, &b)) in pairs().enumerate().rev() {
            let later = a.max(b);
            let place = &mut later_start[seats.first(seats.body(later as usize))];
            *place -= 1;
            by_later[*place as usize] = [2 * pair as u32 + u32::from(b > a), later];
        }
        window
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

    /// Place of the pair (`first`, `second`).
    pub(crate) fn find(&self, first: u32, second: u32) -> Option<usize> {
        let owner = first.min(second) as usize;
        let runs = [&self.touching_start, &self.near_start];
        for start in runs {
            let (mut begin, end) = (start[owner] as usize, start[owner + 1] as usize);
            while begin < end {
                if let Some(place) = self.among_eight(begin, end - begin, [first, second]) {
                    return Some(place);
                }
                begin += LANES;
            }
        }
        None
    }

    /// Place of a pair among the first `count` of eight from `begin` on, if it is one of them.
    #[inline(always)]
    fn among_eight(&self, begin: usize, count: usize, [a, b]: [u32; 2]) -> Option<usize> {
        let (first, second) = (&self.first[begin..], &self.second[begin..]);
        let chunks = (first.first_chunk::<LANES>(), second.first_chunk::<LANES>());
        let (Some(first), Some(second)) = chunks else {
            let mut all = first.iter().zip(second).take(count);
            return all.position(|pair| pair == (&a, &b)).map(|nth| begin + nth);
        };
        // Once at most, so that nothing branches on where it is.
        let mut nth = 0;
        for lane in 0..LANES {
            let here = (first[lane] == a) & (second[lane] == b) & (lane < count);
            nth += if here { lane + 1 } else { 0 };
        }
        (nth != 0).then(|| begin + nth - 1)
    }
}

/// The pairs by later sphere, where those of each begin, and the window, each alone in its slice.
type LaterParts<'a> = (&'a mut [Vec<[u32; 2]>], &'a mut [Vec<u32>], &'a mut [usize]);

/// One of the two runs of the list, to be filled.
struct Placing<'a> {
    start: &'a mut Vec<u32>,
    first: &'a mut [u32],
    second: &'a mut [u32],
}

impl Placing<'_> {
    /// Sort what was found of one kind by owners, the first of it to be pair `begin`.
    fn place(&mut self, spheres: usize, found: &[Found], of: Kind, begin: usize) {
        self.start.clear();
        self.start.resize(spheres + 1, 0);
        for pairs in found {
            for pair in of(pairs) {
                self.start[owner(*pair)] += 1;
            }
        }
        ends_from_counts(self.start, begin);
        // From the back, so that pairs keep the order in which they were found and the counters
        // end at the beginnings.
        for pairs in found.iter().rev() {
            for pair in of(pairs).iter().rev() {
                let place = &mut self.start[owner(*pair)];
                *place -= 1;
                let to = *place as usize - begin;
                (self.first[to], self.second[to]) = (pair[0], pair[1]);
            }
        }
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

#[cfg(test)]
impl PairList {
    /// The list of these pairs of spheres that are their own bodies.
    pub(crate) fn of(spheres: usize, found: Found) -> Self {
        let mut list = Self::default();
        let old = (&Self::default(), None);
        let team = Team::new(1);
        list.fill(spheres, 1, &[found], old, Seats::OWN, &team);
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_the_same_for_any_number_of_threads_and_keeps_what_contacts_remember() {
        let spheres = 3000u32;
        // Another list after each turn: pairs go from near to touching and back, and places change.
        let found = |turn: u32| -> Vec<Found> {
            let chunk = |c: u32| {
                let mut found = Found::default();
                for k in 500 * c..500 * (c + 1) {
                    for step in [1, 2, 37].into_iter().filter(|step| k + step < spheres) {
                        let pair = if k % 3 == 0 { [k + step, k] } else { [k, k + step] };
                        found.push(pair, (k + step + turn).is_multiple_of(2));
                    }
                }
                found
            };
            (0..6).map(chunk).collect()
        };
        let turned: Vec<u32> = (0..spheres).rev().collect();
        for slots in [RECORD, 7] {
            let lists = [1, 2, 3].map(|threads| {
                let team = Team::new(threads);
                let (mut old, mut list) = (PairList::default(), PairList::default());
                team.enter(|| {
                    old.fill(3000, slots, &found(0), (&list, None), Seats::OWN, &team);
                    let pairs = (0..old.touching).chain(old.near());
                    for pair in pairs.filter(|pair| pair % 5 != 0) {
                        old.active[pair] = 1;
                        let own = (slots * pair..slots * (pair + 1)).map(|k| k as f64);
                        old.memory[memory_of(slots, pair)]
                            .copy_from_slice(&own.collect::<Vec<_>>());
                    }
                    for (turn, place) in [(1, None), (0, Some(&turned[..]))] {
                        let before = (&old, place);
                        list.fill(3000, slots, &found(turn), before, Seats::OWN, &team);
                    }
                    // Once more without a change of places, for what is remembered.
                    list.fill(3000, slots, &found(1), (&old, None), Seats::OWN, &team);
                });
                (old, list)
            });
            assert!(lists.iter().all(|list| *list == lists[0]));
            let (old, list) = &lists[0];
            let mut remembered = 0;
            for was in (0..old.first.len()).filter(|was| old.active[*was] == 1) {
                let Some(pair) = list.find(old.first[was], old.second[was]) else { continue };
                assert_eq!(list.active[pair], 1);
                let own = [list, old].map(|l| &l.memory[..]);
                assert_eq!(own[0][memory_of(slots, pair)], own[1][memory_of(slots, was)]);
                remembered += 1;
            }
            assert_eq!(list.active.iter().filter(|active| **active == 1).count(), remembered);
            assert!(remembered > 6000, "{remembered}");
        }
    }
}
