//! What a rotating-drum experiment is, as data: parameters, rigs, plans, cases and tables.
//!
//! Everything that can vary has **one path** (`friction.pp`, `camera.roll_deg`): the path is at
//! once the key in a TOML file, the name of a factor of a plan, a free parameter or nuisance of a
//! case, an entry of the effect catalogue and a column of a table. [`namespace::PARAMETERS`]
//! declares them all with unit, nominal value, range, sign and meaning.
//!
//! A [`Rig`] describes the experiment, a [`Plan`] is a rig with factors, a [`Case`] is a rig
//! with data, free parameters and nuisances. All three are read from TOML; a key that is not
//! known is an error that shows the line and names the nearest known key.
//!
//! ```
//! let rig = rig_schema::Rig::parse("drum.toml", r#"
//! name = "beads"
//! drum = { radius_m = 0.125, length_m = 0.15, mantle = "steel", end_plates = "steel" }
//! particles = { material = "glass", shape = { sphere = { diameter_m = 0.006 } } }
//! fill.count = 7807
//! friction = { pp = 0.5, mantle = 0.6 }
//! run = { speeds_rpm = [17.0], time_step_s = 7e-5 }
//! [materials]
//! glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e7 }
//! steel = { density_kg_m3 = 8000.0, poisson_ratio = 0.265, shear_modulus_pa = 8e10 }
//! "#)?;
//! let omega = rig.run.speeds_rpm[0] * std::f64::consts::TAU / 60.0;
//! let froude = omega * omega * rig.drum.radius_m / 9.81;
//! assert!((froude - 0.0404).abs() < 1e-4);
//! assert_eq!(rig.settings.value("friction.mantle"), Some(0.6));
//! # Ok::<(), rig_schema::SchemaError>(())
//! ```

mod case;
mod code_differences;
mod diagnostic;
mod document;
mod errata;
mod error;
mod load;
pub mod namespace;
mod parameter;
mod plan;
mod response;
mod rig;
mod settings;
mod sheet;
mod table;

pub use case::{
    Case, CatalogueChoice, Data, Free, Holdout, NO_DIFFERENCES, Nuisance, Simulator, TableBasis,
    TableSimulator,
};
pub use code_differences::CodeDifferences;
pub use diagnostic::Diagnostic;
pub use errata::{Action, Errata, ErrataLevel, Erratum, Tag};
pub use error::SchemaError;
pub use load::{Amount, Load};
pub use parameter::{Layer, Parameter, Sign};
pub use plan::{DesignKind, Plan, PlanFactor};
pub use response::Response;
pub use rig::{
    Cohesion, Contact, Drum, Ends, Lifters, Material, NormalLaw, Particles, Rig, RigidRing,
    RollingLaw, Run, Shape, Sphere, TangentialLaw,
};
pub use settings::Settings;
pub use table::{Cell, MeasuredRow, MeasuredTable, SimulatedRow, SimulatedTable};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
