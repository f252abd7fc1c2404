//! What stands between a clean picture and a photograph: one effect a file, each off by default.
//!
//! In the order of the light: [`Powder`] and [`Glare`] on the front plate, [`Defocus`] and [`Vignetting`] of the lens,
//! [`Exposure`] of the shutter, [`Noise`] of the sensor.

pub mod defocus;
pub mod exposure;
pub mod glare;
pub mod noise;
pub mod powder;
pub mod vignetting;

pub use defocus::Defocus;
pub use exposure::Exposure;
pub use glare::{Glare, Spot};
pub use noise::Noise;
pub use powder::Powder;
pub use vignetting::Vignetting;
