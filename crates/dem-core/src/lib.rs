//! Discrete-element mechanics of spheres and rigid clumps.

pub use glam;

pub mod body_force;
pub mod builder;
pub mod contact;
pub mod energy;
pub mod error;
mod faults;
mod forces;
mod gap_force;
pub mod geometry;
pub mod impact;
pub mod integrate;
mod list;
pub mod material;
#[cfg(feature = "mesh")]
mod mesh_contacts;
mod neighbour;
pub mod noncontact;
pub mod particles;
pub mod prelude;
pub mod rigid;
pub mod snapshot;
mod step;
mod threads;
pub mod timestep;
pub mod world;
