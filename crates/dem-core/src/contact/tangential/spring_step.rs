//! One step of a shear spring under Coulomb's limit: what the spring laws have in common.
//!
//! `T_trial = share T0 - k ds`, limited by friction, then a dashpot inside the same limit.
//! The laws differ in the stiffness `k` and in the `share` of the old force that they carry over.
//! Dissipation is the work of the mean force of the step less the gain of elastic energy.

use glam::DVec3;

use crate::contact::friction::Friction;
use crate::contact::kinematics::Kinematics;
use crate::contact::law::{NormalResponse, TangentialResponse};
use crate::contact::spring::SpringMemory;

/// Numbers of one step.
pub(crate) struct SpringStep {
    /// Present stiffness `k`, N/m.
    pub(crate) stiffness: f64,
    /// Share of the old force that is carried over.
    pub(crate) share: f64,
    /// Damping coefficient, N s/m; 0 for none.
    pub(crate) dashpot: f64,
}

impl SpringStep {
    #[inline]
    pub(crate) fn advance(
        &self,
        friction: &Friction,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut SpringMemory,
    ) -> TangentialResponse {
        let slip = motion.slip_velocity * motion.dt;
        let before = *memory;
        let energy_before = before.energy();
        let (spring, sliding) = friction.limit(
            before.force * self.share - slip * self.stiffness,
            normal.friction_load,
            before.sliding,
            motion.slip_velocity,
        );
        *memory = SpringMemory { force: spring, stiffness: self.stiffness, sliding };
        let elastic_energy = memory.energy();
        let work = -0.5 * (before.force + spring).dot(slip);
        let mut lost = (work - (elastic_energy - energy_before)) / motion.dt;
        let mut force = spring;
        if self.dashpot > 0.0 && !sliding {
            force = within(
                spring - motion.slip_velocity * self.dashpot,
                friction.mu_static * normal.friction_load,
            );
            lost -= (force - spring).dot(motion.slip_velocity);
        }
        TangentialResponse { force_on_i: force, elastic_energy, dissipated_power: lost, sliding }
    }
}

/// `force` shortened to at most `limit`.
#[inline]
fn within(force: DVec3, limit: f64) -> DVec3 {
    let size2 = force.length_squared();
    if size2 > limit * limit { force * (limit / size2.sqrt()) } else { force }
}
