//! The lanes of AVX-512 and AVX2.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::mem::MaybeUninit;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::lanes::{Lanes, Numbers, Quad, Quads};
use crate::particles::Record;
use crate::sums::Pull;

/// Eight lanes of one AVX-512 register, whose products are rounded before they are added unless `FUSED`.
#[derive(Clone, Copy)]
pub(super) struct Wide<const FUSED: bool>(__m512d);

/// Eight lanes of two AVX2 registers, likewise.
#[derive(Clone, Copy)]
pub(super) struct Pair<const FUSED: bool>(__m256d, __m256d);

macro_rules! wide {
    ($trait:ident, $name:ident, $op:ident) => {
        impl<const FUSED: bool> $trait for Wide<FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, o: Self) -> Self {
                // SAFETY: values of this type exist only where AVX-512 was detected.
                Self(unsafe { $op(self.0, o.0) })
            }
        }
    };
}
wide!(Add, add, _mm512_add_pd);
wide!(Sub, sub, _mm512_sub_pd);
wide!(Mul, mul, _mm512_mul_pd);
wide!(Div, div, _mm512_div_pd);

impl<const FUSED: bool> Neg for Wide<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

/// # Safety
/// AVX is there and the four numbers of the quad can be read.
#[inline(always)]
unsafe fn quad(from: *const f64, at: u32) -> __m256d {
    // SAFETY: by the caller.
    unsafe { _mm256_loadu_pd(from.add(at as usize)) }
}

/// # Safety
/// AVX is there and the four numbers of the quad can be written.
#[inline(always)]
unsafe fn put_quad(to: *mut f64, at: u32, four: __m256d) {
    // SAFETY: by the caller.
    unsafe { _mm256_storeu_pd(to.add(at as usize), four) }
}

/// As [`Lanes::pack_fours`].
///
/// # Safety
/// AVX2 is there.
#[inline(always)]
unsafe fn pack_fours(places: &[u32; 8], order: &[u8; 8], to: &mut [MaybeUninit<u32>; 8]) {
    // SAFETY: by the caller; the arrays are as long as what is read and written.
    unsafe {
        let order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(order.as_ptr().cast()));
        let places = _mm256_loadu_si256(places.as_ptr().cast());
        let picked = _mm256_slli_epi32::<2>(_mm256_permutevar8x32_epi32(places, order));
        _mm256_storeu_si256(to.as_mut_ptr().cast(), picked);
    }
}

/// Quads `k` and `k + 4` of eight, side by side.
///
/// # Safety
/// AVX-512 is there and the numbers of every quad can be read.
#[inline(always)]
unsafe fn rows(from: *const f64, p: &[u32; 8], k: usize) -> __m512d {
    // SAFETY: by the caller.
    unsafe {
        let low = _mm512_castpd256_pd512(quad(from, p[k]));
        _mm512_insertf64x4::<1>(low, quad(from, p[k + 4]))
    }
}

