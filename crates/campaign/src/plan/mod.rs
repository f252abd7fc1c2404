//! Campaigns: every run of a plan, once, whatever interrupts it.
//!
//! A [`rig_schema::Plan`] is frozen into a [`Manifest`]: one [`Row`] a run with all its parameters, its
//! seed and a hash of both. A [`Campaign`] is a folder with a manifest; [`Campaign::run`] carries out what has no
//! result yet, on worker threads of one simulation each, and [`Campaign::collect`] makes one table of
//! the results.
//!
//! | in the folder | what it holds |
//! |---|---|
//! | `manifest.json` | the frozen plan, with a checksum |
//! | `rows/NNNN.json` | result of a run, or why it failed |
//! | `rows/NNNN.checkpoint` | state of a run under way |
//! | `rows/NNNN.motion` | motion of that run, as long as others that differ in camera or reader alone need it |
//! | `locks/` | locks of the operating system, freed when a process dies |
//! | `responses.csv` | table of simulated responses |
//!
//! Runs that differ in camera or reader alone have one seed and one motion, which is simulated once.
//!
//! Every file is written to another name and renamed. A run that was killed goes on from its last
//! checkpoint and gives the same bits as one that was not; neither the number of workers nor the
//! order of the runs changes a result.

mod campaign;
mod checkpoint;
mod collect;
mod design;
pub(crate) mod file;
mod lock;
mod manifest;
mod result;
mod row;
mod runner;
mod scheduler;

pub use campaign::{Campaign, RowState};
pub use collect::{Collected, Missing};
pub use design::{SPEED, points};
pub use manifest::{Coarse, Freeze, Manifest, Row};
pub use result::{
    Effort, Failure, FailureClass, Responses, RowOutcome, RowResult, Seen, Simulated, SpeedResult,
};
pub use runner::{Event, RunOptions, Summary};
pub use scheduler::{Call, gnu_parallel, quoted, slurm, snakemake};
