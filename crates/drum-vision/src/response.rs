//! From a surface to the responses: two angles, centre of area, fill, S-shape.
//!
//! Definitions (the photographs'): `aor_lin` is the angle of the least-squares line of height over column, all
//! columns between the two ends of the free surface weighing alike; `aor_mid` the same from 1/4 to 3/4 of that range.
//! The EDEM variant counts columns whose first transition is the drum's wall, and takes 1/5 to 4/5.
//! The centre of area is measured from the drum's centre in percent of its inner radius, x towards the raised
//! side and y downwards.

use crate::config::{Definition, VisionConfig};
use crate::drum::circle_fit::Circle;
use crate::surface::{RaisedSide, Surface};

/// Points on the wall's arc.
const ARC_POINTS: usize = 2048;

/// The responses of one frame, without uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Responses {
    /// Angle of the line through the whole surface, degrees.
    pub aor_lin_deg: f64,
    /// Angle of the line through its middle, degrees.
    pub aor_mid_deg: f64,
    /// Centre of area towards the raised side, percent of the radius.
    pub cen_x_pct: f64,
    /// Centre of area downwards, percent of the radius.
    pub cen_y_pct: f64,
    /// Area of the bed over area of the drum's circle.
    pub fill: f64,
    /// Second derivative of the least-squares parabola times the radius; positive for a hollow surface.
    pub curvature: f64,
}

impl Responses {
    /// The S-shape: angle of the middle less that of the whole, degrees.
    #[must_use]
    pub fn s_shape_deg(&self) -> f64 {
        self.aor_mid_deg - self.aor_lin_deg
    }

    /// The values as an array, in the order of the fields.
    #[must_use]
    pub fn to_array(self) -> [f64; 6] {
        [
            self.aor_lin_deg,
            self.aor_mid_deg,
            self.cen_x_pct,
            self.cen_y_pct,
            self.fill,
            self.curvature,
        ]
    }
}

/// Measures a surface in a circle.
#[must_use]
pub fn responses(
    surface: &Surface,
    circle: Circle,
    hub_px: f64,
    raised: RaisedSide,
    config: &VisionConfig,
) -> Responses {
    let sign = raised.sign();
    let (top, middle) = match config.response.definition {
        Definition::Photograph => (surface.points.clone(), 0.25),
        Definition::Edem => (with_wall_columns(surface, circle.radius_px), 0.2),
    };
    let (first, last) = (top[0].0, top[top.len() - 1].0);
    let span = last - first;
    let lin = line_slope(&top, first, last);
    let mid = line_slope(&top, first + middle * span, last - middle * span);
    let outline = bed_outline(surface, circle.radius_px);
    let (mut area, mut mx, mut my) = area_and_moment(&outline);
    if !config.response.hub_in_area && hub_px > 0.0 {
        let (a, x, y) = hub_share(surface, circle.radius_px, hub_px);
        area -= a;
        mx -= x;
        my -= y;
    }
    let radius = circle.radius_px * config.measure.scale;
    Responses {
        aor_lin_deg: sign * lin.atan().to_degrees() + config.measure.bias_lin_deg,
        aor_mid_deg: sign * mid.atan().to_degrees() + config.measure.bias_mid_deg,
        cen_x_pct: 100.0 * sign * mx / area / radius + config.measure.offset_x_pct,
        cen_y_pct: -100.0 * my / area / radius + config.measure.offset_y_pct,
        fill: area / (std::f64::consts::PI * radius * radius),
        curvature: parabola_bend(&surface.points) * radius,
    }
}

/// Slope of the least-squares line of a polyline over x from `from` to `to`, by exact integrals.
#[must_use]
pub fn line_slope(points: &[(f64, f64)], from: f64, to: f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    // With t = (x - middle) / half, the slope is 3/2 of the integral of t y over -1..1, per half.
    1.5 * moment(points, middle, half, |t| t) / half
}

