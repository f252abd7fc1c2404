//! Discrete-element mechanics of spheres and rigid clumps.

pub use glam;

pub mod contact;
