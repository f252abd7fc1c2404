//! Which of eight spheres are in reach of another, and their pairs side by side.

use super::lanes::Lanes;
use super::{Level, V3};
#[cfg(target_arch = "x86_64")]
use super::{avx2, avx512};
use crate::neighbour::Period;
use crate::neighbour::search::SET_BITS;
use crate::particles::{Column, Record};

/// Bits of those among eight spheres (coordinates and radii in `columns` from `begin` on) whose gap to
/// `own` is below the range, and of those whose gap is below the margin.
#[inline(always)]
pub(crate) fn in_reach(
    level: Level,
    own: &Record,
    (columns, more): (&[Column<f64>; 4], Option<&[f64; 8]>),
    begin: usize,
    gaps: [f64; 2],
    period: Option<Period>,
) -> [u8; 2] {
    let eight = |k: usize| columns[k][begin..].first_chunk::<8>();
    let (Some(x), Some(y), Some(z), Some(r)) = (eight(0), eight(1), eight(2), eight(3)) else {
        return [0; 2];
    };
    let more = more.unwrap_or(&[0.0; 8]);
    #[cfg(target_arch = "x86_64")]
    match level {
        Level::Avx512 => {
            return reach::<avx512::Wide<false, false>>(own, [x, y, z, r, more], gaps, period);
        }
        Level::Avx2 => return reach::<avx2::Pair<false>>(own, [x, y, z, r, more], gaps, period),
        Level::Portable => {}
    }
    let _ = level;
    (0..8).fold([0; 2], |[near, touching], k| {
        let d = glam::DVec3::new(x[k] - own.x, y[k] - own.y, z[k] - own.z);
        let d2 = Period::shortest(period, d).length_squared();
        let below = |gap: f64| u8::from(d2 < (own.w + r[k] + gap).powi(2)) << k;
        [near | below(gaps[0] + more[k]), touching | below(gaps[1])]
    })
}

#[inline(always)]
fn reach<V: Lanes>(
    own: &Record,
    [x, y, z, r, more]: [&[f64; 8]; 5],
    gaps: [f64; 2],
    period: Option<Period>,
) -> [u8; 2] {
    let mut d = V3 {
        x: V::load(x) - V::splat(own.x),
        y: V::load(y) - V::splat(own.y),
        z: V::load(z) - V::splat(own.z),
    };
    if let Some(p) = period {
        d = d.shortest(p);
    }
    let (d2, both) = (d.dot(d), V::splat(own.w) + V::load(r));
    let range = both + (V::splat(gaps[0]) + V::load(more));
    let margin = both + V::splat(gaps[1]);
    [d2.less(range * range), d2.less(margin * margin)]
}

/// Put the marked ones of eight numbers below 2^31 side by side, with their highest bit where `highest` has one; whatever is written
/// behind them is of no account. Returns how many they are.
#[inline(always)]
pub(crate) fn keep_marked(
    level: Level,
    of: &[u32; 8],
    [marks, highest]: [u8; 2],
    to: &mut [u32; 8],
) -> usize {
    #[cfg(target_arch = "x86_64")]
    if level == Level::Avx512 {
        // SAFETY: the processor has it.
        unsafe { avx512::put_eight(of, [marks, highest], to) }
        return marks.count_ones() as usize;
    }
    let _ = level;
    for (to, lane) in to.iter_mut().zip(&SET_BITS[usize::from(marks)]) {
        *to = of[usize::from(*lane)] | (u32::from(highest) >> lane) << 31;
    }
    marks.count_ones() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marked_numbers_are_kept_alike_by_all_instructions() {
        for marks in 0..=u8::MAX {
            let of = [0, 1, 2, 3, 4, 5, 6, 7].map(|k: u32| 1_000_003 * (k + u32::from(marks)));
            let highest = marks.wrapping_mul(113);
            let bit = |set: bool| u32::from(set) << 31;
            let expected: Vec<_> = (0..8)
                .filter(|lane| marks >> lane & 1 != 0)
                .map(|lane| of[lane] | bit(highest >> lane & 1 != 0))
                .collect();
            for level in [Level::Portable, Level::detect()] {
                let mut to = [0; 8];
                let count = crate::simd::widened(
                    level,
                    #[inline(always)]
                    || keep_marked(level, &of, [marks, highest], &mut to),
                );
                assert_eq!(to[..count], expected, "{level:?}");
            }
        }
    }
}
