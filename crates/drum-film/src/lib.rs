//! Films a rotating drum: sphere positions of any code, or an analytic bed, through a perspective camera, with every defect
//! that a photograph has and a truth that is known.
//!
//! - [`Film`] holds [`Camera`], [`Scene`], [`Light`] and the [`effects`]; [`Film::studio`] sets them up for a series.
//! - [`Studio::bed_frame`] draws an analytic [`Bed`] with stated responses and says in [`Truth`] what a perfect reader measures.
//! - [`Studio::sphere_frame`] and [`Studio::exposed_frame`] draw [`Sphere`]s; [`Frames`] groups rows of positions.
//! - [`parameters()`] declares what can vary, [`Film::set`] varies it.
//!
//! Lengths are in metres, drum radii or pixels as the names say; pixel centres lie at whole numbers; grey levels are
//! proportional to light. The same input gives the same bits for any number of threads.

pub use {glam, image, rig_schema};

pub mod bed;
pub mod camera;
pub mod canvas;
pub mod coverage;
pub mod effects;
pub mod error;
pub mod film;
pub mod frames;
#[cfg(feature = "gif")]
pub mod gif;
pub mod light;
pub mod parameters;
pub mod scene;
pub mod spheres;
mod stage;
pub mod strip;
pub mod studio;
pub mod texture;
pub mod truth;

pub use bed::{Bed, BedResponses, BedShape, RaisedSide};
pub use camera::{Camera, Projection, View};
pub use canvas::{Canvas, Color};
pub use coverage::Coverage;
pub use error::Error;
pub use film::Film;
pub use frames::{Frames, Snapshot};
pub use light::Light;
pub use parameters::parameters;
pub use scene::{Drum, Hub, Ring, Scene};
pub use spheres::Sphere;
pub use strip::{contact_sheet, strip};
pub use studio::{BedFrame, SphereFrame, Studio};
pub use texture::Texture;
pub use truth::{RingCircle, Truth};
