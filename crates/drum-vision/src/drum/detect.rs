//! The drum's circle in a frame, by whichever way the configuration asks for.

use super::circle_fit::{Circle, CircleFit, fit_circle};
use super::hough::{Contrast, HoughCircle, find_circles};
use super::{rim, ring, ring_model};
use crate::config::{CircleSource, DrumConfig, Polarity};
use crate::error::{CircleCandidate, VisionError};
use crate::frame::Frame;

/// Where a circle came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum CircleOrigin {
    /// The inner edge of the red ring.
    Ring,
    /// The outline in grey.
    Outline,
    /// Another frame.
    Reference,
    /// Given by hand.
    Hand,
}

/// The drum in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Drum {
    /// The circle with its uncertainties.
    pub fit: CircleFit,
    /// Where it came from.
    pub origin: CircleOrigin,
}

/// The radius range searched in a frame, pixels.
#[must_use]
pub fn radius_range(config: &DrumConfig, width: usize, height: usize) -> (f64, f64) {
    let side = width.min(height) as f64;
    config.radius_range_px.map_or((0.2 * side, 0.55 * side), |[lo, hi]| (lo, hi))
}

/// Finds the drum; `reference` is the drum of the reference frame where one is configured.
///
/// # Errors
/// [`VisionError::NoCircle`], [`VisionError::SeveralCircles`], [`VisionError::CircleOutside`].
pub fn detect_drum(
    frame: &Frame,
    config: &DrumConfig,
    reference: Option<&Drum>,
) -> Result<Drum, VisionError> {
    match &config.source {
        CircleSource::Circle { x_px, y_px, radius_px } => {
            by_hand(frame, Circle { x_px: *x_px, y_px: *y_px, radius_px: *radius_px })
        }
        CircleSource::Reference { .. } if reference.is_some() => {
            let mut drum = *reference.expect("checked by the guard");
            inside_frame(frame, drum.fit.circle)?;
            drum.origin = CircleOrigin::Reference;
            Ok(drum)
        }
        CircleSource::Ring => by_ring(frame, config),
        CircleSource::Outline => by_outline(frame, config),
        CircleSource::Auto | CircleSource::Reference { .. } => match by_ring(frame, config) {
            Err(VisionError::NoCircle { .. }) => by_outline(frame, config),
            found => found,
        },
    }
}

fn by_hand(frame: &Frame, circle: Circle) -> Result<Drum, VisionError> {
    inside_frame(frame, circle)?;
    // A person places a circle to about a pixel.
    let fit = CircleFit {
        circle,
        center_sd_px: 0.5,
        radius_sd_px: 0.5,
        scatter_px: 0.0,
        support: 1.0,
        ellipticity: 0.0,
        long_axis_deg: 0.0,
        ellipticity_sd: 0.0,
    };
    Ok(Drum { fit, origin: CircleOrigin::Hand })
}

/// At least the centre and 60 % of the radius each way must lie within the frame.
fn inside_frame(frame: &Frame, c: Circle) -> Result<(), VisionError> {
    let fits =
        |x: f64, n: usize| x - 0.6 * c.radius_px >= -0.5 && x + 0.6 * c.radius_px <= n as f64;
    if fits(c.x_px, frame.width()) && fits(c.y_px, frame.height()) {
        return Ok(());
    }
    Err(VisionError::CircleOutside {
        x_px: c.x_px,
        y_px: c.y_px,
        radius_px: c.radius_px,
        width_px: frame.width() as u32,
        height_px: frame.height() as u32,
    })
}

/// Blocks of this many pixels bring the largest radius to some hundred pixels, enough for the transform.
fn bin_for(range: (f64, f64)) -> usize {
    ((range.1 / 110.0).round() as usize).max(1)
}

fn by_ring(frame: &Frame, config: &DrumConfig) -> Result<Drum, VisionError> {
    let (w, h) = (frame.width(), frame.height());
    let range = radius_range(config, w, h);
    let bin = bin_for(range);
    let median_px =
        config.red.median_px.unwrap_or(((range.1 * 10.0 / 550.0).round() as usize).max(3));
    let mask = ring::red_mask(frame, &config.red, median_px);
    let plane = ring::mask_plane(&mask, w, h, bin);
    // Inside the ring the mask is dark: its inner edge is the dark disc, its outer edge a light one.
    let found = find_circles(&plane, scaled(range, bin), Contrast::DarkDisc, 0.3, 5);
    let near = pick(&found, range, bin, config.min_support)?;
    let redness = frame.redness(frame.window());
    let mut fit =
        refine(near, range, config.min_support, |c, reach| rim::ring_points(&redness, c, reach))?;
    // The blur moves the half-way points of all rays alike: the mean profile tells by how much.
    let reach = (0.1 * fit.circle.radius_px).max(8.0);
    let profile = ring_model::mean_profile(&redness, fit.circle, reach);
    match ring_model::inner_edge(&profile) {
        Some((shift, _)) if shift.abs() < 3.0 => fit.circle.radius_px += shift,
        // Without the model the half-way points stand, known to a fraction of a pixel.
        _ => fit.radius_sd_px = fit.radius_sd_px.hypot(0.3),
    }
    Ok(Drum { fit, origin: CircleOrigin::Ring })
}

