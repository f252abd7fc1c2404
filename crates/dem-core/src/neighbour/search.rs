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
}

/// Blocks of eight places that are held against the bodies of a cell at a time.
const BLOCKS: usize = 64;

/// Bodies of a cell that are held against a block at once.
const BODIES: usize = 8;

/// Candidates in reach that are kept before they are told.
const CANDIDATES: usize = 2 * LANES * BLOCKS;

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

/// Blocks of eight sorted places around the bodies of a cell.
struct Around {
    /// Where each begins, and which of it count.
    begins: [usize; BLOCKS],
    valid: [u8; BLOCKS],
    /// Where it begins, of a block of the bodies' own level, and behind all places, of one of a coarser level, which counts for every
    /// body.
    own: [usize; BLOCKS],
    count: usize,
    /// Which of each are in reach of each of some bodies, and which touch it.
    marks: [[[u8; 2]; BODIES]; BLOCKS],
}

/// Bodies in reach of others, with a mark on those that touch.
struct Candidates {
    owners: [u32; CANDIDATES],
    places: [u32; CANDIDATES],
    count: usize,
    /// Their pairs, those that touch and those that are near, before they are told.
    pairs: [[[u32; 2]; CANDIDATES]; 2],
}

impl Around {
    const NONE: Self = Self {
        begins: [0; BLOCKS],
        valid: [0; BLOCKS],
        own: [0; BLOCKS],
        count: 0,
        marks: [[[0; 2]; BODIES]; BLOCKS],
    };

    /// Take in a block of places that begins there, and which of them count.
    #[inline(always)]
    fn push(&mut self, (begin, valid): (usize, u8), coarser: bool) {
        self.begins[self.count] = begin;
        self.valid[self.count] = valid;
        self.own[self.count] = if coarser { usize::MAX } else { begin };
        self.count += 1;
    }
}

impl Candidates {
    const NONE: Self = Self {
        owners: [0; CANDIDATES],
        places: [0; CANDIDATES],
        count: 0,
        pairs: [[[0; 2]; CANDIDATES]; 2],
    };
}

