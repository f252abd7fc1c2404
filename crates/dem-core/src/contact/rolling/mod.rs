//! Rolling laws: resistance against rolling and twisting.

pub mod absolute_spin;
pub mod coefficient;
pub mod constant_torque;
pub mod none;
pub mod spring_dashpot;
pub mod torsion;
pub mod viscous_capped;
pub mod zhu;

pub use absolute_spin::AbsoluteSpin;
pub use coefficient::{RollingArm, RollingCoefficient};
pub use constant_torque::{ConstantTorque, ConstantTorqueSpec};
pub use none::FreeRolling;
pub use spring_dashpot::{RollingSpringDashpot, RollingSpringDashpotSpec, RollingStiffness};
pub use torsion::{Torsion, TorsionSpec, WithTorsion};
pub use viscous_capped::{RollingViscosity, ViscousCapped, ViscousCappedSpec};
pub use zhu::{Zhu, ZhuSpec};

#[cfg(test)]
mod frame_tests;
