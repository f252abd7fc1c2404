//! Eight numbers side by side, and vectors of them.

use std::mem::MaybeUninit;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use glam::DVec3;

use crate::neighbour::Period;
use crate::neighbour::search::SET_BITS;
use crate::particles::Record;
use crate::sums::Pull;
use crate::threads::View;

/// Numbers side by side, on which laws are written once.
pub(crate) trait Numbers:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// One bit a lane.
    type Mask: Mask;
    /// Whether a product is added to something without being rounded first.
    const FUSED: bool = false;
    /// Whether reciprocals and roots may be off in the last places.
    const FAST: bool = false;
    /// Whether lanes are so few that what one in two groups needs is done for all rather than asked about.
    const FEW: bool = false;
    /// The same number in every lane.
    fn splat(x: f64) -> Self;
    /// `self * factor + o`; rounded once where the numbers are fused.
    #[inline(always)]
    fn times_plus(self, factor: Self, o: Self) -> Self {
        self * factor + o
    }
    /// `self * factor - o`, likewise.
    #[inline(always)]
    fn times_less(self, factor: Self, o: Self) -> Self {
        self * factor - o
    }
    /// `self - a * b`, likewise.
    #[inline(always)]
    fn less_times(self, a: Self, b: Self) -> Self {
        self - a * b
    }
    fn sqrt(self) -> Self;
    /// The root of what is not negative, from the reciprocal one where the numbers are fast.
    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }
    /// The root of what is positive, and the root of that; to about four units in the last place where the numbers are fast.
    #[inline(always)]
    fn both_roots(self) -> [Self; 2] {
        let root = self.root();
        [root, root.root()]
    }
    /// `1 / sqrt(x)` to about two units in the last place, `x` positive and normal.
    fn reciprocal_root(self) -> Self;
    /// `1 / x`; to about two units in the last place where the numbers are fast.
    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self::splat(1.0) / self
    }
    fn abs(self) -> Self;
    /// Larger of two numbers, `other` where they cannot be compared.
    fn max(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    /// One bit a lane: `self < other`, false for what cannot be compared.
    fn less(self, other: Self) -> Self::Mask;
    /// `self` in the lanes of `mask`, `other` elsewhere.
    fn select(self, mask: Self::Mask, other: Self) -> Self;
    /// `self` in the lanes of `mask`, zero elsewhere.
    #[inline(always)]
    fn only(self, mask: Self::Mask) -> Self {
        self.select(mask, Self::splat(0.0))
    }
    /// A function of each by itself: slow.
    fn one_by_one(self, f: fn(f64) -> f64) -> Self;
}

/// Bits of lanes.
pub(crate) trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// Whether no bit is set.
    fn is_empty(self) -> bool;
}

impl Mask for u8 {
    #[inline(always)]
    fn is_empty(self) -> bool {
        self == 0
    }
}

impl Mask for bool {
    #[inline(always)]
    fn is_empty(self) -> bool {
        !self
    }
}

