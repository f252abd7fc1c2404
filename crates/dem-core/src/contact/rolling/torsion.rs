//! Resistance against twisting about the normal, on top of any rolling law.
//!
//! `M = M0 min(1, k/k0) - k w_n dt` along the normal, then `|M| <= (3 pi/16) mu N a`,
//! `k = 16/3 G_s a^3`
//!
//! - `M` torque on i, N m; `M0`, `k0` of the step before; `w_n` relative spin about the normal, rad/s
//! - `k` torsional stiffness of a stuck circle, N m/rad; `a` contact radius, m
//! - `G_s = 1/(1/G_i + 1/G_j)` shear moduli in series, Pa; `mu` friction; `N` load, N
//!
//! The limit is the torque of a Hertz pressure that slides everywhere:
//! `2 pi mu integral p r^2 dr = (3 pi/16) mu N a`. No parameter but friction is free.
//! Validity: smooth spheres. References: K. L. Johnson, *Contact Mechanics*, 1985, section 3.9 and
//! 7.4 (after Reissner and Sagoci). Departures: no micro-slip at the rim; the combined limit of
//! shear and twist is neglected; a falling stiffness takes its share of the torque along.

use glam::DVec3;

use crate::contact::error::{LawError, non_negative, positive};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{Memory, NormalResponse, RollingLaw, RollingResponse};
use crate::contact::spring::{kept_share, spring_energy};

/// Parameters of [`Torsion`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct TorsionSpec {
    /// Shear moduli in series, Pa.
    pub g_series: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

/// Torsion of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torsion {
    /// Shear moduli in series, Pa.
    pub g_series: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

impl TryFrom<TorsionSpec> for Torsion {
    type Error = LawError;
    fn try_from(spec: TorsionSpec) -> Result<Self, LawError> {
        Ok(Self {
            g_series: positive("Torsion", "g_series", spec.g_series)?,
            friction: non_negative("Torsion", "friction", spec.friction)?,
        })
    }
}

/// A rolling law with torsion added.
///
/// ```
/// use dem_core::contact::rolling::{FreeRolling, Torsion, WithTorsion};
/// let law = WithTorsion { rolling: FreeRolling, torsion: Torsion { g_series: 1e10, friction: 0.3 } };
/// // A 10 N contact of 50 um radius slips when twisted by 88 uN m.
/// assert!((law.torsion.limit(10.0, 50e-6) - 88.4e-6).abs() < 1e-7);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WithTorsion<R> {
    /// Resistance against rolling.
    pub rolling: R,
    /// Resistance against twisting.
    pub torsion: Torsion,
}

/// Memory of [`WithTorsion`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TorsionMemory<M> {
    /// Of the rolling law.
    pub rolling: M,
    /// Torque of the twisted spring on i along the normal, N m.
    pub torque: f64,
    /// Stiffness at which it was reached, N m/rad.
    pub stiffness: f64,
}

impl<M: Memory> Memory for TorsionMemory<M> {
    const SLOTS: usize = M::SLOTS + 2;

    #[inline]
    fn store(&self, slots: &mut [f64]) {
        let (rolling, own) = slots.split_at_mut(M::SLOTS);
        self.rolling.store(rolling);
        own[0] = self.torque;
        own[1] = self.stiffness;
    }

    #[inline]
    fn load(slots: &[f64]) -> Self {
        let (rolling, own) = slots.split_at(M::SLOTS);
        Self { rolling: M::load(rolling), torque: own[0], stiffness: own[1] }
    }

    #[inline]
    fn transport(&mut self, normal: DVec3, twist: f64) {
        self.rolling.transport(normal, twist);
    }
}

impl Torsion {
    /// Torque at which the whole circle slides, N m.
    #[inline]
    pub fn limit(&self, load: f64, contact_radius: f64) -> f64 {
        3.0 * std::f64::consts::PI / 16.0 * self.friction * load * contact_radius
    }

    /// Torsional stiffness of a stuck circle, N m/rad.
    #[inline]
    pub fn stiffness(&self, contact_radius: f64) -> f64 {
        16.0 / 3.0 * self.g_series * contact_radius * contact_radius * contact_radius
    }
}

impl<R: RollingLaw> RollingLaw for WithTorsion<R> {
    type Memory = TorsionMemory<R::Memory>;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut Self::Memory,
    ) -> RollingResponse {
        let mut response = self.rolling.respond(pair, motion, normal, &mut memory.rolling);
        let a = normal.contact_radius;
        let (limit, k) = (self.torsion.limit(normal.friction_load, a), self.torsion.stiffness(a));
        let turn = motion.torsion_spin() * motion.dt;
        let (torque0, k0) = (memory.torque, memory.stiffness);
        let torque = (torque0 * kept_share(k, k0) - k * turn).clamp(-limit, limit);
        let energy = spring_energy(torque * torque, k);
        let work = -0.5 * (torque0 + torque) * turn;
        memory.torque = torque;
        memory.stiffness = k;
        response.torque_on_i += motion.normal_i_to_j * torque;
        response.torque_on_j -= motion.normal_i_to_j * torque;
        response.elastic_energy += energy;
        response.dissipated_power +=
            (work - (energy - spring_energy(torque0 * torque0, k0))) / motion.dt;
        response
    }
}
