//! One record in a register of AVX2, two in one of AVX-512.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::ops::{Add, Mul, Sub};

use super::avx::transpose;
use super::lanes::{Apart, Quad, Quads};
use crate::integrate::Vector;
use crate::particles::Record;
use crate::sums::Pull;

/// One record in a register.
#[derive(Clone, Copy)]
pub(super) struct Four<const FUSED: bool>(__m256d);

macro_rules! four {
    ($trait:ident, $name:ident, $op:ident) => {
        impl<const FUSED: bool> $trait for Four<FUSED> {
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

impl<const FUSED: bool> Mul<f64> for Four<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f64) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm256_mul_pd(self.0, _mm256_set1_pd(s)) })
    }
}

impl<const FUSED: bool> Vector for Four<FUSED> {
    #[inline(always)]
    fn plus_times(self, o: Self, s: f64) -> Self {
        if !FUSED {
            return self + o * s;
        }
        // SAFETY: as above.
        Self(unsafe { _mm256_fmadd_pd(o.0, _mm256_set1_pd(s), self.0) })
    }
}

// SAFETY of all blocks below: as above; records lie at multiples of 32.
impl<const FUSED: bool> Quad for Four<FUSED> {
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
    #[inline(always)]
    fn four_apart(now: &[Self; 4], then: &[Self; 4], frame: &[Record; 4], noted: &mut Apart<Self>) {
        unsafe {
            let [x, y, z, limits] = transpose(then[0].0, then[1].0, then[2].0, then[3].0);
            let [x, y, z] = [Self(x), Self(y), Self(z)];
            let [now_x, now_y, now_z, _] = transpose(now[0].0, now[1].0, now[2].0, now[3].0);
            let [now_x, now_y, now_z] = [Self(now_x), Self(now_y), Self(now_z)];
            let [a, b, c, shift] = frame;
            let xx = along([x, y, z], now_x, [a.x, b.x, c.x, shift.x]);
            let yy = along([x, y, z], now_y, [a.y, b.y, c.y, shift.y]);
            let zz = along([x, y, z], now_z, [a.z, b.z, c.z, shift.z]);
            let [xx, yy, zz] = [xx.0, yy.0, zz.0];
            // In the order of `length_squared`: x and y, then z.
            let squares = _mm256_add_pd(_mm256_add_pd(xx, yy), zz);
            let beyond = _mm256_cmp_pd::<_CMP_NLE_UQ>(squares, limits);
            noted.beyond |= _mm256_movemask_pd(beyond) as u8;
            // Where one of them is no number this yields the second.
            noted.largest.0 = _mm256_max_pd(squares, noted.largest.0);
        }
    }
    #[inline(always)]
    fn at_least(self, other: f64) -> Self {
        Self(unsafe { _mm256_max_pd(_mm256_set1_pd(other), self.0) })
    }
    #[inline(always)]
    fn greatest(self) -> f64 {
        let Record { x, y, z, w } = self.record();
        x.max(y).max(z.max(w))
    }
}

/// Squares of how far four bodies are along one axis from where they were `then`, by that axis of the frame.
///
/// # Safety
/// AVX2 is there.
#[inline(always)]
unsafe fn along<const FUSED: bool>(
    then: [Four<FUSED>; 3],
    now: Four<FUSED>,
    axis: [f64; 4],
) -> Four<FUSED> {
    let image = (then[0] * axis[0]).plus_times(then[1], axis[1]).plus_times(then[2], axis[2]);
    // SAFETY: by the caller.
    let d = now - (image + Four(unsafe { _mm256_set1_pd(axis[3]) }));
    // SAFETY: by the caller.
    Four(unsafe { _mm256_mul_pd(d.0, d.0) })
}

/// Two records side by side.
#[derive(Clone, Copy)]
pub(super) struct Eight<const FUSED: bool>(__m512d);

macro_rules! eight {
    ($trait:ident, $name:ident, $op:ident) => {
        impl<const FUSED: bool> $trait for Eight<FUSED> {
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

impl<const FUSED: bool> Mul<f64> for Eight<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f64) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_mul_pd(self.0, _mm512_set1_pd(s)) })
    }
}

impl<const FUSED: bool> Vector for Eight<FUSED> {
    #[inline(always)]
    fn plus_times(self, o: Self, s: f64) -> Self {
        // SAFETY: as above.
        self.plus_product(&o, Self(unsafe { _mm512_set1_pd(s) }))
    }
}

impl<const FUSED: bool> Eight<FUSED> {
    /// One over the scalar of each record, in all of its numbers.
    #[inline(always)]
    fn reciprocal_scalars(self) -> Self {
        // SAFETY: as above.
        unsafe {
            let scalars = _mm512_permutex_pd::<0xFF>(self.0);
            Self(_mm512_div_pd(_mm512_set1_pd(1.0), scalars))
        }
    }

    /// `self + a * b`, number by number.
    #[inline(always)]
    fn plus_product(self, a: &Self, b: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe {
            if FUSED {
                _mm512_fmadd_pd(a.0, b.0, self.0)
            } else {
                _mm512_add_pd(self.0, _mm512_mul_pd(a.0, b.0))
            }
        })
    }
}

