//! Numbers of contacts that are computed at a time in stages: as many as one register holds.
#![cfg(target_arch = "x86_64")]

use super::lanes::{Numbers, V3};

/// `N` numbers in one register.
pub(super) trait Group<const N: usize>: Numbers + From<[f64; N]> {
    /// The lanes of the lowest bits.
    fn which(bits: u8) -> Self::Mask;
    /// The numbers.
    fn each(self) -> [f64; N];
    /// One bit a lane.
    fn bits(mask: Self::Mask) -> u8;
    /// Four numbers from `EACH` times each of some places on, one vector for each of the four.
    ///
    /// # Safety
    /// The instructions are there and all numbers can be read.
    unsafe fn quads<const EACH: usize>(from: *const f64, at: &[u32; N]) -> [Self; 4];
    /// Put records there, and nothing for lanes that are not `used`.
    ///
    /// # Safety
    /// The instructions are there and all numbers can be written.
    unsafe fn put_used(v: V3<Self>, scalar: Self, used: Self::Mask, to: *mut f64, at: &[u32; N]);
}