/// Rows of eight quads from their fields: `k` and `k + 4` side by side.
///
/// # Safety
/// AVX-512 is there.
#[inline(always)]
unsafe fn rows_of<const FUSED: bool>([x, y, z, w]: [Wide<FUSED>; 4]) -> [__m512d; 4] {
    // SAFETY: by the caller.
    unsafe {
        let (xy, xy2) = (_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
        let (zw, zw2) = (_mm512_unpacklo_pd(z.0, w.0), _mm512_unpackhi_pd(z.0, w.0));
        let low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
        let high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
        [
            _mm512_permutex2var_pd(xy, low, zw),
            _mm512_permutex2var_pd(xy2, low, zw2),
            _mm512_permutex2var_pd(xy, high, zw),
            _mm512_permutex2var_pd(xy2, high, zw2),
        ]
    }
}

/// Where the sums of spheres begin, of whose places four times is given.
///
/// # Safety
/// AVX2 is there.
#[inline(always)]
unsafe fn sums_at(within: u32, places: &[u32; 8]) -> [u32; 8] {
    let mut at = [0; 8];
    // SAFETY: by the caller; the arrays are as long as what is read and written.
    unsafe {
        let places = _mm256_loadu_si256(places.as_ptr().cast());
        let own = _mm256_and_si256(places, _mm256_set1_epi32(within.cast_signed()));
        _mm256_storeu_si256(at.as_mut_ptr().cast(), _mm256_slli_epi32::<1>(own));
    }
    at
}

/// Add force and torque to the sum of a sphere.
///
/// # Safety
/// AVX-512 is there and the sum can be written.
#[inline(always)]
unsafe fn add_wide(to: *mut f64, at: u32, wrench: __m512d) {
    // SAFETY: by the caller; sums lie at multiples of 64.
    unsafe {
        let sum = to.add(at as usize);
        _mm512_store_pd(sum, _mm512_add_pd(_mm512_load_pd(sum), wrench));
    }
}

/// Fields of eight records from four pairs of rows: two rounds of exchanges.
///
/// # Safety
/// AVX-512 is there.
#[inline(always)]
unsafe fn columns<const FUSED: bool>([a, b, c, d]: [__m512d; 4]) -> [Wide<FUSED>; 4] {
    // SAFETY: by the caller.
    unsafe {
        let (xz, yw) = (_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
        let (xz2, yw2) = (_mm512_unpacklo_pd(c, d), _mm512_unpackhi_pd(c, d));
        let low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
        let high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
        [
            Wide(_mm512_permutex2var_pd(xz, low, xz2)),
            Wide(_mm512_permutex2var_pd(yw, low, yw2)),
            Wide(_mm512_permutex2var_pd(xz, high, xz2)),
            Wide(_mm512_permutex2var_pd(yw, high, yw2)),
        ]
    }
}

// SAFETY of all blocks below: values exist only where AVX-512 was detected; references to arrays
// of eight numbers are valid for the unaligned loads and stores.
impl<const FUSED: bool> Numbers for Wide<FUSED> {
    type Mask = u8;
    const FUSED: bool = FUSED;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(x) })
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, o: Self) -> Self {
        if FUSED {
            Self(unsafe { _mm512_fmadd_pd(self.0, factor.0, o.0) })
        } else {
            self * factor + o
        }
    }
    #[inline(always)]
    fn times_less(self, factor: Self, o: Self) -> Self {
        if FUSED {
            Self(unsafe { _mm512_fmsub_pd(self.0, factor.0, o.0) })
        } else {
            self * factor - o
        }
    }
    #[inline(always)]
    fn less_times(self, a: Self, b: Self) -> Self {
        if FUSED {
            Self(unsafe { _mm512_fnmadd_pd(a.0, b.0, self.0) })
        } else {
            self - a * b
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        // 14 bits from the table; each Newton step y += y (1 - x y^2) / 2 squares the error:
        // 6e-5, 5e-9, 4e-17, so rounding is left.
        unsafe {
            let (half, one) = (_mm512_set1_pd(0.5), _mm512_set1_pd(1.0));
            let mut y = _mm512_rsqrt14_pd(self.0);
            for _ in 0..2 {
                let error = _mm512_fnmadd_pd(_mm512_mul_pd(self.0, y), y, one);
                y = _mm512_fmadd_pd(_mm512_mul_pd(y, half), error, y);
            }
            Self(y)
        }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(unsafe { _mm512_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn less(self, other: Self) -> u8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(self, mask: u8, other: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_pd(mask, other.0, self.0) })
    }
}

// SAFETY: as above.
impl<const FUSED: bool> Lanes for Wide<FUSED> {
    #[inline(always)]
    fn load(from: &[f64; 8]) -> Self {
        Self(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; 8]) {
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    unsafe fn quads(from: *const f64, p: &[u32; 8]) -> [Self; 4] {
        unsafe {
            let (a, b) = (rows(from, p, 0), rows(from, p, 1));
            columns([a, b, rows(from, p, 2), rows(from, p, 3)])
        }
    }
    #[inline(always)]
    unsafe fn put_quads(fields: [Self; 4], to: *mut f64, p: &[u32; 8]) {
        unsafe {
            for (k, v) in rows_of(fields).into_iter().enumerate() {
                put_quad(to, p[k], _mm512_castpd512_pd256(v));
                put_quad(to, p[k + 4], _mm512_extractf64x4_pd::<1>(v));
            }
        }
    }
    #[inline(always)]
    unsafe fn add_wrenches(
        [f, ti, tj]: [[Self; 4]; 3],
        to: *mut f64,
        within: u32,
        first: &[u32; 8],
        second: &[u32; 8],
    ) {
        unsafe {
            let (first, second) = (sums_at(within, first), sums_at(within, second));
            let (f, ti, tj) = (rows_of(f), rows_of(ti), rows_of(tj));
            let opposite = _mm512_setr_pd(-0.0, -0.0, -0.0, -0.0, 0.0, 0.0, 0.0, 0.0);
            // In the order of the list: rows 0 to 3 hold the first four contacts in their lower halves.
            for k in 0..4 {
                let on_second = _mm512_shuffle_f64x2::<0x44>(f[k], tj[k]);
                add_wide(to, first[k], _mm512_shuffle_f64x2::<0x44>(f[k], ti[k]));
                add_wide(to, second[k], _mm512_xor_pd(on_second, opposite));
            }
            for k in 0..4 {
                let on_second = _mm512_shuffle_f64x2::<0xEE>(f[k], tj[k]);
                add_wide(to, first[k + 4], _mm512_shuffle_f64x2::<0xEE>(f[k], ti[k]));
                add_wide(to, second[k + 4], _mm512_xor_pd(on_second, opposite));
            }
        }
    }
    #[inline(always)]
    fn pack_fours(places: &[u32; 8], order: &[u8; 8], to: &mut [MaybeUninit<u32>; 8]) {
        unsafe { pack_fours(places, order, to) }
    }
    #[inline(always)]
    unsafe fn differences(from: *const f64, of: &[u32; 8], less: &[u32; 8]) -> [Self; 4] {
        unsafe {
            columns([
                _mm512_sub_pd(rows(from, of, 0), rows(from, less, 0)),
                _mm512_sub_pd(rows(from, of, 1), rows(from, less, 1)),
                _mm512_sub_pd(rows(from, of, 2), rows(from, less, 2)),
                _mm512_sub_pd(rows(from, of, 3), rows(from, less, 3)),
            ])
        }
    }
}

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

/// Four bits as a mask of four lanes.
///
/// # Safety
/// AVX2 is there.
#[inline(always)]
unsafe fn mask4(bits: u8) -> __m256d {
    // SAFETY: by the caller.
    unsafe {
        let lane = _mm256_setr_epi64x(1, 2, 4, 8);
        let all = _mm256_set1_epi64x(i64::from(bits));
        _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(all, lane), lane))
    }
}

