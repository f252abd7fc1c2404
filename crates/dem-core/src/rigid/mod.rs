//! Rigid bodies of several spheres, and the integrator of their rotation.

mod clump;
mod rotation;

pub use clump::{Clump, ClumpSpec, ClumpSphere, PlacedClump};
pub use rotation::FreeRotation;
pub(crate) use rotation::{axes_of, free_turn, spin_of};
