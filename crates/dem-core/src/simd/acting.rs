//! Which of the listed pairs act.
//!
//! Of the pairs that touch when a list is made, a flowing bed keeps a half to two thirds in contact at any
//! moment. The others are told by their gap alone.

use std::mem::MaybeUninit;

use super::lanes::{Lanes, RECORD};
use super::pairs::{PairKernel, Run};
use crate::contact_stage::{CHUNK, TOGETHER};
use crate::neighbour::search::lowest_bits;

/// Most pairs of a run.
const LONGEST: usize = TOGETHER * CHUNK;

/// The same, and a register of places more, which may be written without being counted.
const MOST: usize = LONGEST + 16;

/// Room for the pairs of a run that are to be looked at, then for those that act: nothing is written that is not read.
pub(super) struct Room {
    pair: [MaybeUninit<u32>; MOST],
    first: [MaybeUninit<u32>; MOST],
    second: [MaybeUninit<u32>; MOST],
}

/// Pairs of a run that touch, or did when they were computed last: where their numbers begin. Filled up to a whole block with
/// those of a pair that does neither, and its spheres or those of a pair that acts.
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

    /// Put where the numbers of those pairs begin that `bits` marks; returns how many they are.
    #[inline(always)]
    fn pack<V: Lanes>(&mut self, blocks: (&[[u32; 8]], &[[u32; 8]]), bits: &[u8]) -> usize {
        V::pack_marked(blocks, bits, [&mut self.pair, &mut self.first, &mut self.second])
    }

    /// Fill up to a whole block, from `count` on, with one pair.
    #[inline(always)]
    fn fill_up(&mut self, count: usize, [pair, first, second]: [u32; 3]) {
        let whole = count.next_multiple_of(8);
        let to = [(&mut self.pair, pair), (&mut self.first, first), (&mut self.second, second)];
        for (to, place) in to {
            to[count..whole].fill(MaybeUninit::new(RECORD * place));
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
        assert!(8 * active.len() <= LONGEST, "a run is some chunks at most");
        let mut acts = [0; LONGEST / 8];
        // SAFETY: by the caller.
        unsafe { self.look::<V>((first, second), active, run.pairs, (&mut acts, room)) };
        let acts = &acts[..first.len().min(active.len())];
        let count = room.pack::<V>((first, second), acts);
        let idle = acts.iter().position(|acts| *acts != u8::MAX);
        let idle = idle.map_or(0, |k| 8 * k + acts[k].trailing_ones() as usize);
        // As many lanes are idle as a last block lacks. Where they are no pairs, two spheres that are apart stand for them.
        // All pairs act then, so that the first one's are.
        let of = if idle < run.pairs { idle } else { 0 };
        let at = |places: &[u32]| places.get(of).copied().unwrap_or_default();
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
        (acts, room): (&mut [u8; LONGEST / 8], &mut Room),
    ) {
        let (whole, rest) = (pairs / 8, lowest_bits(pairs % 8));
        let mut others = [0; LONGEST / 8];
        for (k, ((active, acts), others)) in
            active.iter().zip(&mut *acts).zip(&mut others).enumerate()
        {
            // A byte of 0 or 1 each: their bits side by side.
            let before = u64::from_le_bytes(*active).wrapping_mul(0x0102_0408_1020_4080) >> 56;
            *acts = before as u8;
            *others = !*acts & if k < whole { u8::MAX } else { rest };
        }
        let still = room.pack::<V>((first, second), &others[..first.len().min(active.len())]);
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
                let place = pair[8 * k + touching.trailing_zeros() as usize] / RECORD;
                let place = place as usize;
                acts[place / 8] |= 1 << (place % 8);
                active[place / 8][place % 8] = 1;
                touching &= touching - 1;
            }
        }
    }
}
