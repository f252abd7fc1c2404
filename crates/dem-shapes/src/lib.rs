//! Tablets and other solids as rigid clumps of spheres.
//!
//! A discrete-element code that knows only spheres carries a tablet as a *clump*: overlapping
//! spheres that move as one body. How such a body tumbles is settled by the mass, the centroid
//! and the inertia of the **union** of its spheres (a region in two spheres counts once), and how
//! much it resembles the tablet by its distance from the solid it stands for.
//!
//! | module | what it holds |
//! |---|---|
//! | [`solids`] | exact solids: ball, flat tablet, biconvex tablet; volume, surface, inertia, signed distance |
//! | [`union`] | volume, surface, centroid and inertia of a union of spheres, to a stated tolerance |
//! | [`clump`] | [`ClumpShape`]: the spheres in the principal frame, with mass and principal moments |
//! | [`tablet`] | [`RingTablet`]: n spheres on a ring and one in the middle, and the ring for a volume |
//! | [`aspherical`] | slightly aspherical particles with the volume of a sphere |
//! | [`fidelity`] | how far a clump is from the solid it stands for |
//!
//! Lengths are in metres, volumes in cubic metres, densities in kg/m3.
//!
//! ```
//! use dem_shapes::{ClumpMass, RingTabletSpec};
//!
//! // A flat tablet of 8 mm diameter as ten equal spheres: nine on a ring, one in the middle.
//! let spec = RingTabletSpec {
//!     ring_spheres: 9,
//!     ring_radius: 2.5e-3,
//!     sphere_radius: 1.747e-3,
//!     middle_radius: Some(1.747e-3),
//! };
//! let clump = spec.build()?.clump(ClumpMass::Density(1030.0))?;
//! assert!((clump.volume - 145.464e-9).abs() < 0.001e-9); // 145.464 mm3
//! assert!((clump.mass - 0.1498e-3).abs() < 1e-7); // 0.15 g
//! # Ok::<(), dem_shapes::ShapeError>(())
//! ```

pub mod aspherical;
pub mod clump;
pub mod error;
pub mod fidelity;
mod principal;
mod quadrature;
pub mod solids;
pub mod sphere;
pub mod tablet;
pub mod union;

pub use aspherical::{AsphericalKind, aspherical_clump};
pub use clump::{ClumpMass, ClumpShape};
pub use error::ShapeError;
pub use fidelity::{Fidelity, FidelityOptions, Roughness};
pub use glam;
pub use solids::{Ball, BiconvexTablet, FlatTablet, Solid};
pub use sphere::Sphere;
pub use tablet::{RingTablet, RingTabletSpec};
pub use union::{DEFAULT_RELATIVE_TOLERANCE, UnionProperties, union_properties};

/// The examples of the README, run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
