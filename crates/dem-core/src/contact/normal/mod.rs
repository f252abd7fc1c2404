//! Normal laws: force along the line of centres.

pub mod dmt;
pub mod hertz;
pub mod jkr;
pub mod linear_impact;
pub mod linear_spring_dashpot;
pub mod linear_stiffness;
pub mod restitution;
pub mod walton_braun;

pub use dmt::{Dmt, DmtSpec};
pub use hertz::{Hertz, HertzSpec, HertzTailCut, HertzTailKept};
pub use jkr::{Jkr, JkrSpec};
pub use linear_impact::LinearImpact;
pub use linear_spring_dashpot::{
    LinearSpringDashpot, LinearSpringDashpotSpec, LinearTailCut, LinearTailKept,
};
pub use linear_stiffness::{HertzMatch, linear_stiffness};
pub use restitution::AttractiveTail;
pub use walton_braun::{WaltonBraun, WaltonBraunSpec, YieldStiffness};

#[cfg(test)]
mod cycle_tests;
