//! Which of the listed pairs act.
//!
//! Of the pairs that touch when a list is made, a flowing bed keeps a half to two thirds in contact at any
//! moment. The others are told by their gap alone.

use super::lanes::Lanes;
use super::pairs::{PairKernel, Run};
use crate::contact_stage::CHUNK;
use crate::list::{SET_BITS, lowest_bits};

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

/// Pairs of a run that touch, or did and have something to forget: where their numbers begin, which is four times
/// their place. Filled up to a whole block with one pair that does neither.
pub(super) struct Acting {
    /// In the run.
    pub(super) pair: [u32; CHUNK + 8],
    /// Of the spheres.
    pub(super) first: [u32; CHUNK + 8],
    pub(super) second: [u32; CHUNK + 8],
    pub(super) count: usize,
}

impl PairKernel<'_> {
    /// Look which pairs of a run act, and mark those that touch. The others feel nothing and remember
    /// nothing, as before, so that they cost no more than this look: a third to a half of them.
    ///
    /// # Safety
    /// Every place in the run is that of a sphere.
    #[inline(always)]
    pub(super) unsafe fn acting<V: Lanes>(&self, run: &mut Run<'_>) -> Acting {
        let (first, _) = run.first.as_chunks::<8>();
        let (second, _) = run.second.as_chunks::<8>();
        let (active, _) = run.active.as_chunks_mut::<8>();
        debug_assert!(8 * active.len() <= CHUNK);
        let none = [0; CHUNK + 8];
        let mut acting = Acting { pair: none, first: none, second: none, count: 0 };
        let mut idle = 0;
        for (k, ((first, second), active)) in first.iter().zip(second).zip(active).enumerate() {
            let valid = lowest_bits(run.pairs.saturating_sub(8 * k));
            // SAFETY: by the caller.
            let touching = unsafe { self.near::<V>(first, second) } & valid;
            // A byte of 0 or 1 each: their bits side by side.
            let before = u64::from_le_bytes(*active).wrapping_mul(0x0102_0408_1020_4080) >> 56;
            let acts = touching | before as u8;
            *active = BYTES[usize::from(touching)];
            let order = &SET_BITS[usize::from(acts)];
            let begin = 8 * k as u32;
            let own = std::array::from_fn(|lane| begin + lane as u32);
            for (from, to) in
                [(&own, &mut acting.pair), (first, &mut acting.first), (second, &mut acting.second)]
            {
                if let Some(to) = to[acting.count..].first_chunk_mut() {
                    V::pack_fours(from, order, to);
                }
            }
            acting.count += acts.count_ones() as usize;
            if acts != u8::MAX {
                idle = 8 * k + acts.trailing_ones() as usize;
            }
        }
        // As many lanes are idle as a last block lacks, or more.
        let last = acting.count..(acting.count + 8).min(CHUNK + 8);
        acting.pair[last.clone()].fill(4 * idle as u32);
        acting.first[last.clone()].fill(4 * run.first.get(idle).unwrap_or(&0));
        acting.second[last].fill(4 * run.second.get(idle).unwrap_or(&0));
        acting
    }
}
