//! Cohesion laws: attraction added to a normal law.

pub mod none;

pub use none::Cohesionless;
