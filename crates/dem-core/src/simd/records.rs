//! One record in a register of AVX2, two in one of AVX-512.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::ops::{Add, Mul, Sub};

use super::lanes::{Quad, Quads};
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

impl<const FUSED: bool> crate::integrate::Vector for Four<FUSED> {
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

impl<const FUSED: bool> crate::integrate::Vector for Eight<FUSED> {
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
    fn turned(self, [x, y, z, shift]: &[Self; 4]) -> Self {
        unsafe {
            let along_x = Self(_mm512_mul_pd(x.0, _mm512_permutex_pd::<0x00>(self.0)));
            let along_xy = along_x.plus_product(y, Self(_mm512_permutex_pd::<0x55>(self.0)));
            let sum = along_xy.plus_product(z, Self(_mm512_permutex_pd::<0xAA>(self.0)));
            sum + *shift
        }
    }
    #[inline(always)]
    fn beyond(self, limit: Self) -> (Self, u8) {
        unsafe {
            let square = _mm512_mul_pd(self.0, self.0);
            // In the order of `Four`: x and y, then z.
            let y = _mm512_permutex_pd::<0x55>(square);
            let z = _mm512_permutex_pd::<0xAA>(square);
            let sums = _mm512_add_pd(_mm512_add_pd(square, y), z);
            let limits = _mm512_permutex_pd::<0xFF>(limit.0);
            // Of the first number of each record.
            (Self(sums), _mm512_mask_cmp_pd_mask::<_CMP_NLE_UQ>(0b1_0001, sums, limits))
        }
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        // Where one of them is no number this yields the second.
        Self(unsafe { _mm512_max_pd(other.0, self.0) })
    }
    #[inline(always)]
    fn largest(self) -> f64 {
        let [a, b] = unsafe {
            [_mm512_cvtsd_f64(self.0), _mm256_cvtsd_f64(_mm512_extractf64x4_pd::<1>(self.0))]
        };
        if a >= b { a } else { b }
    }
}
