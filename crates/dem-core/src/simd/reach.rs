//! Which of eight spheres are in reach of another, and their pairs side by side.

use super::lanes::Lanes;
use super::{Level, V3};
#[cfg(target_arch = "x86_64")]
use super::{avx2, avx512};
use crate::neighbour::Period;
use crate::neighbour::search::SET_BITS;
use crate::particles::Record;

/// Of each of some spheres, the bits of those among eight others (coordinates, radii and what each may move) whose gap to it is below
/// its range, which is one of these and what they may move, and of those whose gap is below the margin.
#[inline(always)]
pub(crate) fn in_reach(
    level: Level,
    spheres: &[Record],
    others: [&[f64; 8]; 5],
    (ranges, margin): (&[f64], f64),
    period: Option<Period>,
    marks: &mut [[u8; 2]],
) {
    #[cfg(target_arch = "x86_64")]
    match level {
        Level::Avx512 => {
            type Eight = avx512::Wide<false, false>;
            return reach::<Eight>(spheres, others, (ranges, margin), period, marks);
        }
        Level::Avx2 => {
            return reach::<avx2::Pair<false>>(spheres, others, (ranges, margin), period, marks);
        }
        Level::Portable => {}
    }
    let _ = level;
    let [x, y, z, r, more] = others;
    for ((own, range), marks) in spheres.iter().zip(ranges).zip(marks) {
        *marks = (0..8).fold([0; 2], |[near, touching], k| {
            let d = glam::DVec3::new(x[k] - own.x, y[k] - own.y, z[k] - own.z);
            let d2 = Period::shortest(period, d).length_squared();
            let below = |gap: f64| u8::from(d2 < (own.w + r[k] + gap).powi(2)) << k;
            [near | below(range + more[k]), touching | below(margin)]
        });
    }
}

#[inline(always)]
fn reach<V: Lanes>(
    spheres: &[Record],
    [x, y, z, r, more]: [&[f64; 8]; 5],
    (ranges, margin): (&[f64], f64),
    period: Option<Period>,
    marks: &mut [[u8; 2]],
) {
    let others = V3 { x: V::load(x), y: V::load(y), z: V::load(z) };
    let (r, more, margin) = (V::load(r), V::load(more), V::splat(margin));
    for ((own, range), marks) in spheres.iter().zip(ranges).zip(marks) {
        let mut d = others - V3 { x: V::splat(own.x), y: V::splat(own.y), z: V::splat(own.z) };
        if let Some(p) = period {
            d = d.shortest(p);
        }
        let (d2, both) = (d.dot(d), V::splat(own.w) + r);
        let range = both + (V::splat(*range) + more);
        let margin = both + margin;
        *marks = [d2.less(range * range), d2.less(margin * margin)];
    }
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
