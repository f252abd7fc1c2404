//! Cases that `dem-core` must reproduce, each as data: reference, ours, deviation, tolerance and its
//! reason, source, verdict.
//!
//! One file a group of cases, each with `cases()`; [`all`] joins them. The workspace's validation
//! report is written from this list, and the test of this crate asserts that every check passes.

mod check;
mod group;
mod laws;
mod scenes;

pub mod contact_compatibility;
pub mod contact_free_fall;
pub mod contact_hertz;
pub mod contact_jkr;
pub mod contact_linear;
pub mod contact_oblique;
pub mod contact_restitution;
pub mod contact_rolling;
pub mod curves;
pub mod engine_drops;
pub mod engine_energy;
pub mod engine_invariants;
pub mod engine_order;
pub mod engine_restitution;
pub mod engine_rigid;
pub mod engine_rolling;
mod squeezed;

pub use check::{Check, Held};
pub use group::{GROUPS, Group, all};
