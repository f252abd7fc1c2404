//! Pictures and self-contained HTML pages of a calibration.
//!
//! Plain data goes in, a [`String`] comes out: every picture is a small struct with named fields
//! that implements [`Picture`] and draws itself as SVG, a [`page::Page`] gathers figures, tables and
//! notes into one HTML file without scripts or external resources, and
//! [`calibration::CalibrationReport`] is the whole report of one calibrated case. The crate opens no
//! file, fits nothing and knows nothing of drums.
//!
//! ```
//! use calib_report::Picture;
//! use calib_report::pictures::{FrictionAtSpeed, FrictionSpeed, PrintedRange};
//!
//! let picture = FrictionSpeed {
//!     title: "Friction between beads".into(),
//!     estimates: vec![FrictionAtSpeed {
//!         omega_rpm: 17.0,
//!         value: Some(0.31),
//!         lo: Some(0.27),
//!         hi: None, // the data bound it from below only
//!     }],
//!     printed: vec![PrintedRange { omega_rpm: 17.0, lo: 0.25, hi: 0.50 }],
//!     ..Default::default()
//! };
//! let svg = picture.svg();
//! assert!(svg.starts_with("<svg") && svg.contains("printed range"));
//! ```
//!
//! # What every picture promises
//!
//! - It never panics: empty, non-finite or all-equal data give a picture that says "no data", or an
//!   axis of sensible width.
//! - The same input gives the same bytes; coordinates have at most two decimals.
//! - Colours are those of Okabe and Ito (*Color Universal Design*, 2008), told apart by marker, dash
//!   or label as well. A picture carries its light colours as attributes, so that it can be saved as
//!   a file of its own, and class names, by which the page gives it dark colours.
//! - `<title>` and `<desc>` tell a screen reader what is drawn.
//!
//! # Why an SVG layer of its own
//!
//! The central picture fills the set of frictions for which several responses lie within their
//! measured bands *at once*. The general crate that was considered, kuva 0.6, fills the levels of
//! one field at a time, writes colours that a page cannot exchange for its dark scheme, and gives
//! the picture no title and description of its own. With contours, bands and the document layer
//! done here, what remains (axes, ticks, lines, markers) is short enough to own.

pub mod calibration;
pub mod contour;
pub mod number;
pub mod page;
pub mod pictures;
mod svg;

/// A picture that draws itself as a stand-alone SVG document.
pub trait Picture {
    /// The SVG document, ready for a file of its own or to be put into a page.
    fn svg(&self) -> String;
}