/// # Safety
/// AVX is there.
#[inline(always)]
unsafe fn transpose(a: __m256d, b: __m256d, c: __m256d, d: __m256d) -> [__m256d; 4] {
    // SAFETY: by the caller.
    unsafe {
        let (xz, yw) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        let (xz2, yw2) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(xz, xz2),
            _mm256_permute2f128_pd::<0x20>(yw, yw2),
            _mm256_permute2f128_pd::<0x31>(xz, xz2),
            _mm256_permute2f128_pd::<0x31>(yw, yw2),
        ]
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

/// Add force and torques of one contact to the sums of both spheres.
///
/// # Safety
/// AVX is there and both sums can be written.
#[inline(always)]
unsafe fn add_pair(to: *mut f64, at: [u32; 2], [f, ti, tj]: [__m256d; 3]) {
    // SAFETY: by the caller; sums lie at multiples of 64.
    unsafe {
        let (first, second) = (to.add(at[0] as usize), to.add(at[1] as usize));
        let torque = first.add(4);
        _mm256_store_pd(first, _mm256_add_pd(_mm256_load_pd(first), f));
        _mm256_store_pd(torque, _mm256_add_pd(_mm256_load_pd(torque), ti));
        let torque = second.add(4);
        _mm256_store_pd(second, _mm256_sub_pd(_mm256_load_pd(second), f));
        _mm256_store_pd(torque, _mm256_add_pd(_mm256_load_pd(torque), tj));
    }
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
    unsafe fn quads(from: *const f64, p: &[u32; 8]) -> [Self; 4] {
        unsafe {
            let r = |k: usize| quad(from, p[k]);
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
        [f, ti, tj]: [[Self; 4]; 3],
        to: *mut f64,
        within: u32,
        first: &[u32; 8],
        second: &[u32; 8],
    ) {
        unsafe {
            let (first, second) = (sums_at(within, first), sums_at(within, second));
            let [f4, ti4, tj4] = [lower_rows(f), lower_rows(ti), lower_rows(tj)];
            for k in 0..4 {
                add_pair(to, [first[k], second[k]], [f4[k], ti4[k], tj4[k]]);
            }
            let [f4, ti4, tj4] = [upper_rows(f), upper_rows(ti), upper_rows(tj)];
            for k in 0..4 {
                add_pair(to, [first[k + 4], second[k + 4]], [f4[k], ti4[k], tj4[k]]);
            }
        }
    }
    #[inline(always)]
    fn pack_fours(places: &[u32; 8], order: &[u8; 8], to: &mut [MaybeUninit<u32>; 8]) {
        unsafe { pack_fours(places, order, to) }
    }
    #[inline(always)]
    unsafe fn differences(from: *const f64, of: &[u32; 8], less: &[u32; 8]) -> [Self; 4] {
        unsafe {
            let r = |k: usize| _mm256_sub_pd(quad(from, of[k]), quad(from, less[k]));
            let low = transpose(r(0), r(1), r(2), r(3));
            let high = transpose(r(4), r(5), r(6), r(7));
            std::array::from_fn(|k| Self(low[k], high[k]))
        }
    }
}

/// One record in a register.
#[derive(Clone, Copy)]
pub(super) struct Four(__m256d);

macro_rules! four {
    ($trait:ident, $name:ident, $op:ident) => {
        impl $trait for Four {
            type Output = Self;
            #[inline(always)]
            fn $name(self, o: Self) -> Self {
                // SAFETY: values of this type exist only where AVX2 was detected.
                Self(unsafe { $op(self.0, o.0) })
            }
        }
    };
}
four!(Add, add, _mm256_add_pd);
four!(Sub, sub, _mm256_sub_pd);

impl Mul<f64> for Four {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f64) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_mul_pd(self.0, _mm256_set1_pd(s)) })
    }
}

