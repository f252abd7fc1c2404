//! Claims about the engine and the laws, each with the reason of its tolerance.

mod allocation;
mod clumps;
mod conservation;
mod determinism;
mod faults;
mod integrators;
mod lists;
mod scenes;
mod walls;
