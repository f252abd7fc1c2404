//! Cases that `dem-core` must reproduce, each as data: reference, ours, deviation, tolerance and its
//! reason, source, verdict.
//!
//! One file a group of cases, each with `cases()`; [`all`] joins them. The workspace's validation
//! report is written from this list, and the test of this crate asserts that every check passes.

mod check;
mod laws;

pub mod contact_compatibility;
pub mod contact_free_fall;
pub mod contact_hertz;
pub mod contact_jkr;
pub mod contact_linear;
pub mod contact_oblique;
pub mod contact_restitution;
pub mod contact_rolling;
pub mod engine_drops;
pub mod engine_order;
pub mod engine_rolling;

pub use check::{Check, Held};

/// Every check of every group.
pub fn all() -> Vec<Check> {
    let groups: [fn() -> Vec<Check>; 11] = [
        contact_hertz::cases,
        contact_restitution::cases,
        contact_oblique::cases,
        contact_linear::cases,
        contact_jkr::cases,
        contact_free_fall::cases,
        contact_rolling::cases,
        contact_compatibility::cases,
        engine_drops::cases,
        engine_order::cases,
        engine_rolling::cases,
    ];
    groups.into_iter().flat_map(|cases| cases()).collect()
}
