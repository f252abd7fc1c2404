//! The analytic bed: a surface curve in the drum's cross-section, with responses in closed form.
//!
//! In drum radii, x towards the raised side and y up, the surface between its two ends on the wall,
//! `x = x_m + w t` with `t` in -1..1, is a sum of Legendre polynomials,
//!
//! ```text
//! y(t) = b0 + b1 P1(t) + b2 P2(t) + b3 P3(t) + b5 P5(t),      b5 = -b3 / 5
//! ```
//!
//! The columns of a picture sample x uniformly, so that a least-squares line is an integral over t:
//! - over the whole surface its slope is `b1 / w`, because the polynomials are orthogonal;
//! - over the middle half `|t| <= 1/2` its slope is `(b1 - 9/8 b3 + 99/128 b5) / w`
//!   (the slope of `t^n`, n odd, over `|t| <= a` is `3 a^(n-1) / (n+2)`), and P2 adds nothing by symmetry.
//!
//! The stated angles therefore fix `b1/w` and `b3/w`. The share of P5 makes a sigmoid whose ends level off; with
//! P3 alone the ends would fall twice as fast for the same S-shape. The least-squares parabola has the second
//! derivative `3 b2 / w^2`, the stated curvature. The chord between the ends has the slope `(b1 + b3 + b5) / w`, and its
//! distance from the axis follows from the fill; area and first moments of segment and rest are closed forms.

use std::f64::consts::PI;

use glam::DVec2;

use crate::error::{Error, check};

/// Share of the fifth polynomial against the third.
const P5_SHARE: f64 = 0.2;
/// What one unit of `-b3` adds to the slope of the middle half.
const MID_GAIN: f64 = 9.0 / 8.0 + P5_SHARE * 99.0 / 128.0;
/// The steepest surface accepted: tan 85 deg.
const MAX_SLOPE: f64 = 11.43;
/// Falling steeper than this, the thesis's column rule takes a surface for the wall.
const MIN_SLOPE: f64 = -0.5;

/// The side of the picture on which the bed is raised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum RaisedSide {
    /// The drum turns counter-clockwise in the picture.
    #[default]
    Right,
    /// The drum turns clockwise in the picture.
    Left,
}

impl RaisedSide {
    /// +1 to the right, -1 to the left.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Right => 1.0,
            Self::Left => -1.0,
        }
    }
}

/// A bed as one asks for it: by the responses that it shall have.
///
/// ```
/// use drum_film::Bed;
/// let shape = Bed { fill: 0.5, aor_lin_deg: 30.0, s_shape_deg: 0.0, ..Bed::default() }.shape()?;
/// // A half disc has its centre of area 4/(3 pi) R = 42.44 % of R from the axis.
/// let r = shape.responses();
/// assert!((r.cen_x_pct - 42.441 * 0.5).abs() < 1e-3);
/// assert!((r.cen_y_pct - 42.441 * 0.75_f64.sqrt()).abs() < 1e-3);
/// # Ok::<(), drum_film::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Bed {
    /// Share of the drum's cross-section that the bed covers.
    pub fill: f64,
    /// Angle of the least-squares line over the whole surface, degrees.
    pub aor_lin_deg: f64,
    /// Angle of the middle half less that of the whole, degrees.
    pub s_shape_deg: f64,
    /// Second derivative of the least-squares parabola times the drum radius; positive: hollow surface.
    pub curvature: f64,
    /// On which side it is raised.
    pub raised: RaisedSide,
    /// Whether the bed reaches to the rear wall, so that perspective shows its free surface; otherwise only the
    /// silhouette on the front plate is drawn.
    pub extruded: bool,
}

impl Default for Bed {
    fn default() -> Self {
        Self {
            fill: 0.35,
            aor_lin_deg: 30.0,
            s_shape_deg: 2.0,
            curvature: 0.0,
            raised: RaisedSide::Right,
            extruded: false,
        }
    }
}

/// The thesis's four responses and the apparent fill, of a bed in the plane of the front plate.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BedResponses {
    /// Angle of the least-squares line over the whole surface, degrees.
    pub aor_lin_deg: f64,
    /// Angle of the least-squares line over its second and third quarter, degrees.
    pub aor_mid_deg: f64,
    /// Centre of area from the axis towards the raised side, percent of the radius.
    pub cen_x_pct: f64,
    /// Centre of area from the axis downwards, percent of the radius.
    pub cen_y_pct: f64,
    /// Area of the bed over area of the drum's circle.
    pub fill: f64,
}

