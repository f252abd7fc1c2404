//! Cases that `dem-core` must reproduce, each as data: reference, ours, deviation, tolerance and its
//! reason, source, verdict.
//!
//! One file a group of cases, each with `cases()`; [`all`] joins them. The workspace's validation
//! report is written from this list, and the test of this crate asserts that every check passes.

mod check;
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

/// Cases that belong together.
#[derive(Debug, Clone, Copy)]
pub struct Group {
    /// Short name, that of its module.
    pub name: &'static str,
    /// Heading.
    pub title: &'static str,
    /// Runs its cases.
    pub cases: fn() -> Vec<Check>,
}

/// Every group, in the order of the report.
pub const GROUPS: [Group; 15] = [
    group("contact_hertz", "Elastic normal impact (Chung-Ooi 1, 2)", contact_hertz::cases),
    group("contact_restitution", "Restitution (Chung-Ooi 3)", contact_restitution::cases),
    group(
        "contact_oblique",
        "Oblique and spinning impact (Chung-Ooi 4 to 8)",
        contact_oblique::cases,
    ),
    group("contact_linear", "Linear spring-dashpot in closed form", contact_linear::cases),
    group("contact_jkr", "JKR and DMT", contact_jkr::cases),
    group("contact_free_fall", "A dropped sphere (MFIX DEM01, DEM02)", contact_free_fall::cases),
    group(
        "engine_drops",
        "Drops and squeezes in the engine (MFIX DEM01 to DEM03)",
        engine_drops::cases,
    ),
    group(
        "contact_rolling",
        "Slipping and rolling (MFIX DEM04, incline, Zhu)",
        contact_rolling::cases,
    ),
    group(
        "engine_rolling",
        "Slipping and rolling in the engine (MFIX DEM04, incline, decay)",
        engine_rolling::cases,
    ),
    group("contact_compatibility", "Compatibility laws", contact_compatibility::cases),
    group("engine_restitution", "Restitution in the engine", engine_restitution::cases),
    group("engine_order", "Order of the integrators", engine_order::cases),
    group("engine_energy", "Energy of many steps", engine_energy::cases),
    group("engine_rigid", "Free rotation", engine_rigid::cases),
    group("engine_invariants", "Invariants of the engine", engine_invariants::cases),
];

const fn group(name: &'static str, title: &'static str, cases: fn() -> Vec<Check>) -> Group {
    Group { name, title, cases }
}

/// Every check of every group.
pub fn all() -> Vec<Check> {
    GROUPS.into_iter().flat_map(|group| (group.cases)()).collect()
}
