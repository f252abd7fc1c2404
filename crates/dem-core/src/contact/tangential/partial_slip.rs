//! What the laws with micro-slip share: an axis of loading, and the energy in a softening spring.
//!
//! A contact that softens as its rim slips is a bundle of springs with sliders (Iwan's model): on
//! a branch with the virgin curve `f(y)` the sliders that slip bear `f - y f'`, so the power lost
//! is `(f - y f') |v|`. With the tangent stiffness `k theta`, `theta = (1 - f/L)^gamma`:
//!
//! `f - y f' = L (1 - theta^(1/gamma) - theta (1 - theta^(1/gamma - 1))/(1 - gamma))`
//!
//! and the energy held at the onset of full sliding is `L^2/(k (2 - gamma))`, an upper bound.
//! A step that would return more than the contact holds has its shear held back, so that these laws
//! are passive on every path, also where their published increments (one direction, few branches)
//! are not: a load that falls between shear and its return.
//!
//! - `f` shear force since the last reversal (half of it after a reversal), N; `L` its limit, N
//! - `k` initial stiffness, N/m; `gamma` exponent, 1/3 for Mindlin and Deresiewicz
//!
//! Reference: W. D. Iwan, *J. Appl. Mech.* 33 (1966) 893-900, doi:10.1115/1.3625199; the closed
//! forms are ours.

use glam::DVec3;

use crate::contact::law::Memory;
use crate::contact::spring::transport_vector;

/// What a contact with micro-slip remembers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PartialSlipMemory {
    /// Shear that the contact bears (the opposite of the force on i), N.
    pub shear: DVec3,
    /// Unit vector of the loading direction; zero for a new contact.
    pub axis: DVec3,
    /// Branch: 0 first loading, 1 unloading, 2 reloading.
    pub branch: f64,
    /// Shear along the axis at the last reversal from loading, N.
    pub turn: f64,
    /// Shear along the axis at the last reversal from unloading, N.
    pub turn_back: f64,
    /// Load of the step before, N.
    pub load: f64,
    /// Growth of the limit that shear has not caught up with, N.
    pub deficit: f64,
    /// Shear added since the load last outgrew it, N.
    pub since: f64,
    /// Initial stiffness of the step before, N/m.
    pub stiffness: f64,
    /// Elastic energy, J.
    pub energy: f64,
    /// Whether the whole contact slid.
    pub sliding: bool,
}

impl Memory for PartialSlipMemory {
    const SLOTS: usize = 15;

    #[inline]
    fn store(&self, slots: &mut [f64]) {
        slots[..3].copy_from_slice(&self.shear.to_array());
        slots[3..6].copy_from_slice(&self.axis.to_array());
        slots[6..14].copy_from_slice(&[
            self.branch,
            self.turn,
            self.turn_back,
            self.load,
            self.deficit,
            self.since,
            self.stiffness,
            self.energy,
        ]);
        slots[14] = f64::from(u8::from(self.sliding));
    }

    #[inline]
    fn load(s: &[f64]) -> Self {
        Self {
            shear: DVec3::new(s[0], s[1], s[2]),
            axis: DVec3::new(s[3], s[4], s[5]),
            branch: s[6],
            turn: s[7],
            turn_back: s[8],
            load: s[9],
            deficit: s[10],
            since: s[11],
            stiffness: s[12],
            energy: s[13],
            sliding: s[14] != 0.0,
        }
    }

    #[inline]
    fn transport(&mut self, normal: DVec3, twist: f64) {
        self.shear = transport_vector(self.shear, normal, twist);
        self.axis = transport_vector(self.axis, normal, twist);
    }
}

impl PartialSlipMemory {
    /// Lay the axis along the shear, or along the `slip` of a contact that bears none yet.
    #[inline]
    pub(crate) fn follow(&mut self, slip: DVec3) {
        let size = self.shear.length();
        if size > 0.0 {
            self.axis = self.shear / size;
        } else if slip != DVec3::ZERO {
            self.axis = slip.normalize_or_zero();
        }
    }

    /// `shear` (N) at the end of a step over `slip` (m), held back where the step would return more
    /// energy than the contact has stored; `before` is the shear at its start, N.
    #[inline]
    pub(crate) fn passive(&self, before: DVec3, shear: DVec3, slip: DVec3) -> DVec3 {
        let excess = 0.5 * (before + shear).dot(slip) + self.energy;
        let size2 = slip.length_squared();
        if excess < 0.0 && size2 > 0.0 { shear - slip * (2.0 * excess / size2) } else { shear }
    }

    /// Book the `work` (J) done on the contact in a step that lost `slid` (J): the new energy
    /// between 0 and `most` (J), and what was lost in all, J.
    #[inline]
    pub(crate) fn book(&mut self, work: f64, slid: f64, most: f64) -> f64 {
        let before = self.energy;
        self.energy = (before + work - slid).clamp(0.0, most.max(0.0));
        before + work - self.energy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_survives_the_store() {
        let m = PartialSlipMemory {
            shear: DVec3::new(1.0, 2.0, 3.0),
            axis: DVec3::Y,
            branch: 2.0,
            turn: 4.0,
            turn_back: 5.0,
            load: 6.0,
            deficit: 7.0,
            since: 10.0,
            stiffness: 8.0,
            energy: 9.0,
            sliding: true,
        };
        let mut slots = [0.0; PartialSlipMemory::SLOTS];
        m.store(&mut slots);
        assert_eq!(PartialSlipMemory::load(&slots), m);
        assert_eq!(
            PartialSlipMemory::load(&[0.0; PartialSlipMemory::SLOTS]),
            PartialSlipMemory::default()
        );
    }
}
