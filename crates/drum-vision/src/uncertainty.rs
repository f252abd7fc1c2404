//! Standard uncertainty of every response, from what the frame itself shows.
//!
//! Components, each carried to the responses by measuring a perturbed surface or circle again:
//! - **edge**: scatter of the edge points about the smooth curve (sub-pixel noise and roughness of particle size). Points
//!   are correlated over a length taken from the residuals' autocorrelation (at least the particle's diameter where
//!   known), so `n = span / length` of them count. Each Legendre shape `P_k` of the surface, k = 0 to 4, then has the
//!   standard deviation `scatter sqrt((2 k + 1) / n)`;
//! - **circle**: standard uncertainty of centre and radius from the fit;
//! - **threshold**: how far the curve moves when the level moves by a tenth of the contrast, for each of the same shapes;
//! - **bridged**: pieces without an edge. Beyond the last edge at either end the curve goes on straight, and may bend by
//!   a curvature of `1/R`; across an inner gap the spline may be off by a tenth of such an arc;
//! - **model**: smooth faults that nothing of this shows (uneven grains at the edge, light), a floor for each shape
//!   in pixels, and one for centre and radius of the circle;
//! - **tilt**: an elliptic rim turns lines by up to half its ellipticity.
//!
//! The components are added in squares with the factors of [`Weights`], which were fitted once on synthetic
//! frames of known silhouette, so that value ± 2 u covers the truth in about 95 % of frames.

use crate::bed::edge::Curve;
use crate::config::VisionConfig;
use crate::drum::circle_fit::{Circle, CircleFit};
use crate::response::{Responses, responses};
use crate::surface::{RaisedSide, Surface};

/// Number of Legendre shapes.
const SHAPES: usize = 5;

/// Factors on the components, and floors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// On the scatter of the edge.
    pub edge: f64,
    /// On centre and radius of the circle.
    pub circle: f64,
    /// On the threshold's effect.
    pub threshold: f64,
    /// On the curvature of bridged pieces.
    pub bridged: f64,
    /// Standard deviation of every shape that no component sees, pixels.
    pub floor_px: f64,
    /// The same for centre and radius of the circle, pixels.
    pub circle_floor_px: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self { edge: 1.0, circle: 1.0, threshold: 1.0, bridged: 1.0, floor_px: 0.03, circle_floor_px: 0.03 }
    }
}

/// Standard uncertainties of the responses, in the order and units of [`Responses`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget {
    /// Share of the edge's scatter.
    pub edge: [f64; 6],
    /// Share of the circle.
    pub circle: [f64; 6],
    /// Share of the threshold.
    pub threshold: [f64; 6],
    /// Share of what no component sees, for the surface.
    pub model: [f64; 6],
    /// The same for the circle.
    pub rim: [f64; 6],
    /// Share of bridged pieces.
    pub bridged: [f64; 6],
    /// Share of a tilted camera.
    pub tilt: [f64; 6],
}