impl crate::integrate::Vector for Four {}

// SAFETY of all blocks below: as above; records lie at multiples of 32.
impl Quad for Four {
    #[inline(always)]
    fn load(from: &Record) -> Self {
        Self(unsafe { _mm256_load_pd(std::ptr::from_ref(from).cast()) })
    }
    #[inline(always)]
    fn store(self, to: &mut Record) {
        unsafe { _mm256_store_pd(std::ptr::from_mut(to).cast(), self.0) }
    }
    #[inline(always)]
    fn with_scalar_of(self, o: Self) -> Self {
        Self(unsafe { _mm256_blend_pd::<0b1000>(self.0, o.0) })
    }
    #[inline(always)]
    fn length_squared(self) -> f64 {
        unsafe {
            let square = _mm256_mul_pd(self.0, self.0);
            let (xy, z) = (_mm256_castpd256_pd128(square), _mm256_extractf128_pd::<1>(square));
            let sum = _mm_add_sd(xy, _mm_unpackhi_pd(xy, xy));
            _mm_cvtsd_f64(_mm_add_sd(sum, z))
        }
    }
}

/// Two records side by side.
#[derive(Clone, Copy)]
pub(super) struct Eight(__m512d);

macro_rules! eight {
    ($trait:ident, $name:ident, $op:ident) => {
        impl $trait for Eight {
            type Output = Self;
            #[inline(always)]
            fn $name(self, o: Self) -> Self {
                // SAFETY: values of this type exist only where AVX-512 was detected.
                Self(unsafe { $op(self.0, o.0) })
            }
        }
    };
}
eight!(Add, add, _mm512_add_pd);
eight!(Sub, sub, _mm512_sub_pd);

