//! The thesis's surface: transitions of a thresholded picture, column by column.

use super::boundary::{Boundary, TurnedAxes};
use super::edge::{Curve, check};
use super::prepare::Prepared;
use crate::config::{Threshold, VisionConfig};
use crate::error::VisionError;
use crate::filter::median::median_binary;
use crate::filter::threshold::otsu;
use crate::spline::smooth;

/// Row of the surface in every `step`-th column of a binary picture.
///
/// Going down a column, its transitions are counted. Of two the first is the surface; of four the third, of six the
/// fifth, for what lies above is an artefact (thesis, section 4.3). Columns with any other number are
/// left out. The row is that of the last pixel above the transition plus one half.
///
/// ```
/// use drum_vision::bed::columns::column_transitions;
/// // One column of eight pixels: an artefact of one pixel, then the bed from row 4 to row 6.
/// let column = [false, true, false, false, true, true, true, false];
/// assert_eq!(column_transitions(&column, 1, 8, 1), vec![(0.0, 3.5)]);
/// ```
#[must_use]
pub fn column_transitions(
    mask: &[bool],
    width: usize,
    height: usize,
    step: usize,
) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    let mut rows = Vec::new();
    for x in (0..width).step_by(step.max(1)) {
        rows.clear();
        rows.extend((1..height).filter(|&y| mask[y * width + x] != mask[(y - 1) * width + x]));
        let surface = match rows.len() {
            2 => rows[0],
            4 => rows[2],
            6 => rows[4],
            _ => continue,
        };
        points.push((x as f64, surface as f64 - 0.5));
    }
    points
}

/// The bed as a binary picture: level, drum and hub masks, majority filter.
#[must_use]
pub fn bed_mask(prepared: &Prepared, boundary: &Boundary, config: &VisionConfig) -> Vec<bool> {
    let plane = &prepared.plane;
    let c = prepared.circle;
    let level = match config.bed.threshold {
        Threshold::Fixed { level } => Some(level),
        Threshold::Otsu => otsu(&prepared.histogram).map(|v| f64::from(v) + 0.5),
        Threshold::LocalContrast => None,
    };
    let bright = boundary.levels[1][0] > boundary.levels[0][0];
    let bias = config.measure.threshold_bias;
    let gap = boundary.levels[1][0] - boundary.levels[0][0];
    let inner = 0.985 * c.radius_px;
    let (cos, sin) = boundary.axes.turn;
    let mut mask = vec![false; plane.data.len()];
    for y in 0..plane.height {
        for x in 0..plane.width {
            let (dx, dy) = (x as f64 - c.x_px, y as f64 - c.y_px);
            let r = dx.hypot(dy);
            if r > inner || r < prepared.hub_px {
                continue;
            }
            let threshold = level.map_or_else(
                || {
                    let (u, v) = (dx * cos - dy * sin, dx * sin + dy * cos);
                    let (a, b) = boundary.expected(u, v);
                    a + (0.5 + bias) * (b - a)
                },
                |l| l + bias * gap,
            );
            let g = f64::from(plane.at(x, y));
            mask[y * plane.width + x] = if bright { g > threshold } else { g < threshold };
        }
    }
    let side = ((10.0 * c.radius_px / 450.0).round() as usize).max(3);
    let clean = median_binary(&mask, plane.width, plane.height, side);
    clean.iter().zip(&mask).map(|(&a, &b)| a && b).collect()
}

/// Traces the surface by column transitions and smooths it with a spline.
///
/// # Errors
/// [`VisionError::TooFewColumns`], [`VisionError::SurfaceHidden`], [`VisionError::SurfaceRagged`].
pub fn trace_columns(
    prepared: &Prepared,
    boundary: &Boundary,
    config: &VisionConfig,
) -> Result<Curve, VisionError> {
    let mask = bed_mask(prepared, boundary, config);
    curve_of_mask(&mask, prepared, config, config.surface.column_step_px)
}

/// The curve through the column transitions of a mask; wall columns and those at the hub are dropped.
pub(crate) fn curve_of_mask(
    mask: &[bool],
    prepared: &Prepared,
    config: &VisionConfig,
    step: usize,
) -> Result<Curve, VisionError> {
    let c = prepared.circle;
    let (w, h) = (prepared.plane.width, prepared.plane.height);
    let axes = TurnedAxes::new((c.x_px, c.y_px), 0.0);
    let wall = 0.985 * c.radius_px - 2.0;
    let (mut u, mut v) = (Vec::new(), Vec::new());
    let mut scanned = 0usize;
    for (x, y) in column_transitions(mask, w, h, step) {
        let (dx, dy) = (x - c.x_px, y - c.y_px);
        let r = dx.hypot(dy);
        // A first transition on the rim is the wall, one on the hub is the hub's edge.
        if r > wall || r < prepared.hub_px + 2.0 {
            continue;
        }
        scanned += 1;
        u.push(dx);
        v.push(dy);
    }
    let few = VisionError::TooFewColumns { columns: scanned, needed: 16 };
    if u.len() < 16 {
        return Err(few);
    }
    let span = u[u.len() - 1] - u[0];
    let pieces =
        (config.surface.spline_pieces as f64 * span / (2.0 * c.radius_px)).round() as usize;
    let smoothed = smooth(&u, &v, pieces.max(4)).ok_or(few)?;
    let hub = if prepared.hub_px > 0.0 { 2.0 * (prepared.hub_px + 2.0) } else { 0.0 };
    let crosses_hub = smoothed.spline.value(0.0).abs() < prepared.hub_px;
    let expected = ((span - if crosses_hub { hub } else { 0.0 }) / step as f64).max(1.0);
    let accepted = smoothed.weights.iter().filter(|w| **w > 0.1).count() as f64;
    let visible = (accepted / expected).min(1.0);
    check(visible, &smoothed, c.radius_px, config)?;
    // A mask tells the surface to half a pixel either way.
    let level_shift_px = vec![0.25; u.len()];
    Ok(Curve {
        axes,
        u_px: u,
        smoothed,
        visible,
        glare: 0.0,
        lit: Vec::new(),
        level_shift_px,
        level_scatter: 0.1,
        contrast: 0.0,
        edge_width_px: 1.0,
    })
}
