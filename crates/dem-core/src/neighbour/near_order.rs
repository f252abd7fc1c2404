//! Which near pairs need no look yet.
//!
//! Two spheres that are a gap apart when the list is made cannot touch before both together have moved that far. So the
//! near pairs of a chunk are sorted into classes of their gap, and only those classes are looked at which the spheres
//! of the chunk may have closed meanwhile. In the part of a bed that turns with the drum, whose spheres hardly move in its frame,
//! that is next to none. What is passed over would have been seen not to touch: the bits are the same.

use crate::contact_stage::CHUNK;
use crate::neighbour::verlet_list::{LANES, PairList};
use crate::particles::Column;
use crate::sums::PIECE;
use crate::threads::{Team, cut};

const _: () = assert!(CHUNK <= 1 << u8::BITS, "a byte tells which pair of its chunk");

/// Classes of gaps up to the range of the list.
const CLASSES: usize = 16;

/// Pieces of spheres that are told apart while those of a chunk are gathered.
const TOLD_APART: usize = 64;

/// Near pairs, chunk by chunk by the class of their gap.
#[derive(Debug, Clone, Default)]
pub(crate) struct NearOrder {
    first: Column<u32>,
    second: Column<u32>,
    /// Which pair of its chunk.
    index: Vec<u8>,
    chunks: Vec<NearChunk>,
    /// Near pairs when the order was made.
    pairs: usize,
    /// Classes a metre.
    scale: f64,
}

/// Pieces that a chunk finds room for without asking.
const USUAL_PIECES: usize = 64;

/// One chunk of near pairs.
#[derive(Debug, Clone)]
struct NearChunk {
    /// Where each class of gaps ends.
    ends: [u16; CLASSES],
    /// Pieces of bodies to which its spheres belong; some may stand twice.
    pieces: Vec<u32>,
}

/// Pairs of a chunk that need a look: whole blocks, and which pair of the chunk each is.
pub(crate) struct Looks<'a> {
    pub(crate) first: &'a [[u32; LANES]],
    pub(crate) second: &'a [[u32; LANES]],
    pub(crate) index: &'a [[u8; LANES]],
}

/// How far bodies of each piece have moved at most since the list was made, m, squared.
#[derive(Debug, Clone, Default)]
pub(crate) struct Moved {
    pub(crate) square: Vec<f64>,
    /// How far each body of a piece may move at least before the list is made again, m.
    reserve: Vec<f64>,
}

impl Moved {
    /// Nobody has moved; each body may move by its `reserve`.
    pub(crate) fn reset(&mut self, reserve: &[f64]) {
        self.square.clear();
        self.square.resize(reserve.len().div_ceil(PIECE), 0.0);
        let least = |piece: &[f64]| piece.iter().copied().fold(f64::INFINITY, f64::min);
        self.reserve.clear();
        self.reserve.extend(reserve.chunks(PIECE).map(least));
    }

    /// By how much every body may move on before the list is made again, m.
    pub(crate) fn room(&self) -> f64 {
        let left = self.reserve.iter().zip(&self.square).map(|(own, square)| own - square.sqrt());
        left.fold(f64::INFINITY, f64::min)
    }

    /// If it is not known for so many bodies, they may be anywhere.
    pub(crate) fn cover(&mut self, bodies: usize) {
        let pieces = bodies.div_ceil(PIECE);
        if self.square.len() != pieces {
            self.square.clear();
            self.square.resize(pieces, f64::INFINITY);
            self.reserve.clear();
            self.reserve.resize(pieces, 0.0);
        }
    }
}

impl NearOrder {
    /// Look at all near pairs.
    pub(crate) fn forget(&mut self) {
        self.pairs = 0;
        self.chunks.clear();
    }

