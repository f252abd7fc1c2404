//! Claims about the engine and the laws, each with the reason of its tolerance.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod allocation;
mod clump_passes;
mod clumps;
mod conservation;
mod determinism;
mod extension;
mod faults;
mod integrators;
mod kernels;
mod lists;
#[cfg(feature = "mesh")]
mod meshes;
mod observers;
mod one_pass;
mod scenes;
mod walls;
