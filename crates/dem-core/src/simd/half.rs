//! Four lanes in one register of AVX2, whose masks are registers, too.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::avx::{beginning, mask4, put_quad, quad, transpose};
use super::group::Group;
use super::lanes::{Mask, Numbers, V3};

/// Four lanes.
#[derive(Clone, Copy)]
pub(super) struct Half<const FUSED: bool>(__m256d);

/// Which of four lanes: all bits of a lane or none.
#[derive(Clone, Copy)]
pub(super) struct Which(__m256d);

macro_rules! half {
    ($trait:ident, $name:ident, $op:ident) => {
        impl<const FUSED: bool> $trait for Half<FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, o: Self) -> Self {
                // SAFETY: values of this type exist only where AVX2 was detected.
                Self(unsafe { $op(self.0, o.0) })
            }
        }
    };
}
half!(Add, add, _mm256_add_pd);
half!(Sub, sub, _mm256_sub_pd);
half!(Mul, mul, _mm256_mul_pd);
half!(Div, div, _mm256_div_pd);

impl<const FUSED: bool> Neg for Half<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

impl BitAnd for Which {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_and_pd(self.0, o.0) })
    }
}

impl BitOr for Which {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_or_pd(self.0, o.0) })
    }
}

impl Not for Which {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_castsi256_pd(_mm256_set1_epi64x(-1))) })
    }
}

impl Which {
    /// The lanes of the lowest four bits.
    #[inline(always)]
    pub(super) fn of(bits: u8) -> Self {
        // SAFETY: as above.
        Self(unsafe { mask4(bits) })
    }

    /// One bit a lane.
    #[inline(always)]
    pub(super) fn bits(self) -> u8 {
        // SAFETY: as above.
        unsafe { _mm256_movemask_pd(self.0) as u8 }
    }
}

impl Mask for Which {
    #[inline(always)]
    fn is_empty(self) -> bool {
        self.bits() == 0
    }
}

// SAFETY of all blocks below: as above.
impl<const FUSED: bool> Numbers for Half<FUSED> {
    type Mask = Which;
    const FUSED: bool = FUSED;
    const FEW: bool = true;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(x) })
    }
    #[inline(always)]
    fn times_plus(self, f: Self, o: Self) -> Self {
        if FUSED { Self(unsafe { _mm256_fmadd_pd(self.0, f.0, o.0) }) } else { self * f + o }
    }
    #[inline(always)]
    fn times_less(self, f: Self, o: Self) -> Self {
        if FUSED { Self(unsafe { _mm256_fmsub_pd(self.0, f.0, o.0) }) } else { self * f - o }
    }
    #[inline(always)]
    fn less_times(self, a: Self, b: Self) -> Self {
        if FUSED { Self(unsafe { _mm256_fnmadd_pd(a.0, b.0, self.0) }) } else { self - a * b }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        // AVX2 has no table for doubles.
        Self::splat(1.0) / self.sqrt()
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(unsafe { _mm256_max_pd(self.0, o.0) })
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self(unsafe { _mm256_min_pd(self.0, o.0) })
    }
    #[inline(always)]
    fn less(self, o: Self) -> Which {
        Which(unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, o.0) })
    }
    #[inline(always)]
    fn select(self, mask: Which, o: Self) -> Self {
        Self(unsafe { _mm256_blendv_pd(o.0, self.0, mask.0) })
    }
    #[inline(always)]
    fn only(self, mask: Which) -> Self {
        Self(unsafe { _mm256_and_pd(self.0, mask.0) })
    }
    #[inline(always)]
    fn one_by_one(self, f: fn(f64) -> f64) -> Self {
        let mut each = self.each();
        for x in &mut each {
            *x = f(*x);
        }
        Self::from(each)
    }
}

impl<const FUSED: bool> From<[f64; 4]> for Half<FUSED> {
    #[inline(always)]
    fn from(each: [f64; 4]) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_loadu_pd(each.as_ptr()) })
    }
}

impl<const FUSED: bool> Half<FUSED> {
    /// The vectors of four records, less those of four others, whose numbers begin at `EACH` times that.
    ///
    /// # Safety
    /// AVX2 is there and all of them can be read.
    #[inline(always)]
    pub(super) unsafe fn differences<const EACH: usize>(
        from: *const f64,
        of: &[u32; 4],
        less: &[u32; 4],
    ) -> V3<Self> {
        // SAFETY: by the caller.
        unsafe {
            let a = _mm256_sub_pd(quad::<EACH>(from, of[0]), quad::<EACH>(from, less[0]));
            let b = _mm256_sub_pd(quad::<EACH>(from, of[1]), quad::<EACH>(from, less[1]));
            let c = _mm256_sub_pd(quad::<EACH>(from, of[2]), quad::<EACH>(from, less[2]));
            let d = _mm256_sub_pd(quad::<EACH>(from, of[3]), quad::<EACH>(from, less[3]));
            let [x, y, z, _] = transpose(a, b, c, d);
            V3 { x: Self(x), y: Self(y), z: Self(z) }
        }
    }

    /// Four numbers, which begin at `EACH` times that.
    ///
    /// # Safety
    /// AVX2 is there and all of them can be read.
    #[inline(always)]
    pub(super) unsafe fn fields<const EACH: usize>(from: *const f64, at: &[u32; 4]) -> Self {
        let [a, b, c, d] = at.map(
            #[inline(always)]
            |at| beginning(from, EACH * at as usize),
        );
        // SAFETY: by the caller.
        Self(unsafe { _mm256_setr_pd(*a, *b, *c, *d) })
    }

