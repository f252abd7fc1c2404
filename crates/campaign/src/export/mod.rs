//! The same drum for other codes: a deck, the positions at the start, and the way back.
//!
//! [`deck`] turns a rig into an input script for LIGGGHTS, LAMMPS or YADE with a data file of its filled drum. The
//! deck does what an [`drum_rig::Experiment`] does: the bed settles under tilted gravity with drag,
//! the drum takes up one speed after another, a drag fades while the bed rises at the first, and
//! frames are written at given times. [`positions`] turns their dumps into the table that the film reads.
//!
//! What a code does not know is refused, not left out.
//!
//! | of a rig | LIGGGHTS | LAMMPS | YADE |
//! |---|---|---|---|
//! | particles | spheres, one size or many | as left | as left |
//! | normal, tangential | `hertz`, `tangential history` | `hertz`, `mindlin_rescale/force` | `MindlinPhys_Mindlin` |
//! | rolling | none; `constant_torque` as `cdt` | none; `constant_torque` as `sds` with a stiff spring (approximate) | none; `constant_torque` as a stiff spring (approximate) |
//! | cohesion | none; `simplified_jkr` as `sjkr` | none | none |
//! | ends | turning, still, periodic | as left | as left |
//! | friction, rolling, restitution | own values of mantle and end plates | as left | as left |
//! | moduli | per material, combined by the code | per pair, combined here | stand-ins, which the code combines to the pair's |

mod dump;
mod lammps;
mod liggghts;
mod scene;
mod schedule;
mod yade;

pub use dump::positions;
pub use schedule::Schedule;

use drum_rig::{Experiment, Options};
use rig_schema::Rig;

use crate::CampaignError;
use scene::Scene;

/// A code that a deck can be written for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Code {
    /// LIGGGHTS-PUBLIC 3.8.
    Liggghts,
    /// LAMMPS with the package GRANULAR.
    Lammps,
    /// YADE 2023.02.
    Yade,
}

impl Code {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Liggghts => "LIGGGHTS",
            Self::Lammps => "LAMMPS",
            Self::Yade => "YADE",
        }
    }

    /// Name of the input script of [`deck`].
    pub fn script(self) -> &'static str {
        match self {
            Self::Liggghts => "drum.lig",
            Self::Lammps => "drum.lmp",
            Self::Yade => "drum.py",
        }
    }
}

/// A file of a deck.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeckFile {
    /// Name, in the folder of the deck.
    pub name: String,
    /// Content.
    pub text: String,
}

/// Name of the dump that a deck writes at a speed, rpm.
///
/// ```
/// assert_eq!(campaign::export::dump_name(17.0), "frames_17rpm.dump");
/// ```
pub fn dump_name(speed_rpm: f64) -> String {
    format!("frames_{speed_rpm}rpm.dump")
}

/// The deck of a rig: the input script first, then what it reads.
///
/// Coordinates are those of the rig: drum axis along z through the origin, y up, the bed rising at
/// positive x.
///
/// ```
/// use campaign::export::{Code, Schedule, deck};
/// let rig = campaign::rig_schema::Rig::parse("drum.toml", r#"
/// name = "a handful of beads"
/// drum = { radius_m = 0.02, length_m = 0.02, mantle = "glass", end_plates = "glass" }
/// particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
/// fill.count = 90
/// friction = { pp = 0.5, mantle = 0.6, end_plate = 0.2 }
/// restitution = { pp = 0.7, mantle = 0.7 }
/// rolling = { pp = 0.01, mantle = 0.01 }
/// run = { speeds_rpm = [30.0, 60.0], frames = 5 }
/// [materials]
/// glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e6 }
/// "#)?;
/// let files = deck(&rig, Code::Liggghts, &Schedule::default())?;
/// assert_eq!(files[0].name, "drum.lig");
/// assert!(files[0].text.contains("rolling_friction cdt"));
/// assert_eq!(files[1].text.lines().filter(|l| l.starts_with("1 ")).count(), 1); // bead 1
/// # Ok::<(), campaign::CampaignError>(())
/// ```
///
/// # Errors
/// [`CampaignError::NotExported`] for what the code does not know, [`CampaignError::Option`] for a
/// schedule that cannot be, [`CampaignError::Rig`] for a rig that cannot be filled.
pub fn deck(rig: &Rig, code: Code, how: &Schedule) -> Result<Vec<DeckFile>, CampaignError> {
    let scene = Scene::of(rig, code)?;
    let drum = Experiment::new(rig, &Options::default())?;
    let stages = how.stages(rig, &scene, drum.time_step())?;
    let data = DeckFile { name: "start.data".to_owned(), text: scene.data(&drum) };
    let mut files = match code {
        Code::Liggghts => liggghts::files(&scene, &drum, &stages),
        Code::Lammps => lammps::files(&scene, &drum, &stages),
        Code::Yade => yade::files(&scene, &drum, &stages),
    };
    files.insert(1, data);
    Ok(files)
}
