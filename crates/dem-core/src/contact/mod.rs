//! Contacts: kinematics, the roles of laws, and the laws themselves.

pub mod cohesion;
pub mod elasticity;
pub mod error;
pub mod friction;
pub mod kinematics;
pub mod law;
pub mod model;
pub mod normal;
pub mod rolling;
pub mod spring;
pub mod tangential;