impl Budget {
    /// Every component with its name.
    #[must_use]
    pub fn components(&self) -> [(&'static str, [f64; 6]); 7] {
        [
            ("edge", self.edge),
            ("circle", self.circle),
            ("threshold", self.threshold),
            ("model", self.model),
            ("rim", self.rim),
            ("bridged", self.bridged),
            ("tilt", self.tilt),
        ]
    }

    /// The shares added in squares.
    #[must_use]
    pub fn total(&self) -> [f64; 6] {
        std::array::from_fn(|k| {
            self.components().iter()
                .map(|(_, c)| c[k] * c[k])
                .sum::<f64>()
                .sqrt()
        })
    }
}

/// Estimates the budget of a measured frame.
#[must_use]
pub fn budget(
    curve: &Curve,
    local: Circle,
    fit: &CircleFit,
    hub_px: f64,
    raised: RaisedSide,
    nominal: &Responses,
    config: &VisionConfig,
    weights: &Weights,
) -> Budget {
    let again = |circle: Circle, change: &dyn Fn(f64) -> f64| -> [f64; 6] {
        let base = nominal.to_array();
        Surface::from_curve(curve, circle, change).map_or([0.0; 6], |s| {
            let r = responses(&s, circle, hub_px, raised, config).to_array();
            std::array::from_fn(|k| r[k] - base[k])
        })
    };
    let (from, to) = (curve.u_px[0], curve.u_px[curve.u_px.len() - 1]);
    let (middle, half) = (0.5 * (from + to), (0.5 * (to - from)).max(1.0));
    // Effect of half a pixel of each shape; the responses are close to linear in it.
    let unit: Vec<[f64; 6]> = (0..SHAPES)
        .map(|k| {
            again(local, &|u| 0.5 * legendre(k, ((u - middle) / half).clamp(-1.0, 1.0)))
                .map(|d| d / 0.5)
        })
        .collect();
    let add = |sd: &[f64; SHAPES]| -> [f64; 6] {
        std::array::from_fn(|r| {
            (0..SHAPES).map(|k| (unit[k][r] * sd[k]).powi(2)).sum::<f64>().sqrt()
        })
    };
    let scatter = curve.smoothed.scatter;
    let length = correlation_length(curve, local.radius_px, config);
    let n = (2.0 * half * curve.visible / length).max(4.0);
    let edge: [f64; SHAPES] =
        std::array::from_fn(|k| weights.edge * scatter * ((2 * k + 1) as f64 / n).sqrt());
    let threshold = level_shapes(curve, middle, half).map(|s| weights.threshold * s);
    // Shape k of unknown smooth faults: they fade for finer shapes.
    let floor: [f64; SHAPES] =
        std::array::from_fn(|k| weights.floor_px * (1.0 / (1 + k) as f64).sqrt());
    let circle_part = |center: f64, radius: f64| -> [f64; 6] {
        let moved = |dx: f64, dy: f64, dr: f64| {
            again(
                Circle {
                    x_px: local.x_px + dx,
                    y_px: local.y_px + dy,
                    radius_px: local.radius_px + dr,
                },
                &|_| 0.0,
            )
        };
        let (a, b, c) = (moved(0.5, 0.0, 0.0), moved(0.0, 0.5, 0.0), moved(0.0, 0.0, 0.5));
        std::array::from_fn(|k| {
            ((a[k] * center / 0.5).powi(2)
                + (b[k] * center / 0.5).powi(2)
                + (c[k] * radius / 0.5).powi(2))
            .sqrt()
        })
    };
    let circle = circle_part(weights.circle * fit.center_sd_px, weights.circle * fit.radius_sd_px);
    let floor_circle = circle_part(weights.circle_floor_px, weights.circle_floor_px);
    let bridged = bridges(curve, half).iter().fold([0.0; 6], |sum, &(a, b, bend)| {
        // Where surface and wall meet at a small angle the end moves much one way and little the other.
        let effects = [1.0, -1.0].map(|sign| {
            let bend = sign * weights.bridged * bend / local.radius_px;
            again(local, &move |u: f64| {
                if a == b {
                    // Beyond an end: a parabola from it.
                    let d = if a < middle { a - u } else { u - a };
                    0.5 * bend * d.max(0.0).powi(2)
                } else if u > a && u < b {
                    0.5 * bend * (u - a) * (b - u)
                } else {
                    0.0
                }
            })
        });
        let effect: [f64; 6] =
            std::array::from_fn(|k| effects[0][k].abs().max(effects[1][k].abs()));
        std::array::from_fn(|k| f64::hypot(sum[k], effect[k]))
    });
    Budget {
        edge: add(&edge),
        circle,
        threshold: add(&threshold),
        model: add(&floor),
        rim: floor_circle,
        bridged,
        tilt: tilt_share(fit, nominal),
    }
}

/// Pieces without an edge: `(from, to, curvature in 1/R)`; `from == to` stands for what lies beyond an end.
fn bridges(curve: &Curve, half: f64) -> Vec<(f64, f64, f64)> {
    let held: Vec<f64> = curve
        .u_px
        .iter()
        .zip(&curve.smoothed.weights)
        .filter(|(_, w)| **w > 0.05)
        .map(|(u, _)| *u)
        .collect();
    let (Some(&first), Some(&last)) = (held.first(), held.last()) else {
        return Vec::new();
    };
    let mut pieces = vec![(first, first, 1.0), (last, last, 1.0)];
    pieces.extend(
        held.windows(2).filter(|p| p[1] - p[0] > 0.05 * half).map(|p| (p[0], p[1], 0.1)),
    );
    pieces
}

/// A rim that is elliptic beyond its noise turns lines by up to half the ellipticity (radians).
fn tilt_share(fit: &CircleFit, nominal: &Responses) -> [f64; 6] {
    let e = fit.ellipticity;
    if e < 3.0 * fit.ellipticity_sd || e < 0.003 {
        return [0.0; 6];
    }
    let turn = (0.5 * e).to_degrees() / 2.0;
    let size = nominal.cen_x_pct.hypot(nominal.cen_y_pct);
    [turn, turn, 0.25 * e * size, 0.25 * e * size, 0.25 * e * nominal.fill, 0.0]
}

/// Length over which residuals are alike, pixels: spacing times the integrated autocorrelation.
fn correlation_length(curve: &Curve, radius_px: f64, config: &VisionConfig) -> f64 {
    let held: Vec<f64> = curve
        .smoothed
        .residuals
        .iter()
        .zip(&curve.smoothed.weights)
        .filter(|(_, w)| **w > 0.0)
        .map(|(r, _)| *r)
        .collect();
    let n = curve.u_px.len().max(2) as f64;
    let spacing = (curve.u_px[curve.u_px.len() - 1] - curve.u_px[0]) / (n - 1.0);
    let rho = crate::statistics::autocorrelation(&held, held.len() / 4);
    let mut sum = 1.0;
    for r in rho.iter().skip(1) {
        if *r <= 0.0 {
            break;
        }
        sum += 2.0 * r;
    }
    let mut length = spacing * sum;
    if let (Some(d), Some(r)) = (config.rig.particle_diameter_m, config.rig.drum_radius_m) {
        length = length.max(d / r * radius_px);
    }
    length.max(1.0)
}

/// Magnitude of each shape in the curve's shift for a tenth of the contrast.
fn level_shapes(curve: &Curve, middle: f64, half: f64) -> [f64; SHAPES] {
    let mut shapes = [0.0; SHAPES];
    let mut n = 0.0;
    for ((u, s), w) in curve.u_px.iter().zip(&curve.level_shift_px).zip(&curve.smoothed.weights) {
        if s.is_nan() || *w <= 0.0 {
            continue;
        }
        n += 1.0;
        let t = ((u - middle) / half).clamp(-1.0, 1.0);
        for (k, shape) in shapes.iter_mut().enumerate() {
            *shape += (2 * k + 1) as f64 * legendre(k, t) * s;
        }
    }
    shapes.map(|s| if n > 0.0 { (s / n).abs() } else { 0.0 })
}

/// Legendre polynomial of degree 0 to 4.
fn legendre(k: usize, t: f64) -> f64 {
    let s = t * t;
    match k {
        0 => 1.0,
        1 => t,
        2 => 1.5 * s - 0.5,
        3 => t * (2.5 * s - 1.5),
        _ => (35.0 * s * s - 30.0 * s + 3.0) / 8.0,
    }
}