/// A solved bed in drum radii, raised to the right: what [`Bed::shape`] returns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BedShape {
    /// Middle of the surface's range in x.
    x_mid: f64,
    /// Half its range in x.
    half_width: f64,
    /// Legendre coefficients 0, 1, 2, 3, 5.
    b: [f64; 5],
    /// Distance of the chord from the axis, positive above it.
    chord: f64,
    /// Unit normal of the chord, upwards.
    normal: DVec2,
    raised: RaisedSide,
    extruded: bool,
}

impl Bed {
    /// Solves the surface for the stated fill, angles and curvature.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for numbers outside their range, [`Error::SurfaceLeavesDrum`] and
    /// [`Error::SurfaceTooSteep`] where no such surface exists.
    pub fn shape(&self) -> Result<BedShape, Error> {
        check("bed.fill", self.fill, "", (0.005, 0.995), "a share from 0.005 to 0.995")?;
        check("bed.aor_lin_deg", self.aor_lin_deg, "deg", (-10.0, 80.0), "-10 to 80")?;
        check("bed.s_shape_deg", self.s_shape_deg, "deg", (-30.0, 30.0), "-30 to 30")?;
        check("bed.curvature", self.curvature, "", (-5.0, 5.0), "-5 to 5")?;
        let slope_lin = self.aor_lin_deg.to_radians().tan();
        let slope_mid = (self.aor_lin_deg + self.s_shape_deg).to_radians().tan();
        if !(slope_mid.abs() < MAX_SLOPE && self.aor_lin_deg + self.s_shape_deg < 85.0) {
            return Err(Error::SurfaceTooSteep { min_slope: slope_lin, max_slope: slope_mid });
        }
        let s = (slope_mid - slope_lin) / MID_GAIN;
        let chord_slope = slope_lin - (1.0 - P5_SHARE) * s;
        let cos = 1.0 / chord_slope.hypot(1.0);
        let area = |d: f64| {
            let half_chord = (1.0 - d * d).max(0.0).sqrt();
            segment_area(d) - 2.0 / 3.0 * self.curvature * (half_chord * cos).powi(3)
        };
        // The area grows with the chord's height: bisection to the last bit.
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..200 {
            let d = 0.5 * (low + high);
            if area(d) < self.fill * PI {
                low = d;
            } else {
                high = d;
            }
        }
        let d = 0.5 * (low + high);
        let normal = DVec2::new(-chord_slope * cos, cos);
        let w = (1.0 - d * d).max(0.0).sqrt() * cos;
        let b2 = self.curvature * w * w / 3.0;
        let shape = BedShape {
            x_mid: d * normal.x,
            half_width: w,
            b: [d * normal.y - b2, slope_lin * w, b2, -s * w, P5_SHARE * s * w],
            chord: d,
            normal,
            raised: self.raised,
            extruded: self.extruded,
        };
        self.check_shape(&shape)?;
        Ok(shape)
    }

    fn check_shape(&self, shape: &BedShape) -> Result<(), Error> {
        let (mut min_slope, mut max_slope) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..=512 {
            let t = f64::from(i) / 256.0 - 1.0;
            let slope = shape.slope(t);
            min_slope = min_slope.min(slope);
            max_slope = max_slope.max(slope);
            let p = shape.point(t);
            // Rounding of the ends, which lie on the circle.
            if p.length_squared() > 1.0 + 1e-9 {
                return Err(Error::SurfaceLeavesDrum {
                    x: p.x,
                    fill: self.fill,
                    aor_lin_deg: self.aor_lin_deg,
                    s_shape_deg: self.s_shape_deg,
                    curvature: self.curvature,
                });
            }
        }
        if min_slope < MIN_SLOPE || max_slope > MAX_SLOPE {
            return Err(Error::SurfaceTooSteep { min_slope, max_slope });
        }
        Ok(())
    }
}

/// Area of the unit disc below a chord at height `d`.
fn segment_area(d: f64) -> f64 {
    let half_angle = (-d).clamp(-1.0, 1.0).acos();
    half_angle + d * (1.0 - d * d).max(0.0).sqrt()
}

impl BedShape {
    /// The side on which the bed is raised in the picture.
    #[must_use]
    pub fn raised(&self) -> RaisedSide {
        self.raised
    }

    /// Whether the bed reaches to the rear wall.
    #[must_use]
    pub fn extruded(&self) -> bool {
        self.extruded
    }