/// One number by itself.
impl Numbers for f64 {
    type Mask = bool;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        1.0 / self.sqrt()
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if other < self { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn select(self, mask: bool, other: Self) -> Self {
        if mask { self } else { other }
    }
    #[inline(always)]
    fn one_by_one(self, f: fn(f64) -> f64) -> Self {
        f(self)
    }
}

/// Eight numbers in one or several registers.
pub(crate) trait Lanes: Numbers<Mask = u8> {
    fn load(from: &[f64; 8]) -> Self;
    fn store(self, to: &mut [f64; 8]);
    /// Four numbers from `EACH` times each of eight beginnings on, counted by halves of a number, one vector for each of the four.
    ///
    /// # Safety
    /// All of them can be read.
    unsafe fn quads<const EACH: usize>(from: *const f64, at: &[u32; 8]) -> [Self; 4];
    /// Put them there.
    ///
    /// # Safety
    /// All of them can be written.
    unsafe fn put_quads(fields: [Self; 4], to: *mut f64, at: &[u32; 8]);
    /// Add eight wrenches (force, torques on the first and on the second sphere, as fields) one after the other
    /// to the sums of their spheres: of where their records begin counts what is `within`, and that many numbers on lie
    /// four numbers of force (the second sphere feels the opposite) and four of torque.
    ///
    /// # Safety
    /// All of them can be read and written.
    unsafe fn add_wrenches(
        wrenches: [V3<Self>; 3],
        to: *mut f64,
        within: u32,
        first: &[u32; 8],
        second: &[u32; 8],
    );
    /// Four numbers from `EACH` times each of eight beginnings on, less those of eight others.
    ///
    /// # Safety
    /// All of them can be read.
    unsafe fn differences<const EACH: usize>(
        from: *const f64,
        of: &[u32; 8],
        less: &[u32; 8],
    ) -> [Self; 4];
    /// What contacts of spheres alike gather: of the second spheres' positions those of the first ones taken away, of the first
    /// ones' mean velocities and velocities at the end those of the second ones, and the spins of both.
    ///
    /// # Safety
    /// All of them can be read.
    #[inline(always)]
    unsafe fn of_spheres(
        [position, velocities, spin]: [*const f64; 3],
        first: &[u32; 8],
        second: &[u32; 8],
    ) -> [V3<Self>; 5] {
        // SAFETY: by the caller.
        unsafe {
            let apart = V3::of(Self::differences::<1>(position, second, first));
            let approach = V3::of(Self::differences::<2>(velocities, first, second));
            let end = V3::of(Self::differences::<2>(velocities.add(4), first, second));
            let spins = [Self::quads::<1>(spin, first), Self::quads::<1>(spin, second)];
            [apart, approach, end, V3::of(spins[0]), V3::of(spins[1])]
        }
    }
    /// Where the numbers of records begin that `order` picks among eight, of which the places are given.
    fn pack_begins(places: &[u32; 8], order: &[u8; 8], to: &mut [MaybeUninit<u32>; 8]);
    /// The same of eight places that follow each other from `begin` on.
    fn pack_own(begin: u32, order: &[u8; 8], to: &mut [MaybeUninit<u32>; 8]);
    /// Of the pairs of blocks those that `bits` marks: where their numbers in the run begin, and those of their spheres. Behind them,
    /// as far as a register goes, anything is written. Returns how many they are.
    #[inline(always)]
    fn pack_marked(
        (first, second): (&[[u32; 8]], &[[u32; 8]]),
        bits: &[u8],
        [pair, of_first, of_second]: [&mut [MaybeUninit<u32>]; 3],
    ) -> usize {
        let mut count = 0;
        for (k, ((first, second), bits)) in first.iter().zip(second).zip(bits).enumerate() {
            let order = &SET_BITS[usize::from(*bits)];
            if let Some(to) = pair[count..].first_chunk_mut() {
                Self::pack_own(8 * k as u32, order, to);
            }
            for (from, to) in [(first, &mut *of_first), (second, &mut *of_second)] {
                if let Some(to) = to[count..].first_chunk_mut() {
                    Self::pack_begins(from, order, to);
                }
            }
            count += bits.count_ones() as usize;
        }
        count
    }
    /// The records at eight places, one vector a field.
    ///
    /// # Safety
    /// Every place is below the length of `records`.
    #[inline(always)]
    unsafe fn gather(records: View<'_, Record>, places: &[u32; 8]) -> [Self; 4] {
        debug_assert!(places.iter().all(|p| (*p as usize) < records.len()));
        // SAFETY: by the caller; a record is four numbers.
        unsafe { Self::quads::<{ RECORD as usize }>(records.as_ptr().cast(), places) }
    }
    /// The first and the second ones of pairs of records, eight pairs at these places.
    ///
    /// # Safety
    /// Every place is below the number of `pairs`.
    #[inline(always)]
    unsafe fn gather_twos(pairs: View<'_, [Record; 2]>, places: &[u32; 8]) -> [[Self; 4]; 2] {
        debug_assert!(places.iter().all(|p| (*p as usize) < pairs.len()));
        // SAFETY: by the caller; a pair of records is eight numbers.
        unsafe {
            let from: *const f64 = pairs.as_ptr().cast();
            [
                Self::quads::<{ 2 * RECORD as usize }>(from, places),
                Self::quads::<{ 2 * RECORD as usize }>(from.add(4), places),
            ]
        }
    }
    /// Eight records from their fields.
    #[inline(always)]
    fn scatter(fields: [Self; 4], to: &mut [Record; 8]) {
        // SAFETY: eight records are eight times four numbers.
        unsafe {
            Self::put_quads(fields, to.as_mut_ptr().cast(), &begins(&[0, 1, 2, 3, 4, 5, 6, 7]));
        }
    }
}

/// A record as its beginning is counted: by halves of a number, since addresses take what is counted times one, four or eight.
/// So those of records, of pairs of them and of sums need no arithmetic.
pub(super) const RECORD: u32 = 8;

/// Where the numbers of records begin.
#[inline(always)]
pub(super) fn begins<const N: usize>(places: &[u32; N]) -> [u32; N] {
    let mut begins = [0; N];
    // Not by `map`: its closure would not be compiled for the instructions of the kernel.
    for (begin, place) in begins.iter_mut().zip(places) {
        *begin = RECORD * place;
    }
    begins
}

/// Along a periodic axis, the shortest of the images of `x`.
#[inline(always)]
fn shortest<V: Numbers>(x: V, length: f64) -> V {
    let (half, length) = (V::splat(0.5 * length), V::splat(length));
    (x + length).select(x.less(-half), (x - length).select(half.less(x), x))
}

/// Three vectors of lanes.
#[derive(Clone, Copy)]
pub(crate) struct V3<V> {
    pub(crate) x: V,
    pub(crate) y: V,
    pub(crate) z: V,
}

impl<V: Numbers> V3<V> {
    #[inline(always)]
    pub(crate) fn of(f: [V; 4]) -> Self {
        Self { x: f[0], y: f[1], z: f[2] }
    }