impl Mul<f64> for Eight {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f64) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_mul_pd(self.0, _mm512_set1_pd(s)) })
    }
}

impl crate::integrate::Vector for Eight {}

// SAFETY of all blocks below: as above; two records are eight numbers, and so is a pull.
impl Quads for Eight {
    const COUNT: usize = 2;
    #[inline(always)]
    fn alike(record: &Record) -> Self {
        let one = std::ptr::from_ref(record).cast();
        Self(unsafe { _mm512_broadcast_f64x4(_mm256_load_pd(one)) })
    }
    #[inline(always)]
    fn load_some(from: &[Record]) -> Self {
        let two: &[Record; 2] = from.first_chunk().expect("two records");
        Self(unsafe { _mm512_loadu_pd(std::ptr::from_ref(two).cast()) })
    }
    #[inline(always)]
    fn store_some(self, to: &mut [Record]) {
        let two: &mut [Record; 2] = to.first_chunk_mut().expect("two records");
        unsafe { _mm512_storeu_pd(std::ptr::from_mut(two).cast(), self.0) }
    }
    #[inline(always)]
    fn take(from: &mut [Pull]) -> [Self; 2] {
        let two: &mut [Pull; 2] = from.first_chunk_mut().expect("two pulls");
        unsafe {
            let [a, b] = two.each_mut().map(
                #[inline(always)]
                |pull| std::ptr::from_mut(pull).cast::<f64>(),
            );
            let (first, second) = (_mm512_load_pd(a), _mm512_load_pd(b));
            _mm512_store_pd(a, _mm512_setzero_pd());
            _mm512_store_pd(b, _mm512_setzero_pd());
            let forces = _mm512_shuffle_f64x2::<0x44>(first, second);
            [Self(forces), Self(_mm512_shuffle_f64x2::<0xEE>(first, second))]
        }
    }
    #[inline(always)]
    fn with_scalars_of(self, o: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_pd(0b1000_1000, self.0, o.0) })
    }
    #[inline(always)]
    fn over_scalars_of(self, o: Self) -> Self {
        unsafe {
            let scalars = _mm512_permutex_pd::<0xFF>(o.0);
            Self(_mm512_mul_pd(self.0, _mm512_div_pd(_mm512_set1_pd(1.0), scalars)))
        }
    }
    #[inline(always)]
    fn turned(self, [x, y, z, shift]: &[Self; 4]) -> Self {
        unsafe {
            let along_x = _mm512_mul_pd(x.0, _mm512_permutex_pd::<0x00>(self.0));
            let along_y = _mm512_mul_pd(y.0, _mm512_permutex_pd::<0x55>(self.0));
            let along_z = _mm512_mul_pd(z.0, _mm512_permutex_pd::<0xAA>(self.0));
            let sum = _mm512_add_pd(_mm512_add_pd(along_x, along_y), along_z);
            Self(_mm512_add_pd(sum, shift.0))
        }
    }
    #[inline(always)]
    fn largest_square(self) -> f64 {
        unsafe {
            let square = _mm512_mul_pd(self.0, self.0);
            // In the order of `Four`: x and y, then z.
            let y = _mm512_permutex_pd::<0x55>(square);
            let z = _mm512_permutex_pd::<0xAA>(square);
            let sums = _mm512_add_pd(_mm512_add_pd(square, y), z);
            let a = _mm512_cvtsd_f64(sums);
            let b = _mm256_cvtsd_f64(_mm512_extractf64x4_pd::<1>(sums));
            if a >= b || a.is_nan() { a } else { b }
        }
    }
}
