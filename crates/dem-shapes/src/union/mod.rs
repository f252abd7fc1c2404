//! Volume, surface, centroid and inertia of a union of overlapping spheres.
//!
//! Method: the section of the union at a height `z` is a union of discs, whose area, first and
//! second moments follow exactly from the free arcs of its circles (Green's theorem). Over `z` they
//! are integrated by Gauss-Legendre panels between the heights at which the pattern of arcs
//! changes, in a variable in which the integrand is smooth up to both ends, to a tolerance that the
//! caller states. The free surface comes along: a sphere of radius `r` shows
//! `r * (free angle) * dz` between `z` and `z + dz` (Archimedes).
//!
//! A part that lies in several spheres counts once: the sum over the spheres, which is what some
//! codes take, is too heavy and has the wrong moments.

mod breakpoints;
mod slice;

use glam::{DMat3, DVec3};

use crate::error::ShapeError;
use crate::quadrature::{GaussLegendre, Integral, Missed};
use crate::sphere::{Sphere, check_spheres};
pub(crate) use breakpoints::breakpoints as section_breakpoints;
pub(crate) use slice::{Disc, SliceScratch, slice_moments};

/// Relative tolerance for those who have none in mind: far below what any tablet is known to.
pub const DEFAULT_RELATIVE_TOLERANCE: f64 = 1e-10;

/// Tolerances that double precision can meet and that still mean something.
const TOLERANCES: (f64, f64) = (1e-12, 1e-2);

/// Geometry of a union of spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct UnionProperties {
    /// Volume, m3.
    pub volume: f64,
    /// Estimate of the absolute error of the volume, m3.
    pub volume_error: f64,
    /// Free surface, walls of closed holes included, m2.
    pub surface_area: f64,
    /// Centre of volume, m.
    pub centroid: DVec3,
    /// Inertia tensor about the centroid for a density of one, m5 (times density: kg m2).
    pub inertia: DMat3,
}

impl UnionProperties {
    /// Wadell's sphericity: surface of the ball of equal volume over the surface, one for a ball.
    #[must_use]
    pub fn sphericity(&self) -> f64 {
        use std::f64::consts::PI;
        PI.cbrt() * (6.0 * self.volume).powf(2.0 / 3.0) / self.surface_area
    }
}

/// Volume, surface, centroid and inertia of the union of `spheres`, to `relative_tolerance`.
///
/// The tolerance refers to the largest sphere: its volume, surface and the moments that it would
/// have one radius away. Spheres may touch, coincide, contain each other or lie apart.
///
/// # Errors
/// No sphere, a sphere that is none, a tolerance outside `1e-12 ..= 1e-2` or one that is not met.
///
/// # Example
/// ```
/// use dem_shapes::{glam::DVec3, union_properties, Sphere};
/// use std::f64::consts::PI;
///
/// // Two unit spheres whose centres are one radius apart share a lens of 5 pi / 12.
/// let pair = [Sphere::new(DVec3::ZERO, 1.0), Sphere::new(DVec3::X, 1.0)];
/// let union = union_properties(&pair, 1e-10)?;
/// assert!((union.volume - (8.0 / 3.0 - 5.0 / 12.0) * PI).abs() < 1e-9);
/// # Ok::<(), dem_shapes::ShapeError>(())
/// ```
pub fn union_properties(
    spheres: &[Sphere],
    relative_tolerance: f64,
) -> Result<UnionProperties, ShapeError> {
    check_spheres(spheres)?;
    check_tolerance(relative_tolerance)?;
    let frame = UnitFrame::of(spheres);
    let unit = frame.kept(spheres);
    let sums = moments(&unit, relative_tolerance)?;
    frame.properties(&sums, spheres)
}

pub(crate) fn check_tolerance(value: f64) -> Result<(), ShapeError> {
    let (minimum, maximum) = TOLERANCES;
    if (minimum..=maximum).contains(&value) {
        Ok(())
    } else {
        Err(ShapeError::Tolerance { value, minimum, maximum })
    }
}

/// Origin in the middle of the spheres, largest radius one: tolerances then have no unit.
pub(crate) struct UnitFrame {
    pub(crate) origin: DVec3,
    pub(crate) length: f64,
}

impl UnitFrame {
    pub(crate) fn of(spheres: &[Sphere]) -> Self {
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        let mut length: f64 = 0.0;
        for s in spheres {
            low = low.min(s.center - s.radius);
            high = high.max(s.center + s.radius);
            length = length.max(s.radius);
        }
        Self { origin: 0.5 * low + 0.5 * high, length }
    }

