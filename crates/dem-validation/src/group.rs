//! The groups of cases, in the order of the report.

use crate::{
    Check, contact_compatibility, contact_free_fall, contact_hertz, contact_jkr, contact_linear,
    contact_oblique, contact_restitution, contact_rolling, engine_drops, engine_energy,
    engine_invariants, engine_order, engine_restitution, engine_rigid, engine_rolling,
};

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
