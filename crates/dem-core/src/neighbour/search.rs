//! The search for pairs in reach of each other, eight candidates at a time.

use crate::neighbour::Period;
use crate::neighbour::cell_list::CellList;
use crate::neighbour::verlet_list::{Found, LANES};
use crate::particles::{Bodies, Column, Record};
use crate::simd::Level;
use crate::world::Members;

/// What the search for pairs reads.
pub(crate) struct Search<'a> {
    pub(crate) cells: &'a CellList,
    pub(crate) bodies: &'a Bodies,
    /// The spheres of clumps, if there are clumps.
    pub(crate) members: Option<&'a Members>,
    /// Coordinates and radii of those spheres, with room for one more vector at the end.
    pub(crate) spheres: &'a [Column<f64>; 4],
    pub(crate) range: f64,
    /// What each body may move.
    pub(crate) reserve: &'a [f64],
    /// The same in the order of the cells, with room for one more vector at the end.
    pub(crate) sorted_reserve: &'a [f64],
    /// Largest gap across which anything can act.
    pub(crate) reach: f64,
    pub(crate) margin: f64,
    pub(crate) period: Option<Period>,
    pub(crate) level: Level,
}

/// Candidates of a body that are kept before they are looked at.
const CANDIDATES: usize = 512;

/// Places of the set bits among eight, the lowest first; the rest is of no account.
pub(crate) const SET_BITS: [[u8; LANES]; 256] = {
    let (mut table, mut bits) = ([[0; LANES]; 256], 0);
    while bits < 256 {
        let (mut lane, mut set) = (0, 0);
        while lane < LANES {
            if bits >> lane & 1 != 0 {
                table[bits][set] = lane as u8;
                set += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
};

/// The bits of the first `count` lanes, of all for more of them.
#[inline(always)]
pub(crate) fn lowest_bits(count: usize) -> u8 {
    if count >= LANES { u8::MAX } else { (1u8 << count) - 1 }
}

/// Marks a candidate that counts as touching.
const TOUCHES: u32 = 1 << 31;

/// Bodies in reach of one, with a mark on those that touch.
struct Candidates {
    places: [u32; CANDIDATES],
    count: usize,
    /// Their pairs, those that touch and those that are near, before they are told.
    pairs: [[[u32; 2]; CANDIDATES]; 2],
}

impl Candidates {
    const NONE: Self = Self { places: [0; CANDIDATES], count: 0, pairs: [[[0; 2]; CANDIDATES]; 2] };

    fn is_full(&self) -> bool {
        self.count + LANES > CANDIDATES
    }
}

impl Search<'_> {
    /// Pairs of the bodies at these places with those behind them.
    #[inline(always)]
    pub(crate) fn pairs_of(&self, places: std::ops::Range<usize>, found: &mut Found) {
        let (cells, order) = (self.cells, self.cells.order_and_more());
        let most = 0.5 * (self.range - self.reach);
        let (mut own, mut candidates) = (places.start, Candidates::NONE);
        cells.for_each_candidate(
            places,
            #[inline(always)]
            |k| self.sorted_reserve[k] + most + self.reach,
            self.period,
            #[inline(always)]
            |k, row| {
                if k != own {
                    self.keep_all(own, &mut candidates, found);
                    own = k;
                }
                let (pi, mut begin) = (&cells.sorted[k], row.start);
                let gaps = [self.sorted_reserve[k] + self.reach, self.margin];
                while begin < row.end {
                    let left = row.end - begin;
                    let (columns, period) = (&cells.columns, self.period);
                    let more = self.sorted_reserve[begin..].first_chunk();
                    let [near, touching] =
                        crate::simd::in_reach(self.level, pi, (columns, more), begin, gaps, period);
                    // All eight are written and the next ones overwrite what does not count, so that nothing branches on
                    // the bits.
                    let to = candidates.places[candidates.count..].first_chunk_mut();
                    if let (Some(to), Some(of)) = (to, order[begin..].first_chunk()) {
                        let marks = [near & lowest_bits(left), touching];
                        candidates.count += crate::simd::keep_marked(self.level, of, marks, to);
                    }
                    if candidates.is_full() {
                        self.keep_all(k, &mut candidates, found);
                    }
                    begin += LANES;
                }
            },
        );
        self.keep_all(own, &mut candidates, found);
    }

    /// Keep the pairs of the body at sorted place `k` with its candidates.
    #[inline(always)]
    fn keep_all(&self, k: usize, candidates: &mut Candidates, found: &mut Found) {
        let (own, ids) = (self.cells.order_and_more()[k], &self.bodies.id);
        let Candidates { places, count, pairs } = candidates;
        let marked = &places[..std::mem::take(count)];
        if let Some(m) = self.members {
            for place in marked {
                self.spheres_of(m, own, place & !TOUCHES, found);
            }
            return;
        }
        // Each is written to both and counts in one, so that nothing branches on the marks.
        let [touching, near] = pairs;
        let (mut count, mut all) = (0, 0);
        for place in marked {
            let pair = Found::pair(ids, own, place & !TOUCHES);
            (touching[count], near[all - count]) = (pair, pair);
            count += (place >> 31) as usize;
            all += 1;
        }
        found.touching.extend_from_slice(&touching[..count]);
        found.near.extend_from_slice(&near[..all - count]);
    }

    /// Keep the pairs of spheres of two bodies that are in reach of each other: the spheres of the first that are in reach of the
    /// second as a whole are held against eight of its spheres at a time.
    #[inline(always)]
    fn spheres_of(&self, m: &Members, i: u32, j: u32, found: &mut Found) {
        let own = |body: u32| m.first[body as usize] as usize..m.first[body as usize + 1] as usize;
        let whole = &self.bodies.position[j as usize];
        let range = self.reserve[i as usize] + self.reserve[j as usize] + self.reach;
        for (begin, valid) in eights(own(i)) {
            let [marks, _] = self.eight_in_reach(whole, begin, range);
            for lane in set_bits(marks & valid) {
                let first = begin + lane;
                for (begin, valid) in eights(own(j)) {
                    let [near, touching] = self.eight_in_reach(&m.position[first], begin, range);
                    for lane in set_bits(near & valid) {
                        let second = (begin + lane) as u32;
                        let touching = touching >> lane & 1 != 0;
                        found.push(Found::pair(&m.id, first as u32, second), touching);
                    }
                }
            }
        }
    }

    /// Which of the eight spheres from `begin` on are in reach of a sphere, and which count as touching it.
    #[inline(always)]
    fn eight_in_reach(&self, own: &Record, begin: usize, range: f64) -> [u8; 2] {
        let gaps = [range, self.margin];
        crate::simd::in_reach(self.level, own, (self.spheres, None), begin, gaps, self.period)
    }
}

/// Places eight at a time: where they begin, and which of them count.
#[inline(always)]
fn eights(places: std::ops::Range<usize>) -> impl Iterator<Item = (usize, u8)> {
    let mut begin = places.start;
    std::iter::from_fn(
        #[inline(always)]
        move || {
            let now = begin;
            begin += LANES;
            (now < places.end).then(|| (now, lowest_bits(places.end - now)))
        },
    )
}

/// Places of the set bits, the lowest first.
#[inline(always)]
fn set_bits(mut bits: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(
        #[inline(always)]
        move || {
            let lane = bits.trailing_zeros() as usize;
            let any = bits != 0;
            bits &= bits.wrapping_sub(1);
            any.then_some(lane)
        },
    )
}
