//! Claims about the engine and the laws, each with the reason of its tolerance.

mod allocation;
mod clumps;
mod conservation;
mod determinism;
mod faults;
mod integrators;
mod lists;
#[cfg(feature = "mesh")]
mod meshes;
mod scenes;
mod walls;