/// Second derivative of the least-squares parabola of a polyline over its whole range.
#[must_use]
pub fn parabola_bend(points: &[(f64, f64)]) -> f64 {
    let (a, b) = (points[0].0, points[points.len() - 1].0);
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    // Coefficient of the second Legendre polynomial: 5/2 of the integral of P2 y; P2'' = 3.
    7.5 * moment(points, middle, half, |t| 1.5 * t * t - 0.5) / (half * half)
}

/// Integral of `weight(t) y` over `t` from -1 to 1 along a polyline (Simpson's rule on each piece, exact
/// for weights up to the second degree).
fn moment(points: &[(f64, f64)], middle: f64, half: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let mut sum = 0.0;
    for pair in points.windows(2) {
        let ((px, py), (qx, qy)) = (pair[0], pair[1]);
        let (a, b) = (px.max(middle - half), qx.min(middle + half));
        if b <= a {
            continue;
        }
        let slope = (qy - py) / (qx - px);
        let at = |x: f64| weight((x - middle) / half) * (py + slope * (x - px));
        sum += (b - a) / 6.0 * (at(a) + 4.0 * at(0.5 * (a + b)) + at(b));
    }
    sum / half
}

/// The surface continued by the wall's columns that hold bed under the wall itself.
fn with_wall_columns(surface: &Surface, radius: f64) -> Vec<(f64, f64)> {
    let (first, last) = (surface.points[0], surface.points[surface.points.len() - 1]);
    let mut points = Vec::with_capacity(surface.points.len() + 400);
    let arc = |from: f64, to: f64| {
        (1..200).map(move |k| {
            let x = from + (to - from) * f64::from(k) / 200.0;
            (x, (radius * radius - x * x).max(0.0).sqrt())
        })
    };
    if first.1 > 0.0 {
        points.push((-radius, 0.0));
        points.extend(arc(-radius, first.0));
    }
    points.extend_from_slice(&surface.points);
    if last.1 > 0.0 {
        points.extend(arc(last.0, radius));
        points.push((radius, 0.0));
    }
    points.dedup_by(|b, a| b.0 <= a.0);
    points
}

/// The closed outline of the bed, y up: the surface from left to right and the wall below it back again.
#[must_use]
pub fn bed_outline(surface: &Surface, radius: f64) -> Vec<(f64, f64)> {
    let (first, last) = (surface.points[0], surface.points[surface.points.len() - 1]);
    let start = last.1.atan2(last.0);
    let mut end = first.1.atan2(first.0);
    // Clockwise (y up) from the right end through the bottom to the left end.
    while end >= start {
        end -= std::f64::consts::TAU;
    }
    let mut points = Vec::with_capacity(surface.points.len() + ARC_POINTS);
    points.extend(&surface.points);
    // Turned on by one step after the other: after all of them off by some 1e-13 of the radius.
    let (sin, cos) = ((end - start) / ARC_POINTS as f64).sin_cos();
    let (mut y, mut x) = start.sin_cos();
    points.extend((1..ARC_POINTS).map(|_| {
        (x, y) = (x * cos - y * sin, x * sin + y * cos);
        (radius * x, radius * y)
    }));
    points
}

/// Area and first moments of a polygon that runs clockwise (y up).
#[must_use]
pub fn area_and_moment(points: &[(f64, f64)]) -> (f64, f64, f64) {
    let (mut area, mut mx, mut my) = (0.0, 0.0, 0.0);
    for (k, p) in points.iter().enumerate() {
        let q = points[(k + 1) % points.len()];
        let cross = q.0 * p.1 - p.0 * q.1;
        area += 0.5 * cross;
        mx += (p.0 + q.0) * cross / 6.0;
        my += (p.1 + q.1) * cross / 6.0;
    }
    (area, mx, my)
}

