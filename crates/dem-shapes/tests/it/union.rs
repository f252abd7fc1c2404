//! Moments of unions against closed forms and invariances.

use std::f64::consts::PI;

use dem_shapes::glam::{DMat3, DVec3};
use dem_shapes::{Sphere, UnionProperties, union_properties};
use proptest::prelude::*;

use crate::{close, coated, flat, moved, open_ring, some_turn};

const TOLERANCE: f64 = 1e-10;

fn union(spheres: &[Sphere]) -> UnionProperties {
    union_properties(spheres, TOLERANCE).unwrap()
}

/// Lens of two spheres `d` apart.
fn lens(r: f64, s: f64, d: f64) -> f64 {
    let sum = r + s - d;
    PI * sum * sum * (d * d + 2.0 * d * (r + s) - 3.0 * (r - s).powi(2)) / (12.0 * d)
}

#[test]
fn one_sphere_has_the_moments_of_a_ball() {
    let center = DVec3::new(3.0, -7.0, 2.0);
    let r = 1.7;
    let u = union(&[Sphere::new(center, r)]);
    let volume = 4.0 / 3.0 * PI * r.powi(3);
    close(u.volume / volume, 1.0, 1e-13);
    close(u.surface_area / (4.0 * PI * r * r), 1.0, 1e-13);
    assert!(u.centroid.abs_diff_eq(center, 1e-13));
    let inertia = DMat3::from_diagonal(DVec3::splat(0.4 * volume * r * r));
    assert!(u.inertia.abs_diff_eq(inertia, 1e-12));
    close(u.sphericity(), 1.0, 1e-13);
}

#[test]
fn two_unequal_spheres_lack_their_lens_in_any_direction() {
    let (r, s) = (1.0, 0.6);
    for direction in [DVec3::X, DVec3::Z, DVec3::new(0.3, -0.5, 0.8).normalize()] {
        for d in [0.41, 0.5, 0.8, 1.0, 1.3, 1.59, 1.6, 1.7] {
            let u = union(&[Sphere::new(DVec3::ZERO, r), Sphere::new(d * direction, s)]);
            let both = 4.0 / 3.0 * PI * (r.powi(3) + s.powi(3));
            let shared = if d < r + s { lens(r, s, d) } else { 0.0 };
            close(u.volume, both - shared, 1e-10);
            // Caps that are hidden: heights h1, h2 of the lens on either side of its plane.
            let plane = (d * d + r * r - s * s) / (2.0 * d);
            let hidden =
                if d < r + s { 2.0 * PI * (r * (r - plane) + s * (s - (d - plane))) } else { 0.0 };
            close(u.surface_area, 4.0 * PI * (r * r + s * s) - hidden, 1e-9);
        }
    }
}

/// A dumbbell of unit spheres at `+-a` on x is two mirrored truncated balls: polynomials in x.
#[test]
fn dumbbell_has_its_closed_form_inertia() {
    for a in [0.05, 0.3, 0.5, 0.9, 1.0_f64] {
        // Over x from 0 to 1 + a of the section's radius squared w = 1 - (x - a)^2 = k0 + 2 a x - x^2.
        let k0 = 1.0 - a * a;
        let end = 1.0 + a;
        let power = |n: i32| end.powi(n) / f64::from(n);
        let w1 = |shift: i32| k0 * power(1 + shift) + 2.0 * a * power(2 + shift) - power(3 + shift);
        let w2 = k0 * k0 * power(1) + 4.0 * a * k0 * power(2) + (4.0 * a * a - 2.0 * k0) * power(3)
            - 4.0 * a * power(4)
            + power(5);
        let (volume, axial) = (2.0 * PI * w1(0), PI * w2);
        let across = 0.5 * axial + 2.0 * PI * w1(2);
        let u = union(&[Sphere::new(-a * DVec3::X, 1.0), Sphere::new(a * DVec3::X, 1.0)]);
        // The tolerance asked for, times moments of order ten.
        close(u.volume, volume, 1e-9);
        close(u.inertia.x_axis.x, axial, 1e-9);
        close(u.inertia.y_axis.y, across, 1e-9);
        close(u.inertia.z_axis.z, across, 1e-9);
        close(u.centroid.length(), 0.0, 1e-10);
    }
}

