//! What a perfect reader of the picture would measure: the drawn silhouette, by quadrature.
//!
//! Definitions (those for photographs):
//! - **circle**: the least-squares circle through the projected inner edge of the ring (exactly the projected edge when the
//!   camera looks straight at the drum); pixel centres at whole numbers;
//! - **surface**: the upper edge of the bed's silhouette between the two points at which it leaves the drum's wall;
//!   columns in which the wall itself is the upper edge of the bed (beyond those points) do not count;
//! - **aor_lin**: angle of the least-squares line of surface height over column, all columns between the ends with equal weight,
//!   positive when the bed rises towards its raised side;
//! - **aor_mid**: the same over the columns from 1/4 to 3/4 of the range between the ends;
//! - **cen_x, cen_y**: centre of area of the silhouette (hub not cut out) from the circle's centre, percent of its radius,
//!   x towards the raised side, y downwards;
//! - **fill**: area of the silhouette over area of the circle.
//!
//! A bed filmed straight on from the front plate gives its closed-form responses; roll, pitch, perspective and standoff of the
//! ring change them, and the difference is the camera's effect.

use glam::{DVec2, DVec3};

use crate::bed::{BedShape, RaisedSide};
use crate::camera::{Projection, View};
use crate::error::Error;
use crate::scene::Scene;

/// Points along the surface and along the wall.
const POINTS: usize = 4001;

/// The measures of the drawn silhouette.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Truth {
    /// Angle of the least-squares line over the whole surface, degrees.
    pub aor_lin_deg: f64,
    /// The same over the second and third quarter of the columns.
    pub aor_mid_deg: f64,
    /// Centre of area towards the raised side, percent of the radius.
    pub cen_x_pct: f64,
    /// Centre of area downwards, percent of the radius.
    pub cen_y_pct: f64,
    /// Area of the silhouette over area of the circle.
    pub fill: f64,
    /// Column of the circle's centre.
    pub center_x_px: f64,
    /// Row of the circle's centre.
    pub center_y_px: f64,
    /// Radius of the circle.
    pub radius_px: f64,
    /// Shorter over longer axis of the projected ring: 1 straight on, less for a tilted camera.
    pub axis_ratio: f64,
    /// Column and row of the surface's lower end.
    pub lower_end_px: [f64; 2],
    /// Column and row of its upper end.
    pub upper_end_px: [f64; 2],
    /// The raised side.
    pub raised: RaisedSide,
}

impl Truth {
    /// Angle of the middle less that of the whole, degrees.
    #[must_use]
    pub fn s_shape_deg(&self) -> f64 {
        self.aor_mid_deg - self.aor_lin_deg
    }

