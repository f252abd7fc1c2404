//! What a shear spring carries over into a step: its force, laid into the present tangential plane at its old
//! length, turned by the twist and lessened where the contact area shrinks.
//!
//! Exact kernels compute it operation by operation as `contact/spring.rs`. Fused ones need one division where
//! those need two and a root: a spring leaves its plane by so little in a step that its length comes from a
//! series, and the reciprocals of its length and of its stiffness come from that of their product.

use super::lanes::{Mask, Numbers, V3};
use crate::contact::spring::{COSINE, SINE};

/// What contacts remember: force of the spring and its signed stiffness.
#[derive(Clone, Copy)]
pub(super) struct Remembered<V> {
    pub(super) spring: V3<V>,
    pub(super) stiffness: V,
}

/// What fused kernels find out about it beforehand; exact ones nothing.
#[derive(Clone, Copy)]
pub(super) struct Before<V> {
    /// Part of the force along the normal, and reciprocals of its square and of the stiffness without its sign.
    along: V,
    over_square: V,
    over_stiffness: V,
}

/// Below this, squares of forces and stiffnesses are taken for it, so that products of three stay finite and
/// normal: a spring of 1e-40 N.
pub(super) const LEAST: f64 = 1e-80;

/// Largest square of the sine of the angle between spring and tangential plane, and of the twist, rad, together, for both series:
/// their next terms are 3e-17 and 5e-16.
const NEARLY_FLAT: f64 = 1e-4;
/// `1 / sqrt(1 - x)` is one and these times the powers of `x`.
const LENGTHS: [f64; 3] = [1.0 / 2.0, 3.0 / 8.0, 5.0 / 16.0];

/// `tan x / x` is one and these times the powers of `x^2`.
const TANGENT: [f64; 2] = [1.0 / 3.0, 2.0 / 15.0];

impl<V: Numbers> Before<V> {
    /// In exact kernels.
    #[inline(always)]
    pub(super) fn nothing() -> Self {
        let none = V::splat(0.0);
        Self { along: none, over_square: none, over_stiffness: none }
    }

    /// In fused kernels, beside the reciprocal of `more`, with which the division is shared; `along` yields the
    /// part of the spring along the normal from that reciprocal.
    #[inline(always)]
    pub(super) fn fused(old: &Remembered<V>, more: V, along: impl FnOnce(V) -> V) -> (Self, V) {
        let sizes = Self::sizes(old);
        let both = sizes[0] * sizes[1];
        let over_all = V::splat(1.0) / (both * more);
        let (over_more, over_both) = (over_all * both, over_all * more);
        (Self::of(along(over_more), sizes, over_both), over_more)
    }

    /// In fused kernels, by itself: `along` is the part of the spring along the normal.
    #[inline(always)]
    pub(super) fn by_itself(old: &Remembered<V>, along: V) -> Self {
        let sizes = Self::sizes(old);
        Self::of(along, sizes, (sizes[0] * sizes[1]).reciprocal())
    }

    /// Square of the force and stiffness without its sign.
    #[inline(always)]
    fn sizes(old: &Remembered<V>) -> [V; 2] {
        let least = V::splat(LEAST);
        [old.spring.dot(old.spring).max(least), old.stiffness.abs().max(least)]
    }

    /// From these sizes and the reciprocal of both.
    #[inline(always)]
    fn of(along: V, [square, size]: [V; 2], over_both: V) -> Self {
        Self { along, over_square: over_both * size, over_stiffness: over_both * square }
    }