    #[inline(always)]
    pub(crate) fn splat(x: f64) -> Self {
        Self { x: V::splat(x), y: V::splat(x), z: V::splat(x) }
    }

    #[inline(always)]
    pub(crate) fn dot(self, o: Self) -> V {
        self.z.times_plus(o.z, self.y.times_plus(o.y, self.x * o.x))
    }

    /// `self * s + o`.
    #[inline(always)]
    pub(crate) fn times_plus(self, s: V, o: Self) -> Self {
        Self {
            x: self.x.times_plus(s, o.x),
            y: self.y.times_plus(s, o.y),
            z: self.z.times_plus(s, o.z),
        }
    }

    /// `self * s - o`.
    #[inline(always)]
    pub(crate) fn times_less(self, s: V, o: Self) -> Self {
        Self {
            x: self.x.times_less(s, o.x),
            y: self.y.times_less(s, o.y),
            z: self.z.times_less(s, o.z),
        }
    }

    /// `self - v * s`.
    #[inline(always)]
    pub(crate) fn less_times(self, v: Self, s: V) -> Self {
        Self {
            x: self.x.less_times(s, v.x),
            y: self.y.less_times(s, v.y),
            z: self.z.less_times(s, v.z),
        }
    }

    /// `self x o + to`.
    #[inline(always)]
    pub(crate) fn cross_plus(self, o: Self, to: Self) -> Self {
        if V::FUSED {
            Self {
                x: self.y.times_plus(o.z, to.x.less_times(self.z, o.y)),
                y: self.z.times_plus(o.x, to.y.less_times(self.x, o.z)),
                z: self.x.times_plus(o.y, to.z.less_times(self.y, o.x)),
            }
        } else {
            to + self.cross(o)
        }
    }

