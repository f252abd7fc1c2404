//! Walton and Braun's shear: a stiffness that falls towards the limit and recovers on reversal.
//!
//! `T = T0 + k_par ds_par t_par + K0 ds_perp t_perp`, then `|T| <= mu N`, with
//!
//! - growing shear: `k_par = K0 (1 - (T - F*)/(mu N - F*))^gamma`
//! - falling shear: `k_par = K0 (1 - (F* - T)/(mu N + F*))^gamma`
//!
//! - `T` shear, N; `ds` slip, m, split along and across the present shear
//! - `K0` initial stiffness, N/m; `F*` shear at the last reversal, N (0 at first)
//! - `gamma` exponent (1/3 comes near Mindlin and Deresiewicz); `N` load of the limit, N
//!
//! Validity: goes with the hysteretic normal law. References: O. R. Walton, R. L. Braun,
//! *J. Rheology* 30 (1986) 949-980, doi:10.1122/1.549893; thesis eq. 25-27.
//! Departures: `F*` scales with the load, as its authors do; where `K0` follows the normal
//! stiffness, a falling `K0` takes the force down with it (`contact::spring`); energy, loss and
//! passivity by `partial_slip.rs`. Exponents other than 1/3 cost a general power a step.

use super::partial_slip::PartialSlipMemory;
use crate::contact::error::{LawError, positive};
use crate::contact::friction::{Friction, FrictionSpec};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, TangentialLaw, TangentialResponse};
use crate::contact::spring::kept_share;

/// Initial shear stiffness `K0`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum ShearStiffness {
    /// The same for every contact, N/m.
    Fixed(f64),
    /// A multiple of the present normal stiffness.
    OfNormal(f64),
}

/// Parameters of [`WaltonBraunShear`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct WaltonBraunShearSpec {
    /// Initial stiffness.
    pub stiffness: ShearStiffness,
    /// Exponent, above 0 and below 1.
    pub gamma: f64,
    /// Friction coefficients.
    pub friction: FrictionSpec,
}

/// Walton and Braun's shear of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaltonBraunShear {
    /// Initial stiffness that does not depend on the load, N/m.
    pub stiffness: f64,
    /// Initial stiffness per normal stiffness.
    pub stiffness_ratio: f64,
    /// Exponent.
    pub gamma: f64,
    /// Friction coefficients.
    pub friction: Friction,
}

impl TryFrom<WaltonBraunShearSpec> for WaltonBraunShear {
    type Error = LawError;
    fn try_from(spec: WaltonBraunShearSpec) -> Result<Self, LawError> {
        const LAW: &str = "WaltonBraunShear";
        if !(spec.gamma > 0.0 && spec.gamma < 1.0) {
            return Err(LawError::OutOfRange {
                law: LAW,
                parameter: "gamma",
                value: spec.gamma,
                expected: "a number between 0 and 1, both excluded",
            });
        }
        let (stiffness, stiffness_ratio) = match spec.stiffness {
            ShearStiffness::Fixed(k) => (positive(LAW, "stiffness.fixed", k)?, 0.0),
            ShearStiffness::OfNormal(r) => (0.0, positive(LAW, "stiffness.of_normal", r)?),
        };
        Ok(Self {
            stiffness,
            stiffness_ratio,
            gamma: spec.gamma,
            friction: spec.friction.try_into()?,
        })
    }
}

impl WaltonBraunShear {
    /// `theta = x^gamma`, and the share `1 - theta^(1/gamma) - theta (1 - theta^(1/gamma-1))/(1-gamma)`
    /// of the limit that slipping parts bear.
    #[inline]
    fn softening(&self, x: f64) -> (f64, f64) {
        let theta = if self.gamma == 1.0 / 3.0 { x.cbrt() } else { x.powf(self.gamma) };
        // theta^(1/gamma) = x and theta^(1/gamma - 1) = x/theta
        let slipping = 1.0 - x - (theta - x) / (1.0 - self.gamma);
        (theta, slipping.max(0.0))
    }
}

impl TangentialLaw for WaltonBraunShear {
    type Memory = PartialSlipMemory;

