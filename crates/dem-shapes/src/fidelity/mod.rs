//! How far a clump is from the solid it stands for.
//!
//! Volumes come from exact sections (the section of the solid is one disc more, so
//! `V(clump or solid)` is a union of discs too), the largest protrusion from a closed form, the
//! largest uncovered depth from bounds that close in on it, the roughness from rays.

mod profile;
mod uncovered;

use glam::DVec3;

use crate::error::{ShapeError, not_negative};
use crate::quadrature::GaussLegendre;
use crate::solids::SolidOfRevolution;
use crate::sphere::Sphere;
use crate::union::{
    Disc, SliceScratch, UnionProperties, cut, interval_share, not_converged, section_breakpoints,
    slice_moments, union_properties,
};
pub use profile::Roughness;

/// How finely a clump is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct FidelityOptions {
    /// Tolerance of the volumes, relative to the solid's volume.
    pub volume_tolerance: f64,
    /// Width of the bounds of the uncovered depth, relative to the solid's largest half extent. Where
    /// the depth is nearly the same all over the surface, it takes too long to tell the points
    /// apart, and the bounds are returned wider (a ball on itself: by 2 % of its radius).
    pub distance_tolerance: f64,
    /// Rays against the surface of the solid for the roughness.
    pub rays: usize,
}

impl Default for FidelityOptions {
    /// Volumes to `1e-8`, distances to `1e-3`, 20 000 rays.
    fn default() -> Self {
        Self { volume_tolerance: 1e-8, distance_tolerance: 1e-3, rays: 20_000 }
    }
}

/// Numbers that must be sane for [`FidelityOptions::rays`].
const RAYS: (usize, usize) = (100, 10_000_000);

/// Distances between a clump and the solid it stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Fidelity {
    /// Volume of the clump's union, m3.
    pub clump_volume: f64,
    /// Volume of the solid, m3.
    pub solid_volume: f64,
    /// Volume of the clump outside the solid, m3.
    pub excess_volume: f64,
    /// Volume of the solid outside the clump, m3.
    pub deficit_volume: f64,
    /// Distance between the centroids, m.
    pub centroid_offset: f64,
    /// Error of the moments of inertia about x, y and z at equal mass, relative to the solid's.
    pub inertia_error_rel: DVec3,
    /// Height of the clump's highest point above the solid's surface, m; negative if the clump lies
    /// wholly inside. Exact.
    pub protrusion: f64,
    /// Largest distance of a point of the solid from the clump, m: a point at which it is reached
    /// or exceeded is known.
    pub uncovered_depth: f64,
    /// Bound that this distance does not exceed, m.
    pub uncovered_depth_bound: f64,
    /// The clump's surface as a profile over the solid's.
    pub roughness: Roughness,
}

impl Fidelity {
    /// Measures the union of `spheres` against `solid`, both in the frame of the solid.
    ///
    /// # Errors
    /// A sphere that is none, or options that cannot be met.
    ///
    /// # Example
    /// ```
    /// use dem_shapes::{Fidelity, FidelityOptions, FlatTablet, RingTabletSpec};
    ///
    /// let ring = RingTabletSpec {
    ///     ring_spheres: 9,
    ///     ring_radius: 2.5e-3,
    ///     sphere_radius: 1.747e-3,
    ///     middle_radius: Some(1.747e-3),
    /// };
    /// let solid = FlatTablet::new(4.0e-3, 2.9e-3)?;
    /// let spheres = ring.build()?.spheres();
    /// let fidelity = Fidelity::measure(&spheres, &solid, &FidelityOptions::default())?;
    /// // The volume is right to 0.3 %, yet a sixth of it is in the wrong place.
    /// assert!(fidelity.volume_error_rel().abs() < 3e-3);
    /// assert!(fidelity.symmetric_difference_rel() > 0.1);
    /// // The spheres stand 0.297 mm proud of the faces (and 0.247 mm of the band).
    /// assert!((fidelity.protrusion - 0.297e-3).abs() < 1e-9);
    /// # Ok::<(), dem_shapes::ShapeError>(())
    /// ```
    pub fn measure(
        spheres: &[Sphere],
        solid: &impl SolidOfRevolution,
        options: &FidelityOptions,
    ) -> Result<Self, ShapeError> {
        not_negative("distance tolerance (1)", options.distance_tolerance)?;
        let (minimum, maximum) = RAYS;
        if !(minimum..=maximum).contains(&options.rays) {
            let (what, count) = ("number of rays", options.rays);
            return Err(ShapeError::SampleCount { what, count, minimum, maximum });
        }
        let union = union_properties(spheres, options.volume_tolerance)?;
        let solid_volume = solid.volume();
        let joint = joint_volume(spheres, solid, options.volume_tolerance * solid_volume)?;
        let size = solid.half_height().max(largest_radius(solid));
        let (depth, bound) =
            uncovered::uncovered_depth(spheres, solid, options.distance_tolerance * size);
        let protrusion = spheres
            .iter()
            .map(|s| solid.signed_distance(s.center) + s.radius)
            .fold(f64::NEG_INFINITY, f64::max);
        Ok(Self {
            clump_volume: union.volume,
            solid_volume,
            excess_volume: (joint - solid_volume).max(0.0),
            deficit_volume: (joint - union.volume).max(0.0),
            centroid_offset: union.centroid.length(),
            inertia_error_rel: inertia_error(&union, solid),
            protrusion,
            uncovered_depth: depth,
            uncovered_depth_bound: bound,
            roughness: profile::roughness(spheres, solid, options.rays),
        })
    }

