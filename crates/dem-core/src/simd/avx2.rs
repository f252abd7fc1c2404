//! The lanes of AVX2.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::mem::MaybeUninit;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::avx::{add_pair, mask4, pack_begins, pack_own, put_quad, quad, sums_at, transpose};
use super::lanes::{Lanes, Numbers, V3};

/// Eight lanes of two AVX2 registers, likewise.
#[derive(Clone, Copy)]
pub(super) struct Pair<const FUSED: bool>(__m256d, __m256d);

macro_rules! pair {
    ($trait:ident, $name:ident, $op:ident) => {
        impl<const FUSED: bool> $trait for Pair<FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, o: Self) -> Self {
                // SAFETY: values of this type exist only where AVX2 was detected.
                unsafe { Self($op(self.0, o.0), $op(self.1, o.1)) }
            }
        }
    };
}
pair!(Add, add, _mm256_add_pd);
pair!(Sub, sub, _mm256_sub_pd);
pair!(Mul, mul, _mm256_mul_pd);
pair!(Div, div, _mm256_div_pd);

impl<const FUSED: bool> Neg for Pair<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: as above.
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            Self(_mm256_xor_pd(self.0, sign), _mm256_xor_pd(self.1, sign))
        }
    }
}

/// The first four of eight quads from their fields.
///
/// # Safety
/// AVX is there.
#[inline(always)]
unsafe fn lower_rows<const FUSED: bool>([x, y, z, w]: [Pair<FUSED>; 4]) -> [__m256d; 4] {
    // SAFETY: by the caller.
    unsafe { transpose(x.0, y.0, z.0, w.0) }
}

/// The last four of eight quads from their fields.
///
/// # Safety
/// AVX is there.
#[inline(always)]
unsafe fn upper_rows<const FUSED: bool>([x, y, z, w]: [Pair<FUSED>; 4]) -> [__m256d; 4] {
    // SAFETY: by the caller.
    unsafe { transpose(x.1, y.1, z.1, w.1) }
}

// SAFETY of all blocks below: values exist only where AVX2 was detected; references to arrays of
// eight numbers are valid for the unaligned loads and stores.
impl<const FUSED: bool> Numbers for Pair<FUSED> {
    type Mask = u8;
    const FUSED: bool = FUSED;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        unsafe { Self(_mm256_set1_pd(x), _mm256_set1_pd(x)) }
    }
    #[inline(always)]
    fn times_plus(self, f: Self, o: Self) -> Self {
        if FUSED {
            unsafe { Self(_mm256_fmadd_pd(self.0, f.0, o.0), _mm256_fmadd_pd(self.1, f.1, o.1)) }
        } else {
            self * f + o
        }
    }
    #[inline(always)]
    fn times_less(self, f: Self, o: Self) -> Self {
        if FUSED {
            unsafe { Self(_mm256_fmsub_pd(self.0, f.0, o.0), _mm256_fmsub_pd(self.1, f.1, o.1)) }
        } else {
            self * f - o
        }
    }
    #[inline(always)]
    fn less_times(self, a: Self, b: Self) -> Self {
        if FUSED {
            unsafe { Self(_mm256_fnmadd_pd(a.0, b.0, self.0), _mm256_fnmadd_pd(a.1, b.1, self.1)) }
        } else {
            self - a * b
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        unsafe { Self(_mm256_sqrt_pd(self.0), _mm256_sqrt_pd(self.1)) }
    }
    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        // AVX2 has no table for doubles.
        Self::splat(1.0) / self.sqrt()
    }
    #[inline(always)]
    fn abs(self) -> Self {
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            Self(_mm256_andnot_pd(sign, self.0), _mm256_andnot_pd(sign, self.1))
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        unsafe { Self(_mm256_max_pd(self.0, other.0), _mm256_max_pd(self.1, other.1)) }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        unsafe { Self(_mm256_min_pd(self.0, other.0), _mm256_min_pd(self.1, other.1)) }
    }
    #[inline(always)]
    fn less(self, other: Self) -> u8 {
        unsafe {
            let low = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0));
            let high = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.1, other.1));
            (low | high << 4) as u8
        }
    }
    #[inline(always)]
    fn select(self, mask: u8, other: Self) -> Self {
        unsafe {
            Self(
                _mm256_blendv_pd(other.0, self.0, mask4(mask & 15)),
                _mm256_blendv_pd(other.1, self.1, mask4(mask >> 4)),
            )
        }
    }
    #[inline(always)]
    fn one_by_one(self, f: fn(f64) -> f64) -> Self {
        let mut each = [0.0; 8];
        self.store(&mut each);
        for x in &mut each {
            *x = f(*x);
        }
        Self::load(&each)
    }
}

