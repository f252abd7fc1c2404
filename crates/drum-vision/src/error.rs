//! What can go wrong between a file and its responses, with frame, stage and what to try.

use std::fmt;
use std::path::PathBuf;

/// The step of the chain in which a frame failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Stage {
    /// Reading and decoding the file.
    Decode,
    /// Checking the exposure.
    Exposure,
    /// Finding the drum's circle.
    Drum,
    /// Separating the bed from the background.
    Bed,
    /// Tracing the free surface.
    Surface,
    /// Computing the responses.
    Response,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Decode => "decode",
            Self::Exposure => "exposure",
            Self::Drum => "drum",
            Self::Bed => "bed",
            Self::Surface => "surface",
            Self::Response => "response",
        })
    }
}

/// A circle candidate quoted in an error: centre and radius in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CircleCandidate {
    /// Column of the centre, pixels from the left edge of the frame.
    pub x_px: f64,
    /// Row of the centre, pixels from the top edge of the frame.
    pub y_px: f64,
    /// Radius, pixels.
    pub radius_px: f64,
    /// Fraction of the circumference that shows an edge.
    pub support: f64,
}

/// Every way in which a frame, a side-car or a configuration can be refused.
#[derive(Debug, thiserror::Error)]
pub enum VisionError {
    /// The file could not be opened or read.
    #[error("cannot read {path}: {source}; check the name and the permissions", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A picture could not be written.
    #[error("cannot write {path}: {source}", path = path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the encoder said.
        source: image::ImageError,
    },
    /// The bytes are not an image of a known format.
    #[error("not an image of a known format; expected PNG, JPEG, TIFF or BMP")]
    NotAnImage,
    /// The image is broken, or in a form that the decoder does not know.
    #[error("the image cannot be decoded: {source}; write it again from the camera's file")]
    Decode {
        /// What the decoder said.
        source: image::ImageError,
    },
    /// The file ends before the image does.
    #[error("the file is truncated: {detail}; copy it again from its source")]
    Truncated {
        /// Where the end was noticed.
        detail: String,
    },
    /// The image has more pixels than the limit allows.
    #[error(
        "the image has {width_px} x {height_px} = {:.1} million pixels, above the limit of {:.1} million; \
         scale it down, or raise `decode.max_pixels`",
        f64::from(*width_px) * f64::from(*height_px) * 1e-6, *max_pixels as f64 * 1e-6
    )]
    TooLarge {
        /// Width in pixels.
        width_px: u32,
        /// Height in pixels.
        height_px: u32,
        /// The limit.
        max_pixels: u64,
    },
    /// The image is too small to hold a drum.
    #[error(
        "the image has {width_px} x {height_px} pixels; at least {min_px} x {min_px} are needed"
    )]
    TooSmall {
        /// Width in pixels.
        width_px: u32,
        /// Height in pixels.
        height_px: u32,
        /// The least side.
        min_px: u32,
    },
    /// The whole frame is black, or nearly so.
    #[error(
        "the frame is black (99th percentile {p99:.0} of 255); check shutter, aperture and lens cap"
    )]
    Black {
        /// 99th percentile of the grey values.
        p99: f64,
    },
    /// The frame is saturated: most pixels sit at full white.
    #[error(
        "the frame is saturated ({:.0} % of the pixels at {level} or above); expose shorter",
        100.0 * fraction
    )]
    Saturated {
        /// Fraction of pixels at or above `level`.
        fraction: f64,
        /// The grey level that counts as saturated.
        level: u8,
    },
    /// No circle was found in the radius range.
    #[error(
        "no circle with a radius of {min_px:.0} to {max_px:.0} px found (best candidate supports {:.0} % of its \
         circumference, {:.0} % needed); widen `drum.radius_range_px`, check the red thresholds, give a \
         reference frame, or give the circle by hand",
        100.0 * best_support, 100.0 * needed
    )]
    NoCircle {
        /// Least radius searched.
        min_px: f64,
        /// Largest radius searched.
        max_px: f64,
        /// Support of the best candidate, 0 when there was none.
        best_support: f64,
        /// Support needed.
        needed: f64,
    },
    /// Several circles of like strength were found at different places.
    #[error(
        "several circles found: {}; narrow `drum.radius_range_px`, crop the frame, or give the circle by hand",
        list_candidates(candidates)
    )]
    SeveralCircles {
        /// The candidates, strongest first.
        candidates: Vec<CircleCandidate>,
    },
    /// A circle given by hand or by a reference frame does not lie in the frame.
    #[error(
        "the circle ({x_px:.1}, {y_px:.1}) radius {radius_px:.1} px does not lie in the {width_px} x {height_px} frame"
    )]
    CircleOutside {
        /// Centre column.
        x_px: f64,
        /// Centre row.
        y_px: f64,
        /// Radius.
        radius_px: f64,
        /// Frame width.
        width_px: u32,
        /// Frame height.
        height_px: u32,
    },
    /// Bed and background cannot be told apart.
    #[error(
        "bed and background cannot be told apart (contrast {contrast:.1} grey levels over {noise:.1} of scatter): \
         the drum is empty or full, or powder hides the bed; try `bed.threshold`, or outline the bed with a \
         region side-car (`tumble roi IMAGE`)"
    )]
    NoContrast {
        /// Difference of the two mean grey values.
        contrast: f64,
        /// Scatter of the grey values inside the two parts.
        noise: f64,
    },
    /// The drum holds (nearly) no bed.
    #[error("the drum looks empty (fill {fill:.3}); check the frame or the fill")]
    EmptyDrum {
        /// Apparent fill.
        fill: f64,
    },
    /// The drum is (nearly) full: there is no free surface.
    #[error("the drum looks full (fill {fill:.3}): there is no free surface")]
    FullDrum {
        /// Apparent fill.
        fill: f64,
    },
    /// Too little of the free surface is visible.
    #[error(
        "only {:.0} % of the free surface is visible ({:.0} % needed); remove glare, or outline the bed with a \
         region side-car (`tumble roi IMAGE`)",
        100.0 * visible, 100.0 * needed
    )]
    SurfaceHidden {
        /// Fraction of the surface's length that shows an edge.
        visible: f64,
        /// Fraction needed.
        needed: f64,
    },
    /// The traced surface is too ragged to be one.
    #[error(
        "the traced surface is too ragged (scatter {scatter_px:.1} px, at most {limit_px:.1} px expected); filter \
         more (`bed.median_px`), or outline the bed with a region side-car (`tumble roi IMAGE`)"
    )]
    SurfaceRagged {
        /// Robust scatter about the smooth curve, pixels.
        scatter_px: f64,
        /// Limit, pixels.
        limit_px: f64,
    },
    /// Fewer columns than a line fit needs.
    #[error("the surface spans {columns} columns; at least {needed} are needed for the two fits")]
    TooFewColumns {
        /// Columns found.
        columns: usize,
        /// Columns needed.
        needed: usize,
    },
    /// The region of a side-car misses the drum.
    #[error("the polygon of the side-car encloses no pixel inside the drum; draw it on this image")]
    RegionEmpty,
    /// A side-car or configuration is not valid.
    #[error("{what} is not valid: {detail}")]
    Invalid {
        /// Which setting, by its path.
        what: &'static str,
        /// What was expected and what was found.
        detail: String,
    },
    /// A side-car or configuration cannot be parsed.
    #[error("{what} cannot be parsed: {detail}")]
    Parse {
        /// Which document.
        what: String,
        /// The parser's message, with line and key.
        detail: String,
    },
    /// A folder or list holds no frame at all.
    #[error("no frame found in {what}; expected PNG, JPEG, TIFF or BMP files")]
    NoFrames {
        /// Where was looked.
        what: String,
    },
    /// Another frame of the same series served as reference and failed.
    #[error("the reference frame {path} failed: {source}", path = path.display())]
    Reference {
        /// The reference frame.
        path: PathBuf,
        /// Its own error.
        source: Box<VisionError>,
    },
    /// A chain that should not panic did; the frame is kept out and the rest goes on.
    #[error("internal fault while measuring: {detail}; please report the frame")]
    Fault {
        /// The panic's message.
        detail: String,
    },
}

