//! Robust circle through edge points, and the check for an ellipse.
//!
//! The geometric fit minimises the biweight (Tukey, c = 4.685) of the radial residuals by Gauss-Newton steps;
//! the scale is 1.4826 times their median modulus. The first rounds minimise the sum of moduli instead, which
//! brings a start a few pixels off to the majority of the points.

use crate::linear::solve_normal;

/// A circle with its uncertainty, in pixels of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Circle {
    /// Centre column.
    pub x_px: f64,
    /// Centre row.
    pub y_px: f64,
    /// Radius.
    pub radius_px: f64,
}

/// A fitted circle: value, standard uncertainties and deviation from roundness.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CircleFit {
    /// The circle.
    pub circle: Circle,
    /// Standard uncertainty of either coordinate of the centre, pixels.
    pub center_sd_px: f64,
    /// Standard uncertainty of the radius, pixels.
    pub radius_sd_px: f64,
    /// Robust scatter of the edge points about the circle, pixels.
    pub scatter_px: f64,
    /// Fraction of the circumference with an accepted edge point.
    pub support: f64,
    /// Difference of the half axes of the best ellipse over their mean: `(a - b) / r`.
    pub ellipticity: f64,
    /// Direction of the long axis, degrees from the x axis towards the y axis (downwards), 0 to 180.
    pub long_axis_deg: f64,
    /// Standard uncertainty of the ellipticity.
    pub ellipticity_sd: f64,
}

impl CircleFit {
    /// The tilt of the camera that makes a circle this elliptic, `acos(b / a)`, degrees.
    #[must_use]
    pub fn tilt_deg(&self) -> f64 {
        ((1.0 - 0.5 * self.ellipticity) / (1.0 + 0.5 * self.ellipticity)).acos().to_degrees()
    }
}

/// Rounds that minimise the sum of moduli.
const LEAST_MODULI: usize = 10;

/// Fits a circle to points, starting from `start`; `rays` is the number of directions that were searched.
///
/// `None` with fewer than 8 points, or when they do not determine a circle.
#[must_use]
pub fn fit_circle(points: &[(f64, f64)], start: Circle, rays: usize) -> Option<CircleFit> {
    if points.len() < 8 {
        return None;
    }
    let mut c = start;
    let mut residual = vec![0.0; points.len()];
    let mut weight = vec![1.0; points.len()];
    let mut scale = f64::INFINITY;
    for round in 0..25 {
        for (r, p) in residual.iter_mut().zip(points) {
            *r = (p.0 - c.x_px).hypot(p.1 - c.y_px) - c.radius_px;
        }
        scale = (1.4826 * median_modulus(&residual)).max(0.02);
        let cut = 4.685 * scale;
        let mut normal = [[0.0; 3]; 3];
        let mut right = [0.0; 3];
        for ((p, &r), w) in points.iter().zip(&residual).zip(weight.iter_mut()) {
            let t = r / cut;
            *w = if round < LEAST_MODULI {
                1.0 / r.abs().max(0.05)
            } else if t.abs() < 1.0 {
                (1.0 - t * t).powi(2)
            } else {
                0.0
            };
            let d = (p.0 - c.x_px).hypot(p.1 - c.y_px).max(1e-9);
            let row = [(p.0 - c.x_px) / d, (p.1 - c.y_px) / d, 1.0];
            for i in 0..3 {
                right[i] += *w * row[i] * r;
                for j in 0..3 {
                    normal[i][j] += *w * row[i] * row[j];
                }
            }
        }
        let step = solve_normal(&normal, &right)?;
        c.x_px += step[0];
        c.y_px += step[1];
        c.radius_px += step[2];
        if !(c.radius_px.is_finite() && c.radius_px > 0.0) {
            return None;
        }
        if round > LEAST_MODULI && step.iter().all(|s| s.abs() < 1e-6) {
            break;
        }
    }
    let harmonic = second_harmonic(points, &weight, c)?;
    let used: Vec<(f64, f64)> =
        points.iter().zip(&weight).filter(|(_, w)| **w > 0.0).map(|(p, _)| *p).collect();
    let n = used.len() as f64;
    // Neighbouring rays share pixels and faults of the rim: a quarter of them counts as independent.
    let independent = (n / 4.0).max(3.0);
    let sd = scale / independent.sqrt();
    let cover = covariance_factor(&used, c)?;
    Some(CircleFit {
        circle: c,
        center_sd_px: sd * (0.5 * (cover[0] + cover[1])).sqrt(),
        radius_sd_px: sd * cover[2].sqrt(),
        scatter_px: scale,
        support: n / rays.max(1) as f64,
        ellipticity: 2.0 * harmonic.0 / c.radius_px,
        long_axis_deg: harmonic.1,
        ellipticity_sd: 2.0 * sd * std::f64::consts::SQRT_2 / c.radius_px,
    })
}

