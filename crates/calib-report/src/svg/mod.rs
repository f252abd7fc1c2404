//! The drawing layer: canvas, paints, text, scales and the frame with its axes.

pub(crate) mod canvas;
pub(crate) mod frame;
pub(crate) mod legend;
pub(crate) mod paint;
pub(crate) mod scale;
pub(crate) mod text;

pub(crate) use canvas::{Anchor, Canvas, FontSize};
pub(crate) use frame::{Axis, Frame};
pub(crate) use legend::{Key, LegendEntry};
pub(crate) use paint::{Dash, Marker, Paint, Stroke};
pub(crate) use scale::Spacing;

/// Width of every picture, user units (CSS pixels at scale one).
///
/// A phone of 390 px shows it at 0.87 of its size, so that 11 px text stays near 10 px.
pub(crate) const WIDTH: f64 = 420.0;
