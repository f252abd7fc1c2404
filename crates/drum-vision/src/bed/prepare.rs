//! Grey conversion, median and Wiener filter and contrast stretch of the drum's interior.

use crate::config::VisionConfig;
use crate::drum::circle_fit::Circle;
use crate::error::VisionError;
use crate::filter::median::median_u8;
use crate::filter::stretch::{histogram, stretch_limits, stretched};
use crate::filter::wiener::{Border, wiener};
use crate::frame::{Frame, Plane, Window};

/// The square around the drum, filtered and stretched, with the drum's circle in its coordinates.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Filtered grey levels, stretched to 0..255.
    pub plane: Plane,
    /// The same square before filters and stretch, grey levels of the frame.
    pub raw: Plane,
    /// Column and row of its first sample in the frame.
    pub origin_px: (f64, f64),
    /// The drum's circle in the plane's coordinates.
    pub circle: Circle,
    /// Radius of the hub's mask, pixels.
    pub hub_px: f64,
    /// Grey levels of the frame that became 0 and 255.
    pub limits: (u8, u8),
    /// Fraction of the drum's pixels at the saturated level in the frame.
    pub saturated: f64,
    /// Pixels that a reflex hides: saturated spots with a margin. Empty when there is none.
    pub hidden: Vec<bool>,
    /// Histogram of the stretched samples inside the drum and outside the hub.
    pub histogram: [u64; 256],
}

/// Side of the default filter window: the odd number next to radius/100, at least 3.
#[must_use]
pub fn default_window(radius_px: f64) -> usize {
    (2 * ((radius_px / 100.0 - 1.0) / 2.0).round().max(1.0) as usize) + 1
}

/// Prepares the interior of a circle.
///
/// # Errors
/// [`VisionError::Saturated`], [`VisionError::NoContrast`] when the interior is of one grey.
pub fn prepare(
    frame: &Frame,
    circle: Circle,
    config: &VisionConfig,
) -> Result<Prepared, VisionError> {
    let window = Window::around(
        circle.x_px,
        circle.y_px,
        1.02 * circle.radius_px + 4.0,
        frame.width(),
        frame.height(),
    );
    let grey = frame.grey(window);
    let origin_px = (window.x0 as f64, window.y0 as f64);
    let local =
        Circle { x_px: circle.x_px - origin_px.0, y_px: circle.y_px - origin_px.1, ..circle };
    let hub_px = config.bed.hub * circle.radius_px;
    let raw = grey.to_u8();
    let (w, h) = (grey.width, grey.height);
    // A little inside of the rim, so that ring and outline do not enter the statistics.
    let spans = disc_spans(local, 0.97, hub_px, w, h);
    let count: usize = spans.iter().map(|s| s.2 - s.1).sum();
    let level = config.exposure.saturated_level;
    let over = over_spans(&raw, w, &spans).filter(|&v| v >= level).count();
    let saturated = over as f64 / count.max(1) as f64;
    if saturated > config.exposure.saturated_fraction {
        return Err(VisionError::Saturated { fraction: saturated, level });
    }
    let hidden = hidden_by_glare(&raw, w, h, saturated, local.radius_px, config);
    let window_px = default_window(circle.radius_px);
    let median_px = config.bed.median_px.unwrap_or(window_px);
    let filtered = median_u8(&raw, w, h, median_px, median_px);
    let mut plane =
        Plane { width: w, height: h, data: filtered.iter().map(|&v| f32::from(v)).collect() };
    let wiener_px = config.bed.wiener_px.unwrap_or(window_px);
    if wiener_px > 1 {
        plane = wiener(&plane, wiener_px, None, Border::Reflect);
    }
    let counts = histogram(over_spans(&plane.to_u8(), w, &spans));
    let limits = stretch_limits(&counts, config.bed.saturate)
        .ok_or(VisionError::NoContrast { contrast: 0.0, noise: 0.0 })?;
    for v in &mut plane.data {
        *v = stretched(*v, limits);
    }
    let histogram = histogram(over_spans(&plane.to_u8(), w, &spans));
    Ok(Prepared {
        plane,
        raw: grey,
        origin_px,
        circle: local,
        hub_px,
        limits,
        saturated,
        hidden,
        histogram,
    })
}

impl Prepared {
    /// Unfiltered grey at a point on the scale of the stretched plane, not clamped.
    #[must_use]
    #[inline]
    pub fn grey_at(&self, x: f64, y: f64) -> f64 {
        let (low, high) = (f64::from(self.limits.0), f64::from(self.limits.1));
        (self.raw.sample(x, y) - low) * (255.0 / (high - low))
    }

    /// Whether a reflex hides the pixel nearest to a point.
    #[must_use]
    #[inline]
    pub fn is_hidden(&self, x: f64, y: f64) -> bool {
        if self.hidden.is_empty() || x < 0.0 || y < 0.0 {
            return false;
        }
        let (i, j) = ((x + 0.5) as usize, (y + 0.5) as usize);
        i < self.plane.width && j < self.plane.height && self.hidden[j * self.plane.width + i]
    }
}