    #[inline]
    fn respond(
        &self,
        _: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut PartialSlipMemory,
    ) -> TangentialResponse {
        let m = memory;
        let slip = motion.slip_velocity * motion.dt;
        let k = self.stiffness + self.stiffness_ratio * normal.stiffness;
        let load = normal.friction_load;
        let limit = self.friction.mu_static * load;
        let before = m.shear;
        m.shear *= kept_share(k, m.stiffness);
        // F* (in `turn`) follows the load and stays inside the limit.
        let scale = if m.load > 0.0 { load / m.load } else { 0.0 };
        m.turn = (m.turn * scale).clamp(-limit, limit);
        if m.branch == 0.0 {
            m.follow(slip);
        }
        let along = slip.dot(m.axis);
        let mut t0 = m.shear.dot(m.axis);
        if (m.branch == 0.0 && along < 0.0 && t0 > 0.0) || (m.branch == 1.0 && along > 0.0) {
            m.branch = 1.0 - m.branch;
            m.turn = t0;
        }
        // Shear that has passed through zero grows again along the opposite axis.
        if m.branch == 1.0 && t0 < 0.0 {
            m.axis = -m.axis;
            m.branch = 0.0;
            m.turn = -m.turn;
            t0 = -t0;
        }
        let along = slip.dot(m.axis);
        let (t, star) = if m.branch == 0.0 { (t0, m.turn) } else { (-t0, -m.turn) };
        let room = (limit - star).max(f64::MIN_POSITIVE);
        let (theta, slipping) = self.softening((1.0 - (t - star) / room).clamp(0.0, 1.0));
        let across = m.shear - m.axis * t0 + (slip - m.axis * along) * k;
        let trial = m.axis * (t0 + theta * k * along) + across;
        let (shear, sliding) = self.friction.limit(trial, load, m.sliding, motion.slip_velocity);

        let stiff = k.max(f64::MIN_POSITIVE);
        let bearing = if star == 0.0 { limit } else { 0.5 * room };
        let slid =
            bearing * slipping * along.abs() + shear.length() * (trial - shear).length() / stiff;
        let shear = m.passive(before, shear, slip);
        m.shear = shear;
        m.load = load;
        m.stiffness = k;
        m.sliding = sliding;
        let work = 0.5 * (before + shear).dot(slip);
        let lost = m.book(work, slid, limit * limit / (stiff * (2.0 - self.gamma)));
        TangentialResponse {
            force_on_i: -shear,
            elastic_energy: m.energy,
            dissipated_power: lost / motion.dt,
            sliding,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const PAIR: PairGeometry =
        PairGeometry { r_star: 0.005, m_star: 0.01, radius_i: 0.01, radius_j: 0.01 };

    fn slide(law: &WaltonBraunShear, m: &mut PartialSlipMemory, ds: f64) -> TangentialResponse {
        let motion = Kinematics {
            normal_i_to_j: DVec3::Z,
            overlap: 1e-5,
            overlap_rate: 0.0,
            slip_velocity: DVec3::X * ds,
            spin_i: DVec3::ZERO,
            spin_j: DVec3::ZERO,
            lever_i: 0.01,
            lever_j: 0.01,
            dt: 1.0,
        };
        let normal = NormalResponse { force: 10.0, friction_load: 10.0, ..Default::default() };
        law.respond(&PAIR, &motion, &normal, m)
    }

    /// With L the room to the limit since the last reversal, the curve of both branches is
    /// L (1 - (1 - (1 - gamma) K0 s/L)^(1/(1 - gamma))).
    #[test]
    fn loading_and_unloading_follow_the_integral_of_the_stiffness() {
        for gamma in [1.0 / 3.0, 0.6] {
            let law: WaltonBraunShear = WaltonBraunShearSpec {
                stiffness: ShearStiffness::Fixed(1e6),
                gamma,
                friction: FrictionSpec { mu_static: 0.4, mu_kinetic: None, decay_speed: None },
            }
            .try_into()
            .unwrap();
            let curve = |s: f64, room: f64| {
                room * (1.0 - (1.0 - (1.0 - gamma) * 1e6 * s / room).powf(1.0 / (1.0 - gamma)))
            };
            let mut m = PartialSlipMemory::default();
            let (n, ds) = (20_000, 1.5e-10);
            let mut t = 0.0;
            // explicit steps: error of order 1/n of the limit of 4 N
            for k in 1..=n {
                t = -slide(&law, &mut m, ds).force_on_i.x;
                assert!((t - curve(ds * f64::from(k), 4.0)).abs() < 1e-3 * 4.0, "{gamma} {k}");
            }
            let turn = t;
            for k in 1..=n {
                let r = slide(&law, &mut m, -ds);
                let want = turn - curve(ds * f64::from(k), 4.0 + turn);
                assert!((-r.force_on_i.x - want).abs() < 1e-3 * 4.0, "{gamma} {k}");
                assert!(r.dissipated_power >= 0.0);
            }
        }
    }

    #[test]
    fn an_exponent_outside_zero_to_one_is_refused() {
        for gamma in [0.0, 1.0, f64::NAN] {
            let spec = WaltonBraunShearSpec {
                stiffness: ShearStiffness::OfNormal(0.8),
                gamma,
                friction: FrictionSpec { mu_static: 0.4, mu_kinetic: None, decay_speed: None },
            };
            assert!(WaltonBraunShear::try_from(spec).is_err());
        }
    }
}