/// Area and moments of the part of the bed behind the hub, by 256 x 256 cells.
fn hub_share(surface: &Surface, radius: f64, hub: f64) -> (f64, f64, f64) {
    const N: i32 = 256;
    let cell = 2.0 * hub / f64::from(N);
    let (first, last) = surface.range();
    let (mut area, mut mx, mut my) = (0.0, 0.0, 0.0);
    let outline_top = |x: f64| {
        if x < first {
            if surface.points[0].1 > 0.0 { radius } else { -radius }
        } else if x > last {
            if surface.points[surface.points.len() - 1].1 > 0.0 { radius } else { -radius }
        } else {
            surface.height(x)
        }
    };
    for i in 0..N {
        let x = -hub + (f64::from(i) + 0.5) * cell;
        let top = outline_top(x);
        for j in 0..N {
            let y = -hub + (f64::from(j) + 0.5) * cell;
            if x * x + y * y < hub * hub && y < top {
                area += 1.0;
                mx += x;
                my += y;
            }
        }
    }
    let a = cell * cell;
    (area * a, mx * a, my * a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chord(angle_deg: f64, distance: f64) -> Surface {
        let (s, c) = angle_deg.to_radians().sin_cos();
        let half = (1.0 - distance * distance).sqrt();
        let points = (0..=400)
            .map(|k| -half + 2.0 * half * f64::from(k) / 400.0)
            .map(|t| (100.0 * (t * c + distance * s), 100.0 * (t * s - distance * c)))
            .collect();
        Surface { points, folds: false }
    }

    const UNIT: Circle = Circle { x_px: 0.0, y_px: 0.0, radius_px: 100.0 };

    #[test]
    fn a_half_disc_has_its_closed_form() {
        let config = VisionConfig::default();
        let r = responses(&chord(30.0, 0.0), UNIT, 0.0, RaisedSide::Right, &config);
        let d = 400.0 / (3.0 * std::f64::consts::PI);
        // The arc's polygon of 2048 points: relative error (pi / 2048)^2 / 6 = 4e-7.
        assert!((r.cen_x_pct - d * 0.5).abs() < 1e-4, "{r:?}");
        assert!((r.cen_y_pct - d * 0.75f64.sqrt()).abs() < 1e-4);
        assert!((r.aor_lin_deg - 30.0).abs() < 1e-10 && (r.aor_mid_deg - 30.0).abs() < 1e-10);
        assert!((r.fill - 0.5).abs() < 1e-6 && r.curvature.abs() < 1e-9);
    }

    #[test]
    fn a_cubic_has_the_angles_of_least_squares() {
        // y = a t + c t^3: slope a + 3c/5 over the whole, a + 3c/20 over the middle half.
        let points = (0..=20_000)
            .map(|k| f64::from(k) / 10_000.0 - 1.0)
            .map(|t| (50.0 * t, 50.0 * (0.6 * t - 0.2 * t * t * t)))
            .collect();
        let s = Surface { points, folds: false };
        assert!((line_slope(&s.points, -50.0, 50.0) - 0.48).abs() < 1e-7);
        assert!((line_slope(&s.points, -25.0, 25.0) - 0.57).abs() < 1e-7);
    }

    #[test]
    fn wall_columns_lower_the_angle_of_the_edem_variant() {
        let mut config = VisionConfig::default();
        config.response.definition = Definition::Edem;
        let r = responses(&chord(35.0, 0.1), UNIT, 0.0, RaisedSide::Right, &config);
        // The wall falls off to the right of the shoulder: both fits lie below the chord's 35 deg.
        assert!(r.aor_lin_deg < 34.5, "{r:?}");
    }

    #[test]
    fn the_hub_cut_moves_the_centre_as_its_area_says() {
        let mut config = VisionConfig::default();
        config.response.hub_in_area = false;
        let r = responses(&chord(0.0, 0.0), UNIT, 20.0, RaisedSide::Right, &config);
        // Half discs of radius 1 and 0.2: (2/3)(1 - 0.008) / ((pi/2)(1 - 0.04)).
        let expected = 100.0 * (2.0 / 3.0 * 0.992) / (0.5 * std::f64::consts::PI * 0.96);
        // 256 cells over the hub: some 1e-4 of its own moment.
        assert!((r.cen_y_pct - expected).abs() < 0.01, "{r:?} {expected}");
    }
}