/// Saturated spots, each grown to the ellipse of its moments with 1.7 times its axes and 2 % of the radius.
///
/// When more than a tenth of the drum is that bright, white is a tone of the scene and no spot of glare.
fn hidden_by_glare(
    raw: &[u8],
    w: usize,
    h: usize,
    saturated: f64,
    radius_px: f64,
    config: &VisionConfig,
) -> Vec<bool> {
    if saturated == 0.0 || saturated > 0.1 {
        return Vec::new();
    }
    let level = config.exposure.saturated_level.saturating_sub(4);
    let mut hidden = vec![false; raw.len()];
    let mut seen = vec![false; raw.len()];
    let mut stack = Vec::new();
    let mut any = false;
    for start in 0..raw.len() {
        if raw[start] < level || seen[start] {
            continue;
        }
        // Moments of the connected spot.
        let (mut n, mut sx, mut sy, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        seen[start] = true;
        stack.push(start);
        while let Some(k) = stack.pop() {
            let (x, y) = (k % w, k / w);
            let (fx, fy) = (x as f64, y as f64);
            n += 1.0;
            sx += fx;
            sy += fy;
            xx += fx * fx;
            xy += fx * fy;
            yy += fy * fy;
            for (ok, j) in [
                (x > 0, k.wrapping_sub(1)),
                (x + 1 < w, k + 1),
                (y > 0, k.wrapping_sub(w)),
                (y + 1 < h, k + w),
            ] {
                if ok && !seen[j] && raw[j] >= level {
                    seen[j] = true;
                    stack.push(j);
                }
            }
        }
        // A few hot pixels, or sparkles of a grain, are the median filter's business.
        if n < 4.0f64.max(5e-4 * radius_px * radius_px) {
            continue;
        }
        any = true;
        let (cx, cy) = (sx / n, sy / n);
        let spread = [xx / n - cx * cx, xy / n - cx * cy, yy / n - cy * cy];
        hide_ellipse(&mut hidden, w, h, (cx, cy), spread, 0.02 * radius_px + 1.0);
    }
    if any { hidden } else { Vec::new() }
}

/// Marks the ellipse with 3.4 standard deviations (1.7 half axes of an even ellipse) and a margin.
fn hide_ellipse(
    hidden: &mut [bool],
    w: usize,
    h: usize,
    centre: (f64, f64),
    spread: [f64; 3],
    margin: f64,
) {
    let [xx, xy, yy] = spread;
    let (mean, half) = (0.5 * (xx + yy), (0.25 * (xx - yy).powi(2) + xy * xy).sqrt());
    let (a, b) = (
        3.4 * (mean + half).max(0.0).sqrt() + margin,
        3.4 * (mean - half).max(0.0).sqrt() + margin,
    );
    let (sin, cos) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
    let bound = |v: f64, n: usize| v.clamp(0.0, n as f64) as usize;
    for y in bound(centre.1 - a, h)..bound(centre.1 + a + 1.0, h) {
        for x in bound(centre.0 - a, w)..bound(centre.0 + a + 1.0, w) {
            let (dx, dy) = (x as f64 - centre.0, y as f64 - centre.1);
            let (p, q) = ((dx * cos + dy * sin) / a, (dy * cos - dx * sin) / b);
            if p * p + q * q < 1.0 {
                hidden[y * w + x] = true;
            }
        }
    }
}

/// Row, first and end column of the pixels inside `share` of the radius and outside of the hub.
fn disc_spans(
    c: Circle,
    share: f64,
    hub_px: f64,
    w: usize,
    h: usize,
) -> Vec<(usize, usize, usize)> {
    let r = share * c.radius_px;
    let column = |x: f64| x.clamp(0.0, w as f64) as usize;
    let mut spans = Vec::new();
    for y in 0..h {
        let dy = y as f64 - c.y_px;
        if dy.abs() >= r {
            continue;
        }
        let half = (r * r - dy * dy).sqrt();
        let (lo, hi) = (column((c.x_px - half).ceil()), column((c.x_px + half).ceil()));
        if dy.abs() < hub_px {
            let inner = (hub_px * hub_px - dy * dy).sqrt();
            let (a, b) = (column((c.x_px - inner).ceil()), column((c.x_px + inner).ceil()));
            spans.push((y, lo, a.clamp(lo, hi)));
            spans.push((y, b.clamp(lo, hi), hi));
        } else {
            spans.push((y, lo, hi.max(lo)));
        }
    }
    spans
}

fn over_spans<'a>(
    data: &'a [u8],
    w: usize,
    spans: &'a [(usize, usize, usize)],
) -> impl Iterator<Item = u8> + 'a {
    spans.iter().flat_map(move |&(y, a, b)| data[y * w + a..y * w + b].iter().copied())
}