    /// The spring's force now, before slip, where the stiffness is `k` and the contact has turned by `twist` about
    /// its `normal`; of the old stiffness's share at most `most` is kept. `used` are the lanes that matter.
    #[inline(always)]
    pub(super) fn carried(
        &self,
        remembered: &Remembered<V>,
        normal: V3<V>,
        twist: V,
        k: V,
        most: f64,
        used: V::Mask,
    ) -> V3<V> {
        let old = remembered.spring;
        let (zero, tiny) = (V::splat(0.0), V::splat(f64::MIN_POSITIVE));
        if V::FUSED {
            let flat = old.less_times(normal, self.along);
            let share = (k * self.over_stiffness).min(V::splat(most));
            // The cross product of the normal with its own part of the spring is nothing.
            return self.turned_at_length(old, [flat, normal.cross(old)], [twist, share], used);
        }
        let flat = old.less_times(normal, old.dot(normal));
        let (flat2, size2) = (flat.dot(flat), old.dot(old));
        let alive = zero.less(flat2);
        let flat = flat * (size2 / flat2).sqrt();
        let (sin, cos) = small_sin_cos(twist, used & alive);
        let carried = normal.cross(flat).times_plus(sin, flat * cos).select(alive, V3::splat(0.0));
        // A new contact carries nothing, so that its share need only be finite.
        let share = (k / remembered.stiffness.abs().max(tiny)).min(V::splat(most));
        carried * share
    }

    /// The spring's part in the plane, `flat`, turned by the twist towards what stands at right angles to it, at that share of
    /// the spring's old length.
    #[inline(always)]
    fn turned_at_length(
        &self,
        spring: V3<V>,
        [flat, aside]: [V3<V>; 2],
        [twist, share]: [V; 2],
        used: V::Mask,
    ) -> V3<V> {
        let one = V::splat(1.0);
        let lost = self.along * self.along * self.over_square;
        let x2 = twist * twist;
        let (t3, t5) = (V::splat(TANGENT[0]), V::splat(TANGENT[1]));
        let tangent = twist * x2.times_plus(x2.times_plus(t5, t3), one);
        // What is added makes it longer by the square of the tangent: both are mended at once.
        let longer = tangent * tangent;
        let lacks = lost.times_plus(longer, lost - longer);
        let (a1, a2, a3) = (V::splat(LENGTHS[0]), V::splat(LENGTHS[1]), V::splat(LENGTHS[2]));
        let length = lacks.times_plus(lacks.times_plus(lacks.times_plus(a3, a2), a1), one);
        let turned = aside.times_plus(tangent, flat) * (length * share);
        let far = V::splat(NEARLY_FLAT).less(lost + x2) & used;
        if far.is_empty() {
            return turned;
        }
        (by_functions(spring, [flat, aside], twist) * share).select(far, turned)
    }
}

/// `turned_at_length` of springs that stand out far or turn much.
#[cold]
fn by_functions<V: Numbers>(spring: V3<V>, [flat, aside]: [V3<V>; 2], twist: V) -> V3<V> {
    let (sin, cos) = (twist.one_by_one(f64::sin), twist.one_by_one(f64::cos));
    let (flat2, zero) = (flat.dot(flat), V::splat(0.0));
    let length = (spring.dot(spring) / flat2).sqrt();
    // A spring along the normal has no direction left.
    let length = length.select(zero.less(flat2), zero);
    flat.times_plus(cos * length, aside * (sin * length))
}

/// Sine and cosine of the twists of a step, as in `contact/spring.rs`; `used` are the lanes that
/// matter.
#[inline(always)]
fn small_sin_cos<V: Numbers>(x: V, used: V::Mask) -> (V, V) {
    let one = V::splat(1.0);
    let x2 = x * x;
    // Not by `map`: its closure would not be compiled for the instructions of the kernel.
    let (s3, s5, s7, s9) =
        (V::splat(SINE[0]), V::splat(SINE[1]), V::splat(SINE[2]), V::splat(SINE[3]));
    let (c2, c4, c6, c8) =
        (V::splat(COSINE[0]), V::splat(COSINE[1]), V::splat(COSINE[2]), V::splat(COSINE[3]));
    let s = x2.times_plus(x2.times_plus(x2.times_plus(x2.times_plus(s9, s7), s5), s3), one);
    let cos = x2.times_plus(x2.times_plus(x2.times_plus(x2.times_plus(c8, c6), c4), c2), one);
    let sin = x * s;
    let large = V::splat(0.1).less(x.abs()) & used;
    if large.is_empty() { (sin, cos) } else { large_sin_cos(x, sin, cos, large) }
}

