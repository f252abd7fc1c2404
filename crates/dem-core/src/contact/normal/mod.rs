//! Normal laws: force along the line of centres.

pub mod hertz;
pub mod restitution;

pub use hertz::{Hertz, HertzSpec, HertzTailCut, HertzTailKept};
pub use restitution::AttractiveTail;