    /// The x of lower and upper end of the surface, in radii, x towards the raised side.
    #[must_use]
    pub fn ends(&self) -> (f64, f64) {
        (self.x_mid - self.half_width, self.x_mid + self.half_width)
    }

    /// Height of the surface at x, in radii; beyond the ends the polynomial goes on.
    #[must_use]
    pub fn surface(&self, x: f64) -> f64 {
        self.height((x - self.x_mid) / self.half_width)
    }

    fn height(&self, t: f64) -> f64 {
        let t2 = t * t;
        let [b0, b1, b2, b3, b5] = self.b;
        b0 + b2 * (1.5 * t2 - 0.5)
            + t * (b1 + b3 * (2.5 * t2 - 1.5) + b5 * ((7.875 * t2 - 8.75) * t2 + 1.875))
    }

    /// Slope `dy/dx` at a share `t` of the half range, -1 at the lower end and 1 at the upper.
    #[must_use]
    pub fn slope(&self, t: f64) -> f64 {
        let t2 = t * t;
        let [_, b1, b2, b3, b5] = self.b;
        (b1 + 3.0 * b2 * t + b3 * (7.5 * t2 - 1.5) + b5 * ((39.375 * t2 - 26.25) * t2 + 1.875))
            / self.half_width
    }

    /// Point of the surface at a share `t` of the half range, in radii.
    #[must_use]
    pub fn point(&self, t: f64) -> DVec2 {
        DVec2::new(self.x_mid + self.half_width * t, self.height(t))
    }

    /// Whether a point of the cross-section lies in the bed; in radii, x towards the raised side.
    #[must_use]
    pub fn contains(&self, p: DVec2) -> bool {
        if p.length_squared() >= 1.0 {
            return false;
        }
        let t = (p.x - self.x_mid) / self.half_width;
        if t.abs() <= 1.0 { p.y < self.height(t) } else { p.dot(self.normal) < self.chord }
    }

    /// Depth of a point below the surface along the vertical, radii (negative above it).
    pub(crate) fn depth_below_surface(&self, p: DVec2) -> f64 {
        let t = ((p.x - self.x_mid) / self.half_width).clamp(-1.0, 1.0);
        self.height(t) - p.y
    }

    /// The responses in closed form.
    #[must_use]
    pub fn responses(&self) -> BedResponses {
        let [b0, b1, b2, b3, b5] = self.b;
        let w = self.half_width;
        let slope_mid = (b1 - 9.0 / 8.0 * b3 + 99.0 / 128.0 * b5) / w;
        let half_chord = (1.0 - self.chord * self.chord).max(0.0).sqrt();
        let area = segment_area(self.chord) - 2.0 * w * b2;
        // First moments: of the segment (along its normal), then of the strip between chord and surface.
        let segment = self.normal * (-2.0 / 3.0 * half_chord.powi(3));
        let chord_rise = b1 + b3 + b5;
        let y_mid = b0 + b2;
        let strip_x = w * (-2.0 * b2 * self.x_mid - 2.0 / 3.0 * w * (b3 + b5));
        let strip_y = w
            * (b0 * b0 + b1 * b1 / 3.0 + b2 * b2 / 5.0 + b3 * b3 / 7.0 + b5 * b5 / 11.0
                - y_mid * y_mid
                - chord_rise * chord_rise / 3.0);
        BedResponses {
            aor_lin_deg: (b1 / w).atan().to_degrees(),
            aor_mid_deg: slope_mid.atan().to_degrees(),
            cen_x_pct: 100.0 * (segment.x + strip_x) / area,
            cen_y_pct: -100.0 * (segment.y + strip_y) / area,
            fill: area / PI,
        }
    }

