//! Contacts: kinematics, the roles of laws, and the laws themselves.

pub mod kinematics;
pub mod law;
