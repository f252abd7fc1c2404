//! Cohesion laws: attraction added to a normal law.

pub mod linear_cohesion;
pub mod none;
pub mod sjkr;

pub use linear_cohesion::{LinearCohesion, LinearCohesionSpec};
pub use none::Cohesionless;
pub use sjkr::{Sjkr, SjkrSpec};