    /// Sort the near pairs of a list of this range; `body` tells the bodies of spheres, unless they are those themselves, and
    /// `gaps` the gaps of blocks of pairs.
    pub(crate) fn make(
        &mut self,
        pairs: &PairList,
        range: f64,
        team: &Team,
        body: Option<&[u32]>,
        gaps: impl Fn(&[[u32; LANES]], &[[u32; LANES]], &mut [[f64; LANES]]) + Sync,
    ) {
        let near = pairs.near();
        let (first, second) = (&pairs.first[near.clone()], &pairs.second[near.clone()]);
        let whole = near.len().next_multiple_of(LANES);
        self.pairs = near.len();
        self.scale = CLASSES as f64 / range;
        for places in [&mut self.first, &mut self.second] {
            places.resize(whole, 0);
        }
        self.index.resize(whole, 0);
        let count = near.len().div_ceil(CHUNK);
        if self.chunks.len() < count {
            // Never fewer, and some more, so that a list with a few pairs more asks for no memory.
            self.chunks.resize_with(count + count / 4 + 1, || NearChunk {
                ends: [0; CLASSES],
                pieces: Vec::with_capacity(USUAL_PIECES),
            });
        }
        let parts = (
            cut(&mut self.first, CHUNK),
            cut(&mut self.second, CHUNK),
            cut(&mut self.index, CHUNK),
            cut(&mut self.chunks[..count], 1),
        );
        let scale = self.scale;
        team.each(count, parts, |c, (to_first, to_second, index, chunk)| {
            let own = c * CHUNK..((c + 1) * CHUNK).min(first.len());
            let from = [&first[own.clone()], &second[own]];
            chunk[0].sort(from, scale, body, &gaps, [to_first, to_second], index);
        });
    }

    /// Pairs of chunk `c` that need a look when bodies have moved so far; nothing if all of the list's do.
    pub(crate) fn looks(&self, c: usize, near: usize, moved: &Moved) -> Option<Looks<'_>> {
        if self.pairs != near {
            return None;
        }
        let chunk = self.chunks.get(c)?;
        let farthest = |most: f64, piece: &u32| {
            let square = moved.square.get(*piece as usize).copied().unwrap_or(f64::INFINITY);
            if square > most { square } else { most }
        };
        let most = chunk.pieces.iter().fold(0.0, farthest).sqrt();
        // A hair more, for rounding.
        let class = (2.0 * most * self.scale + 1e-6) as usize;
        let count = usize::from(chunk.ends[class.min(CLASSES - 1)]).next_multiple_of(LANES);
        let begin = c * CHUNK;
        Some(Looks {
            first: self.first[begin..begin + count].as_chunks().0,
            second: self.second[begin..begin + count].as_chunks().0,
            index: self.index[begin..begin + count].as_chunks().0,
        })
    }
}