/// The lanes of large twists by the library's functions.
#[cold]
fn large_sin_cos<V: Numbers>(x: V, sin: V, cos: V, large: V::Mask) -> (V, V) {
    let (sines, cosines) = (x.one_by_one(f64::sin), x.one_by_one(f64::cos));
    (sines.select(large, sin), cosines.select(large, cos))
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::avx2::Pair;
    use super::super::lanes::Lanes;
    use super::super::{Level, widened};
    use super::*;
    use crate::contact::spring::transport_vector;
    use glam::DVec3;

    /// What eight springs carry over, by the fused kernel.
    fn fused(
        springs: [DVec3; 8],
        normals: [DVec3; 8],
        before: f64,
        twist: f64,
        k: f64,
    ) -> [DVec3; 8] {
        let mut out = [[0.0; 8]; 3];
        widened(
            Level::Avx2,
            #[inline(always)]
            || {
                type V = Pair<true>;
                let of = |v: &[DVec3; 8]| V3::<V> {
                    x: Lanes::load(&v.map(|v| v.x)),
                    y: Lanes::load(&v.map(|v| v.y)),
                    z: Lanes::load(&v.map(|v| v.z)),
                };
                let (spring, n) = (of(&springs), of(&normals));
                // The division is shared with that by the square of the distance of centres.
                let square: V = Numbers::splat(3.6e-5);
                let stiffness: V = Numbers::splat(-before);
                let old = Remembered { spring, stiffness };
                let (own, over) = Before::fused(&old, square, |_| spring.dot(n));
                let mut unit = [0.0; 8];
                (over * square).store(&mut unit);
                assert!(unit.iter().all(|u| (u - 1.0).abs() < 1e-15), "{unit:?}");
                let (twist, k) = (Numbers::splat(twist), Numbers::splat(k));
                let carried = own.carried(&old, n, twist, k, 1.0, 0xff);
                carried.x.store(&mut out[0]);
                carried.y.store(&mut out[1]);
                carried.z.store(&mut out[2]);
            },
        );
        std::array::from_fn(|lane| DVec3::new(out[0][lane], out[1][lane], out[2][lane]))
    }

    #[test]
    fn fused_springs_carry_over_what_the_portable_law_does() {
        if Level::detect() == Level::Portable {
            return;
        }
        let normal = |lane: usize| {
            let (a, b) = (0.7 * lane as f64 + 0.2, 0.4 * lane as f64 - 1.0);
            DVec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin())
        };
        let normals = std::array::from_fn(normal);
        // By how much springs stand out of the plane: as in a step, near the end of the series, beyond it, and all
        // of these in one block.
        for lean in
            [[1e-7; 8], [9.9e-3; 8], [0.3; 8], [0.0, 1e-9, 1e-4, 9e-3, 0.011, 0.1, 1.0, 30.0]]
        {
            for (twist, size, before, k) in [
                (0.0, 1e-3, 4e3, 5e3),
                (-3e-4, 20.0, 4e3, 3.9e3),
                (9.9e-3, 1e-9, 1.0, 0.2),
                (0.012, 0.5, 2e7, 1e7),
                (0.4, 3.0, 2e3, 1e3),
            ] {
                let springs = std::array::from_fn(|lane| {
                    let n: DVec3 = normals[lane];
                    let flat = n.any_orthonormal_vector();
                    (flat + n * lean[lane]) * (size * (1.0 + lane as f64))
                });
                let all = fused(springs, normals, before, twist, k);
                for (lane, (own, n)) in all.into_iter().zip(normals).enumerate() {
                    let exact = transport_vector(springs[lane], n, twist) * (k / before).min(1.0);
                    // What stands out of the plane is taken away: that much of it is rounding.
                    let bound = 8.0 * f64::EPSILON * (1.0 + lean[lane]) * exact.length();
                    assert!(
                        (own - exact).length() < bound,
                        "{lane}: {own} {exact}, {lean:?} {twist}"
                    );
                }
            }
        }
        // Along the normal nothing is left, as in the portable law.
        let along = fused([DVec3::X * 5.0; 8], [DVec3::X; 8], 1e3, 1e-3, 2e3);
        assert!(along.iter().all(|v| *v == DVec3::ZERO), "{along:?}");
        // A new contact remembers nothing and carries nothing.
        let none = fused([DVec3::ZERO; 8], normals, 0.0, 1e-3, 5e3);
        assert!(none.iter().all(|v| *v == DVec3::ZERO), "{none:?}");
    }
}
