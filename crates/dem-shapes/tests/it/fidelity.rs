//! Distances between clumps and solids against closed forms.

use std::f64::consts::PI;

use dem_shapes::glam::DVec3;
use dem_shapes::solids::SolidOfRevolution;
use dem_shapes::{Ball, BiconvexTablet, Fidelity, FidelityOptions, FlatTablet, Sphere};

use crate::{close, coated, moved, open_ring};

fn measure(spheres: &[Sphere], solid: &impl SolidOfRevolution) -> Fidelity {
    Fidelity::measure(spheres, solid, &FidelityOptions::default()).unwrap()
}

#[test]
fn a_ball_is_faithful_to_itself() {
    let f = measure(&[Sphere::new(DVec3::ZERO, 2.0)], &Ball::new(2.0).unwrap());
    // The tolerance of volumes, times 33.5.
    close(f.volume_error_rel(), 0.0, 1e-8);
    close(f.symmetric_difference(), 0.0, 1e-6);
    close(f.protrusion, 0.0, 1e-15);
    assert!(f.uncovered_depth <= 1e-12 && f.uncovered_depth_bound <= 0.05, "{f:?}");
    assert!(f.inertia_error_rel.length() < 1e-8);
    assert!(f.roughness.rq < 1e-7 && f.roughness.open_share == 0.0);
}

#[test]
fn a_ball_beside_a_ball_differs_by_two_crescents() {
    let d = 0.4;
    let shift = DVec3::new(0.24, 0.0, 0.32);
    let f = measure(&[Sphere::new(shift, 1.0)], &Ball::new(1.0).unwrap());
    let lens = PI * (2.0 - d) * (2.0 - d) * (d * d + 4.0 * d) / (12.0 * d);
    let ball = 4.0 / 3.0 * PI;
    close(f.excess_volume, ball - lens, 1e-7);
    close(f.deficit_volume, ball - lens, 1e-7);
    close(f.centroid_offset, d, 1e-9);
    close(f.protrusion, d, 1e-15);
    // The bounds hold the exact depth and are as near as was asked.
    assert!(f.uncovered_depth <= d + 1e-12 && d <= f.uncovered_depth_bound);
    close(f.uncovered_depth, f.uncovered_depth_bound, 1.001e-3);
    close(f.hausdorff_distance(), d, 1e-15);
}

#[test]
fn a_ball_in_a_cylinder_leaves_the_corners() {
    let solid = FlatTablet::new(1.0, 2.0).unwrap();
    let f = measure(&[Sphere::new(DVec3::ZERO, 1.0)], &solid);
    close(f.excess_volume, 0.0, 1e-7);
    close(f.deficit_volume, 2.0 * PI - 4.0 / 3.0 * PI, 1e-7);
    // The rim is sqrt(2) from the middle.
    let corner = 2.0_f64.sqrt() - 1.0;
    assert!(f.uncovered_depth <= corner + 1e-12 && corner <= f.uncovered_depth_bound);
    close(f.protrusion, 0.0, 1e-15);
    close(f.roughness.peak, 0.0, 1e-3);
    // Depth at the rim of the face: the whole half height, at the band: the radius.
    close(f.roughness.valley, -1.0, 0.02);
}

