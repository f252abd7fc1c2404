//! Which of the listed pairs act.
//!
//! Of the pairs that touch when a list is made, a flowing bed keeps a half to two thirds in contact at any
//! moment. The others are told by their gap alone.

use std::mem::MaybeUninit;

use super::lanes::Lanes;
use super::pairs::{PairKernel, Run};
use crate::contact_stage::CHUNK;
use crate::neighbour::search::{SET_BITS, lowest_bits};

/// Eight bits as bytes.
const BYTES: [[u8; 8]; 256] = {
    let (mut table, mut bits) = ([[0; 8]; 256], 0);
    while bits < 256 {
        let mut lane = 0;
        while lane < 8 {
            table[bits][lane] = (bits >> lane & 1) as u8;
            lane += 1;
        }
        bits += 1;
    }
    table
};

/// Most pairs of a run that act, and a block to fill the last one up.
const MOST: usize = CHUNK + 8;

/// Room for the pairs of a run that act: nothing is written that is not read.
pub(super) struct Room {
    pair: [MaybeUninit<u32>; MOST],
    first: [MaybeUninit<u32>; MOST],
    second: [MaybeUninit<u32>; MOST],
}

impl Room {
    pub(super) const EMPTY: Self = {
        let none = [MaybeUninit::uninit(); MOST];
        Self { pair: none, first: none, second: none }
    };
}

/// Pairs of a run that touch, or did and have something to forget: where their numbers begin, which is four times
/// their place. Filled up to a whole block with one pair that does neither.
pub(super) struct Acting<'r> {
    /// In the run.
    pub(super) pair: &'r [u32],
    /// Of the spheres.
    pub(super) first: &'r [u32],
    pub(super) second: &'r [u32],
    pub(super) count: usize,
}

impl PairKernel<'_> {
    /// Look which pairs of a run act, and mark those that touch. The others feel nothing and remember
    /// nothing, as before, so that they cost no more than this look: a third to a half of them.
    ///
    /// # Safety
    /// Every place in the run is that of a sphere.
    #[inline(always)]
    pub(super) unsafe fn acting<'r, V: Lanes>(
        &self,
        run: &mut Run<'_>,
        room: &'r mut Room,
    ) -> Acting<'r> {
        let (first, _) = run.first.as_chunks::<8>();
        let (second, _) = run.second.as_chunks::<8>();
        let (active, _) = run.active.as_chunks_mut::<8>();
        assert!(8 * active.len() <= CHUNK, "a run is a chunk at most");
        let (mut count, mut idle) = (0, 0);
        let (whole, rest) = (run.pairs / 8, lowest_bits(run.pairs % 8));
        for (k, ((first, second), active)) in first.iter().zip(second).zip(active).enumerate() {
            let valid = if k < whole { u8::MAX } else { rest };
            // SAFETY: by the caller.
            let touching = unsafe { self.near::<V>(first, second) } & valid;
            // A byte of 0 or 1 each: their bits side by side.
            let before = u64::from_le_bytes(*active).wrapping_mul(0x0102_0408_1020_4080) >> 56;
            let acts = touching | before as u8;
            *active = BYTES[usize::from(touching)];
            let order = &SET_BITS[usize::from(acts)];
            if let Some(to) = room.pair[count..].first_chunk_mut() {
                V::pack_own_fours(8 * k as u32, order, to);
            }
            for (from, to) in [(first, &mut room.first), (second, &mut room.second)] {
                if let Some(to) = to[count..].first_chunk_mut() {
                    V::pack_fours(from, order, to);
                }
            }
            count += acts.count_ones() as usize;
            if acts != u8::MAX {
                idle = 8 * k + acts.trailing_ones() as usize;
            }
        }
        // As many lanes are idle as a last block lacks.
        let whole = count.next_multiple_of(8);
        let at = |places: &[u32]| places.get(idle).copied().unwrap_or_default();
        for (to, place) in [
            (&mut room.pair, idle as u32),
            (&mut room.first, at(run.first)),
            (&mut room.second, at(run.second)),
        ] {
            to[count..whole].fill(MaybeUninit::new(4 * place));
        }
        // SAFETY: every number before `count` was packed, the others before `whole` were filled in.
        let written = |of: &'r [MaybeUninit<u32>; MOST]| unsafe {
            std::slice::from_raw_parts(of[..whole].as_ptr().cast::<u32>(), whole)
        };
        Acting {
            pair: written(&room.pair),
            first: written(&room.first),
            second: written(&room.second),
            count,
        }
    }
}
