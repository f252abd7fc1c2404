//! From a photograph or rendered frame of a rotating drum to angle of repose and centre of area.
//!
//! The chain, one module a step, each usable alone:
//!
//! 1. [`decode`]: PNG, JPEG, TIFF, BMP to a [`Frame`], bounded in pixels and memory;
//! 2. [`drum`]: red ring, outline, reference frame or hand, by a circular Hough transform and a robust fit between pixels;
//! 3. [`bed`] and [`filter`]: grey, median, Wiener, stretch; the free surface by level crossing between pixels, by the
//!    thesis's column transitions, or within a person's region ([`RegionSidecar`], [`roi_page`]);
//! 4. [`response`]: `aor_lin`, `aor_mid`, centre of area, fill, shape; [`uncertainty`]: a budget for each;
//! 5. [`series`]: many frames in parallel, means, scatter, outliers; [`overlay`]: pictures of what was found.
//!
//! ```no_run
//! use drum_vision::{VisionConfig, decode, measure_series};
//! let paths = decode::list_frames("frames".as_ref())?;
//! let report = measure_series(&paths, &VisionConfig::default(), None, |p| {
//!     let _ = (p.index + 1, p.total); // advance a bar, write an overlay
//! })?;
//! if let Some(r) = report.responses {
//!     let mean_sd = r.aor_lin_deg.sd.unwrap_or(0.0) / r.aor_lin_deg.n_eff.sqrt();
//!     assert!(r.aor_lin_deg.mean > 0.0 && mean_sd < 1.0);
//! }
//! # Ok::<(), drum_vision::VisionError>(())
//! ```

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