/// Diagonal of `n (A^T A)^-1`: how the scatter of one point spreads to centre and radius.
fn covariance_factor(points: &[(f64, f64)], c: Circle) -> Option<[f64; 3]> {
    let mut normal = [[0.0; 3]; 3];
    for p in points {
        let d = (p.0 - c.x_px).hypot(p.1 - c.y_px).max(1e-9);
        let row = [(p.0 - c.x_px) / d, (p.1 - c.y_px) / d, 1.0];
        for i in 0..3 {
            for j in 0..3 {
                normal[i][j] += row[i] * row[j] / points.len() as f64;
            }
        }
    }
    let mut diagonal = [0.0; 3];
    for (k, d) in diagonal.iter_mut().enumerate() {
        let mut unit = [0.0; 3];
        unit[k] = 1.0;
        *d = solve_normal(&normal, &unit)?[k].max(0.0);
    }
    Some(diagonal)
}

/// Amplitude and direction of `cos 2(theta - axis)` in the radius, fitted along with the circle.
fn second_harmonic(points: &[(f64, f64)], weight: &[f64], c: Circle) -> Option<(f64, f64)> {
    let mut normal = [[0.0; 5]; 5];
    let mut right = [0.0; 5];
    for (p, w) in points.iter().zip(weight).filter(|(_, w)| **w > 0.0) {
        let (dx, dy) = (p.0 - c.x_px, p.1 - c.y_px);
        let d = dx.hypot(dy).max(1e-9);
        let (cos, sin) = (dx / d, dy / d);
        let row = [cos, sin, 1.0, cos * cos - sin * sin, 2.0 * cos * sin];
        for i in 0..5 {
            right[i] += w * row[i] * (d - c.radius_px);
            for j in 0..5 {
                normal[i][j] += w * row[i] * row[j];
            }
        }
    }
    let s = solve_normal(&normal, &right)?;
    let axis = 0.5 * s[4].atan2(s[3]).to_degrees();
    Some((s[3].hypot(s[4]), if axis < 0.0 { axis + 180.0 } else { axis }))
}

/// Median of the moduli.
#[must_use]
pub(crate) fn median_modulus(values: &[f64]) -> f64 {
    let mut moduli: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    crate::statistics::median_in_place(&mut moduli).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_of_wild_points_does_not_move_the_circle() {
        let points: Vec<(f64, f64)> = (0..300)
            .map(|k| {
                let t = f64::from(k) * 0.02094;
                let r = if k % 3 == 0 { 130.0 + f64::from(k % 7) } else { 100.0 };
                (50.3 + r * t.cos(), 60.7 + r * t.sin())
            })
            .collect();
        let start = Circle { x_px: 51.5, y_px: 60.0, radius_px: 101.0 };
        let fit = fit_circle(&points, start, 300).unwrap();
        // Wild points get weight zero, so only rounding is left.
        assert!((fit.circle.x_px - 50.3).abs() < 1e-3, "{fit:?}");
        assert!((fit.circle.radius_px - 100.0).abs() < 1e-3, "{fit:?}");
    }

    #[test]
    fn an_ellipse_is_told_from_a_circle() {
        let points: Vec<(f64, f64)> = (0..360)
            .map(|k| f64::from(k).to_radians())
            .map(|t| (100.0 * t.cos(), 97.0 * t.sin()))
            .collect();
        let start = Circle { x_px: 0.0, y_px: 0.0, radius_px: 98.0 };
        let fit = fit_circle(&points, start, 360).unwrap();
        // (a - b) / mean = 3 / 98.5; the harmonic of the radius equals it to second order.
        assert!((fit.ellipticity - 3.0 / 98.5).abs() < 3e-4, "{fit:?}");
        assert!((fit.tilt_deg() - 0.97f64.acos().to_degrees()).abs() < 0.2);
        assert!(fit.long_axis_deg < 1.0 || fit.long_axis_deg > 179.0);
    }
}
