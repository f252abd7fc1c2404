//! Clumps: principal frame, mass, scaling, hidden spheres, files.

use dem_shapes::glam::{DQuat, DVec3};
use dem_shapes::{ClumpMass, ClumpShape, Sphere, union_properties};

use crate::{close, coated, moved, some_turn};

fn lopsided() -> Vec<Sphere> {
    vec![
        Sphere::new(DVec3::new(5.0, 1.0, -2.0), 1.0),
        Sphere::new(DVec3::new(6.1, 1.4, -2.3), 0.8),
        Sphere::new(DVec3::new(5.2, 2.3, -1.0), 0.6),
    ]
}

#[test]
fn body_frame_is_central_and_principal() {
    let mass = ClumpMass::Density(1350.0);
    let clump = ClumpShape::from_spheres(&lopsided(), mass, 1e-11).unwrap();
    let body = union_properties(&clump.spheres, 1e-11).unwrap();
    // Integration tolerance, on moments of order ten.
    assert!(body.centroid.length() < 1e-10);
    let i = body.inertia * clump.density();
    let largest = clump.principal_moments.max_element();
    for (axis, unit) in [(i.x_axis, DVec3::X), (i.y_axis, DVec3::Y), (i.z_axis, DVec3::Z)] {
        let moment = clump.principal_moments.dot(unit);
        assert!((axis - moment * unit).length() < 1e-9 * largest);
    }
    // And the way back to the given frame.
    for (given, ours) in lopsided().iter().zip(&clump.spheres) {
        assert!((clump.axes * ours.center + clump.centroid).abs_diff_eq(given.center, 1e-13));
    }
    let given = union_properties(&lopsided(), 1e-11).unwrap().inertia * clump.density();
    assert!(clump.inertia_tensor().abs_diff_eq(given, 1e-9 * largest));
}

#[test]
fn moments_do_not_depend_on_how_the_spheres_were_given() {
    let mass = ClumpMass::Total(0.225e-3);
    let spheres = coated(2.417e-3).build().unwrap().spheres();
    let here = ClumpShape::from_spheres(&spheres, mass, 1e-10).unwrap();
    for turn in [some_turn(), some_turn() * some_turn(), DQuat::from_rotation_x(1.0)] {
        let given = moved(&spheres, turn, DVec3::new(0.1, 0.0, -0.2));
        let there = ClumpShape::from_spheres(&given, mass, 1e-10).unwrap();
        let sorted = |c: &ClumpShape| {
            let mut m = c.principal_moments.to_array();
            m.sort_by(f64::total_cmp);
            m
        };
        for (a, b) in sorted(&here).iter().zip(sorted(&there)) {
            close(b / a, 1.0, 1e-8);
        }
    }
}

#[test]
fn density_and_total_mass_describe_the_same_clump() {
    let by_density =
        ClumpShape::from_spheres(&lopsided(), ClumpMass::Density(1030.0), 1e-10).unwrap();
    let by_mass =
        ClumpShape::from_spheres(&lopsided(), ClumpMass::Total(by_density.mass), 1e-10).unwrap();
    close(by_mass.density(), 1030.0, 1e-9);
    assert!((by_mass.principal_moments - by_density.principal_moments).length() < 1e-9);
}

#[test]
fn hidden_and_repeated_spheres_are_left_out_of_the_clump() {
    let mut spheres = lopsided();
    let plain = ClumpShape::from_spheres(&spheres, ClumpMass::Density(1.0), 1e-10).unwrap();
    spheres.insert(0, Sphere::new(DVec3::new(5.1, 1.0, -2.0), 0.5));
    spheres.push(spheres[1]);
    let clump = ClumpShape::from_spheres(&spheres, ClumpMass::Density(1.0), 1e-10).unwrap();
    assert_eq!(clump, plain);
}

#[test]
fn scaling_is_that_of_a_body_of_equal_density() {
    let clump = ClumpShape::from_spheres(&lopsided(), ClumpMass::Density(2500.0), 1e-10).unwrap();
    let half = clump.scaled(0.5).unwrap();
    let spheres: Vec<_> =
        lopsided().iter().map(|s| Sphere::new(0.5 * s.center, 0.5 * s.radius)).collect();
    let direct = ClumpShape::from_spheres(&spheres, ClumpMass::Density(2500.0), 1e-10).unwrap();
    // Powers of two scale without rounding, up to the quadrature's own.
    close(half.mass / direct.mass, 1.0, 1e-12);
    close(half.surface_area / direct.surface_area, 1.0, 1e-12);
    let ratio = half.principal_moments / direct.principal_moments;
    assert!((ratio - DVec3::ONE).length() < 1e-11);
    close(half.bounding_radius(), direct.bounding_radius(), 1e-12);
}

#[test]
fn principal_moments_obey_the_triangle_inequality() {
    let clump = ClumpShape::from_spheres(&lopsided(), ClumpMass::Density(1.0), 1e-10).unwrap();
    let m = clump.principal_moments;
    assert!(m.x < m.y + m.z && m.y < m.z + m.x && m.z < m.x + m.y);
}

#[cfg(feature = "serde")]
#[test]
fn what_is_read_is_checked() {
    use dem_shapes::{BiconvexTablet, RingTablet, Solid};
    let tablet = coated(2.417e-3).build().unwrap();
    let text = serde_json::to_string(&tablet).unwrap();
    assert_eq!(serde_json::from_str::<RingTablet>(&text).unwrap(), tablet);
    let apart = text.replace("0.002417", "0.02417");
    let refusal = serde_json::from_str::<RingTablet>(&apart).unwrap_err().to_string();
    assert!(refusal.contains("falls apart"), "{refusal}");
    let unknown = text.replace("middle_radius", "midle_radius");
    assert!(serde_json::from_str::<RingTablet>(&unknown).is_err());
    let solid = Solid::BiconvexTablet(BiconvexTablet::new(4e-3, 2.25e-3, 9.64e-3).unwrap());
    let text = serde_json::to_string(&solid).unwrap();
    assert!(text.contains("\"biconvex_tablet\":{\"radius\":0.004"), "{text}");
    assert_eq!(serde_json::from_str::<Solid>(&text).unwrap(), solid);
    assert!(serde_json::from_str::<Solid>(&text.replace("0.00964", "0.001")).is_err());
}