    #[inline(always)]
    pub(crate) fn cross(self, o: Self) -> Self {
        Self {
            x: (self.y * o.z).less_times(o.y, self.z),
            y: (self.z * o.x).less_times(o.z, self.x),
            z: (self.x * o.y).less_times(o.x, self.y),
        }
    }

    /// Component by component.
    #[inline(always)]
    pub(crate) fn times(self, o: Self) -> Self {
        Self { x: self.x * o.x, y: self.y * o.y, z: self.z * o.z }
    }

    /// The shortest image along the periodic axis, as [`Period::shortest`] finds it for places that
    /// lie less than one and a half periods apart, as all places of a list do.
    #[inline(always)]
    pub(super) fn shortest(self, p: Period) -> Self {
        // By value: an axis chosen by reference would keep all three in memory.
        match p.axis {
            0 => Self { x: shortest(self.x, p.length), ..self },
            1 => Self { y: shortest(self.y, p.length), ..self },
            _ => Self { z: shortest(self.z, p.length), ..self },
        }
    }

    #[inline(always)]
    pub(crate) fn select(self, mask: V::Mask, other: Self) -> Self {
        Self {
            x: self.x.select(mask, other.x),
            y: self.y.select(mask, other.y),
            z: self.z.select(mask, other.z),
        }
    }
}

impl From<DVec3> for V3<f64> {
    #[inline(always)]
    fn from(v: DVec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<V3<f64>> for DVec3 {
    #[inline(always)]
    fn from(v: V3<f64>) -> Self {
        DVec3::new(v.x, v.y, v.z)
    }
}

impl<V: Numbers> Add for V3<V> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}

impl<V: Numbers> Sub for V3<V> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}

impl<V: Numbers> Mul<V> for V3<V> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: V) -> Self {
        Self { x: self.x * s, y: self.y * s, z: self.z * s }
    }
}

impl<V: Numbers> Neg for V3<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}

/// One record as four numbers side by side.
pub(crate) trait Quad: crate::integrate::Vector {
    fn load(from: &Record) -> Self;
    fn store(self, to: &mut Record);
    /// This vector with the scalar of another record.
    fn with_scalar_of(self, other: Self) -> Self;
    /// Of the vector, without the scalar.
    fn length_squared(self) -> f64;
    /// Square of the distance from where `then` is in a frame that has turned.
    #[inline(always)]
    fn apart_squared(self, then: &Record, [x, y, z, shift]: &[Record; 4]) -> f64 {
        let along_x = Self::load(x) * then.x;
        let image = along_x.plus_times(Self::load(y), then.y).plus_times(Self::load(z), then.z);
        (self - (image + Self::load(shift))).length_squared()
    }
    /// Note how far four of them are, as [`Quads::four_apart`].
    #[inline(always)]
    fn four_apart(now: &[Self; 4], then: &[Self; 4], frame: &[Record; 4], noted: &mut Apart<Self>) {
        for (now, then) in now.iter().zip(then) {
            Quads::apart(*now, *then, frame, noted);
        }
    }
    /// These numbers, or a larger one instead of each that is less or no number.
    fn at_least(self, other: f64) -> Self;
    /// The largest of its numbers.
    fn greatest(self) -> f64;
    /// As a record.
    #[inline(always)]
    fn record(self) -> Record {
        let mut record = Record::ZERO;
        self.store(&mut record);
        record
    }
}

impl Quad for Record {
    #[inline(always)]
    fn load(from: &Record) -> Self {
        *from
    }
    #[inline(always)]
    fn store(self, to: &mut Record) {
        *to = self;
    }
    #[inline(always)]
    fn with_scalar_of(self, other: Self) -> Self {
        Self { w: other.w, ..self }
    }
    #[inline(always)]
    fn length_squared(self) -> f64 {
        self.vector().length_squared()
    }
    #[inline(always)]
    fn at_least(self, other: f64) -> Self {
        // All four are the same.
        if other > self.x { Self::splat(other) } else { self }
    }
    #[inline(always)]
    fn greatest(self) -> f64 {
        self.x
    }
}

