//! The straight line that best parts the drum's interior into two greys: where to look for the surface.
//!
//! Otsu's criterion with a half-plane in place of a level: over all directions and offsets the line with the
//! largest variance between the mean greys of its two sides. It needs no threshold, and a glare spot or a
//! lamp's gradient shifts it little, because a spot is no half-plane.

use super::prepare::Prepared;
use crate::config::Tone;
use crate::error::VisionError;

/// A line across the drum, bed below it.
///
/// With the drum's centre as origin and `v = x sin(angle) + y cos(angle)` (y downwards), the bed is `v > offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSplit {
    /// Angle of the line, degrees, positive when it rises to the right.
    pub angle_deg: f64,
    /// Distance of the line below the centre, pixels.
    pub offset_px: f64,
    /// Mean grey above the line.
    pub above: f64,
    /// Mean grey below the line: the bed's.
    pub below: f64,
    /// Pooled standard deviation of grey on the two sides.
    pub scatter: f64,
}

/// Steps of the offset over the diameter.
const BINS: usize = 160;

/// Finds the line, or refuses a drum whose two parts differ by less than `min_contrast` times their scatter.
///
/// # Errors
/// [`VisionError::NoContrast`].
pub fn split_line(
    prepared: &Prepared,
    tone: Tone,
    min_contrast: f64,
) -> Result<LineSplit, VisionError> {
    let bin = (prepared.circle.radius_px / 70.0).round().max(1.0) as usize;
    let small = prepared.plane.binned(bin);
    let k = bin as f64;
    let centre = |v: f64| (v - 0.5 * (k - 1.0)) / k;
    let (cx, cy) = (centre(prepared.circle.x_px), centre(prepared.circle.y_px));
    let radius = 0.95 * prepared.circle.radius_px / k;
    let hub = prepared.hub_px / k + 1.0;
    let mut samples = Vec::new();
    for y in 0..small.height {
        for x in 0..small.width {
            let (dx, dy) = (x as f64 - cx, y as f64 - cy);
            let r = dx.hypot(dy);
            if r < radius && (r > hub || prepared.hub_px == 0.0) {
                samples.push((dx, dy, f64::from(small.at(x, y))));
            }
        }
    }
    let total = samples.len() as f64;
    let sum: f64 = samples.iter().map(|s| s.2).sum();
    let squares: f64 = samples.iter().map(|s| s.2 * s.2).sum();
    let mut best: Option<(f64, LineSplit)> = None;
    let try_angle = |angle_deg: f64, best: &mut Option<(f64, LineSplit)>| {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let mut bins = [(0.0f64, 0.0f64); BINS];
        for &(dx, dy, g) in &samples {
            let v = dx * sin + dy * cos;
            let b = (((v / radius + 1.0) * 0.5 * BINS as f64) as usize).min(BINS - 1);
            bins[b].0 += 1.0;
            bins[b].1 += g;
        }
        let (mut n, mut s) = (0.0, 0.0);
        for (b, bin) in bins.iter().enumerate().take(BINS - 1) {
            n += bin.0;
            s += bin.1;
            let rest = total - n;
            if n < 0.01 * total || rest < 0.01 * total {
                continue;
            }
            let (above, below) = (s / n, (sum - s) / rest);
            let fits = match tone {
                Tone::Auto => true,
                Tone::Bright => below > above,
                Tone::Dark => below < above,
            };
            let between = n * rest / (total * total) * (above - below).powi(2);
            if fits && best.as_ref().is_none_or(|(v, _)| between > *v) {
                let variance = squares / total - (sum / total).powi(2) - between;
                *best = Some((
                    between,
                    LineSplit {
                        angle_deg,
                        offset_px: ((b + 1) as f64 / BINS as f64 * 2.0 - 1.0) * radius * k,
                        above,
                        below,
                        scatter: variance.max(0.0).sqrt(),
                    },
                ));
            }
        }
    };
    for step in -20..=20 {
        try_angle(f64::from(step) * 4.0, &mut best);
    }
    if let Some(coarse) = best.map(|(_, line)| line.angle_deg) {
        for step in -3..=3 {
            try_angle(coarse + f64::from(step), &mut best);
        }
    }
    let (_, line) = best.ok_or(VisionError::NoContrast { contrast: 0.0, noise: 0.0 })?;
    let contrast = (line.below - line.above).abs();
    if contrast < min_contrast * line.scatter {
        return Err(VisionError::NoContrast { contrast, noise: line.scatter });
    }
    Ok(line)
}
