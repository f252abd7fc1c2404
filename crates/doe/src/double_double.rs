//! Numbers of twice the working precision, for the residuals of a fit.
//!
//! A number is the unevaluated sum of two f64, the second below half a unit in the last place of
//! the first: about 32 decimal digits. Sums by Knuth's two-sum, products by Dekker's splitting
//! (T. J. Dekker, Numer. Math. 18, 1971, doi 10.1007/BF01397083), which needs no fused
//! multiply-add and so gives the same bits everywhere. Products beyond 1e300 overflow.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A sum `hi + lo` of two f64 that do not overlap.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Double {
    pub(crate) hi: f64,
    pub(crate) lo: f64,
}

impl From<f64> for Double {
    fn from(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }
}

/// a + b and the rounding error of that sum, for any a and b.
fn two_sum(a: f64, b: f64) -> Double {
    let hi = a + b;
    let shifted = hi - a;
    Double { hi, lo: (a - (hi - shifted)) + (b - shifted) }
}

/// a + b and its rounding error where |a| >= |b|.
fn quick_two_sum(a: f64, b: f64) -> Double {
    let hi = a + b;
    Double { hi, lo: b - (hi - a) }
}

/// Upper and lower half of the bits of a number.
fn split(a: f64) -> (f64, f64) {
    const HALVES: f64 = 134_217_729.0; // 2^27 + 1
    let t = HALVES * a;
    let high = t - (t - a);
    (high, a - high)
}

/// a b and the rounding error of that product.
fn two_product(a: f64, b: f64) -> Double {
    let hi = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    Double { hi, lo: ((ah * bh - hi) + ah * bl + al * bh) + al * bl }
}

impl Double {
    /// a - b, exactly.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        two_sum(a, -b)
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (s, t) = (two_sum(self.hi, other.hi), two_sum(self.lo, other.lo));
        let s = quick_two_sum(s.hi, s.lo + t.hi);
        quick_two_sum(s.hi, s.lo + t.lo)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let p = two_product(self.hi, other.hi);
        quick_two_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Mul<f64> for Double {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        let p = two_product(self.hi, other);
        quick_two_sum(p.hi, p.lo + self.lo * other)
    }
}

impl Div<f64> for Double {
    type Output = Self;
    fn div(self, other: f64) -> Self {
        let first = self.hi / other;
        let left = self - two_product(first, other);
        quick_two_sum(first, left.hi / other)
    }
}

impl AddAssign for Double {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Double {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_products_keep_what_rounding_drops() {
        let tiny = Double::from(1.0) + Double::from(1.0e-25);
        assert_eq!(tiny.lo, 1.0e-25);
        assert_eq!((tiny - Double::from(1.0)).hi, 1.0e-25);
        // (2^30 + 1)^2 = 2^60 + 2^31 + 1 has 61 bits.
        let square = Double::from(1_073_741_825.0) * Double::from(1_073_741_825.0);
        assert_eq!((square.hi as i128) + (square.lo as i128), (1i128 << 60) + (1 << 31) + 1);
    }

    #[test]
    fn dividing_and_multiplying_back_returns_thirty_digits() {
        let third = Double::from(1.0) / 3.0;
        let error = third * 3.0 - Double::from(1.0);
        assert!(error.hi.abs() < 1.0e-31);
    }
}
