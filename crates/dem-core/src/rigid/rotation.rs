//! Rotation of an asymmetric rigid body: the implicit midpoint rule on the rotation group.
//!
//! Between two kicks the body turns freely. With body angular momentum `pi`, principal moments
//! `I`, middle momentum `m = (pi + pi') / 2` and `omega = I^-1 m`, the rule is
//! `m = pi + dt/2 m x I^-1 m`, which is `pi' = cay(-dt omega) pi`; `q' = q cay(dt omega)` where `cay` is Cayley's map, for quaternions `(1, dt omega / 2)`
//! normalised. Both `|pi|` and the energy `pi . I^-1 pi / 2` are quadratic, so the midpoint rule
//! keeps them exactly, and since momentum and attitude turn by the same map, the angular momentum
//! in space is kept exactly too: all three to rounding. Order 2.
//! Lewis & Simo, J. Nonlinear Sci. 4 (1994) 253, doi:10.1007/BF02430634; Austin, Krishnaprasad &
//! Wang, J. Comput. Phys. 107 (1993) 105, doi:10.1006/jcph.1993.1128.

use glam::{DQuat, DVec3};

use crate::simd::{Mask as _, Numbers, V3};

/// One free turn of a rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeRotation {
    /// Attitude after the turn: body to laboratory.
    pub orientation: DQuat,
    /// Mean angular velocity of the turn in the laboratory frame, rad/s: it carries a body point
    /// at `r` to `r'` by `r' - r = dt mean_spin x (r + r') / 2`, exactly.
    pub mean_spin: DVec3,
}

/// Sweeps of the fixed-point iteration, which contracts by less than `|omega| dt` a sweep.
const SWEEPS: usize = 14;

/// Most sweeps of the iteration by rotations, for turns of a good part of a radian a step.
const MOST_SWEEPS: usize = 50;

/// Change of the momentum, relative and squared, at which an iteration ends.
const CONVERGED: f64 = 1e-32;

impl FreeRotation {
    /// Turn a body with principal moments `moments` (kg m2), attitude `orientation` and angular
    /// momentum `angular_momentum` (laboratory frame, kg m2/s) freely for `dt` seconds.
    ///
    /// ```
    /// # use dem_core::rigid::FreeRotation;
    /// # use glam::{DQuat, DVec3};
    /// // About a principal axis the turn is steady: 1 rad/s for 1 ms.
    /// let turn = FreeRotation::turn(DVec3::new(1.0, 2.0, 3.0), DQuat::IDENTITY, DVec3::Z * 3.0, 1e-3);
    /// assert!((turn.mean_spin.z - 1.0).abs() < 1e-12);
    /// ```
    pub fn turn(
        moments: DVec3,
        orientation: DQuat,
        angular_momentum: DVec3,
        dt: f64,
    ) -> FreeRotation {
        let inverse = moments.recip().into();
        let turn = free_turn(inverse, orientation.to_array(), angular_momentum.into(), dt);
        FreeRotation {
            mean_spin: turn.mean_spin.into(),
            orientation: DQuat::from_array(turn.attitude),
        }
    }
}

/// Free turns of one body, or of several side by side.
pub(crate) struct FreeTurn<V> {
    /// Attitude after the turn: vector, then scalar.
    pub(crate) attitude: [V; 4],
    /// As in [`FreeRotation`].
    pub(crate) mean_spin: V3<V>,
}

/// [`FreeRotation::turn`]; of the moments the inverse is given.
#[inline(always)]
pub(crate) fn free_turn<V: Numbers>(
    inverse: V3<V>,
    attitude: [V; 4],
    angular_momentum: V3<V>,
    dt: f64,
) -> FreeTurn<V> {
    let start = turned_back(attitude, angular_momentum);
    let spin = middle_momentum(inverse, start, dt).times(inverse);
    let half = spin * V::splat(0.5 * dt);
    let [x, y, z, w] = attitude;
    let own = V3 { x, y, z };
    let (v, w) = (own.cross_plus(half, half.times_plus(w, own)), w - own.dot(half));
    let size = V::splat(1.0) / w.times_plus(w, v.dot(v)).sqrt();
    let v = v * size;
    FreeTurn { attitude: [v.x, v.y, v.z, w * size], mean_spin: turned(attitude, spin) }
}

/// Angular velocity in the laboratory of bodies with this angular momentum.
#[inline(always)]
pub(crate) fn spin_of<V: Numbers>(
    inverse: V3<V>,
    attitude: [V; 4],
    angular_momentum: V3<V>,
) -> V3<V> {
    turned(attitude, turned_back(attitude, angular_momentum).times(inverse))
}

/// A vector of the body in the laboratory.
#[inline(always)]
fn turned<V: Numbers>([x, y, z, w]: [V; 4], v: V3<V>) -> V3<V> {
    let own = V3 { x, y, z };
    let across = own.cross(v) * V::splat(2.0);
    own.cross_plus(across, across.times_plus(w, v))
}

/// A vector of the laboratory in the body.
#[inline(always)]
fn turned_back<V: Numbers>([x, y, z, w]: [V; 4], v: V3<V>) -> V3<V> {
    turned([-x, -y, -z, w], v)
}

