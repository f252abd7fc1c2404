//! Rolling laws: resistance against rolling and twisting.

pub mod coefficient;
pub mod constant_torque;
pub mod none;

pub use coefficient::{RollingArm, RollingCoefficient};
pub use constant_torque::{ConstantTorque, ConstantTorqueSpec};
pub use none::FreeRolling;