/// Records of one body or of several that follow each other.
pub(crate) trait Quads: crate::integrate::Vector {
    /// How many.
    const COUNT: usize;
    /// The same record for each.
    fn alike(record: &Record) -> Self;
    /// The first records of a run.
    fn load_some(from: &[Record]) -> Self;
    fn store_some(self, to: &mut [Record]);
    /// The first and the second ones of the first pairs of a run.
    fn load_twos(from: &[[Record; 2]]) -> [Self; 2];
    fn store_twos(of_two: [Self; 2], to: &mut [[Record; 2]]);
    /// Forces and torques on the first bodies of a run, which are zero then.
    fn take(from: &mut [Pull]) -> [Self; 2];
    /// These vectors with the scalars of other records.
    fn with_scalars_of(self, other: Self) -> Self;
    /// Vectors divided by the scalars of other records, by way of their reciprocals.
    fn over_scalars_of(self, other: Self) -> Self;
    /// These vectors and others, which are divided by the scalars of `of` in that way.
    fn plus_over_scalars(self, other: Self, of: Self) -> Self;
    /// Note how far these are from where they were `then`, `frame[0] x + frame[1] y + frame[2] z + frame[3]` now, and whether they are
    /// not within the scalars of that, squared.
    fn apart(self, then: Self, frame: &[Record; 4], noted: &mut Apart<Self>);
    /// The same of four of them.
    fn four_apart(now: &[Self; 4], then: &[Self; 4], frame: &[Record; 4], noted: &mut Apart<Self>);
    /// The largest of all numbers.
    fn largest(self) -> f64;
}

/// How far bodies have moved.
pub(crate) struct Apart<W> {
    /// Squares of the largest displacements, one of them the largest of all; of what is no number none is kept.
    pub(crate) largest: W,
    /// Bits of those that are too far away, or nowhere.
    pub(crate) beyond: u8,
}

impl<Q: Quad> Quads for Q {
    const COUNT: usize = 1;
    #[inline(always)]
    fn alike(record: &Record) -> Self {
        Q::load(record)
    }
    #[inline(always)]
    fn load_some(from: &[Record]) -> Self {
        Q::load(&from[0])
    }
    #[inline(always)]
    fn store_some(self, to: &mut [Record]) {
        self.store(&mut to[0]);
    }
    #[inline(always)]
    fn load_twos(from: &[[Record; 2]]) -> [Self; 2] {
        [Q::load(&from[0][0]), Q::load(&from[0][1])]
    }
    #[inline(always)]
    fn store_twos(of_two: [Self; 2], to: &mut [[Record; 2]]) {
        of_two[0].store(&mut to[0][0]);
        of_two[1].store(&mut to[0][1]);
    }
    #[inline(always)]
    fn take(from: &mut [Pull]) -> [Self; 2] {
        let Pull { force, torque } = std::mem::take(&mut from[0]);
        [Q::load(&force), Q::load(&torque)]
    }
    #[inline(always)]
    fn with_scalars_of(self, other: Self) -> Self {
        self.with_scalar_of(other)
    }
    #[inline(always)]
    fn over_scalars_of(self, other: Self) -> Self {
        self * (1.0 / other.record().w)
    }
    #[inline(always)]
    fn plus_over_scalars(self, other: Self, of: Self) -> Self {
        self.plus_times(other, 1.0 / of.record().w)
    }
    #[inline(always)]
    fn apart(self, then: Self, frame: &[Record; 4], noted: &mut Apart<Self>) {
        let then = then.record();
        let square = self.apart_squared(&then, frame);
        noted.beyond |= u8::from(!(square <= then.w));
        noted.largest = noted.largest.at_least(square);
    }
    #[inline(always)]
    fn four_apart(now: &[Self; 4], then: &[Self; 4], frame: &[Record; 4], noted: &mut Apart<Self>) {
        Quad::four_apart(now, then, frame, noted);
    }
    #[inline(always)]
    fn largest(self) -> f64 {
        self.greatest()
    }
}
