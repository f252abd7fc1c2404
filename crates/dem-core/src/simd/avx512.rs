//! The lanes of AVX-512.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::mem::MaybeUninit;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::avx::{pack_begins, pack_own, put_quad, quad, sums_at, two};
use super::group::Group;
use super::lanes::{Lanes, Numbers, V3};

/// Eight lanes of one AVX-512 register, whose products are rounded before they are added unless `FUSED`, and whose
/// reciprocals and roots come from the processor's table if `FAST`.
#[derive(Clone, Copy)]
pub(super) struct Wide<const FUSED: bool, const FAST: bool>(__m512d);

macro_rules! wide {
    ($trait:ident, $name:ident, $op:ident) => {
        impl<const FUSED: bool, const FAST: bool> $trait for Wide<FUSED, FAST> {
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

impl<const FUSED: bool, const FAST: bool> Neg for Wide<FUSED, FAST> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: as above.
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

/// Two quads side by side.
///
/// # Safety
/// AVX-512 is there and the numbers of both can be read.
#[inline(always)]
unsafe fn two_quads<const EACH: usize>(from: *const f64, at: [u32; 2]) -> __m512d {
    // SAFETY: by the caller.
    unsafe {
        let low = _mm512_castpd256_pd512(quad::<EACH>(from, at[0]));
        _mm512_insertf64x4::<1>(low, quad::<EACH>(from, at[1]))
    }
}

/// Two quads that follow each other from twice a place on.
///
/// # Safety
/// AVX-512 is there and the numbers of both can be read.
#[inline(always)]
unsafe fn both(from: *const f64, at: u32) -> __m512d {
    // SAFETY: by the caller.
    unsafe { _mm512_loadu_pd(from.add(2 * at as usize)) }
}

/// `(1 / sqrt(1 - e) - 1) / e` for small `e`.
///
/// # Safety
/// AVX-512 is there.
#[inline(always)]
unsafe fn series(e: __m512d) -> __m512d {
    // SAFETY: by the caller.
    unsafe {
        let (a1, a2) = (_mm512_set1_pd(1.0 / 2.0), _mm512_set1_pd(3.0 / 8.0));
        let a3 = _mm512_set1_pd(5.0 / 16.0);
        _mm512_fmadd_pd(_mm512_fmadd_pd(a3, e, a2), e, a1)
    }
}

/// Put the marked ones of sixteen numbers side by side, and zeros behind them.
///
/// # Safety
/// AVX-512 is there and sixteen numbers can be written.
#[inline(always)]
unsafe fn put_marked(of: __m512i, to: *mut i32, marked: u16) {
    // SAFETY: by the caller.
    unsafe { _mm512_storeu_si512(to.cast(), _mm512_maskz_compress_epi32(marked, of)) }
}

/// Put the numbers of eight that `marks` marks side by side, with their highest bit where `highest` has one.
///
/// # Safety
/// AVX-512 is there.
#[inline(always)]
pub(super) unsafe fn put_eight(of: &[u32; 8], [marks, highest]: [u8; 2], to: &mut [u32; 8]) {
    // SAFETY: by the caller; eight numbers are read and eight written.
    unsafe {
        let bit = _mm256_maskz_set1_epi32(highest, i32::MIN);
        let of = _mm256_or_si256(_mm256_loadu_si256(of.as_ptr().cast()), bit);
        _mm256_storeu_si256(to.as_mut_ptr().cast(), _mm256_maskz_compress_epi32(marks, of));
    }
}

/// Places `k` and `k + 4` of eight, then `k + 1` and `k + 5`.
#[inline(always)]
fn sides(p: &[u32; 8], k: usize) -> [[u32; 2]; 2] {
    assert!(k < 3, "within eight");
    // SAFETY: they are some of the eight.
    let [[a, b], [c, d]] = unsafe { [two(p.as_ptr().add(k)), two(p.as_ptr().add(k + 4))] };
    [[a, c], [b, d]]
}

/// Quads `k` and `k + 4` of eight, side by side.
///
/// # Safety
/// AVX-512 is there and the numbers of every quad can be read.
#[inline(always)]
unsafe fn rows<const EACH: usize>(from: *const f64, p: &[u32; 8], k: usize) -> __m512d {
    // SAFETY: by the caller.
    unsafe { two_quads::<EACH>(from, [p[k], p[k + 4]]) }
}

/// Places in two registers, and whatever else.
#[repr(align(64))]
struct Order([i64; 8]);

/// First and second halves of two quads' pairs of fields.
static LOW: Order = Order([0, 1, 8, 9, 4, 5, 12, 13]);
static HIGH: Order = Order([2, 3, 10, 11, 6, 7, 14, 15]);
/// The same of a pair of fields and of a third.
static ROWS: [Order; 4] = [
    Order([0, 1, 8, 0, 4, 5, 12, 0]),
    Order([0, 1, 9, 0, 4, 5, 13, 0]),
    Order([2, 3, 10, 0, 6, 7, 14, 0]),
    Order([2, 3, 11, 0, 6, 7, 15, 0]),
];

/// Three of four lanes; as hidden as the orders are.
static THREE: u8 = 0x77;

impl Order {
    /// As the processor takes it. A compiler that knew the places would put other exchanges in the place of those below, and more.
    ///
    /// # Safety
    /// AVX-512 is there.
    #[inline(always)]
    unsafe fn hidden(&self) -> __m512i {
        // SAFETY: by the caller; eight numbers at a multiple of 64.
        unsafe { (&raw const self.0).cast::<__m512i>().read_volatile() }
    }
}

/// Rows of eight vectors from their fields, and zero where not `three` of four lanes are: `k` and `k + 4` side by side.
///
/// # Safety
/// AVX-512 is there.
#[inline(always)]
unsafe fn vectors_of<const FUSED: bool, const FAST: bool>(
    V3 { x, y, z }: V3<Wide<FUSED, FAST>>,
    three: u8,
) -> [__m512d; 4] {
    // SAFETY: by the caller.
    unsafe {
        let (even, odd) = (_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
        [
            _mm512_maskz_permutex2var_pd(three, even, ROWS[0].hidden(), z.0),
            _mm512_maskz_permutex2var_pd(three, odd, ROWS[1].hidden(), z.0),
            _mm512_maskz_permutex2var_pd(three, even, ROWS[2].hidden(), z.0),
            _mm512_maskz_permutex2var_pd(three, odd, ROWS[3].hidden(), z.0),
        ]
    }
}

/// Rows of eight quads from their fields: `k` and `k + 4` side by side.
///
/// # Safety
/// AVX-512 is there.
#[inline(always)]
unsafe fn rows_of<const FUSED: bool, const FAST: bool>(
    [x, y, z, w]: [Wide<FUSED, FAST>; 4],
) -> [__m512d; 4] {
    // SAFETY: by the caller.
    unsafe {
        let (xy, xy2) = (_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
        let (zw, zw2) = (_mm512_unpacklo_pd(z.0, w.0), _mm512_unpackhi_pd(z.0, w.0));
        let (low, high) = (LOW.hidden(), HIGH.hidden());
        [
            _mm512_permutex2var_pd(xy, low, zw),
            _mm512_permutex2var_pd(xy2, low, zw2),
            _mm512_permutex2var_pd(xy, high, zw),
            _mm512_permutex2var_pd(xy2, high, zw2),
        ]
    }
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

/// Take them away.
///
/// # Safety
/// As above.
#[inline(always)]
unsafe fn take_wide(to: *mut f64, at: u32, wrench: __m512d) {
    // SAFETY: by the caller; sums lie at multiples of 64.
    unsafe {
        let sum = to.add(at as usize);
        _mm512_store_pd(sum, _mm512_sub_pd(_mm512_load_pd(sum), wrench));
    }
}

/// Fields of eight records from four pairs of rows: two rounds of exchanges.
///
/// # Safety
/// AVX-512 is there.
#[inline(always)]
unsafe fn columns<const FUSED: bool, const FAST: bool>(
    [a, b, c, d]: [__m512d; 4],
) -> [Wide<FUSED, FAST>; 4] {
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
impl<const FUSED: bool, const FAST: bool> Numbers for Wide<FUSED, FAST> {
    type Mask = u8;
    const FUSED: bool = FUSED;
    const FAST: bool = FAST;
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
        if FUSED { Self(unsafe { _mm512_fnmadd_pd(a.0, b.0, self.0) }) } else { self - a * b }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn root(self) -> Self {
        if !FAST {
            return self.sqrt();
        }
        // As `reciprocal_root`, times the number.
        unsafe {
            let y = _mm512_rsqrt14_pd(_mm512_max_pd(self.0, _mm512_set1_pd(f64::MIN_POSITIVE)));
            let root = _mm512_mul_pd(self.0, y);
            let e = _mm512_fnmadd_pd(root, y, _mm512_set1_pd(1.0));
            Self(_mm512_fmadd_pd(_mm512_mul_pd(root, e), series(e), root))
        }
    }
    #[inline(always)]
    fn both_roots(self) -> [Self; 2] {
        if !FAST {
            let root = self.sqrt();
            return [root, root.sqrt()];
        }
        // The table asked twice gives `z`, the reciprocal of the fourth root to 9.2e-5. What its fourth power lacks,
        // `e = 1 - x z^4`, is below 3.7e-4: a series whose next term is below 1e-18.
        unsafe {
            let x = self.0;
            let z = _mm512_rsqrt14_pd(_mm512_mul_pd(x, _mm512_rsqrt14_pd(x)));
            let z2 = _mm512_mul_pd(z, z);
            let e = _mm512_fnmadd_pd(_mm512_mul_pd(x, z2), z2, _mm512_set1_pd(1.0));
            let (a1, a2) = (_mm512_set1_pd(1.0 / 4.0), _mm512_set1_pd(5.0 / 32.0));
            let (a3, a4) = (_mm512_set1_pd(15.0 / 128.0), _mm512_set1_pd(195.0 / 2048.0));
            let series = _mm512_fmadd_pd(_mm512_fmadd_pd(a4, e, a3), e, a2);
            let z = _mm512_fmadd_pd(_mm512_mul_pd(z, e), _mm512_fmadd_pd(series, e, a1), z);
            let root = _mm512_mul_pd(x, _mm512_mul_pd(z, z));
            [Self(root), Self(_mm512_mul_pd(root, z))]
        }
    }
    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        // 14 bits from the table. What its square lacks, `e = 1 - x y^2`, is below 1.3e-4, and the root of `1 - e` is in
        // the denominator: a series whose next term is below 7e-17.
        unsafe {
            let y = _mm512_rsqrt14_pd(self.0);
            let e = _mm512_fnmadd_pd(_mm512_mul_pd(self.0, y), y, _mm512_set1_pd(1.0));
            Self(_mm512_fmadd_pd(_mm512_mul_pd(y, e), series(e), y))
        }
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        if !FAST {
            return Self::splat(1.0) / self;
        }
        // 14 bits from the table, and `1 / (1 - e)` as `(1 + e) (1 + e^2)`: the next term is below 2e-17.
        unsafe {
            let y = _mm512_rcp14_pd(self.0);
            let e = _mm512_fnmadd_pd(self.0, y, _mm512_set1_pd(1.0));
            let once = _mm512_fmadd_pd(y, e, y);
            Self(_mm512_fmadd_pd(once, _mm512_mul_pd(e, e), once))
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
impl<const FUSED: bool, const FAST: bool> Lanes for Wide<FUSED, FAST> {
    #[inline(always)]
    fn load(from: &[f64; 8]) -> Self {
        Self(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; 8]) {
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    unsafe fn quads<const EACH: usize>(from: *const f64, p: &[u32; 8]) -> [Self; 4] {
        unsafe {
            let ([a, b], [c, d]) = (sides(p, 0), sides(p, 2));
            let low = [two_quads::<EACH>(from, a), two_quads::<EACH>(from, b)];
            columns([low[0], low[1], two_quads::<EACH>(from, c), two_quads::<EACH>(from, d)])
        }
    }
    #[inline(always)]
    unsafe fn put_quads(fields: [Self; 4], to: *mut f64, p: &[u32; 8]) {
        unsafe {
            let rows = rows_of(fields);
            for k in [0, 2] {
                for (k, [low, high]) in [k, k + 1].into_iter().zip(sides(p, k)) {
                    put_quad(to, low, _mm512_castpd512_pd256(rows[k]));
                    put_quad(to, high, _mm512_extractf64x4_pd::<1>(rows[k]));
                }
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
            // Of the second sphere both are taken away.
            let tj = -tj;
            let three = (&raw const THREE).read_volatile();
            let (f, ti, tj) = (vectors_of(f, three), vectors_of(ti, three), vectors_of(tj, three));
            // In the order of the list: rows 0 to 3 hold the first four contacts in their lower halves.
            for k in [0, 2] {
                let (i, j) = (first.two(k), second.two(k));
                for (k, (i, j)) in [k, k + 1].into_iter().zip(i.into_iter().zip(j)) {
                    let from_second = _mm512_shuffle_f64x2::<0x44>(f[k], tj[k]);
                    add_wide(to, i, _mm512_shuffle_f64x2::<0x44>(f[k], ti[k]));
                    take_wide(to, j, from_second);
                }
            }
            for k in [0, 2] {
                let (i, j) = (first.two(k + 4), second.two(k + 4));
                for (k, (i, j)) in [k, k + 1].into_iter().zip(i.into_iter().zip(j)) {
                    let from_second = _mm512_shuffle_f64x2::<0xEE>(f[k], tj[k]);
                    add_wide(to, i, _mm512_shuffle_f64x2::<0xEE>(f[k], ti[k]));
                    take_wide(to, j, from_second);
                }
            }
        }
    }
    #[inline(always)]
    unsafe fn of_spheres(
        [position, velocities, spin]: [*const f64; 3],
        first: &[u32; 8],
        second: &[u32; 8],
    ) -> [V3<Self>; 5] {
        unsafe {
            // Contact by contact: places of all of them are more than the registers hold.
            let none = _mm512_setzero_pd();
            let mut row = [[none; 4]; 5];
            for k in [0, 2] {
                let (i, j) = (sides(first, k), sides(second, k));
                for (k, (i, j)) in [k, k + 1].into_iter().zip(i.into_iter().zip(j)) {
                    row[0][k] =
                        _mm512_sub_pd(two_quads::<1>(position, j), two_quads::<1>(position, i));
                    // Both velocities of a body are one register.
                    let low = _mm512_sub_pd(both(velocities, i[0]), both(velocities, j[0]));
                    let high = _mm512_sub_pd(both(velocities, i[1]), both(velocities, j[1]));
                    row[1][k] = _mm512_shuffle_f64x2::<0x44>(low, high);
                    row[2][k] = _mm512_shuffle_f64x2::<0xEE>(low, high);
                    row[3][k] = two_quads::<1>(spin, i);
                    row[4][k] = two_quads::<1>(spin, j);
                }
            }
            let of = [columns(row[0]), columns(row[1]), columns(row[2])];
            let spins = [columns(row[3]), columns(row[4])];
            [V3::of(of[0]), V3::of(of[1]), V3::of(of[2]), V3::of(spins[0]), V3::of(spins[1])]
        }
    }
    #[inline(always)]
    fn pack_begins(places: &[u32; 8], order: &[u8; 8], to: &mut [MaybeUninit<u32>; 8]) {
        unsafe { pack_begins(places, order, to) }
    }
    #[inline(always)]
    fn pack_marked(
        (first, second): (&[[u32; 8]], &[[u32; 8]]),
        bits: &[u8],
        room: [&mut [MaybeUninit<u32>]; 3],
    ) -> usize {
        let blocks = bits.len();
        assert!(first.len().min(second.len()) >= blocks, "every mark has its pair");
        assert!(room.iter().all(|room| room.len() >= 8 * blocks + 16), "there is room for all");
        let mut count = 0;
        // SAFETY: sixteen places or, of a last single block, eight are read; no more are written than there is room for behind as many
        // as were read before.
        unsafe {
            let mut own =
                _mm512_setr_epi32(0, 8, 16, 24, 32, 40, 48, 56, 64, 72, 80, 88, 96, 104, 112, 120);
            let [pair, of_first, of_second] = room.map(|room| room.as_mut_ptr().cast::<i32>());
            let from = [first.as_ptr().cast::<i32>(), second.as_ptr().cast::<i32>()];
            for (k, marked) in bits.as_chunks().0.iter().enumerate() {
                let marked = u16::from_le_bytes(*marked);
                let first = _mm512_loadu_si512(from[0].add(16 * k).cast());
                let second = _mm512_loadu_si512(from[1].add(16 * k).cast());
                put_marked(own, pair.add(count), marked);
                put_marked(_mm512_slli_epi32::<3>(first), of_first.add(count), marked);
                put_marked(_mm512_slli_epi32::<3>(second), of_second.add(count), marked);
                count += marked.count_ones() as usize;
                own = _mm512_add_epi32(own, _mm512_set1_epi32(128));
            }
            if let [marked] = bits.as_chunks::<2>().1 {
                let (at, marked) = (8 * (blocks - 1), u16::from(*marked));
                let first = _mm512_maskz_loadu_epi32(0xFF, from[0].add(at));
                let second = _mm512_maskz_loadu_epi32(0xFF, from[1].add(at));
                put_marked(own, pair.add(count), marked);
                put_marked(_mm512_slli_epi32::<3>(first), of_first.add(count), marked);
                put_marked(_mm512_slli_epi32::<3>(second), of_second.add(count), marked);
                count += marked.count_ones() as usize;
            }
        }
        count
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
            columns([
                _mm512_sub_pd(rows::<EACH>(from, of, 0), rows::<EACH>(from, less, 0)),
                _mm512_sub_pd(rows::<EACH>(from, of, 1), rows::<EACH>(from, less, 1)),
                _mm512_sub_pd(rows::<EACH>(from, of, 2), rows::<EACH>(from, less, 2)),
                _mm512_sub_pd(rows::<EACH>(from, of, 3), rows::<EACH>(from, less, 3)),
            ])
        }
    }
}

impl<const FUSED: bool, const FAST: bool> From<[f64; 8]> for Wide<FUSED, FAST> {
    #[inline(always)]
    fn from(each: [f64; 8]) -> Self {
        Self::load(&each)
    }
}

// SAFETY: as above, and by the caller.
impl<const FUSED: bool, const FAST: bool> Group<8> for Wide<FUSED, FAST> {
    #[inline(always)]
    fn which(bits: u8) -> u8 {
        bits
    }
    #[inline(always)]
    fn each(self) -> [f64; 8] {
        let mut each = [0.0; 8];
        self.store(&mut each);
        each
    }
    #[inline(always)]
    fn bits(mask: u8) -> u8 {
        mask
    }
    #[inline(always)]
    unsafe fn quads<const EACH: usize>(from: *const f64, at: &[u32; 8]) -> [Self; 4] {
        unsafe { <Self as Lanes>::quads::<EACH>(from, at) }
    }
    #[inline(always)]
    unsafe fn put_used(v: V3<Self>, scalar: Self, used: u8, to: *mut f64, at: &[u32; 8]) {
        let zero = Self::splat(0.0);
        let v = v.select(used, V3::splat(0.0));
        unsafe { Self::put_quads([v.x, v.y, v.z, scalar.select(used, zero)], to, at) }
    }
}
