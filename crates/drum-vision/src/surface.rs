//! The free surface from wall to wall in the frame's pixels.

use crate::bed::edge::Curve;
use crate::config::Rotation;
use crate::drum::circle_fit::Circle;
use crate::error::VisionError;

/// The side on which the drum raises its bed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum RaisedSide {
    /// The left: the drum turns clockwise in the picture.
    Left,
    /// The right: the drum turns counter-clockwise in the picture.
    Right,
}

impl RaisedSide {
    /// +1 to the right, -1 to the left.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }
}

/// A free surface: heights over columns between its two ends on the drum's wall.
///
/// Coordinates are relative to the drum's centre, pixels, x to the right and **y up**.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Points from the left end to the right end, x strictly increasing.
    pub points: Vec<(f64, f64)>,
    /// Whether the traced curve was not a function of the column, so that its upper branch was kept.
    pub folds: bool,
}

impl Surface {
    /// Follows a curve to the circle at both ends; `tilt` is added to `v` as a function of `u` (for perturbations).
    ///
    /// # Errors
    /// [`VisionError::TooFewColumns`] when the curve does not reach across at least 16 pixels.
    pub fn from_curve(
        curve: &Curve,
        circle: Circle,
        change: impl Fn(f64) -> f64,
    ) -> Result<Self, VisionError> {
        let (cos, sin) = curve.axes.turn;
        let shift = (circle.x_px - curve.axes.center.0, circle.y_px - curve.axes.center.1);
        // Relative to the circle's centre, y up.
        let place = |u: f64| {
            let v = curve.smoothed.spline.value(u) + change(u);
            (u * cos + v * sin - shift.0, -(-u * sin + v * cos - shift.1))
        };
        let outside = |u: f64| {
            let (x, y) = place(u);
            x * x + y * y >= circle.radius_px * circle.radius_px
        };
        let (from, to) = curve.smoothed.spline.range();
        let middle = inner_point(from, to, &outside).ok_or(few(0))?;
        let limit = 1.5 * circle.radius_px;
        let left = wall_end(middle, -limit, &outside);
        let right = wall_end(middle, limit, &outside);
        let n = (2.0 * (right - left)).ceil().clamp(16.0, 8000.0) as usize;
        let raw: Vec<(f64, f64)> =
            (0..=n).map(|k| place(left + (right - left) * k as f64 / n as f64)).collect();
        let (points, folds) = upper_branch(&raw);
        if points.len() < 16 || points[points.len() - 1].0 - points[0].0 < 16.0 {
            return Err(few(points.len()));
        }
        Ok(Self { points, folds })
    }

    /// Columns of the two ends.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        (self.points[0].0, self.points[self.points.len() - 1].0)
    }

    /// Height at a column, linear between points, the end's value beyond.
    #[must_use]
    pub fn height(&self, x: f64) -> f64 {
        polyline_height(&self.points, x)
    }

    /// The raised side: as given, or the one towards which the line through the surface rises.
    #[must_use]
    pub fn raised(&self, rotation: Rotation) -> RaisedSide {
        match rotation {
            Rotation::Clockwise => RaisedSide::Left,
            Rotation::CounterClockwise => RaisedSide::Right,
            Rotation::Auto => {
                let (a, b) = self.range();
                if crate::response::line_slope(&self.points, a, b) >= 0.0 {
                    RaisedSide::Right
                } else {
                    RaisedSide::Left
                }
            }
        }
    }
}

fn few(columns: usize) -> VisionError {
    VisionError::TooFewColumns { columns, needed: 16 }
}

/// Height of a polyline with increasing x, the end's value beyond its ends.
pub(crate) fn polyline_height(points: &[(f64, f64)], x: f64) -> f64 {
    let k = points.partition_point(|p| p.0 < x);
    if k == 0 {
        return points[0].1;
    }
    if k == points.len() {
        return points[k - 1].1;
    }
    let ((ax, ay), (bx, by)) = (points[k - 1], points[k]);
    ay + (by - ay) * (x - ax) / (bx - ax)
}

/// Some point of the curve inside of the circle, the one nearest to the middle of its range.
fn inner_point(from: f64, to: f64, outside: &impl Fn(f64) -> bool) -> Option<f64> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    (0..=64)
        .flat_map(|k| [1.0, -1.0].map(|s| middle + s * half * f64::from(k) / 64.0))
        .find(|&u| !outside(u))
}

/// Marches from a point inside to the circle and closes in by bisection.
fn wall_end(inside: f64, limit: f64, outside: &impl Fn(f64) -> bool) -> f64 {
    let step = (limit - inside).signum() * limit.abs() / 400.0;
    let (mut a, mut b) = (inside, inside);
    while (b - inside).abs() < (limit - inside).abs() {
        b += step;
        if outside(b) {
            break;
        }
        a = b;
    }
    for _ in 0..50 {
        let m = 0.5 * (a + b);
        if outside(m) { b = m } else { a = m }
    }
    a
}

/// Keeps strictly increasing columns; where the curve folds back, the higher branch.
fn upper_branch(raw: &[(f64, f64)]) -> (Vec<(f64, f64)>, bool) {
    let folds = raw.windows(2).any(|p| p[1].0 <= p[0].0);
    if !folds {
        return (raw.to_vec(), false);
    }
    let mut sorted = raw.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (sorted[0].0, sorted[sorted.len() - 1].0);
    let n = ((last - first).ceil() as usize).max(1);
    let mut top = vec![None::<f64>; n + 1];
    for p in raw.windows(2) {
        let ((ax, ay), (bx, by)) = (p[0], p[1]);
        let (lo, hi) = (ax.min(bx), ax.max(bx));
        let k0 = ((lo - first).ceil().max(0.0)) as usize;
        let k1 = (((hi - first).floor()).max(0.0) as usize).min(n);
        for (k, t) in top.iter_mut().enumerate().take(k1 + 1).skip(k0) {
            let x = first + k as f64;
            let y = if hi > lo { ay + (by - ay) * (x - ax) / (bx - ax) } else { ay.max(by) };
            *t = Some(t.map_or(y, |v: f64| v.max(y)));
        }
    }
    let points =
        top.into_iter().enumerate().filter_map(|(k, y)| y.map(|y| (first + k as f64, y))).collect();
    (points, true)
}