#[test]
fn three_spheres_through_one_another_obey_inclusion_and_exclusion() {
    // Unit spheres at the corners of a unit triangle. Common volume of three (Powell, Mol. Phys. 7
    // (1964) 591, for equal spheres at side r): from pairs and the integral below.
    let corners = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.75_f64.sqrt(), 0.0)];
    let triple: Vec<_> = corners.iter().map(|&c| Sphere::new(c, 1.0)).collect();
    // Sections at height z: three discs of radius s at unit distance; their common area is the
    // Reuleaux-like figure below, which ends where s = 1/sqrt(3).
    let common_area = |z: f64| {
        let s = (1.0 - z * z).sqrt();
        // Distance of the corners of the common figure, and the angle each arc spans.
        let reach = (s * s - 0.25).sqrt();
        let across = reach - 0.75_f64.sqrt() / 3.0;
        let side = 3.0_f64.sqrt() * across;
        let half = (side / (2.0 * s)).asin();
        0.75_f64.sqrt() / 2.0 * side * side + 3.0 * s * s * (half - half.sin() * half.cos())
    };
    let top = (2.0_f64 / 3.0).sqrt();
    // Simpson in z = top sin(t): the integrand is smooth in t, so 2000 panels are exact to 1e-12.
    let n = 2000;
    let f = |k: usize| {
        let t = 0.5 * PI * k as f64 / n as f64;
        // At the end the figure vanishes.
        if k == n { 0.0 } else { common_area(top * t.sin()) * top * t.cos() }
    };
    let sum: f64 = (0..=n)
        .map(|k| {
            f(k) * if k == 0 || k == n {
                1.0
            } else if k % 2 == 1 {
                4.0
            } else {
                2.0
            }
        })
        .sum();
    let common = 2.0 * sum * (0.5 * PI / n as f64) / 3.0;
    let expected = 4.0 * PI - 3.0 * lens(1.0, 1.0, 1.0) + common;
    close(union(&triple).volume, expected, 1e-9);
}

#[test]
fn turning_and_moving_a_tablet_turns_and_moves_its_moments() {
    for spec in [flat(), open_ring(), coated(2.417e-3)] {
        let spheres = spec.build().unwrap().spheres();
        let here = union(&spheres);
        for k in 1..=5 {
            let turn = some_turn() * some_turn() * f64::from(k);
            let turn = turn.normalize();
            let shift = DVec3::new(0.02, -0.01, 0.05);
            let there = union(&moved(&spheres, turn, shift));
            close(there.volume / here.volume, 1.0, 1e-9);
            close(there.surface_area / here.surface_area, 1.0, 1e-9);
            assert!(there.centroid.abs_diff_eq(turn * here.centroid + shift, 1e-12));
            let r = DMat3::from_quat(turn);
            let turned = r * here.inertia * r.transpose();
            assert!(there.inertia.abs_diff_eq(turned, 1e-9 * here.inertia.x_axis.x));
        }
    }
}

#[test]
fn duplicates_and_contained_spheres_change_nothing() {
    let spheres = coated(2.417e-3).build().unwrap().spheres();
    let here = union(&spheres);
    let mut doubled = spheres.clone();
    doubled.extend(spheres.iter().copied());
    assert_eq!(union(&doubled), here);
    let mut filled = spheres.clone();
    filled.push(Sphere::new(DVec3::new(0.3e-3, 0.1e-3, 0.0), 1.5e-3));
    // Touches the middle sphere from inside.
    filled.push(Sphere::new(DVec3::new(0.0, 0.0, 1.3e-3), 1.0e-3));
    assert_eq!(union(&filled), here);
}

#[test]
fn nearly_equal_spheres_count_once() {
    for shift in [1e-16, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8, 1e-6] {
        let direction = DVec3::new(0.6, 0.48, 0.64);
        let u = union(&[
            Sphere::new(DVec3::ZERO, 1.0),
            Sphere::new(shift * direction, 1.0),
            Sphere::new(0.9 * DVec3::X, 1.0),
        ]);
        let exact = 8.0 / 3.0 * PI - lens(1.0, 1.0, 0.9);
        // The union grows by at most half a sphere's surface, projected: pi times the shift.
        close(u.volume, exact, 1e-9 + PI * shift);
    }
}