fn by_outline(frame: &Frame, config: &DrumConfig) -> Result<Drum, VisionError> {
    let range = radius_range(config, frame.width(), frame.height());
    let bin = bin_for(range);
    let grey = frame.grey(frame.window());
    let small = grey.binned(bin);
    let senses: &[Contrast] = match config.polarity {
        Polarity::Both => &[Contrast::DarkDisc, Contrast::LightDisc],
        Polarity::DarkOnLight => &[Contrast::DarkDisc],
        Polarity::LightOnDark => &[Contrast::LightDisc],
    };
    // The gradient of an outline may be anything from faint to the strongest of the frame.
    let mut best: Option<(f64, Contrast, Result<Circle, VisionError>)> = None;
    for &sense in senses {
        for edge_fraction in [0.25, 0.1, 0.04] {
            let found = find_circles(&small, scaled(range, bin), sense, edge_fraction, 5);
            let support = found.first().map_or(0.0, |c| c.support);
            if best.as_ref().is_none_or(|b| support > b.0 + 0.02) {
                best = Some((support, sense, pick(&found, range, bin, config.min_support)));
            }
        }
    }
    let Some((_, sense, near)) = best else {
        return Err(no_circle(range, 0.0, config.min_support));
    };
    let mut fit = refine(near?, range, config.min_support, |c, reach| {
        rim::outline_points(&grey, c, reach, sense)
    })?;
    // Whether the outline's line is the inner wall, its middle or its outer edge, the picture does not tell.
    fit.radius_sd_px = fit.radius_sd_px.hypot(1.0);
    Ok(Drum { fit, origin: CircleOrigin::Outline })
}

fn scaled(range: (f64, f64), bin: usize) -> (f64, f64) {
    (range.0 / bin as f64, range.1 / bin as f64)
}

fn no_circle(range: (f64, f64), best_support: f64, needed: f64) -> VisionError {
    VisionError::NoCircle { min_px: range.0, max_px: range.1, best_support, needed }
}

/// The one circle among the candidates, in pixels of the frame.
fn pick(
    found: &[HoughCircle],
    range: (f64, f64),
    bin: usize,
    min_support: f64,
) -> Result<Circle, VisionError> {
    let best = found.first().ok_or_else(|| no_circle(range, 0.0, min_support))?;
    if best.support < min_support {
        return Err(no_circle(range, best.support, min_support));
    }
    // Pixel k of the binned plane has its centre at k bin + (bin - 1) / 2.
    let full = |v: f64| v * bin as f64 + 0.5 * (bin as f64 - 1.0);
    let rivals: Vec<&HoughCircle> = found
        .iter()
        .filter(|c| {
            c.support >= min_support.max(0.8 * best.support)
                && (c.x - best.x).hypot(c.y - best.y) > 0.4 * best.radius.min(c.radius)
        })
        .collect();
    if !rivals.is_empty() {
        let candidates = std::iter::once(best)
            .chain(rivals)
            .map(|c| CircleCandidate {
                x_px: full(c.x),
                y_px: full(c.y),
                radius_px: c.radius * bin as f64,
                support: c.support,
            })
            .collect();
        return Err(VisionError::SeveralCircles { candidates });
    }
    Ok(Circle { x_px: full(best.x), y_px: full(best.y), radius_px: best.radius * bin as f64 })
}

/// Two rounds of rim points and robust fit, the second with a shorter reach.
fn refine(
    near: Circle,
    range: (f64, f64),
    min_support: f64,
    points: impl Fn(Circle, f64) -> Vec<(f64, f64)>,
) -> Result<CircleFit, VisionError> {
    let fail = |support| no_circle(range, support, min_support);
    let mut circle = near;
    let mut fit = None;
    for share in [0.08, 0.05] {
        let reach = (share * near.radius_px).max(5.0);
        let rim = points(circle, reach);
        let rays = rim::ray_count(circle.radius_px);
        let f = fit_circle(&rim, circle, rays).ok_or_else(|| fail(0.0))?;
        circle = f.circle;
        fit = Some(f);
    }
    let fit = fit.ok_or_else(|| fail(0.0))?;
    let drift = (fit.circle.x_px - near.x_px).hypot(fit.circle.y_px - near.y_px);
    if fit.support < 0.75 * min_support || drift > 0.2 * near.radius_px {
        return Err(fail(fit.support));
    }
    Ok(fit)
}