    /// Measures the silhouette of an analytic bed in a view.
    ///
    /// # Errors
    /// [`Error::SurfaceFolds`] when a column of the picture meets the surface twice, [`Error::PinholeBesideDrum`] for a
    /// bed that reaches to the rear wall and a camera so far aside that the tube would hide part of it.
    pub fn of_bed(shape: &BedShape, scene: &Scene, view: &View) -> Result<Self, Error> {
        let ring = RingCircle::of(scene, view);
        let (surface, wall) = shape.outline(POINTS);
        let surface = if shape.extruded() {
            let (foot, _) = rear_shrink(shape.raised(), scene, view);
            if foot.length() >= 1.0
                || view.projection == Projection::Orthographic && view.backward.z < 1.0
            {
                return Err(Error::PinholeBesideDrum { foot_radii: foot.length() });
            }
            seen_from_front(shape, scene, view)
        } else {
            surface
        };
        let front = scene.drum.front_z();
        let to_picture = |p: &DVec2| {
            let x = p.x * shape.raised().sign();
            view.project(DVec3::new(x, p.y, 0.0) * scene.drum.radius_m + DVec3::Z * front)
                .expect("the front plate lies before the pinhole: the camera was checked")
        };
        // In the picture, heights upwards and columns towards the raised side.
        let sign = shape.raised().sign();
        let up = |p: &DVec2| {
            let q = to_picture(p);
            DVec2::new(sign * (q.x - ring.center.x), ring.center.y - q.y)
        };
        let surface: Vec<DVec2> = surface.iter().map(up).collect();
        let wall: Vec<DVec2> = wall.iter().map(up).collect();
        let column = |x: f64| ring.center.x + sign * x;
        if let Some(pair) = surface.windows(2).find(|p| p[1].x < p[0].x - 1e-9) {
            return Err(Error::SurfaceFolds { column_px: column(pair[0].x) });
        }
        let (first, last) = (surface[0], surface[surface.len() - 1]);
        let quarter = 0.25 * (last.x - first.x);
        let (area, moment) = area_and_moment(surface.iter().chain(&wall));
        let pixel = |p: DVec2| [column(p.x), ring.center.y - p.y];
        Ok(Self {
            aor_lin_deg: line_slope(&surface, first.x, last.x).atan().to_degrees(),
            aor_mid_deg: line_slope(&surface, first.x + quarter, last.x - quarter)
                .atan()
                .to_degrees(),
            cen_x_pct: 100.0 * moment.x / area / ring.radius,
            cen_y_pct: -100.0 * moment.y / area / ring.radius,
            fill: area / (std::f64::consts::PI * ring.radius * ring.radius),
            center_x_px: ring.center.x,
            center_y_px: ring.center.y,
            radius_px: ring.radius,
            axis_ratio: ring.axis_ratio,
            lower_end_px: pixel(first),
            upper_end_px: pixel(last),
            raised: shape.raised(),
        })
    }
}

/// The circle that a reader finds for the ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingCircle {
    /// Column and row of its centre.
    pub center: DVec2,
    /// Its radius in pixels.
    pub radius: f64,
    /// Shorter over longer half axis of the projected edge.
    pub axis_ratio: f64,
}

impl RingCircle {
    /// Projects the inner edge of the ring and fits a circle (Kåsa's least squares).
    #[must_use]
    pub fn of(scene: &Scene, view: &View) -> Self {
        const N: usize = 720;
        let z = scene.drum.front_z() + scene.ring.standoff_m;
        let points: Vec<DVec2> = (0..N)
            .filter_map(|i| {
                let p = DVec2::from_angle(std::f64::consts::TAU * i as f64 / N as f64)
                    * scene.drum.radius_m;
                view.project(p.extend(z))
            })
            .collect();
        let n = points.len() as f64;
        let mean = points.iter().copied().sum::<DVec2>() / n;
        let (mut xx, mut xy, mut yy, mut xz, mut yz, mut zz) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for p in &points {
            let d = *p - mean;
            let s = d.length_squared();
            xx += d.x * d.x;
            xy += d.x * d.y;
            yy += d.y * d.y;
            xz += d.x * s;
            yz += d.y * s;
            zz += s;
        }
        let det = xx * yy - xy * xy;
        let offset = DVec2::new(xz * yy - yz * xy, yz * xx - xz * xy) / (2.0 * det);
        let center = mean + offset;
        let radius = (zz / n + offset.length_squared()).sqrt();
        // Principal second moments of the edge of an ellipse stand as the squares of its axes, to first order.
        let (half_sum, half_diff) = (0.5 * (xx + yy), (0.25 * (xx - yy).powi(2) + xy * xy).sqrt());
        let axis_ratio = ((half_sum - half_diff) / (half_sum + half_diff)).sqrt();
        Self { center, radius, axis_ratio }
    }
}

