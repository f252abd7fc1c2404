//! One or two blocks of eight contacts: two side by side keep the processor busy while each waits for its
//! own long chain of operations.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::lanes::{Lanes, Mask, Numbers, V3};

/// Most blocks at once.
pub(super) const MOST: usize = 2;

/// Numbers of whole blocks of contacts.
pub(super) trait Blocks: Numbers {
    /// How many blocks.
    const COUNT: usize;
    /// The bits of all blocks.
    fn mask(bits: [u8; MOST]) -> Self::Mask;
    /// The bits of each block.
    fn bits(mask: Self::Mask) -> [u8; MOST];
    /// Numbers by block and lane.
    fn of(f: impl Fn(usize, usize) -> f64) -> Self;
    /// The numbers of each block.
    fn each(self) -> [[f64; 8]; MOST];
    /// As [`Lanes::quads`], block by block.
    ///
    /// # Safety
    /// All of them can be read.
    unsafe fn quads<const EACH: usize>(from: *const f64, at: &[[u32; 8]]) -> [Self; 4];
    /// As [`Lanes::put_quads`], block by block.
    ///
    /// # Safety
    /// All of them can be written.
    unsafe fn put_quads(fields: [Self; 4], to: *mut f64, at: &[[u32; 8]]);
    /// As [`Lanes::add_wrenches`], block by block.
    ///
    /// # Safety
    /// All of them can be read and written.
    unsafe fn add_wrenches(
        wrenches: [V3<Self>; 3],
        to: *mut f64,
        within: u32,
        first: &[[u32; 8]],
        second: &[[u32; 8]],
    );
    /// As [`Lanes::of_spheres`], block by block.
    ///
    /// # Safety
    /// All of them can be read.
    unsafe fn of_spheres(
        from: [*const f64; 3],
        first: &[[u32; 8]],
        second: &[[u32; 8]],
    ) -> [V3<Self>; 5];
    /// As [`Lanes::differences`], block by block.
    ///
    /// # Safety
    /// All of them can be read.
    unsafe fn differences<const EACH: usize>(
        from: *const f64,
        of: &[[u32; 8]],
        less: &[[u32; 8]],
    ) -> [Self; 4];
}

impl<V: Lanes> Blocks for V {
    const COUNT: usize = 1;
    #[inline(always)]
    fn mask(bits: [u8; MOST]) -> u8 {
        bits[0]
    }
    #[inline(always)]
    fn bits(mask: u8) -> [u8; MOST] {
        [mask, 0]
    }
    #[inline(always)]
    fn of(f: impl Fn(usize, usize) -> f64) -> Self {
        V::load(&std::array::from_fn(|lane| f(0, lane)))
    }
    #[inline(always)]
    fn each(self) -> [[f64; 8]; MOST] {
        let mut all = [[0.0; 8]; MOST];
        self.store(&mut all[0]);
        all
    }
    #[inline(always)]
    unsafe fn quads<const EACH: usize>(from: *const f64, at: &[[u32; 8]]) -> [Self; 4] {
        // SAFETY: by the caller.
        unsafe { <V as Lanes>::quads::<EACH>(from, &at[0]) }
    }
    #[inline(always)]
    unsafe fn put_quads(fields: [Self; 4], to: *mut f64, at: &[[u32; 8]]) {
        // SAFETY: by the caller.
        unsafe { <V as Lanes>::put_quads(fields, to, &at[0]) }
    }
    #[inline(always)]
    unsafe fn add_wrenches(
        wrenches: [V3<Self>; 3],
        to: *mut f64,
        within: u32,
        first: &[[u32; 8]],
        second: &[[u32; 8]],
    ) {
        // SAFETY: by the caller.
        unsafe { <V as Lanes>::add_wrenches(wrenches, to, within, &first[0], &second[0]) }
    }
    #[inline(always)]
    unsafe fn of_spheres(
        from: [*const f64; 3],
        first: &[[u32; 8]],
        second: &[[u32; 8]],
    ) -> [V3<Self>; 5] {
        // SAFETY: by the caller.
        unsafe { <V as Lanes>::of_spheres(from, &first[0], &second[0]) }
    }
    #[inline(always)]
    unsafe fn differences<const EACH: usize>(
        from: *const f64,
        of: &[[u32; 8]],
        less: &[[u32; 8]],
    ) -> [Self; 4] {
        // SAFETY: by the caller.
        unsafe { <V as Lanes>::differences::<EACH>(from, &of[0], &less[0]) }
    }
}

/// Two blocks side by side.
#[derive(Clone, Copy)]
pub(super) struct Two<V>(V, V);

/// Bits of two blocks.
#[derive(Clone, Copy)]
pub(super) struct TwoBits(u8, u8);

impl BitAnd for TwoBits {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        Self(self.0 & o.0, self.1 & o.1)
    }
}

impl BitOr for TwoBits {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        Self(self.0 | o.0, self.1 | o.1)
    }
}

impl Not for TwoBits {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

impl Mask for TwoBits {
    #[inline(always)]
    fn is_empty(self) -> bool {
        self.0 | self.1 == 0
    }
}

macro_rules! two {
    ($($trait:ident $name:ident),*) => {$(
        impl<V: Lanes> $trait for Two<V> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, o: Self) -> Self {
                Self(self.0.$name(o.0), self.1.$name(o.1))
            }
        }
    )*};
}
two!(Add add, Sub sub, Mul mul, Div div);

