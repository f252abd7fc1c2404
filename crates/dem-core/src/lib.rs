//! Discrete-element mechanics of spheres and rigid clumps.
//!
//! A [`world::World`] holds particles, walls and one contact law for each pair of materials, and
//! advances them step by step. It does no input or output and depends on nothing but a vector
//! type. The same input gives the same bits for any number of threads, with or
//! without observers, across a stop and restart.
//!
//! ```
//! use dem_core::prelude::*;
//! // A glass bead falls 20 mm on a plate and leaves it with the restitution asked for.
//! let glass = Material::from_shear_modulus(2.52e7, 0.29, 2500.0);
//! let e_star = glass.youngs_modulus / (2.0 * (1.0 - 0.29f64.powi(2)));
//! let normal: HertzTailCut = HertzSpec { e_star, restitution: 0.8 }.try_into()?;
//! let law = ContactModel {
//!     normal,
//!     tangential: Frictionless,
//!     rolling: FreeRolling,
//!     cohesion: Cohesionless,
//! };
//! let mut builder = WorldBuilder::new(1e-5);
//! let bead = builder.material(glass);
//! builder.pair_law(bead, bead, law).gravity(DVec3::NEG_Z * 9.81);
//! builder.domain(DVec3::splat(-0.1), DVec3::splat(0.1));
//! builder.wall(Wall::plane(DVec3::ZERO, DVec3::Z, bead));
//! let id = builder.sphere(Sphere::at(DVec3::Z * 0.023, 3e-3, bead));
//! let mut world = builder.build()?;
//! // Top of the first bounce: 1.8 sqrt(2 h / g) = 114.9 ms, and 0.5 ms of contact.
//! world.run(11_540)?;
//! let height = world.position(id).z - 3e-3;
//! assert!((height / (0.8 * 0.8 * 0.02) - 1.0).abs() < 0.01);
//! # Ok::<(), dem_core::error::Error>(())
//! ```
//!
//! # A law of your own
//!
//! Laws are plain structs that implement [`contact::law::NormalLaw`],
//! [`contact::law::TangentialLaw`], [`contact::law::RollingLaw`] or
//! [`contact::law::CohesionLaw`]; a [`contact::model::ContactModel`] of four of them, from here
//! or elsewhere, goes into [`builder::WorldBuilder::pair_law`]. What a contact remembers is the
//! law's [`contact::law::Memory`]; the world keeps it through every rebuild and snapshot.

pub use glam;

pub mod body_force;
mod body_run;
mod body_stage;
pub mod builder;
mod clump_stage;
pub mod contact;
mod contact_stage;
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
pub mod observe;
mod one_pass;
pub mod particles;
pub mod prelude;
pub mod rigid;
mod simd;
pub mod snapshot;
mod spheres;
mod step;
mod strips;
mod sums;
mod sweep;
mod threads;
mod tier;
pub mod timestep;
pub mod world;
