//! Tangential laws: friction and shear stiffness.

pub mod linear_spring;
pub mod mindlin;
pub mod mindlin_deresiewicz;
pub mod mindlin_total_spring;
pub mod none;
pub mod partial_slip;
mod spring_step;
pub mod walton_braun;

pub use linear_spring::{LinearSpring, LinearSpringSpec};
pub use mindlin::{Mindlin, MindlinSpec};
pub use mindlin_deresiewicz::{MindlinDeresiewicz, MindlinDeresiewiczSpec};
pub use mindlin_total_spring::MindlinTotalSpring;
pub use none::Frictionless;
pub use walton_braun::{ShearStiffness, WaltonBraunShear, WaltonBraunShearSpec};

#[cfg(test)]
mod cycle_tests;