/// Directions of the axes of bodies with these attitudes.
#[inline(always)]
pub(crate) fn axes_of<V: Numbers>([x, y, z, w]: [V; 4]) -> [V3<V>; 3] {
    let one = V::splat(1.0);
    let (x2, y2, z2) = (x + x, y + y, z + z);
    let (wx, wy, wz) = (w * x2, w * y2, w * z2);
    let zz = z * z2;
    let (xx_zz, yy_zz, xx_yy) =
        (x.times_plus(x2, zz), y.times_plus(y2, zz), x.times_plus(x2, y * y2));
    [
        V3 { x: one - yy_zz, y: x.times_plus(y2, wz), z: x.times_less(z2, wy) },
        V3 { x: x.times_less(y2, wz), y: one - xx_zz, z: y.times_plus(z2, wx) },
        V3 { x: x.times_plus(z2, wy), y: y.times_less(z2, wx), z: one - xx_yy },
    ]
}

/// The middle momentum in the body's frame, from that at the start. Bodies side by side stop each
/// when it has converged, so that what is beside a body does not matter to it.
#[inline(always)]
fn middle_momentum<V: Numbers>(inverse: V3<V>, start: V3<V>, dt: f64) -> V3<V> {
    let limit = V::splat(CONVERGED) * start.dot(start);
    let half = V::splat(0.5 * dt);
    let mut middle = start;
    let mut open = V::splat(0.0).less(V::splat(1.0));
    for _ in 0..SWEEPS {
        let next = middle.cross(middle.times(inverse)).times_plus(half, start);
        let change = next - middle;
        middle = next.select(open, middle);
        open = open & limit.less(change.dot(change));
        if open.is_empty() {
            return middle;
        }
    }
    fast_turn(inverse, start, half, limit, middle, open)
}

/// The same for fast turns, which are `open` yet: rotations keep the length of the momentum, so the
/// sweeps stay bounded.
#[cold]
fn fast_turn<V: Numbers>(
    inverse: V3<V>,
    start: V3<V>,
    half: V,
    limit: V,
    middle: V3<V>,
    open: V::Mask,
) -> V3<V> {
    let mut end = start;
    let mut left = open;
    for _ in 0..MOST_SWEEPS {
        let spin = ((start + end) * V::splat(0.5)).times(inverse);
        let rotated = cayley_back(spin * half, start);
        let change = rotated - end;
        end = rotated.select(left, end);
        left = left & limit.less(change.dot(change));
        if left.is_empty() {
            break;
        }
    }
    ((start + end) * V::splat(0.5)).select(open, middle)
}

/// `cay(-2 half) v`: rotate `v` back by the Cayley transform of `half = dt omega / 2`.
#[inline(always)]
fn cayley_back<V: Numbers>(half: V3<V>, v: V3<V>) -> V3<V> {
    // (1 + h^)^-1 (1 - h^) v in closed form, with h^ w = h x w.
    let denominator = V::splat(1.0) + half.dot(half);
    v - (half.cross(v) - half.cross(half.cross(v))) * (V::splat(2.0) / denominator)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_asymmetric_body_keeps_energy_and_momentum_to_rounding() {
        let moments = DVec3::new(1.0, 2.0, 3.5);
        let l = DVec3::new(0.3, 2.0, 0.1);
        let mut q = DQuat::from_xyzw(0.1, 0.2, -0.3, 0.9).normalize();
        let energy = |q: DQuat| {
            let pi = q.conjugate() * l;
            0.5 * pi.dot(pi / moments)
        };
        let e0 = energy(q);
        for _ in 0..100_000 {
            q = FreeRotation::turn(moments, q, l, 0.02).orientation;
        }
        // 1e5 steps of rounding at 2e-16 each add to at most 2e-11; random signs give ~1e-13.
        assert!((energy(q) / e0 - 1.0).abs() < 1e-11, "{}", energy(q) / e0 - 1.0);
    }

    #[test]
    fn fast_turns_keep_the_energy_too() {
        let moments = DVec3::new(1.0, 2.0, 3.5);
        let energy = |pi: DVec3| 0.5 * pi.dot(pi / moments);
        for dt in [0.05, 0.2, 0.5, 1.0] {
            let start = DVec3::new(0.3, 2.0, 0.1);
            let middle = DVec3::from(middle_momentum(moments.recip().into(), start.into(), dt));
            let end = middle * 2.0 - start;
            // The iteration ends within 1e-16 of the momentum; ten roundings are allowed for.
            assert!((energy(end) / energy(start) - 1.0).abs() < 1e-14, "{dt}");
            assert!((end.length() / start.length() - 1.0).abs() < 1e-14, "{dt}");
        }
    }

    #[test]
    fn mean_spin_carries_body_points_exactly() {
        let moments = DVec3::new(1.0, 2.0, 3.5);
        let l = DVec3::new(0.3, 2.0, 0.1);
        let q = DQuat::from_xyzw(0.1, 0.2, -0.3, 0.9).normalize();
        let dt = 0.1;
        let turn = FreeRotation::turn(moments, q, l, dt);
        let p = DVec3::new(0.7, -0.2, 0.4);
        let (a, b) = (q * p, turn.orientation * p);
        let moved = turn.mean_spin.cross((a + b) * 0.5) * dt;
        assert!((b - a - moved).length() < 1e-15);
    }
}
