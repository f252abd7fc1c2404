//! Listed pairs as they lie: which touch, and how far apart the others are. Eight pairs are one block.

use std::slice::from_ref;

use super::Level;
use super::lanes::{Lanes, RECORD};
use super::pairs::{PairKernel, difference};
use crate::neighbour::Period;

/// What is told of a block of eight pairs.
trait ToldOfBlock {
    /// # Safety
    /// Every place is that of a sphere.
    unsafe fn of<V: Lanes>(kernel: &PairKernel<'_>, first: &[u32; 8], second: &[u32; 8]) -> Self;
}

/// Bits of those that touch.
impl ToldOfBlock for u8 {
    #[inline(always)]
    unsafe fn of<V: Lanes>(kernel: &PairKernel<'_>, first: &[u32; 8], second: &[u32; 8]) -> Self {
        // SAFETY: by the caller.
        unsafe { kernel.near::<V, { RECORD as usize }>(first, second) }
    }
}

/// Gaps, m.
impl ToldOfBlock for [f64; 8] {
    #[inline(always)]
    unsafe fn of<V: Lanes>(kernel: &PairKernel<'_>, first: &[u32; 8], second: &[u32; 8]) -> Self {
        // SAFETY: by the caller.
        let (d2, sum) = unsafe { kernel.apart::<V, { RECORD as usize }>(first, second) };
        let mut gaps = [0.0; 8];
        (d2.sqrt() - sum).store(&mut gaps);
        gaps
    }
}

impl PairKernel<'_> {
    /// Bits of the near pairs that touch now, block by block; all of them where nothing tells.
    pub(crate) fn touch(
        &self,
        level: Level,
        first: &[[u32; 8]],
        second: &[[u32; 8]],
        bits: &mut [u8],
    ) {
        if !self.told_by_vectors(level, [first, second], bits) {
            bits.fill(u8::MAX);
        }
    }

    /// Fill `told` with what vectors tell of each block; whether there are vectors.
    fn told_by_vectors<T: ToldOfBlock>(
        &self,
        level: Level,
        pairs: [&[[u32; 8]]; 2],
        told: &mut [T],
    ) -> bool {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,popcnt")]
            unsafe fn avx512<T: ToldOfBlock>(
                k: &PairKernel<'_>,
                pairs: [&[[u32; 8]]; 2],
                told: &mut [T],
            ) {
                // SAFETY: the lists hold places of spheres.
                unsafe { k.each_block::<super::avx512::Wide<false, false>, T>(pairs, told) }
            }
            #[target_feature(enable = "avx2,fma,popcnt")]
            unsafe fn avx2<T: ToldOfBlock>(
                k: &PairKernel<'_>,
                pairs: [&[[u32; 8]]; 2],
                told: &mut [T],
            ) {
                // SAFETY: the lists hold places of spheres.
                unsafe { k.each_block::<super::avx2::Pair<false>, T>(pairs, told) }
            }
            // SAFETY: `level` comes from `Level::detect`, which asked the processor.
            match level {
                Level::Avx512 => unsafe { avx512(self, pairs, told) },
                Level::Avx2 => unsafe { avx2(self, pairs, told) },
                Level::Portable => return false,
            }
            true
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            let _ = (level, pairs, told);
            false
        }
    }

    /// # Safety
    /// Every place is that of a sphere.
    #[inline(always)]
    unsafe fn each_block<V: Lanes, T: ToldOfBlock>(
        &self,
        [first, second]: [&[[u32; 8]]; 2],
        told: &mut [T],
    ) {
        for ((first, second), told) in first.iter().zip(second).zip(told) {
            // SAFETY: by the caller.
            *told = unsafe { T::of::<V>(self, first, second) };
        }
    }

    /// Bits of those that touch, of spheres whose records begin at `EACH` times that.
    ///
    /// # Safety
    /// Every place is that of a sphere.
    #[inline(always)]
    pub(super) unsafe fn near<V: Lanes, const EACH: usize>(
        &self,
        first: &[u32; 8],
        second: &[u32; 8],
    ) -> u8 {
        // SAFETY: by the caller.
        let (d2, sum) = unsafe { self.apart::<V, EACH>(first, second) };
        d2.less(sum * sum)
    }

    /// Squares of the distances of centres, and sums of radii, of spheres whose records begin at `EACH` times that.
    ///
    /// # Safety
    /// Every place is that of a sphere.
    #[inline(always)]
    unsafe fn apart<V: Lanes, const EACH: usize>(
        &self,
        first: &[u32; 8],
        second: &[u32; 8],
    ) -> (V, V) {
        let radius = self.one_size.map(|s| s[0]);
        let (first, second) = (from_ref(first), from_ref(second));
        // SAFETY: by the caller.
        let (mut d, [rj, ri]) =
            unsafe { difference::<V, EACH, _>(self.spheres.position, second, first, radius) };
        if let Some(p) = self.period {
            d = d.shortest(p);
        }
        (d.dot(d), ri + rj)
    }

    /// Gaps of pairs, m, block by block.
    pub(crate) fn gaps(
        &self,
        level: Level,
        first: &[[u32; 8]],
        second: &[[u32; 8]],
        gaps: &mut [[f64; 8]],
    ) {
        if self.told_by_vectors(level, [first, second], gaps) {
            return;
        }
        let position = self.spheres.position;
        let pairs = first.as_flattened().iter().zip(second.as_flattened());
        for ((a, b), gap) in pairs.zip(gaps.as_flattened_mut()) {
            let (a, b) = (&position[*a as usize], &position[*b as usize]);
            let d = Period::shortest(self.period, b.vector() - a.vector());
            *gap = d.length() - (a.w + b.w);
        }
    }
}
