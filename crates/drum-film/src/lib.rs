//! Films a rotating drum: sphere positions of any code, or an analytic bed, through a perspective camera, with every defect
//! that a photograph has and a truth that is known.
//!
//! - [`Film::bed_frame`] draws an analytic [`Bed`] that has stated responses, and says in [`Truth`] what a perfect reader measures.

pub use {glam, image};

pub mod bed;
pub mod camera;
pub mod canvas;
pub mod coverage;
pub mod effects;
pub mod error;
pub mod film;
pub mod frames;
pub mod light;
pub mod scene;
pub mod spheres;
mod stage;
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
pub use scene::{Drum, Hub, Ring, Scene};
pub use spheres::Sphere;
pub use studio::{BedFrame, SphereFrame, Studio};
pub use texture::Texture;
pub use truth::{RingCircle, Truth};
