//! Moments of the union against an independent estimate with its standard error.

use dem_shapes::glam::DVec3;
use dem_shapes::{Sphere, union_properties};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{coated, flat, moved, open_ring, some_turn};

const POINTS: usize = 2_000_000;

/// Means and standard errors of volume and of the six central second moments.
fn monte_carlo(spheres: &[Sphere], about: DVec3, seed: u64) -> ([f64; 7], [f64; 7]) {
    let low = spheres.iter().fold(DVec3::INFINITY, |m, s| m.min(s.center - s.radius));
    let high = spheres.iter().fold(DVec3::NEG_INFINITY, |m, s| m.max(s.center + s.radius));
    let size = high - low;
    let box_volume = size.x * size.y * size.z;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut sum, mut squares) = ([0.0; 7], [0.0; 7]);
    for _ in 0..POINTS {
        let p = low
            + DVec3::new(
                rng.random::<f64>() * size.x,
                rng.random::<f64>() * size.y,
                rng.random::<f64>() * size.z,
            );
        if spheres.iter().any(|s| s.signed_distance(p) < 0.0) {
            let d = p - about;
            let values = [1.0, d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.y * d.z, d.z * d.x];
            for k in 0..7 {
                sum[k] += values[k];
                squares[k] += values[k] * values[k];
            }
        }
    }
    let n = POINTS as f64;
    let mean = sum.map(|v| v / n);
    let mut error = [0.0; 7];
    for k in 0..7 {
        error[k] = ((squares[k] / n - mean[k] * mean[k]) / n).sqrt() * box_volume;
    }
    (mean.map(|v| v * box_volume), error)
}

#[test]
fn volume_and_inertia_agree_with_monte_carlo_within_its_error() {
    let lopsided = vec![
        Sphere::new(DVec3::new(0.0, 0.0, 0.0), 1.0),
        Sphere::new(DVec3::new(0.8, 0.3, -0.2), 0.7),
        Sphere::new(DVec3::new(0.1, 0.9, 0.6), 0.8),
        Sphere::new(DVec3::new(0.5, 0.5, 0.1), 0.6),
        Sphere::new(DVec3::new(-0.9, 0.4, 0.8), 0.5),
    ];
    let tablets = [flat(), open_ring(), coated(2.5e-3), coated(2.33e-3), coated(2.417e-3)];
    let mut shapes: Vec<Vec<Sphere>> =
        tablets.iter().map(|t| t.build().unwrap().spheres()).collect();
    shapes.push(moved(&shapes[4], some_turn(), DVec3::new(1e-3, 2e-3, 3e-3)));
    shapes.push(lopsided);
    for (k, spheres) in shapes.iter().enumerate() {
        let u = union_properties(spheres, 1e-10).unwrap();
        let (mean, error) = monte_carlo(spheres, u.centroid, 7 + k as u64);
        let i = u.inertia;
        let half = 0.5 * (i.x_axis.x + i.y_axis.y + i.z_axis.z);
        let ours = [
            u.volume,
            half - i.x_axis.x,
            half - i.y_axis.y,
            half - i.z_axis.z,
            -i.x_axis.y,
            -i.y_axis.z,
            -i.z_axis.x,
        ];
        for c in 0..7 {
            let sigma = (ours[c] - mean[c]) / error[c];
            // 49 numbers with a fixed seed: beyond four standard errors is 1 in 300 by chance.
            assert!(sigma.abs() < 4.0, "shape {k}, moment {c}: {sigma} standard errors");
        }
    }
}

/// A clump with the moments of its spheres' sum would fail the test above: the difference is far
/// beyond the sampling error.
#[test]
fn sum_over_spheres_is_far_from_the_union() {
    let spheres = coated(2.417e-3).build().unwrap().spheres();
    let u = union_properties(&spheres, 1e-10).unwrap();
    let sum: f64 = spheres.iter().map(Sphere::volume).sum();
    assert!(sum > 1.7 * u.volume);
    let about_z: f64 = spheres
        .iter()
        .map(|s| s.volume() * (0.4 * s.radius * s.radius + s.center.length_squared()))
        .sum();
    let per_mass = (about_z / sum) / (u.inertia.z_axis.z / u.volume);
    assert!((per_mass - 1.0).abs() > 0.03, "{per_mass}");
}