// SAFETY: as above.
impl<const FUSED: bool> Lanes for Pair<FUSED> {
    #[inline(always)]
    fn load(from: &[f64; 8]) -> Self {
        unsafe { Self(_mm256_loadu_pd(from.as_ptr()), _mm256_loadu_pd(from.as_ptr().add(4))) }
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; 8]) {
        unsafe {
            _mm256_storeu_pd(to.as_mut_ptr(), self.0);
            _mm256_storeu_pd(to.as_mut_ptr().add(4), self.1);
        }
    }
    #[inline(always)]
    unsafe fn quads<const EACH: usize>(from: *const f64, p: &[u32; 8]) -> [Self; 4] {
        unsafe {
            let r = |k: usize| quad::<EACH>(from, p[k]);
            let low = transpose(r(0), r(1), r(2), r(3));
            let high = transpose(r(4), r(5), r(6), r(7));
            std::array::from_fn(|k| Self(low[k], high[k]))
        }
    }
    #[inline(always)]
    unsafe fn put_quads([x, y, z, w]: [Self; 4], to: *mut f64, p: &[u32; 8]) {
        unsafe {
            for (k, v) in lower_rows([x, y, z, w]).into_iter().enumerate() {
                put_quad(to, p[k], v);
            }
            for (k, v) in upper_rows([x, y, z, w]).into_iter().enumerate() {
                put_quad(to, p[k + 4], v);
            }
        }
    }
    #[inline(always)]
    unsafe fn add_wrenches(
        [f, ti, tj]: [V3<Self>; 3],
        to: *mut f64,
        within: u32,
        first: &[u32; 8],
        second: &[u32; 8],
    ) {
        unsafe {
            let (first, second) = (sums_at(within, first), sums_at(within, second));
            // Not known to the compiler: it would take the exchanges apart for the sake of a zero.
            let zero = Self::splat(std::hint::black_box(0.0));
            let (f, ti) = ([f.x, f.y, f.z, zero], [ti.x, ti.y, ti.z, zero]);
            let tj = [tj.x, tj.y, tj.z, zero];
            let [f4, ti4, tj4] = [lower_rows(f), lower_rows(ti), lower_rows(tj)];
            for k in 0..4 {
                add_pair(to, [first.of(k), second.of(k)], [f4[k], ti4[k], tj4[k]]);
            }
            let [f4, ti4, tj4] = [upper_rows(f), upper_rows(ti), upper_rows(tj)];
            for k in 0..4 {
                add_pair(to, [first.of(k + 4), second.of(k + 4)], [f4[k], ti4[k], tj4[k]]);
            }
        }
    }
    #[inline(always)]
    fn pack_begins(places: &[u32; 8], order: &[u8; 8], to: &mut [MaybeUninit<u32>; 8]) {
        unsafe { pack_begins(places, order, to) }
    }
    #[inline(always)]
    fn pack_own(begin: u32, order: &[u8; 8], to: &mut [MaybeUninit<u32>; 8]) {
        unsafe { pack_own(begin, order, to) }
    }
    #[inline(always)]
    unsafe fn differences<const EACH: usize>(
        from: *const f64,
        of: &[u32; 8],
        less: &[u32; 8],
    ) -> [Self; 4] {
        unsafe {
            let r =
                |k: usize| _mm256_sub_pd(quad::<EACH>(from, of[k]), quad::<EACH>(from, less[k]));
            let low = transpose(r(0), r(1), r(2), r(3));
            let high = transpose(r(4), r(5), r(6), r(7));
            std::array::from_fn(|k| Self(low[k], high[k]))
        }
    }
}