    /// The surface from its lower to its upper end in `n` points, and the wall back again in `n` points.
    ///
    /// In radii, x towards the raised side; together they bound the bed, clockwise.
    #[must_use]
    pub fn outline(&self, n: usize) -> (Vec<DVec2>, Vec<DVec2>) {
        let at = |i: usize| i as f64 / (n - 1) as f64;
        let surface = (0..n).map(|i| self.point(2.0 * at(i) - 1.0)).collect();
        let upper = self.point(1.0);
        let half_angle = (-self.chord).clamp(-1.0, 1.0).acos();
        let start = upper.y.atan2(upper.x);
        let wall = (0..n).map(|i| DVec2::from_angle(start - 2.0 * half_angle * at(i))).collect();
        (surface, wall)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beds() -> Vec<Bed> {
        let mut beds = Vec::new();
        for fill in [0.1, 0.35, 0.6] {
            for aor_lin_deg in [10.0, 30.0, 55.0] {
                for s_shape_deg in [0.0, 4.0, 8.0] {
                    for curvature in [-0.2, 0.0, 0.2] {
                        let bed =
                            Bed { fill, aor_lin_deg, s_shape_deg, curvature, ..Bed::default() };
                        // Only a thin, steep, strongly curved bed would cross the wall.
                        assert!(bed.shape().is_ok() || curvature != 0.0, "{bed:?}");
                        if bed.shape().is_ok() {
                            beds.push(bed);
                        }
                    }
                }
            }
        }
        assert!(beds.len() > 70, "{}", beds.len());
        beds
    }

    #[test]
    fn closed_forms_agree_with_a_fine_polygon() {
        for bed in beds() {
            let shape = bed.shape().unwrap();
            let r = shape.responses();
            let (surface, wall) = shape.outline(20_001);
            let all: Vec<DVec2> = surface.iter().chain(&wall).copied().collect();
            let (mut area, mut moment) = (0.0, DVec2::ZERO);
            for (p, q) in all.iter().zip(all.iter().cycle().skip(1)) {
                let cross = p.x * q.y - q.x * p.y;
                area -= 0.5 * cross;
                moment -= (p + q) * cross / 6.0;
            }
            // A polygon of 20001 points on an arc of up to 2 pi: relative error (1e-4 pi)^2 / 6 = 2e-8.
            assert!((area / PI - bed.fill).abs() < 1e-7, "{bed:?}: {area}");
            assert!((r.fill - bed.fill).abs() < 1e-13);
            assert!((100.0 * moment.x / area - r.cen_x_pct).abs() < 1e-4, "{bed:?}");
            assert!((-100.0 * moment.y / area - r.cen_y_pct).abs() < 1e-4, "{bed:?}");
        }
    }

    #[test]
    fn stated_angles_are_those_of_least_squares_over_columns() {
        let line = |points: &[DVec2]| {
            let n = points.len() as f64;
            let mean = points.iter().copied().sum::<DVec2>() / n;
            let (mut xx, mut xy) = (0.0, 0.0);
            for p in points {
                xx += (p.x - mean.x).powi(2);
                xy += (p.x - mean.x) * (p.y - mean.y);
            }
            (xy / xx).atan().to_degrees()
        };
        for bed in beds() {
            let (surface, _) = bed.shape().unwrap().outline(40_001);
            // Sums against integrals: the ends weigh 1/n too much, 40001 points bring 1e-3 deg at 8 deg of S-shape.
            assert!((line(&surface) - bed.aor_lin_deg).abs() < 2e-3, "{bed:?}");
            let mid = line(&surface[10_000..=30_000]);
            assert!((mid - bed.aor_lin_deg - bed.s_shape_deg).abs() < 2e-3, "{bed:?} {mid}");
        }
    }

    #[test]
    fn what_the_outline_bounds_is_what_contains_says() {
        let shape = Bed { fill: 0.58, aor_lin_deg: 50.0, s_shape_deg: 6.0, ..Bed::default() }
            .shape()
            .unwrap();
        let n = 1200;
        let count = (0..n * n)
            .filter(|i| {
                let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n) * 2.0 - 1.0;
                shape.contains(DVec2::new(at(i % n), at(i / n)))
            })
            .count();
        let fill = count as f64 * 4.0 / f64::from(n * n) / PI;
        // Counting cells along a boundary of about 6 R: sd 0.3 sqrt(3600) cells of 2.8e-6 R^2.
        assert!((fill - 0.58).abs() < 2e-4, "{fill}");
    }

    #[test]
    fn an_impossible_surface_is_refused() {
        let bed = Bed { fill: 0.1, curvature: 4.0, aor_lin_deg: 20.0, ..Bed::default() };
        assert!(matches!(
            bed.shape(),
            Err(Error::SurfaceLeavesDrum { .. } | Error::SurfaceTooSteep { .. })
        ));
        let bed = Bed { aor_lin_deg: 79.0, s_shape_deg: 8.0, ..Bed::default() };
        assert!(matches!(bed.shape(), Err(Error::SurfaceTooSteep { .. })));
        let bed = Bed { fill: 1.2, ..Bed::default() };
        assert!(matches!(bed.shape(), Err(Error::OutOfRange { path: "bed.fill", .. })));
    }
}
