//! A contact model: one normal, one tangential, one rolling and one cohesion law.
//!
//! `F_i = -(N - P) n + T`, `tau_i = l_i n x T + M_i`, `tau_j = l_j n x T + M_j`
//!
//! - `n` unit vector from i to j; `N` normal repulsion, `P` pull of cohesion, N
//! - `T` tangential force on i, N; `M` rolling torques, N m; `l` levers, m
//!
//! The product is static: each combination of laws compiles to its own loop body, and results
//! that the caller does not read vanish with inlining. Torques are about the centres.

use glam::DVec3;

use super::kinematics::{Kinematics, PairGeometry};
use super::law::{
    CohesionLaw, CohesionResponse, Memory, NormalLaw, NormalResponse, RollingLaw, RollingResponse,
    TangentialLaw, TangentialResponse,
};

/// The laws of one pair of materials.
///
/// ```
/// use dem_core::contact::cohesion::Cohesionless;
/// use dem_core::contact::model::ContactModel;
/// use dem_core::contact::normal::HertzTailKept;
/// use dem_core::contact::rolling::FreeRolling;
/// use dem_core::contact::tangential::Frictionless;
/// // A damping factor of 0 is elastic; 25 GPa is glass on glass.
/// let model = ContactModel {
///     normal: HertzTailKept { e_star: 25e9, damping: 0.0 },
///     tangential: Frictionless,
///     rolling: FreeRolling,
///     cohesion: Cohesionless,
/// };
/// assert_eq!(model.normal.e_star, 25e9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactModel<N, T, R, C> {
    /// Normal law.
    pub normal: N,
    /// Tangential law.
    pub tangential: T,
    /// Rolling (and torsion) law.
    pub rolling: R,
    /// Cohesion law.
    pub cohesion: C,
}

/// What a contact remembers under a [`ContactModel`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ModelMemory<N, T, R, C> {
    /// Of the normal law.
    pub normal: N,
    /// Of the tangential law.
    pub tangential: T,
    /// Of the rolling law.
    pub rolling: R,
    /// Of the cohesion law.
    pub cohesion: C,
}

impl<N: Memory, T: Memory, R: Memory, C: Memory> Memory for ModelMemory<N, T, R, C> {
    const SLOTS: usize = N::SLOTS + T::SLOTS + R::SLOTS + C::SLOTS;

    #[inline]
    fn store(&self, slots: &mut [f64]) {
        let (n, rest) = slots.split_at_mut(N::SLOTS);
        let (t, rest) = rest.split_at_mut(T::SLOTS);
        let (r, c) = rest.split_at_mut(R::SLOTS);
        self.normal.store(n);
        self.tangential.store(t);
        self.rolling.store(r);
        self.cohesion.store(c);
    }

    #[inline]
    fn load(slots: &[f64]) -> Self {
        let (n, rest) = slots.split_at(N::SLOTS);
        let (t, rest) = rest.split_at(T::SLOTS);
        let (r, c) = rest.split_at(R::SLOTS);
        Self {
            normal: N::load(n),
            tangential: T::load(t),
            rolling: R::load(r),
            cohesion: C::load(c),
        }
    }

    #[inline]
    fn transport(&mut self, normal: DVec3, twist: f64) {
        self.normal.transport(normal, twist);
        self.tangential.transport(normal, twist);
        self.rolling.transport(normal, twist);
        self.cohesion.transport(normal, twist);
    }
}

/// Total effect of one contact, and what each law contributed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactResponse {
    /// Force on body i, N; on j it is the opposite.
    pub force_on_i: DVec3,
    /// Torque on body i about its centre, N m.
    pub torque_on_i: DVec3,
    /// Torque on body j about its centre, N m.
    pub torque_on_j: DVec3,
    /// Result of the normal law, its friction load raised by cohesion.
    pub normal: NormalResponse,
    /// Result of the tangential law.
    pub tangential: TangentialResponse,
    /// Result of the rolling law.
    pub rolling: RollingResponse,
    /// Result of the cohesion law.
    pub cohesion: CohesionResponse,
}

impl ContactResponse {
    /// Elastic energy of all laws together, J.
    #[inline]
    pub fn elastic_energy(&self) -> f64 {
        self.normal.elastic_energy
            + self.tangential.elastic_energy
            + self.rolling.elastic_energy
            + self.cohesion.elastic_energy
    }

    /// Power lost by all laws together, W.
    #[inline]
    pub fn dissipated_power(&self) -> f64 {
        self.normal.dissipated_power
            + self.tangential.dissipated_power
            + self.rolling.dissipated_power
            + self.cohesion.dissipated_power
    }
}

/// Anything that answers for a whole contact; [`ContactModel`] is the one implementation here.
pub trait ContactLaw: Copy + Send + Sync {
    /// What a contact remembers.
    type Memory: Memory;
    /// Forces and torques of the contact; updates the memory (already transported).
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        memory: &mut Self::Memory,
    ) -> ContactResponse;
    /// Largest gap, m, across which a contact that has touched still acts.
    fn reach(&self, pair: &PairGeometry) -> f64;
}

impl<N: NormalLaw, T: TangentialLaw, R: RollingLaw, C: CohesionLaw> ContactLaw
    for ContactModel<N, T, R, C>
{
    type Memory = ModelMemory<N::Memory, T::Memory, R::Memory, C::Memory>;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        memory: &mut Self::Memory,
    ) -> ContactResponse {
        let mut normal = self.normal.respond(pair, motion, &mut memory.normal);
        let cohesion = self.cohesion.respond(pair, motion, &normal, &mut memory.cohesion);
        normal.friction_load += cohesion.friction_load;
        let tangential = self.tangential.respond(pair, motion, &normal, &mut memory.tangential);
        let rolling = self.rolling.respond(pair, motion, &normal, &mut memory.rolling);
        let n = motion.normal_i_to_j;
        let moment = n.cross(tangential.force_on_i);
        ContactResponse {
            force_on_i: tangential.force_on_i - n * (normal.force - cohesion.pull),
            torque_on_i: moment * motion.lever_i + rolling.torque_on_i,
            torque_on_j: moment * motion.lever_j + rolling.torque_on_j,
            normal,
            tangential,
            rolling,
            cohesion,
        }
    }

    #[inline]
    fn reach(&self, pair: &PairGeometry) -> f64 {
        self.normal.reach(pair).max(self.cohesion.reach(pair))
    }
}