#[test]
fn a_hole_is_open_and_counts_as_uncovered() {
    let tablet = open_ring().build().unwrap();
    let solid = FlatTablet::new(4.0e-3, 2.9e-3).unwrap();
    let f = measure(&tablet.spheres(), &solid);
    // Rays on either face pass through the hole inside the ring's outline, and through the grooves
    // where the outline falls short of the tablet's radius; both bounded by circles about the ring.
    let (ring, r, sector) = (2.5_f64, 1.747_f64, PI / 10.0);
    let n = 100_000;
    let hole: f64 = (0..n)
        .map(|k| {
            let a = sector * (f64::from(k) + 0.5) / f64::from(n);
            let chord = (r * r - (ring * a.sin()).powi(2)).sqrt();
            let (inner, outer) = (ring * a.cos() - chord, ring * a.cos() + chord);
            let groove = (16.0 - outer * outer).max(0.0);
            0.5 * (inner * inner + groove) * sector / f64::from(n)
        })
        .sum::<f64>()
        * 20.0;
    let share = 2.0 * hole * 1e-6 / solid.surface_area();
    // Even spread of 20 000 rays.
    close(f.roughness.open_share, share, 3e-4);
    // The deepest point is the centre of a face: sqrt(ring^2 + (h/2)^2) - r.
    let depth = (2.5e-3_f64.hypot(1.45e-3)) - 1.747e-3;
    assert!(f.uncovered_depth <= depth + 1e-15 && depth <= f.uncovered_depth_bound);
    close(f.uncovered_depth, depth, 4e-6);
    // Faces: r - h/2; band: ring + r - R.
    close(f.protrusion, (1.747e-3_f64 - 1.45e-3).max(2.5e-3 + 1.747e-3 - 4.0e-3), 1e-17);
}

#[test]
fn excess_less_deficit_is_the_difference_of_the_volumes() {
    let tablet = coated(2.417e-3).build().unwrap();
    let solid = BiconvexTablet::new(4.0e-3, 2.25e-3, 9.64e-3).unwrap();
    let f = measure(&tablet.spheres(), &solid);
    close(
        f.excess_volume - f.deficit_volume,
        f.clump_volume - f.solid_volume,
        1e-12 * f.solid_volume,
    );
    assert!(f.excess_volume > 0.0 && f.deficit_volume > 0.0);
    assert!(f.roughness.open_share == 0.0);
}

/// Symmetric difference counted on a fine grid: another way to the same number.
#[test]
fn symmetric_difference_agrees_with_a_count_on_a_grid() {
    let spheres = coated(2.417e-3).build().unwrap().spheres();
    let solid = BiconvexTablet::new(4.0e-3, 2.25e-3, 9.64e-3).unwrap();
    let f = measure(&spheres, &solid);
    let n = 200;
    let (half, half_z) = (4.4e-3, 2.4e-3);
    let cell = DVec3::new(half, half, half_z) * (2.0 / f64::from(n));
    let mut count = 0_u32;
    for i in 0..n {
        for j in 0..n {
            for k in 0..n {
                let at = |m: i32| f64::from(m) + 0.5;
                let p = DVec3::new(at(i), at(j), at(k)) * cell - DVec3::new(half, half, half_z);
                let clump = spheres.iter().any(|s| s.signed_distance(p) < 0.0);
                count += u32::from(clump != (solid.signed_distance(p) < 0.0));
            }
        }
    }
    let counted = f64::from(count) * cell.x * cell.y * cell.z;
    // 8 million cells of which some 2e5 lie on a surface: the error of the count is about the
    // root of that number, 0.03 % of the solid.
    close(f.symmetric_difference() / counted, 1.0, 5e-3);
}

#[test]
fn turning_about_the_axis_changes_no_figure() {
    let spheres = coated(2.417e-3).build().unwrap().spheres();
    let solid = BiconvexTablet::new(4.0e-3, 2.25e-3, 9.64e-3).unwrap();
    let here = measure(&spheres, &solid);
    let turn = dem_shapes::glam::DQuat::from_rotation_z(0.37);
    let there = measure(&moved(&spheres, turn, DVec3::ZERO), &solid);
    close(there.symmetric_difference() / here.symmetric_difference(), 1.0, 1e-6);
    close(there.protrusion, here.protrusion, 1e-17);
    // Both are within the width of the bounds.
    close(there.uncovered_depth, here.uncovered_depth, 4e-6);
    // Other rays meet other points of the profile.
    close(there.roughness.rq / here.roughness.rq, 1.0, 0.01);
}