#[test]
fn spheres_apart_add_up() {
    let spheres = [
        Sphere::new(DVec3::ZERO, 1.0),
        Sphere::new(DVec3::new(3.0, 1.0, 0.5), 0.7),
        Sphere::new(DVec3::new(-1.0, 4.0, 9.0), 1.4),
        // Touches the first.
        Sphere::new(DVec3::new(0.0, 0.0, -1.5), 0.5),
    ];
    let u = union(&spheres);
    let volume: f64 = spheres.iter().map(Sphere::volume).sum();
    close(u.volume / volume, 1.0, 1e-10);
    let centroid =
        spheres.iter().map(|s| s.center * s.volume()).fold(DVec3::ZERO, |a, b| a + b) / volume;
    assert!(u.centroid.abs_diff_eq(centroid, 1e-9));
    let mut inertia = DMat3::ZERO;
    for s in &spheres {
        let d = s.center - centroid;
        let own = DMat3::from_diagonal(DVec3::splat(0.4 * s.radius * s.radius + d.dot(d)));
        let outer = DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        inertia += (own - outer) * s.volume();
    }
    assert!(u.inertia.abs_diff_eq(inertia, 1e-7), "{} {inertia}", u.inertia);
}

#[test]
fn tangent_and_coincident_patterns_are_handled() {
    // Inside tangency, outside tangency, three through one line, four on a square through one
    // point, a column of spheres whose circles are level, rings whose heights all coincide.
    let line = |z: f64| Sphere::new(DVec3::new(0.0, 0.0, z), 1.0);
    close(
        union(&[Sphere::new(DVec3::ZERO, 1.0), Sphere::new(DVec3::X * 0.5, 0.5)]).volume,
        4.0 / 3.0 * PI,
        1e-10,
    );
    close(
        union(&[line(0.0), line(0.5), line(1.0)]).volume,
        4.0 * PI - 2.0 * lens(1.0, 1.0, 0.5),
        1e-10,
    );
    let square = [DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y].map(|c| Sphere::new(c, 1.0));
    // All four touch the origin only in pairs' lenses: opposite ones are tangent there.
    close(union(&square).volume, 16.0 / 3.0 * PI - 4.0 * lens(1.0, 1.0, 2.0_f64.sqrt()), 1e-9);
    let cube: Vec<_> = (0..8)
        .map(|k| {
            let at = |bit: i32| if k & bit == 0 { -1.0 } else { 1.0 };
            Sphere::new(DVec3::new(at(1), at(2), at(4)), 1.2)
        })
        .collect();
    // Twelve edges overlap; faces' diagonals (2.83 apart) do not.
    close(
        union(&cube).volume,
        8.0 * 4.0 / 3.0 * PI * 1.2_f64.powi(3) - 12.0 * lens(1.2, 1.2, 2.0),
        1e-9,
    );
}

#[test]
fn estimated_error_holds_and_falls_with_the_tolerance() {
    let spheres = moved(&flat().build().unwrap().spheres(), some_turn(), DVec3::ZERO);
    let best = union_properties(&spheres, 1e-12).unwrap().volume;
    let largest = spheres[0].volume();
    for tolerance in [1e-3, 1e-5, 1e-7, 1e-9, 1e-11] {
        let u = union_properties(&spheres, tolerance).unwrap();
        close(u.volume, best, tolerance * largest);
        assert!(u.volume_error <= tolerance * largest);
    }
}

