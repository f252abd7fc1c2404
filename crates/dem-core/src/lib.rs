//! Discrete-element mechanics of spheres and rigid clumps.

pub use glam;

pub mod contact;
pub mod impact;
pub mod noncontact;
pub mod timestep;
