//! Mindlin and Deresiewicz: a rim of micro-slip that grows with the shear, with loading,
//! unloading and reloading.
//!
//! `dT = 8 G* a theta ds + (-1)^k mu dN (1 - theta)`, with `theta^3` one of
//!
//! - k = 0, loading: `1 - (T + mu dN)/(mu N)`
//! - k = 1, unloading: `1 - (T1 - T + 2 mu dN)/(2 mu N)`
//! - k = 2, reloading: `1 - (T - T2 + 2 mu dN)/(2 mu N)`
//!
//! `T1`, `T2` shear at the reversals, moved by `+mu dN`, `-mu dN` as the load changes;
//! `theta = 1` while `8 G* a |ds| < mu dN`: the circle that grew sticks as a whole. Until the shear
//! has caught up with the limit so gained, slip starts anew from the rim:
//! `theta^3 = 1 - (T' + mu dN)/(mu N)` with `T'` the shear added since.
//!
//! - `T` shear along the axis of loading, N; `ds` slip along it, m; `dN` change of the load `N`, N
//! - `G*` effective shear modulus, Pa; `a` contact radius, m; `mu` static friction
//!
//! Validity: elastic spheres, one direction of shear. References: R. D. Mindlin, H. Deresiewicz,
//! *J. Appl. Mech.* 20 (1953) 327-344, doi:10.1115/1.4010702; C. Thornton, K. K. Yin, *Powder
//! Technology* 65 (1991) 153-166, doi:10.1016/0032-5910(91)80178-L; thesis eq. 20-22 with `G*`
//! for `G`, `2 mu N` for the printed `2 mu`, and the rule for a growing load added.
//! Departures: shear across the axis meets the no-slip stiffness and, on first loading, turns the
//! axis; a reversal within a reloading starts a new unloading and forgets the outer loop;
//! energy, loss and passivity by `partial_slip.rs`.

use glam::DVec3;

use super::partial_slip::PartialSlipMemory;
use crate::contact::error::{LawError, positive};
use crate::contact::friction::{Friction, FrictionSpec};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, TangentialLaw, TangentialResponse};
use crate::contact::spring::kept_share;

/// Parameters of [`MindlinDeresiewicz`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct MindlinDeresiewiczSpec {
    /// Effective shear modulus, Pa.
    pub g_star: f64,
    /// Friction coefficients.
    pub friction: FrictionSpec,
}

/// Mindlin-Deresiewicz law of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MindlinDeresiewicz {
    /// Effective shear modulus, Pa.
    pub g_star: f64,
    /// Friction coefficients.
    pub friction: Friction,
}

impl TryFrom<MindlinDeresiewiczSpec> for MindlinDeresiewicz {
    type Error = LawError;
    fn try_from(spec: MindlinDeresiewiczSpec) -> Result<Self, LawError> {
        Ok(Self {
            g_star: positive("MindlinDeresiewicz", "g_star", spec.g_star)?,
            friction: spec.friction.try_into()?,
        })
    }
}

impl MindlinDeresiewicz {
    /// Shear (N) of first loading at the displacement `s` (m) under the constant load `load` (N):
    /// `mu N (1 - (1 - s/s_m)^(3/2))`, `s_m = 3 mu N/(16 G* a)`.
    pub fn first_loading(&self, s: f64, load: f64, contact_radius: f64) -> f64 {
        let limit = self.friction.mu_static * load;
        let onset = 1.5 * limit / (8.0 * self.g_star * contact_radius);
        let left = (1.0 - s / onset).max(0.0);
        limit * (1.0 - left * left.sqrt())
    }
}

impl TangentialLaw for MindlinDeresiewicz {
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
        let k = 8.0 * self.g_star * normal.contact_radius;
        let load = normal.friction_load;
        let mu = self.friction.mu_static;
        let (limit, growth) = (mu * load, mu * (load - m.load));
        let before = m.shear;
        if m.branch == 0.0 {
            m.follow(slip);
        }
        let along = slip.dot(m.axis);
        let t0 = m.shear.dot(m.axis);
        reverse(m, along, t0);
        let loading = m.branch != 1.0;
        let forward = if loading { along } else { -along };

        let distance = if m.branch == 0.0 {
            t0 + growth
        } else if loading {
            0.5 * (t0 - m.turn_back + 2.0 * growth)
        } else {
            0.5 * (m.turn - t0 + 2.0 * growth)
        };
        let advance = k * forward;
        let bound = limit.max(f64::MIN_POSITIVE);
        let theta = if growth > 0.0 && advance < growth {
            // A load that outgrows the shear sticks the whole circle.
            m.deficit += growth - advance;
            m.since = 0.0;
            1.0
        } else {
            let behind = m.deficit > 0.0;
            let distance = if behind { m.since + growth } else { distance };
            let theta = (1.0 - distance / bound).clamp(0.0, 1.0).cbrt();
            if behind {
                // Slip starts anew from the rim until the shear has caught up with the limit.
                let caught = theta * (advance - growth);
                m.since += caught + growth;
                m.deficit = (m.deficit - caught).max(0.0);
            }
            theta
        };
        let change = theta * advance + growth * (1.0 - theta);
        let t1 = if loading { t0 + change } else { t0 - change };
        if m.branch != 0.0 {
            m.turn += growth;
            m.turn_back -= growth;
        }
        let across =
            (m.shear - m.axis * t0) * kept_share(k, m.stiffness) + (slip - m.axis * along) * k;
        let trial = m.axis * t1 + across;
        let (shear, sliding) = self.friction.limit(trial, load, m.sliding, motion.slip_velocity);

        let rim = limit * (1.0 - 1.5 * theta + 0.5 * theta * theta * theta);
        let stiff = k.max(f64::MIN_POSITIVE);
        let capped = shear.length() * (trial - shear).length() / stiff;
        let slid = rim * (forward - growth / stiff).max(0.0) + capped;
        let shear = m.passive(before, shear, slip);
        m.shear = shear;
        m.load = load;
        m.stiffness = k;
        m.sliding = sliding;
        settle(m);
        let work = 0.5 * (before + shear).dot(slip);
        let lost = m.book(work, slid, 0.6 * limit * limit / stiff);
        TangentialResponse {
            force_on_i: -shear,
            elastic_energy: m.energy,
            dissipated_power: lost / motion.dt,
            sliding,
        }
    }
}

/// Change the branch where the slip turns back.
#[inline]
fn reverse(m: &mut PartialSlipMemory, along: f64, t: f64) {
    if m.branch != 1.0 && along < 0.0 && t > 0.0 {
        m.branch = 1.0;
        m.turn = t;
        m.deficit = 0.0;
        m.since = 0.0;
    } else if m.branch == 1.0 && along > 0.0 {
        m.branch = 2.0;
        m.turn_back = t;
        m.deficit = 0.0;
        m.since = 0.0;
    }
}

/// Return to first loading where unloading or reloading has reached its turning point.
#[inline]
fn settle(m: &mut PartialSlipMemory) {
    let t = m.shear.dot(m.axis);
    if (m.branch == 1.0 && t <= -m.turn)
        || (m.branch != 0.0 && (t >= m.turn || m.shear == DVec3::ZERO))
    {
        m.branch = 0.0;
        m.turn = 0.0;
        m.turn_back = 0.0;
    }
}

#[cfg(test)]
#[path = "mindlin_deresiewicz_tests.rs"]
mod tests;
