//! What the lanes of AVX-512 and both kinds of AVX2 share.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::mem::MaybeUninit;

/// Four numbers from `EACH` times a beginning on, which is counted by halves of a number.
///
/// # Safety
/// AVX is there and the four numbers of the quad can be read.
#[inline(always)]
pub(super) unsafe fn quad<const EACH: usize>(from: *const f64, at: u32) -> __m256d {
    // SAFETY: by the caller. The product is one of addresses: of places it would be cut off and widened again.
    unsafe { _mm256_loadu_pd(beginning(from, EACH * at as usize)) }
}

/// Where numbers begin, counted by halves of them.
#[inline(always)]
pub(super) fn beginning(from: *const f64, at: usize) -> *const f64 {
    from.cast::<f32>().wrapping_add(at).cast()
}

/// # Safety
/// AVX is there and the four numbers of the quad can be written.
#[inline(always)]
pub(super) unsafe fn put_quad(to: *mut f64, at: u32, four: __m256d) {
    // SAFETY: by the caller.
    unsafe { _mm256_storeu_pd(to.cast::<f32>().add(at as usize).cast(), four) }
}

/// As [`Lanes::pack_begins`].
///
/// # Safety
/// AVX2 is there.
#[inline(always)]
pub(super) unsafe fn pack_begins(
    places: &[u32; 8],
    order: &[u8; 8],
    to: &mut [MaybeUninit<u32>; 8],
) {
    // SAFETY: by the caller; the arrays are as long as what is read and written.
    unsafe {
        let order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(order.as_ptr().cast()));
        let places = _mm256_loadu_si256(places.as_ptr().cast());
        let picked = _mm256_slli_epi32::<3>(_mm256_permutevar8x32_epi32(places, order));
        _mm256_storeu_si256(to.as_mut_ptr().cast(), picked);
    }
}

/// As [`Lanes::pack_own`].
///
/// # Safety
/// AVX2 is there.
#[inline(always)]
pub(super) unsafe fn pack_own(begin: u32, order: &[u8; 8], to: &mut [MaybeUninit<u32>; 8]) {
    // SAFETY: by the caller; the arrays are as long as what is read and written.
    unsafe {
        let order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(order.as_ptr().cast()));
        let own = _mm256_add_epi32(order, _mm256_set1_epi32(begin.cast_signed()));
        _mm256_storeu_si256(to.as_mut_ptr().cast(), _mm256_slli_epi32::<3>(own));
    }
}

/// Where the sums of eight spheres begin.
#[repr(align(8))]
pub(super) struct SumsAt([u32; 8]);

impl SumsAt {
    /// Those of spheres `lane` and `lane + 1`, of which `lane` is even.
    #[inline(always)]
    pub(super) fn two(&self, lane: usize) -> [u32; 2] {
        let both = self.0[lane..].first_chunk::<2>().expect("two of eight");
        // SAFETY: numbers of ours at a multiple of eight.
        let both = unsafe { std::ptr::from_ref(both).cast::<u64>().read_volatile() };
        [both as u32, (both >> 32) as u32]
    }

    /// That of one sphere. From the memory: compilers would rather take numbers out of the register, which keeps busy what
    /// exchanges fields.
    #[inline(always)]
    pub(super) fn of(&self, lane: usize) -> u32 {
        // SAFETY: a number of ours.
        unsafe { (&raw const self.0[lane]).read_volatile() }
    }
}

/// Two numbers that follow each other, by one access to the memory: accesses are what contacts wait for, and the other operations it
/// takes are free.
///
/// # Safety
/// Both can be read.
#[inline(always)]
pub(super) unsafe fn two(at: *const u32) -> [u32; 2] {
    // SAFETY: by the caller.
    let both = unsafe { at.cast::<u64>().read_unaligned() };
    [both as u32, (both >> 32) as u32]
}

/// Where the sums of spheres begin, of whose records that is given.
///
/// # Safety
/// AVX2 is there.
#[inline(always)]
pub(super) unsafe fn sums_at(within: u32, places: &[u32; 8]) -> SumsAt {
    let mut at = [0; 8];
    // SAFETY: by the caller; the arrays are as long as what is read and written.
    unsafe {
        let places = _mm256_loadu_si256(places.as_ptr().cast());
        let own = _mm256_and_si256(places, _mm256_set1_epi32(within.cast_signed()));
        _mm256_storeu_si256(at.as_mut_ptr().cast(), own);
    }
    SumsAt(at)
}

/// Four bits as a mask of four lanes.
///
/// # Safety
/// AVX2 is there.
#[inline(always)]
pub(super) unsafe fn mask4(bits: u8) -> __m256d {
    // SAFETY: by the caller.
    unsafe {
        let lane = _mm256_setr_epi64x(1, 2, 4, 8);
        let all = _mm256_set1_epi64x(i64::from(bits));
        _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(all, lane), lane))
    }
}

/// Fields from rows and rows from fields.
///
/// # Safety
/// AVX is there.
#[inline(always)]
pub(super) unsafe fn transpose(a: __m256d, b: __m256d, c: __m256d, d: __m256d) -> [__m256d; 4] {
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

/// Add force and torques of one contact to the sums of both spheres.
///
/// # Safety
/// AVX is there and both sums can be written.
#[inline(always)]
pub(super) unsafe fn add_pair(to: *mut f64, at: [u32; 2], [f, ti, tj]: [__m256d; 3]) {
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
