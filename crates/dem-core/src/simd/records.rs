//! One record in a register of AVX2, two in one of AVX-512.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::ops::{Add, Mul, Sub};

use super::lanes::{Quad, Quads};
use crate::particles::Record;
use crate::sums::Pull;

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
    fn beyond(self, limit: Self) -> (f64, bool) {
        unsafe {
            let square = _mm512_mul_pd(self.0, self.0);
            // In the order of `Four`: x and y, then z.
            let y = _mm512_permutex_pd::<0x55>(square);
            let z = _mm512_permutex_pd::<0xAA>(square);
            let sums = _mm512_add_pd(_mm512_add_pd(square, y), z);
            let a = _mm512_cvtsd_f64(sums);
            let b = _mm256_cvtsd_f64(_mm512_extractf64x4_pd::<1>(sums));
            let limits = _mm512_permutex_pd::<0xFF>(limit.0);
            let far = !_mm512_mask_cmp_pd_mask::<_CMP_LE_OQ>(0b1_0001, sums, limits) & 0b1_0001;
            (if a >= b { a } else { b }, far != 0)
        }
    }
}