impl Search<'_> {
    /// Pairs of the bodies at these places with those behind them, by the instructions of `level`. The bodies of a cell have their
    /// candidates in common: those are looked for once, and each body is held against as many blocks of them.
    #[inline(always)]
    pub(crate) fn pairs_of(&self, level: Level, places: std::ops::Range<usize>, found: &mut Found) {
        let most = 0.5 * (self.range - self.reach);
        let (mut around, mut candidates) = (Around::NONE, Candidates::NONE);
        let mut begin = places.start;
        while begin < places.end {
            let bodies = self.cells.together(begin, places.end, self.period);
            let reserve = if bodies.is_alone() { self.sorted_reserve[begin] } else { most };
            begin = bodies.places.end;
            self.cells.for_each_row(
                &bodies,
                reserve + most + self.reach,
                self.period,
                #[inline(always)]
                |row, coarser| {
                    for block in eights(row) {
                        if around.count == BLOCKS {
                            let places = &bodies.places;
                            self.hold_against(level, places, &mut around, &mut candidates, found);
                        }
                        around.push(block, coarser);
                    }
                },
            );
            self.hold_against(level, &bodies.places, &mut around, &mut candidates, found);
        }
        self.keep_all(level, &mut candidates, found);
    }

    /// Keep which of the places `around` the bodies of a `run` are in reach of each of them and, unless they are of a coarser level,
    /// behind it; then none are around.
    #[inline(always)]
    fn hold_against(
        &self,
        level: Level,
        run: &std::ops::Range<usize>,
        around: &mut Around,
        candidates: &mut Candidates,
        found: &mut Found,
    ) {
        let (order, [x, y, z, r]) = (self.cells.order_and_more(), &self.cells.columns);
        let columns = [x, y, z, r, self.sorted_reserve];
        let Around { begins, valid, own, count, marks } = around;
        let blocks = std::mem::take(count);
        for first in run.clone().step_by(BODIES) {
            let end = run.end.min(first + BODIES);
            let bodies = &self.cells.sorted[first..end];
            let mut ranges = [0.0; BODIES];
            for (range, reserve) in ranges.iter_mut().zip(&self.sorted_reserve[first..end]) {
                *range = reserve + self.reach;
            }
            for (begin, marks) in begins[..blocks].iter().zip(marks.iter_mut()) {
                let others = columns.map(
                    #[inline(always)]
                    |column| eight_from(column, *begin),
                );
                let gaps = (&ranges[..], self.margin);
                crate::simd::in_reach(level, bodies, others, gaps, self.period, marks);
            }
            for (nth, k) in (first..end).enumerate() {
                if candidates.count + LANES * blocks > CANDIDATES {
                    self.keep_all(level, candidates, found);
                }
                let (place, mut count) = (order[k], candidates.count);
                for b in 0..blocks {
                    let [near, touching] = marks[b][nth % BODIES];
                    let near = near & valid[b] & !lowest_bits((k + 1).saturating_sub(own[b]));
                    // All eight are written and the next ones overwrite what does not count, so that nothing branches on the bits.
                    let of = eight_from(order, begins[b]);
                    let to = candidates.places[count..].first_chunk_mut();
                    let owners = candidates.owners[count..].first_chunk_mut::<LANES>();
                    if let (Some(to), Some(owners)) = (to, owners) {
                        *owners = [place; LANES];
                        count += crate::simd::keep_marked(level, of, [near, touching], to);
                    }
                }
                candidates.count = count;
            }
        }
    }

    /// Keep the pairs of bodies with candidates.
    #[inline(always)]
    fn keep_all(&self, level: Level, candidates: &mut Candidates, found: &mut Found) {
        let ids = &self.bodies.id;
        let Candidates { owners, places, count, pairs } = candidates;
        let count = std::mem::take(count);
        let both = owners[..count].iter().zip(&places[..count]);
        if let Some(m) = self.members {
            for (own, place) in both {
                self.spheres_of(level, m, [*own, place & !TOUCHES], found);
            }
            return;
        }
        // Each is written to both and counts in one, so that nothing branches on the marks.
        let [touching, near] = pairs;
        let (mut count, mut all) = (0, 0);
        for (own, place) in both {
            let pair = Found::pair(ids, *own, place & !TOUCHES);
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
    fn spheres_of(&self, level: Level, m: &Members, [i, j]: [u32; 2], found: &mut Found) {
        let own = |body: u32| m.first[body as usize] as usize..m.first[body as usize + 1] as usize;
        let whole = &self.bodies.position[j as usize];
        let range = self.reserve[i as usize] + self.reserve[j as usize] + self.reach;
        for (begin, valid) in eights(own(i)) {
            let [marks, _] = self.eight_in_reach(level, whole, begin, range);
            for lane in set_bits(marks & valid) {
                let first = begin + lane;
                for (begin, valid) in eights(own(j)) {
                    let [near, touching] =
                        self.eight_in_reach(level, &m.position[first], begin, range);
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
    fn eight_in_reach(&self, level: Level, own: &Record, begin: usize, range: f64) -> [u8; 2] {
        let [x, y, z, r] = self.spheres.each_ref().map(
            #[inline(always)]
            |column| eight_from(column, begin),
        );
        let (one, mut marks) = (std::slice::from_ref(own), [[0; 2]]);
        let (others, gaps) = ([x, y, z, r, &[0.0; LANES]], (&[range][..], self.margin));
        crate::simd::in_reach(level, one, others, gaps, self.period, &mut marks);
        marks[0]
    }
}

/// Eight numbers of a column.
#[inline(always)]
fn eight_from<T>(column: &[T], begin: usize) -> &[T; LANES] {
    column[begin..].first_chunk().expect("columns have room for a vector more")
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::MaterialId;
    use crate::simd::widened_for;
    use crate::threads::Team;
    use glam::DVec3;

    const RANGE: f64 = 0.2;
    const MARGIN: f64 = 0.02;

    /// Spheres of radii in this ratio at most, every third of them in a heap that fills a cell with more than is looked at at once.
    fn cloud(count: usize, ratio: f64) -> (Vec<Record>, Vec<f64>) {
        let mut state = 99u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut spheres = Vec::new();
        for k in 0..count {
            let within = if k % 3 == 0 { [0.9; 3] } else { [10.0, 9.0, 8.0] };
            let at = within.map(|most| most * random());
            spheres.push(Record::new(at.into(), 0.5 * ratio.powf(-random())));
        }
        let reserve = (0..count).map(|_| 0.5 * RANGE * random()).collect();
        (spheres, reserve)
    }

    /// Pairs in reach, the lower number first, and whether they count as touching.
    type Told = Vec<(u32, u32, bool)>;

    fn searched(
        (spheres, reserve): &(Vec<Record>, Vec<f64>),
        level: Level,
        period: Option<Period>,
    ) -> Told {
        let mut bodies = Bodies::default();
        for s in spheres {
            let v = DVec3::ZERO;
            bodies.push(s.vector(), s.w, v, 1.0, v, 1.0, MaterialId(0));
        }
        let (mut cells, team) = (CellList::default(), Team::new(1));
        team.enter(|| cells.sort(&bodies.position, RANGE, period, &team));
        let mut sorted: Vec<_> = cells.order().iter().map(|k| reserve[*k as usize]).collect();
        sorted.resize(sorted.len() + LANES, 0.0);
        let search = Search {
            cells: &cells,
            bodies: &bodies,
            members: None,
            spheres: &Default::default(),
            range: RANGE,
            reserve,
            sorted_reserve: &sorted,
            reach: 0.0,
            margin: MARGIN,
            period,
        };
        let mut found = Found::default();
        // In chunks, as the threads of a team do.
        for begin in (0..spheres.len()).step_by(500) {
            let places = begin..(begin + 500).min(spheres.len());
            widened_for(
                level,
                #[inline(always)]
                |level| search.pairs_of(level, places, &mut found),
            );
        }
        let kinds = [(&found.touching, true), (&found.near, false)];
        let mut told: Told = kinds
            .into_iter()
            .flat_map(|(pairs, touching)| pairs.iter().map(move |[a, b]| (*a, *b, touching)))
            .collect();
        told.sort_unstable();
        told
    }

    fn by_brute_force(
        (spheres, reserve): &(Vec<Record>, Vec<f64>),
        period: Option<Period>,
    ) -> Told {
        let mut told = Vec::new();
        for (i, a) in spheres.iter().enumerate() {
            for (j, b) in spheres.iter().enumerate().skip(i + 1) {
                let gap = Period::shortest(period, b.vector() - a.vector()).length() - a.w - b.w;
                if gap < reserve[i] + reserve[j] {
                    told.push((i as u32, j as u32, gap < MARGIN));
                }
            }
        }
        told
    }

    #[test]
    fn pairs_are_those_of_brute_force_in_crowded_cells_and_of_all_sizes() {
        let across = Some(Period { axis: 1, min: 0.0, length: 9.0 });
        let along = Some(Period { axis: 0, min: 0.0, length: 10.0 });
        for ratio in [1.0, 1.7, 7.0] {
            let cloud = cloud(1900, ratio);
            for period in [None, across, along] {
                let expected = by_brute_force(&cloud, period);
                for level in [Level::Portable, Level::detect()] {
                    let told = searched(&cloud, level, period);
                    assert!(told == expected, "{ratio}, {period:?}, {level:?}");
                }
                let near = expected.iter().filter(|(.., touching)| !touching).count();
                assert!(near > 500 && expected.len() > 50_000, "{near} of {}", expected.len());
            }
        }
    }
}
