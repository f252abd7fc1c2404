//! What the lanes of AVX-512 and of AVX2 share.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::mem::MaybeUninit;

/// # Safety
/// AVX is there and the four numbers of the quad can be read.
#[inline(always)]
pub(super) unsafe fn quad(from: *const f64, at: u32) -> __m256d {
    // SAFETY: by the caller.
    unsafe { _mm256_loadu_pd(from.add(at as usize)) }
}

/// # Safety
/// AVX is there and the four numbers of the quad can be written.
#[inline(always)]
pub(super) unsafe fn put_quad(to: *mut f64, at: u32, four: __m256d) {
    // SAFETY: by the caller.
    unsafe { _mm256_storeu_pd(to.add(at as usize), four) }
}

/// As [`Lanes::pack_fours`].
///
/// # Safety
/// AVX2 is there.
#[inline(always)]
pub(super) unsafe fn pack_fours(
    places: &[u32; 8],
    order: &[u8; 8],
    to: &mut [MaybeUninit<u32>; 8],
) {
    // SAFETY: by the caller; the arrays are as long as what is read and written.
    unsafe {
        let order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(order.as_ptr().cast()));
        let places = _mm256_loadu_si256(places.as_ptr().cast());
        let picked = _mm256_slli_epi32::<2>(_mm256_permutevar8x32_epi32(places, order));
        _mm256_storeu_si256(to.as_mut_ptr().cast(), picked);
    }
}

/// Where the sums of spheres begin, of whose places four times is given.
///
/// # Safety
/// AVX2 is there.
#[inline(always)]
pub(super) unsafe fn sums_at(within: u32, places: &[u32; 8]) -> [u32; 8] {
    let mut at = [0; 8];
    // SAFETY: by the caller; the arrays are as long as what is read and written.
    unsafe {
        let places = _mm256_loadu_si256(places.as_ptr().cast());
        let own = _mm256_and_si256(places, _mm256_set1_epi32(within.cast_signed()));
        _mm256_storeu_si256(at.as_mut_ptr().cast(), _mm256_slli_epi32::<1>(own));
    }
    at
}