/// Upper edge of a bed that reaches to the rear wall, as seen on the plane of the front plate.
///
/// A point at depth h behind the front plate appears on it at `e + s (p - e)` with `s = D / (D + h)`, `e` being the foot of
/// the pinhole on that plane and D its height above it: the silhouette is the union of the front face shrunk by all s from
/// `s_rear` to 1. In each column the upper edge is the largest height over s.
fn seen_from_front(shape: &BedShape, scene: &Scene, view: &View) -> Vec<DVec2> {
    let (foot, s_rear) = rear_shrink(shape.raised(), scene, view);
    let (low, high) = shape.ends();
    // Ends of the union: the front's own, or the rear's where that reaches further (a pinhole beside the bed).
    let at = |x: f64, s: f64| foot.x + s * (x - foot.x);
    let (x0, x1) = (low.min(at(low, s_rear)), high.max(at(high, s_rear)));
    let top = |x: f64| {
        let height = |s: f64| {
            let q = foot.x + (x - foot.x) / s;
            (q >= low - 1e-12 && q <= high + 1e-12)
                .then(|| foot.y + s * (shape.surface(q.clamp(low, high)) - foot.y))
        };
        // The heights are smooth in s where they exist; their ends in s (radial edges) are taken exactly.
        let mut s_from = s_rear;
        let mut s_to = 1.0_f64;
        for end in [low, high] {
            let s = (x - foot.x) / (end - foot.x);
            if s > s_rear && s < 1.0 {
                if height(0.5 * (s + s_rear)).is_some() {
                    s_to = s_to.min(s);
                } else {
                    s_from = s_from.max(s);
                }
            }
        }
        let mut best = f64::NEG_INFINITY;
        let mut best_s = s_from;
        let step = (s_to - s_from) / 64.0;
        for i in 0..=64 {
            let s = s_from + step * f64::from(i);
            if let Some(y) = height(s)
                && y > best
            {
                (best, best_s) = (y, s);
            }
        }
        // A maximum inside: ternary search in its two neighbouring steps.
        let (mut a, mut b) = ((best_s - step).max(s_from), (best_s + step).min(s_to));
        for _ in 0..40 {
            let (m, n) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
            if height(m) < height(n) { a = m } else { b = n }
        }
        height(0.5 * (a + b)).map_or(best, |y| y.max(best))
    };
    (0..POINTS)
        .map(|i| {
            let x = x0 + (x1 - x0) * i as f64 / (POINTS - 1) as f64;
            DVec2::new(x, top(x.clamp(x0, x1)))
        })
        .collect()
}

/// Foot of the pinhole on the front plane in radii (x towards the raised side) and the shrink of the rear wall.
pub(crate) fn rear_shrink(raised: RaisedSide, scene: &Scene, view: &View) -> (DVec2, f64) {
    let drum = &scene.drum;
    let height = view.position.z - drum.front_z();
    let foot = DVec2::new(raised.sign() * view.position.x, view.position.y) / drum.radius_m;
    match view.projection {
        Projection::Perspective => (foot, height / (height + drum.length_m)),
        Projection::Orthographic => (foot, 1.0),
    }
}

/// Slope of the least-squares line of a polyline over x from `from` to `to`, by exact integrals.
fn line_slope(points: &[DVec2], from: f64, to: f64) -> f64 {
    let mid = 0.5 * (from + to);
    // Integrals of y and (x - mid) y; over a range symmetric about mid the line's slope needs only the latter.
    let mut xy = 0.0;
    for pair in points.windows(2) {
        let (p, q) = (pair[0], pair[1]);
        let (a, b) = (p.x.max(from), q.x.min(to));
        if b <= a {
            continue;
        }
        let slope = (q.y - p.y) / (q.x - p.x);
        let (ya, yb) = (p.y + slope * (a - p.x), p.y + slope * (b - p.x));
        let (a, b) = (a - mid, b - mid);
        // Simpson's rule is exact for the quadratic (x - mid) y.
        xy += (b - a) / 6.0 * (a * ya + (a + b) * (ya + yb) + b * yb);
    }
    12.0 * xy / (to - from).powi(3)
}

/// Area and first moment of a closed polygon that runs clockwise (y up).
fn area_and_moment<'a>(points: impl Iterator<Item = &'a DVec2> + Clone) -> (f64, DVec2) {
    let (mut area, mut moment) = (0.0, DVec2::ZERO);
    for (p, q) in points.clone().zip(points.clone().skip(1).chain(points.take(1))) {
        let cross = q.x * p.y - p.x * q.y;
        area += 0.5 * cross;
        moment += (*p + *q) * (cross / 6.0);
    }
    (area, moment)
}
