//! Tangential laws: friction and shear stiffness.

pub mod mindlin;
pub mod none;

pub use mindlin::{Mindlin, MindlinSpec};
pub use none::Frictionless;