    /// Volume of the clump over that of the solid, less one.
    #[must_use]
    pub fn volume_error_rel(&self) -> f64 {
        self.clump_volume / self.solid_volume - 1.0
    }

    /// Volume that belongs to one of the two only, m3.
    #[must_use]
    pub fn symmetric_difference(&self) -> f64 {
        self.excess_volume + self.deficit_volume
    }

    /// Volume that belongs to one of the two only, over that of the solid.
    #[must_use]
    pub fn symmetric_difference_rel(&self) -> f64 {
        self.symmetric_difference() / self.solid_volume
    }

    /// Hausdorff distance between clump and solid as filled bodies, m: no point of either is
    /// farther from the other; from below, see [`Self::uncovered_depth_bound`].
    #[must_use]
    pub fn hausdorff_distance(&self) -> f64 {
        self.protrusion.max(self.uncovered_depth).max(0.0)
    }
}

fn inertia_error(union: &UnionProperties, solid: &impl SolidOfRevolution) -> DVec3 {
    let m = &union.inertia;
    let clump = DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z) / union.volume;
    clump / (solid.inertia() / solid.volume()) - DVec3::ONE
}

/// Half the solid's width: convex and symmetric, it is widest in the middle.
fn largest_radius(solid: &impl SolidOfRevolution) -> f64 {
    solid.radius_at(0.0)
}

/// Volume of what lies in the clump or in the solid, to the absolute error `allowed`.
fn joint_volume(
    spheres: &[Sphere],
    solid: &impl SolidOfRevolution,
    allowed: f64,
) -> Result<f64, ShapeError> {
    let top = solid.half_height();
    let mut heights = section_breakpoints(spheres);
    for z in solid.edges().into_iter().chain([top]) {
        heights.extend([z, -z]);
    }
    heights.sort_unstable_by(f64::total_cmp);
    let extent = heights[heights.len() - 1] - heights[0];
    heights.dedup_by(|next, kept| *next - *kept <= 1e-13 * extent);

    let rule = GaussLegendre::new();
    let mut discs = Vec::with_capacity(spheres.len() + 1);
    let mut scratch = SliceScratch::default();
    let mut area = |z: f64| {
        cut(spheres, z, &mut discs);
        let radius = solid.radius_at(z);
        discs.push(Disc { x: 0.0, y: 0.0, radius, sphere_z: z, sphere_radius: radius });
        [slice_moments(&mut discs, z, &mut scratch).area]
    };
    let mut volume = 0.0;
    for pair in heights.windows(2) {
        let share = allowed * interval_share(pair, extent, heights.len());
        let part = rule.integrate(pair[0], pair[1], &[share], &mut area).map_err(not_converged)?;
        volume += part.value[0];
    }
    Ok(volume)
}
