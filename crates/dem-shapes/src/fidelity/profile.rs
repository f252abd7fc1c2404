//! The clump's surface as a height profile over the surface of the solid.

use std::f64::consts::PI;

use glam::DVec3;

use crate::solids::SolidOfRevolution;
use crate::sphere::Sphere;

/// Roughness of a clump, as an instrument that looks at the solid's surface from outside reads it.
///
/// A ray comes in along each normal of the solid; where it meets the clump first is the height
/// (above the solid's surface positive). Rays are spread evenly over the surface (a spiral of the
/// golden angle), so means are means over the area; with `n` rays they are good to about `1/n` of
/// the range where the profile is smooth and `1/sqrt(n)` at worst.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Roughness {
    /// Mean height, m.
    pub mean_height: f64,
    /// Mean absolute deviation from the mean height (R_a), m.
    pub ra: f64,
    /// Standard deviation of the height (R_q), m.
    pub rq: f64,
    /// Largest height, m.
    pub peak: f64,
    /// Smallest height, m.
    pub valley: f64,
    /// Share of the surface whose rays pass the clump without meeting it: the hole of a ring, the
    /// grooves at a rim. It is not in the other figures. If it is one, they are zero.
    pub open_share: f64,
}

pub(super) fn roughness(
    spheres: &[Sphere],
    solid: &impl SolidOfRevolution,
    rays: usize,
) -> Roughness {
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    let heights: Vec<f64> = (0..rays)
        .filter_map(|k| {
            let k = k as f64;
            let (point, normal) =
                solid.surface_point((k + 0.5) / rays as f64, (k * golden_angle) % (2.0 * PI));
            first_hit(spheres, point, normal)
        })
        .collect();
    let open_share = 1.0 - heights.len() as f64 / rays as f64;
    if heights.is_empty() {
        let (mean_height, ra, rq, peak, valley) = (0.0, 0.0, 0.0, 0.0, 0.0);
        return Roughness { mean_height, ra, rq, peak, valley, open_share };
    }
    let mean =
        |f: &dyn Fn(f64) -> f64| heights.iter().map(|&h| f(h)).sum::<f64>() / heights.len() as f64;
    let mean_height = mean(&|h| h);
    Roughness {
        mean_height,
        ra: mean(&|h| (h - mean_height).abs()),
        rq: mean(&|h| (h - mean_height).powi(2)).sqrt(),
        peak: heights.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        valley: heights.iter().copied().fold(f64::INFINITY, f64::min),
        open_share,
    }
}

/// Height over `point` at which a ray against `normal` enters the first sphere.
fn first_hit(spheres: &[Sphere], point: DVec3, normal: DVec3) -> Option<f64> {
    spheres
        .iter()
        .filter_map(|s| {
            let offset = s.center - point;
            let along = offset.dot(normal);
            let squared = s.radius * s.radius - (offset - along * normal).length_squared();
            (squared >= 0.0).then(|| along + squared.sqrt())
        })
        .max_by(f64::total_cmp)
}
