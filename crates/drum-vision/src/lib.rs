//! From a photograph or rendered frame of a rotating drum to angle of repose and centre of area.
#![doc = ""]
pub mod bed;
pub mod config;
pub mod decode;
pub mod drum;
pub mod error;
pub mod filter;
pub mod frame;
mod linear;
pub mod measure;
pub mod overlay;
pub mod parameters;
pub mod regime;
pub mod response;
pub mod roi;
pub mod series;
pub mod sidecar;
pub mod spline;
pub mod statistics;
pub mod surface;
pub mod uncertainty;

pub use image;

pub use config::VisionConfig;
pub use error::{Stage, VisionError};
pub use frame::Frame;
pub use measure::{Context, FrameMeasurement, Measured, Warning, measure_frame};
pub use roi::roi_page;
pub use series::{Progress, SeriesReport, measure_series};
pub use sidecar::RegionSidecar;