    /// The vectors of four pairs of records, first and second ones, less those of four other pairs, whose numbers begin at twice
    /// that.
    ///
    /// # Safety
    /// AVX2 is there and all of them can be read.
    #[inline(always)]
    pub(super) unsafe fn differences_of_twos(
        from: *const f64,
        of: &[u32; 4],
        less: &[u32; 4],
    ) -> [V3<Self>; 2] {
        // SAFETY: by the caller.
        unsafe {
            let a = two_less(from, of[0], less[0]);
            let b = two_less(from, of[1], less[1]);
            let c = two_less(from, of[2], less[2]);
            let d = two_less(from, of[3], less[3]);
            let [x, y, z, _] = transpose(a[0], b[0], c[0], d[0]);
            let first = V3 { x: Self(x), y: Self(y), z: Self(z) };
            let [x, y, z, _] = transpose(a[1], b[1], c[1], d[1]);
            [first, V3 { x: Self(x), y: Self(y), z: Self(z) }]
        }
    }

    /// Sums and differences of the vectors of four records and of four others, whose numbers begin there.
    ///
    /// # Safety
    /// AVX2 is there and all of them can be read.
    #[inline(always)]
    pub(super) unsafe fn sums_and_differences(
        from: *const f64,
        of: &[u32; 4],
        and: &[u32; 4],
    ) -> [V3<Self>; 2] {
        // SAFETY: by the caller.
        unsafe {
            let a = sum_and_less(quad::<1>(from, of[0]), quad::<1>(from, and[0]));
            let b = sum_and_less(quad::<1>(from, of[1]), quad::<1>(from, and[1]));
            let c = sum_and_less(quad::<1>(from, of[2]), quad::<1>(from, and[2]));
            let d = sum_and_less(quad::<1>(from, of[3]), quad::<1>(from, and[3]));
            let [x, y, z, _] = transpose(a[0], b[0], c[0], d[0]);
            let sum = V3 { x: Self(x), y: Self(y), z: Self(z) };
            let [x, y, z, _] = transpose(a[1], b[1], c[1], d[1]);
            [sum, V3 { x: Self(x), y: Self(y), z: Self(z) }]
        }
    }

    /// Four records.
    #[inline(always)]
    pub(super) fn rows(v: V3<Self>, scalar: Self) -> [__m256d; 4] {
        // SAFETY: as above.
        unsafe { transpose(v.x.0, v.y.0, v.z.0, scalar.0) }
    }

    /// Four records, and nothing in the lanes that are not `used`.
    #[inline(always)]
    pub(super) fn used_rows(v: V3<Self>, scalar: Self, used: Which) -> [__m256d; 4] {
        let only = V3 { x: v.x.only(used), y: v.y.only(used), z: v.z.only(used) };
        Self::rows(only, scalar.only(used))
    }
}

/// Sum of two records, and the first less the second.
///
/// # Safety
/// AVX is there.
#[inline(always)]
unsafe fn sum_and_less(a: __m256d, b: __m256d) -> [__m256d; 2] {
    // SAFETY: by the caller.
    unsafe { [_mm256_add_pd(a, b), _mm256_sub_pd(a, b)] }
}

/// Both records of a pair less those of another one, which begin at twice these places.
///
/// # Safety
/// AVX2 is there and all of them can be read.
#[inline(always)]
unsafe fn two_less(from: *const f64, of: u32, less: u32) -> [__m256d; 2] {
    // SAFETY: by the caller.
    unsafe {
        let second = from.add(4);
        let first = _mm256_sub_pd(quad::<2>(from, of), quad::<2>(from, less));
        [first, _mm256_sub_pd(quad::<2>(second, of), quad::<2>(second, less))]
    }
}

// SAFETY of all blocks below: as above, and by the caller.
impl<const FUSED: bool> Group<4> for Half<FUSED> {
    #[inline(always)]
    fn which(bits: u8) -> Which {
        Which::of(bits)
    }
    #[inline(always)]
    fn each(self) -> [f64; 4] {
        let mut each = [0.0; 4];
        unsafe { _mm256_storeu_pd(each.as_mut_ptr(), self.0) };
        each
    }
    #[inline(always)]
    fn bits(mask: Which) -> u8 {
        mask.bits()
    }
    #[inline(always)]
    unsafe fn quads<const EACH: usize>(from: *const f64, at: &[u32; 4]) -> [Self; 4] {
        unsafe {
            let row = [quad::<EACH>(from, at[0]), quad::<EACH>(from, at[1])];
            let more = [quad::<EACH>(from, at[2]), quad::<EACH>(from, at[3])];
            let [x, y, z, w] = transpose(row[0], row[1], more[0], more[1]);
            [Self(x), Self(y), Self(z), Self(w)]
        }
    }
    #[inline(always)]
    unsafe fn put_used(v: V3<Self>, scalar: Self, used: Which, to: *mut f64, at: &[u32; 4]) {
        for (at, row) in at.iter().zip(Self::used_rows(v, scalar, used)) {
            unsafe { put_quad(to, *at, row) }
        }
    }
}
