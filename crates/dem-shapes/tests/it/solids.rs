//! Exact solids: limits, independent integrals, distances.

use std::f64::consts::PI;

use dem_shapes::glam::DVec3;
use dem_shapes::solids::SolidOfRevolution;
use dem_shapes::{Ball, BiconvexTablet, FlatTablet, Solid};

use crate::close;

fn all() -> Vec<Solid> {
    vec![
        Solid::Ball(Ball::new(1.3).unwrap()),
        Solid::FlatTablet(FlatTablet::new(4.0, 2.9).unwrap()),
        Solid::BiconvexTablet(BiconvexTablet::new(4.0, 2.25, 9.64).unwrap()),
        Solid::BiconvexTablet(BiconvexTablet::new(1.0, 0.0, 1.5).unwrap()),
        Solid::BiconvexTablet(BiconvexTablet::new(1.0, 3.0, 1.0).unwrap()),
    ]
}

#[test]
fn closed_forms_agree_with_integrals_of_the_profile() {
    for solid in all() {
        let top = solid.half_height();
        let mut bounds = vec![0.0, top];
        bounds.extend(solid.edges());
        bounds.sort_by(f64::total_cmp);
        let (mut volume, mut axial, mut lever) = (0.0, 0.0, 0.0);
        // Midpoint rule, second order: 20 000 steps a smooth part leave about 1e-9.
        for part in bounds.windows(2) {
            let n = 20_000;
            let dz = (part[1] - part[0]) / f64::from(n);
            for k in 0..n {
                let z = part[0] + (f64::from(k) + 0.5) * dz;
                let w = solid.radius_at(z).powi(2);
                volume += 2.0 * PI * w * dz;
                axial += PI * w * w * dz;
                lever += 2.0 * PI * w * z * z * dz;
            }
        }
        close(solid.volume() / volume, 1.0, 1e-8);
        close(solid.inertia().z / axial, 1.0, 1e-8);
        close(solid.inertia().x / (0.5 * axial + lever), 1.0, 1e-8);
        assert_eq!(solid.inertia().x, solid.inertia().y);
    }
}

#[test]
fn biconvex_tablet_has_its_limits() {
    // Lens of a sphere: no band and the crown of the tablet itself.
    let ball = Ball::new(2.0).unwrap();
    let round = BiconvexTablet::new(2.0, 0.0, 2.0).unwrap();
    close(round.volume() / ball.volume(), 1.0, 1e-15);
    close(round.surface_area() / ball.surface_area(), 1.0, 1e-15);
    assert!((round.inertia() - ball.inertia()).length() < 1e-13);
    // Caps of a huge sphere: cap height R^2/2r.
    let flat = FlatTablet::new(2.0, 1.0).unwrap();
    let nearly = BiconvexTablet::new(2.0, 1.0, 1e9).unwrap();
    close(nearly.volume() / flat.volume(), 1.0, 1e-8);
    close(nearly.surface_area() / flat.surface_area(), 1.0, 1e-8);
    assert!((nearly.inertia() / flat.inertia() - DVec3::ONE).length() < 1e-7);
    // Capsule: ball and cylinder.
    let capsule = BiconvexTablet::new(1.0, 3.0, 1.0).unwrap();
    close(capsule.volume(), PI * 3.0 + 4.0 / 3.0 * PI, 1e-14);
    close(capsule.surface_area(), 6.0 * PI + 4.0 * PI, 1e-13);
}

#[test]
fn volume_deviation_is_that_of_numerical_derivatives() {
    let at = |r: f64, h: f64, c: f64| BiconvexTablet::new(r, h, c).unwrap().volume();
    let (r, h, c) = (4.0, 2.25, 9.64);
    let step = 1e-5;
    let slopes = [
        (at(r + step, h, c) - at(r - step, h, c)) / (2.0 * step),
        (at(r, h + step, c) - at(r, h - step, c)) / (2.0 * step),
        (at(r, h, c + step) - at(r, h, c - step)) / (2.0 * step),
    ];
    let tablet = BiconvexTablet::new(r, h, c).unwrap();
    // Central differences: rounding 1e-14 x 157 over the step.
    close(tablet.volume_sd(1.0, 0.0, 0.0).unwrap(), slopes[0].abs(), 1e-6);
    close(tablet.volume_sd(0.0, 1.0, 0.0).unwrap(), slopes[1].abs(), 1e-6);
    close(tablet.volume_sd(0.0, 0.0, 1.0).unwrap(), slopes[2].abs(), 1e-6);
    let flat = FlatTablet::new(4.0, 2.9).unwrap();
    close(flat.volume_sd(0.1, 0.0).unwrap(), 0.1 * 2.0 * PI * 4.0 * 2.9, 1e-12);
}

#[test]
fn surface_points_lie_on_the_surface_with_the_outward_normal() {
    for solid in all() {
        for k in 0..500 {
            let k = f64::from(k);
            let (p, n) = solid.surface_point((k + 0.5) / 500.0, 2.4 * k);
            close(solid.signed_distance(p), 0.0, 1e-14);
            close(n.length(), 1.0, 1e-14);
            close(solid.signed_distance(p + 0.1 * n), 0.1, 1e-13);
            // Inwards for less than half the smallest thickness and away from edges.
            let inner = solid.signed_distance(p - 1e-3 * n);
            assert!((-1e-3 - 1e-13..=0.0).contains(&inner), "{inner}");
        }
    }
}

/// The signed distance of a convex body is the largest signed distance from its supporting planes.
#[test]
fn signed_distance_is_that_of_the_supporting_planes() {
    for solid in all() {
        let planes: Vec<_> = (0..40_000)
            .map(|k| {
                solid.surface_point((f64::from(k) + 0.5) / 40_000.0, 2.399_963_2 * f64::from(k))
            })
            .collect();
        for k in 0..60 {
            let k = f64::from(k);
            let p = DVec3::new(2.5 * (1.7 * k).sin(), 2.5 * (2.9 * k).cos(), 2.0 * (0.8 * k).sin());
            let planar =
                planes.iter().map(|(q, n)| (p - *q).dot(*n)).fold(f64::NEG_INFINITY, f64::max);
            let got = solid.signed_distance(p);
            // Planes never exceed the distance; edges are outside the fan of normals, where the
            // distance is larger; inside and over smooth parts they meet it to the planes' spacing.
            assert!(planar <= got + 1e-12, "{solid:?} {p}: {planar} against {got}");
            if got < 0.0 {
                close(planar, got, 0.02);
            }
        }
    }
}

#[test]
fn shares_of_the_surface_are_shares_of_area() {
    // Band of the biconvex tablet: 2 pi R h of the whole.
    let tablet = BiconvexTablet::new(4.0, 2.25, 9.64).unwrap();
    let n = 100_000;
    let on_band = (0..n)
        .filter(|&k| {
            let (p, _) = tablet.surface_point((f64::from(k) + 0.5) / f64::from(n), 0.0);
            p.z.abs() < 0.5 * 2.25
        })
        .count();
    let share = 2.0 * PI * 4.0 * 2.25 / tablet.surface_area();
    // One sample at either end of the band.
    close(on_band as f64 / f64::from(n), share, 3e-5);
}
