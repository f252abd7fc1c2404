//! Walton and Braun's hysteretic spring: loading along one line, unloading along a stiffer one.
//!
//! `F = min(K1 delta, K2 (delta - delta_def))`, never below 0
//!
//! `K2 = K1 / E_f`, `delta_def = delta_max (1 - E_f)`, `K1` given or `1.6 pi R* Y0`, `Y0 = E theta`
//!
//! - `F` repulsion, N; `delta` overlap, m; `delta_max` its largest value so far, m
//! - `K1`, `K2` loading and unloading stiffness, N/m; `delta_def` lasting overlap, m
//! - `E_f = e^2` share of the energy given back; `Y0` yield stress, Pa; `theta` its share of `E`
//!
//! Validity: plastic contact without rate effects; restitution `e = sqrt(E_f)` at every speed.
//! References: O. R. Walton, R. L. Braun, *J. Rheology* 30 (1986) 949-980, doi:10.1122/1.549893;
//! thesis eq. 23-24 (repulsive here; energy is recovered in unloading; `R` is `R*`).
//! Departures: the lasting overlap is forgotten when the bodies part, so a new contact meets
//! fresh material. Contact radius `sqrt(R* delta)`.

use glam::DVec3;

use crate::contact::error::{LawError, positive, restitution};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{Memory, NormalLaw, NormalResponse};

/// Loading stiffness `K1`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum YieldStiffness {
    /// The same for every size, N/m.
    Fixed(f64),
    /// From the yield stress `Y0`, Pa: `1.6 pi R* Y0`.
    YieldStress(f64),
}

/// Parameters of [`WaltonBraun`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct WaltonBraunSpec {
    /// Loading stiffness.
    pub loading: YieldStiffness,
    /// Coefficient of restitution, above 0 and at most 1; `E_f` is its square.
    pub restitution: f64,
}

/// Hysteretic law of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaltonBraun {
    /// Loading stiffness that does not depend on size, N/m.
    pub stiffness: f64,
    /// Loading stiffness per effective radius, Pa.
    pub stiffness_per_radius: f64,
    /// Share `E_f` of the energy given back.
    pub recovered: f64,
}

impl TryFrom<WaltonBraunSpec> for WaltonBraun {
    type Error = LawError;
    fn try_from(spec: WaltonBraunSpec) -> Result<Self, LawError> {
        const LAW: &str = "WaltonBraun";
        let e = restitution(LAW, spec.restitution)?;
        let (stiffness, stiffness_per_radius) = match spec.loading {
            YieldStiffness::Fixed(k) => (positive(LAW, "loading.fixed", k)?, 0.0),
            YieldStiffness::YieldStress(y) => {
                (0.0, 1.6 * std::f64::consts::PI * positive(LAW, "loading.yield_stress", y)?)
            }
        };
        Ok(Self { stiffness, stiffness_per_radius, recovered: e * e })
    }
}

/// Largest overlap of the contact so far, m.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PeakOverlap {
    /// Largest overlap, m.
    pub delta_max: f64,
}

impl Memory for PeakOverlap {
    const SLOTS: usize = 1;
    #[inline]
    fn store(&self, slots: &mut [f64]) {
        slots[0] = self.delta_max;
    }
    #[inline]
    fn load(slots: &[f64]) -> Self {
        Self { delta_max: slots[0] }
    }
    #[inline]
    fn transport(&mut self, _: DVec3, _: f64) {}
}

impl NormalLaw for WaltonBraun {
    type Memory = PeakOverlap;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        memory: &mut PeakOverlap,
    ) -> NormalResponse {
        let delta = motion.overlap.max(0.0);
        let k1 = self.stiffness + self.stiffness_per_radius * pair.r_star;
        let k2 = k1 / self.recovered;
        let peak_before = memory.delta_max;
        let peak = peak_before.max(delta);
        memory.delta_max = peak;
        let force = (k2 * (delta - peak * (1.0 - self.recovered))).max(0.0);
        // Work along the loading line that the unloading line will not give back.
        let lost = 0.5 * k1 * (1.0 - self.recovered) * (peak * peak - peak_before * peak_before);
        NormalResponse {
            force,
            friction_load: force,
            stiffness: if delta < peak { k2 } else { k1 },
            contact_radius: (pair.r_star * delta).sqrt(),
            elastic_energy: 0.5 * force * force / k2,
            dissipated_power: lost / motion.dt,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAIR: PairGeometry =
        PairGeometry { r_star: 0.005, m_star: 0.01, radius_i: 0.01, radius_j: 0.01 };

    fn motion(overlap: f64) -> Kinematics {
        Kinematics {
            normal_i_to_j: DVec3::X,
            overlap,
            overlap_rate: 0.0,
            slip_velocity: DVec3::ZERO,
            spin_i: DVec3::ZERO,
            spin_j: DVec3::ZERO,
            lever_i: 1.0,
            lever_j: 1.0,
            dt: 0.5,
        }
    }

    #[test]
    fn loading_unloading_and_reloading_follow_their_lines() {
        let law: WaltonBraun =
            WaltonBraunSpec { loading: YieldStiffness::Fixed(100.0), restitution: 0.5 }
                .try_into()
                .unwrap();
        let mut m = PeakOverlap::default();
        let mut at = |x| law.respond(&PAIR, &motion(x), &mut m);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(close(at(1.0).force, 100.0));
        let peak = at(2.0);
        assert!(close(peak.force, 200.0));
        // K2 = 400, delta_def = 1.5; a quarter of the 200 J of loading is left
        assert!(close(peak.elastic_energy, 50.0));
        assert!(close(at(1.75).force, 100.0));
        assert!(close(at(1.4).force, 0.0));
        let reload = at(1.9);
        assert!(close(reload.force, 160.0));
        assert_eq!(reload.dissipated_power, 0.0);
        assert!(close(at(3.0).force, 300.0));
    }

    #[test]
    fn the_stiffness_from_the_yield_stress_scales_with_the_radius() {
        let law: WaltonBraun =
            WaltonBraunSpec { loading: YieldStiffness::YieldStress(1e6), restitution: 1.0 }
                .try_into()
                .unwrap();
        let r = law.respond(&PAIR, &motion(1e-3), &mut PeakOverlap::default());
        let want = 1.6 * std::f64::consts::PI * 0.005 * 1e6 * 1e-3;
        assert!((r.force - want).abs() < 1e-12 * want);
    }
}