impl NearChunk {
    /// Sort a chunk of pairs.
    fn sort(
        &mut self,
        from: [&[u32]; 2],
        scale: f64,
        body: Option<&[u32]>,
        gaps: &impl Fn(&[[u32; LANES]], &[[u32; LANES]], &mut [[f64; LANES]]),
        [first, second]: [&mut [u32]; 2],
        index: &mut [u8],
    ) {
        let count = from[0].len();
        let whole = count.next_multiple_of(LANES);
        let mut gap = [[0.0; LANES]; CHUNK / LANES];
        let mut padded = [[0; CHUNK]; 2];
        for (padded, from) in padded.iter_mut().zip(from) {
            padded[..count].copy_from_slice(from);
            padded[count..whole].fill(from[count - 1]);
        }
        let blocks = padded.each_ref().map(|places| places[..whole].as_chunks().0);
        gaps(blocks[0], blocks[1], &mut gap[..whole / LANES]);
        let mut class = [0u8; CHUNK];
        let mut starts = [0u16; CLASSES + 1];
        for (class, gap) in class.iter_mut().zip(gap.as_flattened()).take(count) {
            // What is no number counts as closed.
            *class = ((gap * scale) as usize).min(CLASSES - 1) as u8;
            starts[usize::from(*class) + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        for (k, class) in class.iter().enumerate().take(count) {
            let place = &mut starts[usize::from(*class)];
            let to = usize::from(*place);
            *place += 1;
            (first[to], second[to], index[to]) = (from[0][k], from[1][k], k as u8);
        }
        self.ends.copy_from_slice(&starts[..CLASSES]);
        // Padding repeats the last pair.
        let last = (first[count - 1], second[count - 1], index[count - 1]);
        first[count..].fill(last.0);
        second[count..].fill(last.1);
        index[count..].fill(last.2);
        self.pieces.clear();
        let mut seen = [u32::MAX; TOLD_APART];
        for place in from.into_iter().flatten() {
            let piece = body.map_or(*place, |body| body[*place as usize]) / PIECE as u32;
            let slot = &mut seen[piece as usize % TOLD_APART];
            if *slot != piece {
                *slot = piece;
                self.pieces.push(piece);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::neighbour::verlet_list::Found;

    #[test]
    fn every_pair_that_may_have_closed_is_looked_at_and_most_others_are_not() {
        let (bodies, range) = (901u32, 1e-3);
        let mut state = 7u64;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        // Two kinds of neighbours; the gap of each pair follows from its names.
        let near = (0..bodies - 40).flat_map(|k| [[k, k + 1], [k, k + 40]]).collect();
        let gap_of = |a: u32, b: u32| {
            range * (f64::from(a.wrapping_mul(2654435761) ^ b.wrapping_mul(40503)) / 4294967296.0)
        };
        let pairs = PairList::of(bodies as usize, Found { touching: Vec::new(), near });
        let count = pairs.near().len();
        assert_ne!(count % LANES, 0, "the last block is to be padded");
        let mut order = NearOrder::default();
        order.make(&pairs, range, &Team::new(1), None, |first, second, gaps| {
            let ends = first.as_flattened().iter().zip(second.as_flattened());
            for (gap, (a, b)) in gaps.as_flattened_mut().iter_mut().zip(ends) {
                *gap = gap_of(*a, *b);
            }
        });
        let mut moved = Moved::default();
        moved.reset(&vec![range; bodies as usize]);
        for (k, square) in moved.square.iter_mut().enumerate() {
            // The first half lies nearly still.
            *square = (range * if k < 7 { 1e-3 } else { 0.3 } * random()).powi(2);
        }
        let mut looked = vec![false; count];
        for c in 0..count.div_ceil(CHUNK) {
            let looks = order.looks(c, count, &moved).unwrap();
            for k in looks.index.as_flattened() {
                looked[c * CHUNK + usize::from(*k)] = true;
            }
            let names = looks.first.as_flattened().iter().zip(looks.second.as_flattened());
            for ((a, b), k) in names.zip(looks.index.as_flattened()) {
                let pair = pairs.near_begin + c * CHUNK + usize::from(*k);
                assert_eq!((*a, *b), (pairs.first[pair], pairs.second[pair]));
            }
        }
        let mut spared = 0;
        for (k, looked) in looked.iter().enumerate() {
            let (a, b) = (pairs.first[pairs.near_begin + k], pairs.second[pairs.near_begin + k]);
            let reach: f64 = [a, b].map(|p| moved.square[p as usize / PIECE].sqrt()).iter().sum();
            assert!(*looked || gap_of(a, b) > reach, "{a} and {b}");
            spared += usize::from(!looked);
        }
        assert!(2 * spared > count, "{spared} of {count} are spared");
        // Nothing is known after a restart, and of another list.
        moved.cover(2 * bodies as usize);
        assert_eq!(order.looks(0, count, &moved).unwrap().index.len(), CHUNK / LANES);
        assert!(order.looks(0, count - 1, &moved).is_none());
        order.forget();
        assert!(order.looks(0, count, &moved).is_none());
    }
}
