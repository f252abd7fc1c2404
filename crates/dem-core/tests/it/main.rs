//! Claims about the engine and the laws, each with the reason of its tolerance.

mod allocation;
mod clumps;
mod conservation;
mod determinism;
mod extension;
mod faults;
mod integrators;
mod lists;
#[cfg(feature = "mesh")]
mod meshes;
mod observers;
mod scenes;
mod walls;
