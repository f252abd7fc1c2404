//! The straight line that best parts the drum's interior into two greys: where to look for the surface.
//!
//! Otsu's criterion with a half-plane in place of a level: over all directions and offsets the line with the
//! largest variance between the mean greys of its two sides. It needs no threshold, and a glare spot or a
//! lamp's gradient shifts it little, because a spot is no half-plane.

use super::prepare::Prepared;
use crate::config::Tone;
use crate::error::VisionError;
use crate::frame::Plane;

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

/// Grey levels are counted in this many parts.
const PARTS: f64 = 4096.0;
/// One sample in a sum of samples, whose low bits are greys.
const ONE: u64 = 1 << 40;

/// A sample: one, and its grey in [`PARTS`]; so that one addition of whole numbers, in whatever order, counts both.
fn sample(grey: f32) -> u64 {
    ONE + (f64::from(grey) * PARTS + 0.5) as u64
}

/// Grey of a sample, or of a sum of them.
fn grey(sample: u64) -> f64 {
    (sample % ONE) as f64 / PARTS
}

/// The drum's interior: rows of samples that follow one another.
struct Disc {
    /// Place of the first sample about the centre, x and y, and where its row begins and ends among the samples.
    rows: Vec<(f64, f64, std::ops::Range<usize>)>,
    samples: Vec<u64>,
}

impl Disc {
    /// What lies within `radius` of a point and outside of `hub`.
    fn of(plane: &Plane, (cx, cy): (f64, f64), radius: f64, hub: f64) -> Self {
        let (mut rows, mut samples) = (Vec::new(), Vec::new());
        for y in 0..plane.height {
            let dy = y as f64 - cy;
            let mut begun: Option<(f64, usize)> = None;
            for (x, &g) in plane.row(y).iter().enumerate() {
                let dx = x as f64 - cx;
                let r = (dx * dx + dy * dy).sqrt();
                if r < radius && r > hub {
                    begun.get_or_insert((dx, samples.len()));
                    samples.push(sample(g));
                } else if let Some((dx, first)) = begun.take() {
                    rows.push((dx, dy, first..samples.len()));
                }
            }
            if let Some((dx, first)) = begun {
                rows.push((dx, dy, first..samples.len()));
            }
        }
        Self { rows, samples }
    }

    /// Number and sum of greys in strips parallel to a line, the uppermost first.
    fn across(&self, angle_deg: f64, radius: f64) -> [(f64, f64); BINS] {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        // Strips are counted in 2^-32, so that going on by a pixel is one addition.
        let scale = 0.5 * BINS as f64 / radius * 2f64.powi(32);
        let along = (sin * scale) as i64;
        // Neighbours mostly share a strip: by turns in one of four, no sum waits for the one before it.
        let mut strips = [[0u64; BINS]; 4];
        for (dx, dy, range) in &self.rows {
            let mut at = ((dx * sin + dy * cos + radius) * scale) as i64;
            for four in self.samples[range.clone()].chunks(4) {
                for (strips, &sample) in strips.iter_mut().zip(four) {
                    strips[((at >> 32).max(0) as usize).min(BINS - 1)] += sample;
                    at += along;
                }
            }
        }
        let [a, b, c, d] = &strips;
        std::array::from_fn(|k| {
            let sum = a[k] + b[k] + c[k] + d[k];
            ((sum / ONE) as f64, grey(sum))
        })
    }
}

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
    let disc = Disc::of(&small, (cx, cy), radius, if prepared.hub_px == 0.0 { -1.0 } else { hub });
    let total = disc.samples.len() as f64;
    let (mut sum, mut squares) = (0.0, 0.0);
    for g in disc.samples.iter().map(|&s| grey(s)) {
        sum += g;
        squares += g * g;
    }
    let mut best: Option<(f64, LineSplit)> = None;
    let try_angle = |angle_deg: f64, best: &mut Option<(f64, LineSplit)>| {
        let bins = disc.across(angle_deg, radius);
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
