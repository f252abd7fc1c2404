//! Films a rotating drum: sphere positions of any code, or an analytic bed, through a perspective camera, with every defect
//! that a photograph has and a truth that is known.
//!
//! - [`Film::bed_frame`] draws an analytic [`Bed`] that has stated responses, and says in [`Truth`] what a perfect reader measures.

pub use {glam, image};

pub mod bed;
pub mod camera;
pub mod canvas;
pub mod effects;
pub mod error;
pub mod film;
pub mod light;
pub mod scene;
mod stage;
pub mod texture;
pub mod truth;

pub use bed::{Bed, BedResponses, BedShape, RaisedSide};
pub use camera::{Camera, Projection, View};
pub use canvas::{Canvas, Color};
pub use error::Error;
pub use film::{BedFrame, Film};
pub use light::Light;
pub use scene::{Drum, Hub, Ring, Scene};
pub use texture::Texture;
pub use truth::{RingCircle, Truth};