impl<V: Lanes> Neg for Two<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl<V: Lanes> Numbers for Two<V> {
    type Mask = TwoBits;
    const FUSED: bool = V::FUSED;
    const FAST: bool = V::FAST;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(V::splat(x), V::splat(x))
    }
    #[inline(always)]
    fn times_plus(self, f: Self, o: Self) -> Self {
        Self(self.0.times_plus(f.0, o.0), self.1.times_plus(f.1, o.1))
    }
    #[inline(always)]
    fn times_less(self, f: Self, o: Self) -> Self {
        Self(self.0.times_less(f.0, o.0), self.1.times_less(f.1, o.1))
    }
    #[inline(always)]
    fn less_times(self, a: Self, b: Self) -> Self {
        Self(self.0.less_times(a.0, b.0), self.1.less_times(a.1, b.1))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        Self(self.0.reciprocal_root(), self.1.reciprocal_root())
    }
    #[inline(always)]
    fn root(self) -> Self {
        Self(self.0.root(), self.1.root())
    }
    #[inline(always)]
    fn both_roots(self) -> [Self; 2] {
        let (a, b) = (self.0.both_roots(), self.1.both_roots());
        [Self(a[0], b[0]), Self(a[1], b[1])]
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self(self.0.reciprocal(), self.1.reciprocal())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self(self.0.max(o.0), self.1.max(o.1))
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self(self.0.min(o.0), self.1.min(o.1))
    }
    #[inline(always)]
    fn less(self, o: Self) -> TwoBits {
        TwoBits(self.0.less(o.0), self.1.less(o.1))
    }
    #[inline(always)]
    fn select(self, mask: TwoBits, o: Self) -> Self {
        Self(self.0.select(mask.0, o.0), self.1.select(mask.1, o.1))
    }
    #[inline(always)]
    fn one_by_one(self, f: fn(f64) -> f64) -> Self {
        Self(self.0.one_by_one(f), self.1.one_by_one(f))
    }
}

/// The fields of two blocks, field by field.
#[inline(always)]
fn joined<V: Lanes>(a: [V; 4], b: [V; 4]) -> [Two<V>; 4] {
    [Two(a[0], b[0]), Two(a[1], b[1]), Two(a[2], b[2]), Two(a[3], b[3])]
}

impl<V: Lanes> Blocks for Two<V> {
    const COUNT: usize = 2;
    #[inline(always)]
    fn mask(bits: [u8; MOST]) -> TwoBits {
        TwoBits(bits[0], bits[1])
    }
    #[inline(always)]
    fn bits(mask: TwoBits) -> [u8; MOST] {
        [mask.0, mask.1]
    }
    #[inline(always)]
    fn of(f: impl Fn(usize, usize) -> f64) -> Self {
        Self(
            V::load(&std::array::from_fn(|lane| f(0, lane))),
            V::load(&std::array::from_fn(|lane| f(1, lane))),
        )
    }
    #[inline(always)]
    fn each(self) -> [[f64; 8]; MOST] {
        let mut all = [[0.0; 8]; MOST];
        self.0.store(&mut all[0]);
        self.1.store(&mut all[1]);
        all
    }
    #[inline(always)]
    unsafe fn quads<const EACH: usize>(from: *const f64, at: &[[u32; 8]]) -> [Self; 4] {
        // SAFETY: by the caller.
        unsafe {
            let first = <V as Lanes>::quads::<EACH>(from, &at[0]);
            joined(first, <V as Lanes>::quads::<EACH>(from, &at[1]))
        }
    }
    #[inline(always)]
    unsafe fn put_quads([x, y, z, w]: [Self; 4], to: *mut f64, at: &[[u32; 8]]) {
        // SAFETY: by the caller.
        unsafe {
            <V as Lanes>::put_quads([x.0, y.0, z.0, w.0], to, &at[0]);
            <V as Lanes>::put_quads([x.1, y.1, z.1, w.1], to, &at[1]);
        }
    }
    #[inline(always)]
    unsafe fn add_wrenches(
        [f, ti, tj]: [V3<Self>; 3],
        to: *mut f64,
        within: u32,
        first: &[[u32; 8]],
        second: &[[u32; 8]],
    ) {
        let low = |v: V3<Self>| V3 { x: v.x.0, y: v.y.0, z: v.z.0 };
        let high = |v: V3<Self>| V3 { x: v.x.1, y: v.y.1, z: v.z.1 };
        // SAFETY: by the caller.
        unsafe {
            let wrenches = [low(f), low(ti), low(tj)];
            <V as Lanes>::add_wrenches(wrenches, to, within, &first[0], &second[0]);
            let wrenches = [high(f), high(ti), high(tj)];
            <V as Lanes>::add_wrenches(wrenches, to, within, &first[1], &second[1]);
        }
    }
    #[inline(always)]
    unsafe fn of_spheres(
        from: [*const f64; 3],
        first: &[[u32; 8]],
        second: &[[u32; 8]],
    ) -> [V3<Self>; 5] {
        // SAFETY: by the caller.
        unsafe {
            let a = <V as Lanes>::of_spheres(from, &first[0], &second[0]);
            let b = <V as Lanes>::of_spheres(from, &first[1], &second[1]);
            let both = |k: usize| V3 {
                x: Two(a[k].x, b[k].x),
                y: Two(a[k].y, b[k].y),
                z: Two(a[k].z, b[k].z),
            };
            [both(0), both(1), both(2), both(3), both(4)]
        }
    }
    #[inline(always)]
    unsafe fn differences<const EACH: usize>(
        from: *const f64,
        of: &[[u32; 8]],
        less: &[[u32; 8]],
    ) -> [Self; 4] {
        // SAFETY: by the caller.
        unsafe {
            let first = <V as Lanes>::differences::<EACH>(from, &of[0], &less[0]);
            joined(first, <V as Lanes>::differences::<EACH>(from, &of[1], &less[1]))
        }
    }
}