    /// The spheres in this frame, without those that lie in another one.
    fn kept(&self, spheres: &[Sphere]) -> Vec<Sphere> {
        let mut unit: Vec<Sphere> = spheres
            .iter()
            .map(|s| Sphere::new((s.center - self.origin) / self.length, s.radius / self.length))
            .collect();
        unit.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        let mut kept: Vec<Sphere> = Vec::with_capacity(unit.len());
        for s in unit {
            // The allowance of the section's discs, see `slice`.
            let inside = kept
                .iter()
                .any(|k| k.center.distance(s.center) + s.radius <= k.radius * (1.0 + 1e-13));
            if !inside {
                kept.push(s);
            }
        }
        kept
    }

    fn properties(
        &self,
        sums: &Integral<COMPONENTS>,
        spheres: &[Sphere],
    ) -> Result<UnionProperties, ShapeError> {
        let [volume, x, y, z, xx, xy, yy, zx, zy, zz, surface] = sums.value;
        let mean = DVec3::new(x, y, z) / volume;
        let central = |second: f64, a: f64, b: f64| second - volume * a * b;
        let (xx, yy, zz) =
            (central(xx, mean.x, mean.x), central(yy, mean.y, mean.y), central(zz, mean.z, mean.z));
        let (xy, zx, zy) =
            (central(xy, mean.x, mean.y), central(zx, mean.z, mean.x), central(zy, mean.z, mean.y));
        let inertia = DMat3::from_cols(
            DVec3::new(yy + zz, -xy, -zx),
            DVec3::new(-xy, xx + zz, -zy),
            DVec3::new(-zx, -zy, xx + yy),
        );
        let cubed = self.length.powi(3);
        let properties = UnionProperties {
            volume: volume * cubed,
            volume_error: sums.error[0] * cubed,
            surface_area: surface * self.length.powi(2),
            centroid: self.origin + mean * self.length,
            inertia: inertia * (cubed * self.length.powi(2)),
        };
        let smallest = properties.inertia.x_axis.x.min(properties.inertia.y_axis.y);
        let smallest = smallest.min(properties.inertia.z_axis.z);
        if properties.volume.is_normal() && smallest.is_normal() && properties.inertia.is_finite() {
            Ok(properties)
        } else {
            let extent = spheres
                .iter()
                .map(|s| s.center.distance(self.origin) + s.radius)
                .fold(0.0, f64::max);
            Err(ShapeError::OutOfRange { extent, largest_radius: self.length })
        }
    }
}

/// Volume, three first and six second moments, surface.
const COMPONENTS: usize = 11;

fn moments(spheres: &[Sphere], tolerance: f64) -> Result<Integral<COMPONENTS>, ShapeError> {
    let heights = section_breakpoints(spheres);
    let extent = heights[heights.len() - 1] - heights[0];
    // In units of the largest sphere, which the union is no smaller than.
    let volume = tolerance * 4.0 / 3.0 * std::f64::consts::PI;
    let mut allowed = [volume; COMPONENTS];
    allowed[COMPONENTS - 1] = 3.0 * volume;

    let rule = GaussLegendre::new();
    let mut discs = Vec::with_capacity(spheres.len());
    let mut scratch = SliceScratch::default();
    let mut section = |z: f64| {
        cut(spheres, z, &mut discs);
        let m = slice_moments(&mut discs, z, &mut scratch);
        let (x, y, a) = (m.x, m.y, m.area);
        [a, x, y, z * a, m.xx, m.xy, m.yy, z * x, z * y, z * z * a, m.weighted_arc]
    };
    let mut sum = Integral::ZERO;
    for pair in heights.windows(2) {
        let share = interval_share(pair, extent, heights.len());
        let part = rule
            .integrate(pair[0], pair[1], &allowed.map(|v| v * share), &mut section)
            .map_err(not_converged)?;
        sum.add(&part);
    }
    Ok(sum)
}

/// Share of the allowed error that one of the intervals may have: half of the whole goes by width,
/// half to each alike, as in a very narrow interval rounding sets a floor to what can be met.
pub(crate) fn interval_share(pair: &[f64], extent: f64, heights: usize) -> f64 {
    0.5 * ((pair[1] - pair[0]) / extent + 1.0 / heights as f64)
}

pub(crate) fn not_converged(missed: Missed) -> ShapeError {
    ShapeError::NotConverged { height: missed.at, excess: missed.excess }
}

/// The discs that a level plane cuts from `spheres`.
pub(crate) fn cut(spheres: &[Sphere], z: f64, discs: &mut Vec<Disc>) {
    discs.clear();
    for s in spheres {
        let up = z - s.center.z;
        let squared = (s.radius - up) * (s.radius + up);
        if squared > 0.0 {
            let radius = squared.sqrt();
            discs.push(Disc {
                x: s.center.x,
                y: s.center.y,
                radius,
                sphere_z: s.center.z,
                sphere_radius: s.radius,
            });
        }
    }
}
