//! Which of the listed pairs act.
//!
//! Of the pairs that touch when a list is made, a flowing bed keeps a half to two thirds in contact at any
//! moment. The others are told by their gap alone.

use std::mem::MaybeUninit;

use super::lanes::Lanes;
use super::pairs::{PairKernel, Run};
use crate::contact_stage::CHUNK;
use crate::neighbour::search::{SET_BITS, lowest_bits};

/// Most pairs of a run that act, and a block to fill the last one up.
const MOST: usize = CHUNK + 8;

/// Room for the pairs of a run that are to be looked at, then for those that act: nothing is written that is not read.
pub(super) struct Room {
    pair: [MaybeUninit<u32>; MOST],
    first: [MaybeUninit<u32>; MOST],
    second: [MaybeUninit<u32>; MOST],
}

/// Pairs of a run that touch, or did when they were computed last: where their numbers begin, which is four times
/// their place. Filled up to a whole block with one pair that does neither.
pub(super) struct Acting<'r> {
    /// In the run.
    pub(super) pair: &'r [u32],
    /// Of the spheres.
    pub(super) first: &'r [u32],
    pub(super) second: &'r [u32],
    pub(super) count: usize,
}

impl Room {
    pub(super) const EMPTY: Self = {
        let none = [MaybeUninit::uninit(); MOST];
        Self { pair: none, first: none, second: none }
    };

    /// The numbers before `whole`.
    ///
    /// # Safety
    /// They were written.
    unsafe fn written(of: &[MaybeUninit<u32>; MOST], whole: usize) -> &[u32] {
        // SAFETY: by the caller; it is no more than the room has.
        unsafe { std::slice::from_raw_parts(of[..whole].as_ptr().cast::<u32>(), whole) }
    }

    /// Put where the numbers of those pairs of the `k`-th block begin that `order` picks, from `count` on.
    #[inline(always)]
    fn pack<V: Lanes>(
        &mut self,
        count: usize,
        (k, first, second): (usize, &[u32; 8], &[u32; 8]),
        order: &[u8; 8],
    ) {
        if let Some(to) = self.pair[count..].first_chunk_mut() {
            V::pack_own_fours(8 * k as u32, order, to);
        }
        for (from, to) in [(first, &mut self.first), (second, &mut self.second)] {
            if let Some(to) = to[count..].first_chunk_mut() {
                V::pack_fours(from, order, to);
            }
        }
    }

    /// Fill up to a whole block, from `count` on, with one pair.
    #[inline(always)]
    fn fill_up(&mut self, count: usize, [pair, first, second]: [u32; 3]) {
        let whole = count.next_multiple_of(8);
        let to = [(&mut self.pair, pair), (&mut self.first, first), (&mut self.second, second)];
        for (to, place) in to {
            to[count..whole].fill(MaybeUninit::new(4 * place));
        }
    }
}

impl PairKernel<'_> {
    /// Look which pairs of a run act: those that are marked, and of the others those that touch, which are marked now. What
    /// feels nothing and remembers nothing costs no more than this look; marks of pairs that touch no more are taken away
    /// where they are computed.
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
        let mut acts = [0; CHUNK / 8];
        // SAFETY: by the caller.
        unsafe { self.look::<V>((first, second), active, run.pairs, (&mut acts, room)) };
        let (mut count, mut idle) = (0, 0);
        for (k, (first, second)) in first.iter().zip(second).enumerate().take(active.len()) {
            let acts = acts[k];
            room.pack::<V>(count, (k, first, second), &SET_BITS[usize::from(acts)]);
            count += acts.count_ones() as usize;
            if acts != u8::MAX {
                idle = 8 * k + acts.trailing_ones() as usize;
            }
        }
        // As many lanes are idle as a last block lacks.
        let at = |places: &[u32]| places.get(idle).copied().unwrap_or_default();
        room.fill_up(count, [idle as u32, at(run.first), at(run.second)]);
        let whole = count.next_multiple_of(8);
        // SAFETY: every number before `count` was packed, the others before `whole` were filled in.
        unsafe {
            Acting {
                pair: Room::written(&room.pair, whole),
                first: Room::written(&room.first, whole),
                second: Room::written(&room.second, whole),
                count,
            }
        }
    }

    /// Tell which of so many pairs act, by bits of each block, and mark those that do anew.
    ///
    /// # Safety
    /// Every place is that of a sphere.
    #[inline(always)]
    unsafe fn look<V: Lanes>(
        &self,
        (first, second): (&[[u32; 8]], &[[u32; 8]]),
        active: &mut [[u8; 8]],
        pairs: usize,
        (acts, room): (&mut [u8; CHUNK / 8], &mut Room),
    ) {
        let (whole, rest) = (pairs / 8, lowest_bits(pairs % 8));
        let mut still = 0;
        let blocks = first.iter().zip(second).zip(&*active).zip(&mut *acts);
        for (k, (((first, second), active), acts)) in blocks.enumerate() {
            // A byte of 0 or 1 each: their bits side by side.
            let before = u64::from_le_bytes(*active).wrapping_mul(0x0102_0408_1020_4080) >> 56;
            *acts = before as u8;
            let others = !*acts & if k < whole { u8::MAX } else { rest };
            room.pack::<V>(still, (k, first, second), &SET_BITS[usize::from(others)]);
            still += others.count_ones() as usize;
        }
        // Any spheres will do for lanes that do not count.
        let any = |places: &[[u32; 8]]| places.first().map_or(0, |eight| eight[0]);
        room.fill_up(still, [0, any(first), any(second)]);
        let whole = still.next_multiple_of(8);
        // SAFETY: every number before `still` was packed, the others before `whole` were filled in; by the caller.
        let [pair, first, second] =
            unsafe { [&room.pair, &room.first, &room.second].map(|of| Room::written(of, whole)) };
        let blocks = first.as_chunks().0.iter().zip(second.as_chunks().0);
        for (k, (first, second)) in blocks.enumerate() {
            // SAFETY: as above.
            let mut touching = unsafe { self.near::<V, 1>(first, second) };
            touching &= lowest_bits(still - 8 * k);
            while touching != 0 {
                let place = pair[8 * k + touching.trailing_zeros() as usize] as usize / 4;
                acts[place / 8] |= 1 << (place % 8);
                active[place / 8][place % 8] = 1;
                touching &= touching - 1;
            }
        }
    }
}
