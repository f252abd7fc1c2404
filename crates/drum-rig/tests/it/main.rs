//! Claims about the virtual experiment.

mod determinism;
mod errors;
mod laws;
mod parameters;
mod physics;
mod rigs;
mod walls;