impl VisionError {
    /// The stage to which this error belongs.
    #[must_use]
    pub fn stage(&self) -> Stage {
        match self {
            Self::Read { .. }
            | Self::Write { .. }
            | Self::NotAnImage
            | Self::Decode { .. }
            | Self::Truncated { .. }
            | Self::TooLarge { .. }
            | Self::TooSmall { .. }
            | Self::NoFrames { .. } => Stage::Decode,
            Self::Black { .. } | Self::Saturated { .. } => Stage::Exposure,
            Self::NoCircle { .. }
            | Self::SeveralCircles { .. }
            | Self::CircleOutside { .. }
            | Self::Reference { .. } => Stage::Drum,
            Self::NoContrast { .. }
            | Self::EmptyDrum { .. }
            | Self::FullDrum { .. }
            | Self::RegionEmpty => Stage::Bed,
            Self::SurfaceHidden { .. }
            | Self::SurfaceRagged { .. }
            | Self::TooFewColumns { .. } => Stage::Surface,
            Self::Invalid { .. } | Self::Parse { .. } | Self::Fault { .. } => Stage::Response,
        }
    }
}

fn list_candidates(candidates: &[CircleCandidate]) -> String {
    let mut text = String::new();
    for (k, c) in candidates.iter().enumerate() {
        if k > 0 {
            text.push_str(", ");
        }
        text.push_str(&format!("({:.0}, {:.0}) radius {:.0} px", c.x_px, c.y_px, c.radius_px));
    }
    text
}