#[test]
fn size_of_the_unit_does_not_matter() {
    let spheres = coated(2.417e-3).build().unwrap().spheres();
    let here = union(&spheres);
    for scale in [1e-9, 1e-3, 1e6, 1e20] {
        let scaled: Vec<_> =
            spheres.iter().map(|s| Sphere::new(s.center * scale, s.radius * scale)).collect();
        let there = union(&scaled);
        // Rounding in the scaling itself.
        close(there.volume / here.volume / scale.powi(3), 1.0, 1e-12);
        let ratio = there.inertia.z_axis.z / here.inertia.z_axis.z / scale.powi(5);
        close(ratio, 1.0, 1e-12);
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    #[test]
    fn union_is_bounded_and_turns_with_its_spheres(
        raw in prop::collection::vec((-1.0..1.0, -1.0..1.0, -1.0..1.0, 0.1..1.0), 1..9),
        angles in (0.0..6.0, -1.5..1.5, 0.0..6.0),
    ) {
        let spheres: Vec<_> = raw
            .iter()
            .map(|&(x, y, z, r): &(f64, f64, f64, f64)| Sphere::new(DVec3::new(x, y, z), r))
            .collect();
        let here = union(&spheres);
        let largest = spheres.iter().map(Sphere::volume).fold(0.0, f64::max);
        let total: f64 = spheres.iter().map(Sphere::volume).sum();
        prop_assert!(here.volume > largest * (1.0 - 1e-9) && here.volume < total * (1.0 + 1e-9));
        // A ball has the least surface for its volume.
        prop_assert!(here.sphericity() < 1.0 + 1e-9);
        let turn = dem_shapes::glam::DQuat::from_euler(
            dem_shapes::glam::EulerRot::ZYX, angles.0, angles.1, angles.2);
        let there = union(&moved(&spheres, turn, DVec3::ZERO));
        // The tolerance of both, relative to the largest sphere; surface error is three volumes'.
        prop_assert!((there.volume - here.volume).abs() < 4.0 * TOLERANCE * largest);
        prop_assert!((there.surface_area - here.surface_area).abs() < 1e-8);
        let r = DMat3::from_quat(turn);
        prop_assert!(there.inertia.abs_diff_eq(r * here.inertia * r.transpose(), 1e-8));
    }

    /// Centres on a lattice and radii of a few sizes make every coincidence there is (tangent,
    /// concentric, four through a point); a jitter of any size makes them near misses.
    #[test]
    fn coincidences_and_near_misses_are_met(
        raw in prop::collection::vec((0..3_i32, 0..3_i32, 0..3_i32, 1..5_i32), 1..12),
        jitter in prop::collection::vec((-1.0..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0), 12),
        power in -17..-2_i32,
    ) {
        let size = 10.0_f64.powi(power);
        let exact: Vec<_> = raw
            .iter()
            .map(|&(x, y, z, r)| {
                let at = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * 0.5;
                Sphere::new(at, f64::from(r) * 0.25)
            })
            .collect();
        let near: Vec<_> = exact
            .iter()
            .zip(&jitter)
            .map(|(s, &(x, y, z, r)): (&Sphere, &(f64, f64, f64, f64))| {
                Sphere::new(s.center + size * DVec3::new(x, y, z), s.radius + size * r)
            })
            .collect();
        let (there, here) = (union(&near), union(&exact));
        // A surface of at most 12 x 4 pi moves by at most 1.8 + 1 times the jitter.
        let bound = 420.0 * size + 1e-9;
        prop_assert!((there.volume - here.volume).abs() < bound);
        // However the pattern lies to the sections: the tolerances of both.
        let turned = union(&moved(&near, some_turn(), DVec3::ZERO));
        prop_assert!((turned.volume - there.volume).abs() < 1e-9);
        prop_assert!((turned.surface_area - there.surface_area).abs() < 1e-8);
    }

    #[test]
    fn one_more_sphere_never_takes_volume_away(
        raw in prop::collection::vec((-1.0..1.0, -1.0..1.0, -1.0..1.0, 0.1..1.0), 2..9),
    ) {
        let spheres: Vec<_> = raw
            .iter()
            .map(|&(x, y, z, r): &(f64, f64, f64, f64)| Sphere::new(DVec3::new(x, y, z), r))
            .collect();
        let without = union(&spheres[1..]).volume;
        let with = union(&spheres).volume;
        prop_assert!(with > without - 1e-9);
        prop_assert!(with < without + spheres[0].volume() + 1e-9);
    }
}
