//! The incremental spring of a contact: one vector force whose stiffness changes with the load.
//!
//! Per step, with the stiffness `k` of now and `k0` of the step before (N/m, or N m/rad for a
//! rolling spring):
//!
//! `T_trial = T0 min(1, k/k0) - k ds`
//!
//! - `T` force on body i, N; `ds` slip of i against j in the step, m.
//!
//! While the contact area grows the force stays and new area is laid on free of traction; while
//! it shrinks, the area that opens gives its share of the force back, so that the spring's
//! displacement stays instead. In the energy `U = T^2/(2k)` both changes only lose:
//! `dU = -T ds + (what friction and the change of area took)`, so no closed cycle of load, shear
//! and unload can create energy. The total-spring form `T = -k s` gains `T^2 dk/(2 k^2)` whenever
//! the area grows, the form that keeps `T` while the area shrinks gains when it shrinks.
//!
//! Reference: C. Thornton, S. J. Cummins, P. W. Cleary, *Powder Technology* 233 (2013) 30-46,
//! doi:10.1016/j.powtec.2012.08.012. Departure: none; the energy statement above is ours.

use glam::DVec3;

use super::law::Memory;

/// What an incremental spring remembers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SpringMemory {
    /// Force (or torque) of the spring on body i, N (or N m).
    pub force: DVec3,
    /// Stiffness at which the force was reached, N/m (or N m/rad); 0 for a new contact.
    pub stiffness: f64,
    /// Whether the spring was at its limit.
    pub sliding: bool,
}

impl Memory for SpringMemory {
    /// Four numbers, one 32-byte record: `sliding` is the sign of the stored stiffness.
    const SLOTS: usize = 4;

    #[inline]
    fn store(&self, slots: &mut [f64]) {
        slots[..3].copy_from_slice(&self.force.to_array());
        slots[3] = if self.sliding { -self.stiffness } else { self.stiffness };
    }

    #[inline]
    fn load(slots: &[f64]) -> Self {
        Self {
            force: DVec3::new(slots[0], slots[1], slots[2]),
            stiffness: slots[3].abs(),
            sliding: slots[3].is_sign_negative(),
        }
    }

    #[inline]
    fn transport(&mut self, normal: DVec3, twist: f64) {
        self.force = transport_vector(self.force, normal, twist);
    }
}

impl SpringMemory {
    /// Force that the spring would have after `slip` (m) at the present `stiffness` (N/m).
    #[inline]
    pub fn trial(&self, stiffness: f64, slip: DVec3) -> DVec3 {
        self.force * kept_share(stiffness, self.stiffness) - slip * stiffness
    }

    /// Elastic energy, J.
    #[inline]
    pub fn energy(&self) -> f64 {
        spring_energy(self.force.length_squared(), self.stiffness)
    }
}

/// Share `min(1, k/k0)` of the force that survives a change of stiffness (1 for a new contact).
#[inline]
pub(crate) fn kept_share(stiffness: f64, before: f64) -> f64 {
    (stiffness / before.max(f64::MIN_POSITIVE)).min(1.0)
}

/// Energy `T^2/(2k)` of a spring, J; 0 where there is neither force nor stiffness.
#[inline]
pub(crate) fn spring_energy(force_squared: f64, stiffness: f64) -> f64 {
    0.5 * force_squared / stiffness.max(f64::MIN_POSITIVE)
}

/// `v` laid into the plane perpendicular to the unit vector `normal` at its old length and turned
/// by `twist` (rad) about it.
///
/// The old length is kept because the projection alone would shorten the spring with every turn
/// of the pair (thesis section 3.5.2 leaves this open). A vector along the normal has no
/// direction left and becomes zero.
#[inline]
pub fn transport_vector(v: DVec3, normal: DVec3, twist: f64) -> DVec3 {
    let flat = v - normal * v.dot(normal);
    let flat2 = flat.length_squared();
    let size2 = v.length_squared();
    if flat2 <= 0.0 {
        return DVec3::ZERO;
    }
    let flat = flat * (size2 / flat2).sqrt();
    if twist == 0.0 {
        return flat;
    }
    let (sin, cos) = small_sin_cos(twist);
    flat * cos + normal.cross(flat) * sin
}

/// Sine and cosine of the twist of one step, to rounding.
///
/// Taylor's series to `x^9` and `x^8`: the rest is below 3e-17 at 0.1 rad, beyond which the
/// library's functions take over. No division: a step waits long enough for those it needs.
#[inline]
fn small_sin_cos(x: f64) -> (f64, f64) {
    if x.abs() > 0.1 {
        return x.sin_cos();
    }
    let x2 = x * x;
    let [s3, s5, s7, s9] = SINE;
    let [c2, c4, c6, c8] = COSINE;
    let sin = x * (1.0 + x2 * (s3 + x2 * (s5 + x2 * (s7 + x2 * s9))));
    let cos = 1.0 + x2 * (c2 + x2 * (c4 + x2 * (c6 + x2 * c8)));
    (sin, cos)
}

/// Coefficients of `x^3`, `x^5`, `x^7`, `x^9` in the sine.
pub(crate) const SINE: [f64; 4] = [-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0];
/// Coefficients of `x^2`, `x^4`, `x^6`, `x^8` in the cosine.
pub(crate) const COSINE: [f64; 4] = [-0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transport_keeps_the_length_and_stays_perpendicular() {
        let n = DVec3::new(0.6, 0.0, 0.8);
        let v = DVec3::new(1.0, 2.0, -0.5);
        let t = transport_vector(v, n, 0.3);
        assert!((t.length() - v.length()).abs() < 1e-15 * 4.0);
        assert!(t.dot(n).abs() < 1e-15 * 4.0);
    }

    #[test]
    fn a_twist_of_a_quarter_turn_turns_x_into_y() {
        let t = transport_vector(DVec3::X, DVec3::Z, std::f64::consts::FRAC_PI_2);
        assert!((t - DVec3::Y).length() < 1e-15);
    }

    #[test]
    fn the_small_twist_is_a_rotation_by_its_angle() {
        for x in [-0.1f64, -1e-3, 1e-9, 0.03, 0.1, 0.11, 2.0] {
            let (sin, cos) = small_sin_cos(x);
            assert!((sin.hypot(cos) - 1.0).abs() < 1e-15);
            assert!((sin - x.sin()).abs() < 1e-16 && (cos - x.cos()).abs() < 3e-16);
        }
    }

    #[test]
    fn memory_survives_the_store_with_its_sliding_flag() {
        for sliding in [false, true] {
            let m = SpringMemory { force: DVec3::new(1.0, -2.0, 3.0), stiffness: 7.0, sliding };
            let mut slots = [0.0; 4];
            m.store(&mut slots);
            assert_eq!(SpringMemory::load(&slots), m);
        }
        assert_eq!(SpringMemory::load(&[0.0; 4]), SpringMemory::default());
    }

    #[test]
    fn a_new_contact_takes_the_whole_of_its_first_slip() {
        let m = SpringMemory::default();
        assert_eq!(m.trial(10.0, DVec3::X * 0.1), DVec3::X * -1.0);
        assert_eq!(m.energy(), 0.0);
    }
}