// SAFETY of all blocks below: as above; two records are eight numbers, and so is a pull.
impl<const FUSED: bool> Quads for Eight<FUSED> {
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
    fn load_twos(from: &[[Record; 2]]) -> [Self; 2] {
        let [first, second]: &[[Record; 2]; 2] = from.first_chunk().expect("two pairs");
        let (a, b) = (Self::load_some(first).0, Self::load_some(second).0);
        unsafe {
            [Self(_mm512_shuffle_f64x2::<0x44>(a, b)), Self(_mm512_shuffle_f64x2::<0xEE>(a, b))]
        }
    }
    #[inline(always)]
    fn store_twos([a, b]: [Self; 2], to: &mut [[Record; 2]]) {
        let [first, second]: &mut [[Record; 2]; 2] = to.first_chunk_mut().expect("two pairs");
        unsafe {
            Self(_mm512_shuffle_f64x2::<0x44>(a.0, b.0)).store_some(first);
            Self(_mm512_shuffle_f64x2::<0xEE>(a.0, b.0)).store_some(second);
        }
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
        Self(unsafe { _mm512_mul_pd(self.0, o.reciprocal_scalars().0) })
    }
    #[inline(always)]
    fn plus_over_scalars(self, o: Self, of: Self) -> Self {
        self.plus_product(&o, of.reciprocal_scalars())
    }
    #[inline(always)]
    fn apart(self, then: Self, frame: &[Record; 4], noted: &mut Apart<Self>) {
        unsafe {
            let [x, y, z, shift] = frame.each_ref().map(Self::alike);
            let along_x = Self(_mm512_mul_pd(x.0, _mm512_permutex_pd::<0x00>(then.0)));
            let along_xy = along_x.plus_product(&y, Self(_mm512_permutex_pd::<0x55>(then.0)));
            let image = along_xy.plus_product(&z, Self(_mm512_permutex_pd::<0xAA>(then.0)));
            let d = (self - (image + shift)).0;
            let square = _mm512_mul_pd(d, d);
            // In the order of `Four`: x and y, then z.
            let y = _mm512_permutex_pd::<0x55>(square);
            let z = _mm512_permutex_pd::<0xAA>(square);
            let sums = _mm512_add_pd(_mm512_add_pd(square, y), z);
            let limits = _mm512_permutex_pd::<0xFF>(then.0);
            // Of the first number of each record.
            noted.note(sums, limits, 0b1_0001);
        }
    }
    #[inline(always)]
    fn four_apart(now: &[Self; 4], then: &[Self; 4], frame: &[Record; 4], noted: &mut Apart<Self>) {
        unsafe {
            let (now, then) = (fields(now), fields(then));
            let [x, y, z, limits] = then;
            let mut square = [_mm512_setzero_pd(); 3];
            let axes: [fn(&Record) -> f64; 3] = [|r| r.x, |r| r.y, |r| r.z];
            for ((square, now), axis) in square.iter_mut().zip(now).zip(axes) {
                let [a, b, c, shift] = [
                    _mm512_set1_pd(axis(&frame[0])),
                    _mm512_set1_pd(axis(&frame[1])),
                    _mm512_set1_pd(axis(&frame[2])),
                    _mm512_set1_pd(axis(&frame[3])),
                ];
                let along_x = Self(_mm512_mul_pd(a, x));
                let image = along_x.plus_product(&Self(b), Self(y)).plus_product(&Self(c), Self(z));
                let d = _mm512_sub_pd(now, _mm512_add_pd(image.0, shift));
                *square = _mm512_mul_pd(d, d);
            }
            let sums = _mm512_add_pd(_mm512_add_pd(square[0], square[1]), square[2]);
            noted.note(sums, limits, u8::MAX);
        }
    }
    #[inline(always)]
    fn largest(self) -> f64 {
        unsafe { _mm512_reduce_max_pd(self.0) }
    }
}

impl<const FUSED: bool> Apart<Eight<FUSED>> {
    /// Note those squares that `which` marks.
    ///
    /// # Safety
    /// AVX-512 is there.
    #[inline(always)]
    unsafe fn note(&mut self, squares: __m512d, limits: __m512d, which: u8) {
        // SAFETY: by the caller.
        unsafe {
            self.beyond |= _mm512_mask_cmp_pd_mask::<_CMP_NLE_UQ>(which, squares, limits);
            // Where one of them is no number this yields the second.
            let largest = self.largest.0;
            self.largest.0 = _mm512_mask_max_pd(largest, which, squares, largest);
        }
    }
}

/// Fields of eight records, in some order of the records.
///
/// # Safety
/// AVX-512 is there.
#[inline(always)]
unsafe fn fields<const FUSED: bool>([a, b, c, d]: &[Eight<FUSED>; 4]) -> [__m512d; 4] {
    // SAFETY: by the caller.
    unsafe {
        let (xz, yw) = (_mm512_unpacklo_pd(a.0, b.0), _mm512_unpackhi_pd(a.0, b.0));
        let (xz2, yw2) = (_mm512_unpacklo_pd(c.0, d.0), _mm512_unpackhi_pd(c.0, d.0));
        [
            _mm512_shuffle_f64x2::<0b10_00_10_00>(xz, xz2),
            _mm512_shuffle_f64x2::<0b10_00_10_00>(yw, yw2),
            _mm512_shuffle_f64x2::<0b11_01_11_01>(xz, xz2),
            _mm512_shuffle_f64x2::<0b11_01_11_01>(yw, yw2),
        ]
    }
}
