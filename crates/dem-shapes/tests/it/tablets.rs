//! The tablets whose dimensions and volumes are printed in the reference study (its Table 6), with
//! the volumes recomputed from those dimensions.

use std::f64::consts::PI;

use dem_shapes::glam::{DQuat, DVec3};
use dem_shapes::solids::SolidOfRevolution;
use dem_shapes::{Ball, BiconvexTablet, ClumpMass, FlatTablet, RingTabletSpec};

use crate::{close, coated, flat, open_ring};

#[test]
fn flat_tablet_of_ten_spheres_has_its_recomputed_volume() {
    let volume = flat().build().unwrap().union().unwrap().volume * 1e9;
    // An earlier Monte Carlo gave 145.43 +- 0.06.
    close(volume, 145.43, 0.06);
    // Printed: 145.67 +- 0.5.
    close(volume, 145.67, 0.5);
}

/// The ten spheres of the study include the middle one: with all ten on the ring the printed volume
/// is missed by 7 mm3, and an eleventh in the middle exceeds it by 2.4 mm3.
#[test]
fn flat_tablet_needs_its_middle_sphere_among_the_ten() {
    let ten_and_one = RingTabletSpec { ring_spheres: 10, ..flat() };
    for (spec, off) in [(open_ring(), -7.2), (ten_and_one, 2.4)] {
        let volume = spec.build().unwrap().union().unwrap().volume * 1e9;
        // The last digit of the statement above.
        close(volume - 145.67, off, 0.05);
    }
}

#[test]
fn coated_tablet_has_its_recomputed_volumes_on_three_rings() {
    for (ring, volume) in [(2.5e-3, 173.0), (2.33e-3, 160.6), (2.417e-3, 167.03)] {
        let got = coated(ring).build().unwrap().union().unwrap().volume * 1e9;
        // They come from a Monte Carlo of standard error 0.06, the first two to one digit.
        close(got, volume, 0.07);
    }
}

/// All centres lie in one plane, so a tablet is a height field, twice the integral over the plane of
/// the largest `sqrt(r^2 - d^2)`: an integral that shares nothing with the sections.
#[test]
fn tablets_agree_with_the_integral_of_their_height() {
    for spec in [flat(), open_ring(), coated(2.5e-3), coated(2.33e-3), coated(2.417e-3)] {
        let tablet = spec.build().unwrap();
        let spheres = tablet.spheres();
        let outer = spec.ring_radius + spec.sphere_radius;
        // Half a sector, midpoint rule in both directions.
        let sector = PI / spec.ring_spheres as f64;
        let (n_angle, n_radius) = (300, 3000);
        let mut sum = 0.0;
        for i in 0..n_angle {
            let angle = sector * (f64::from(i) + 0.5) / f64::from(n_angle);
            for j in 0..n_radius {
                let rho = outer * (f64::from(j) + 0.5) / f64::from(n_radius);
                let p = DVec3::new(rho * angle.cos(), rho * angle.sin(), 0.0);
                let square = spheres
                    .iter()
                    .map(|s| s.radius * s.radius - p.distance_squared(s.center))
                    .fold(0.0, f64::max);
                sum += rho * square.sqrt();
            }
        }
        let cell = sector / f64::from(n_angle) * outer / f64::from(n_radius);
        let volume = 4.0 * spec.ring_spheres as f64 * sum * cell;
        // Roots at the outline leave (1/3000)^1.5 = 6e-6 of the midpoint rule.
        close(tablet.union().unwrap().volume / volume, 1.0, 1e-5);
    }
}

#[test]
fn ring_for_the_printed_volume_of_the_coated_tablet_is_2_418_mm() {
    let fitted = coated(1.0).with_union_volume(167.03e-9).unwrap();
    // By the integral of the height, 2.4179 mm gives 167.030 mm3.
    close(fitted.ring_radius, 2.4179e-3, 0.05e-6);
    // An earlier Monte Carlo said 2.417; its error of 0.06 mm3 is 0.8 um of the ring.
    close(fitted.ring_radius, 2.417e-3, 1e-6);
    let volume = fitted.build().unwrap().union().unwrap().volume;
    // The integration's tolerance, 1e-10 of the largest sphere.
    close(volume, 167.03e-9, 1e-17);
}

#[test]
fn solver_returns_the_ring_it_was_given() {
    for spec in [flat(), open_ring(), coated(2.2e-3), coated(3.1e-3)] {
        let volume = spec.build().unwrap().union().unwrap().volume;
        let fitted = spec.with_union_volume(volume).unwrap();
        // Volume error 1e-10 over a slope of about twice the relative ring.
        close(fitted.ring_radius / spec.ring_radius, 1.0, 1e-9);
    }
}

#[test]
fn analytic_volumes_and_deviations_follow_from_the_printed_dimensions() {
    // Half of the last digit.
    let half = 0.005e-9;
    let biconvex = BiconvexTablet::new(4.00e-3, 2.25e-3, 9.64e-3).unwrap();
    close(biconvex.volume(), 157.47e-9, half);
    close(biconvex.volume_sd(0.03e-3, 0.05e-3, 0.47e-3).unwrap(), 4.66e-9, half);
    close(biconvex.cap_height(), 0.869e-3, 0.5e-6);
    let flat = FlatTablet::new(4.00e-3, 2.90e-3).unwrap();
    close(flat.volume(), 145.77e-9, half);
    close(flat.volume_sd(0.01e-3, 0.04e-3).unwrap(), 2.14e-9, half);
    let bead = Ball::new(3e-3).unwrap();
    close(bead.volume(), 113.10e-9, half);
    // 3.0 +- 0.3 mm: a tenth of the radius is three tenths of the volume.
    close(bead.volume_sd(0.3e-3).unwrap(), 0.3 * bead.volume(), 1e-22);
}

#[test]
fn ring_from_the_outer_radius_is_the_tablet_less_the_sphere() {
    // The construction's own figures: outer radius 4.2 mm, sphere radius 1.7 mm, nine spheres.
    let spec = RingTabletSpec::from_outer_radius(9, 4.2e-3, 1.7e-3, None);
    close(spec.ring_radius, 2.5e-3, 1e-18);
    let reach = spec
        .build()
        .unwrap()
        .spheres()
        .iter()
        .map(|s| s.center.length() + s.radius)
        .fold(0.0, f64::max);
    close(reach, 4.2e-3, 1e-17);
}

#[test]
fn tablet_clump_keeps_the_axes_of_the_tablet_and_is_a_symmetric_top() {
    for spec in [flat(), open_ring(), coated(2.417e-3)] {
        let clump = spec.build().unwrap().clump(ClumpMass::Total(0.225e-3)).unwrap();
        assert_eq!(clump.axes, DQuat::IDENTITY);
        let m = clump.principal_moments;
        // The quadrature's tolerance.
        close(m.x / m.y, 1.0, 1e-9);
        assert!(m.z > 1.3 * m.x, "a tablet is flat: {m}");
        assert_eq!(clump.mass, 0.225e-3);
        close(clump.centroid.length(), 0.0, 1e-12);
    }
}

#[test]
fn groove_at_the_rim_is_what_the_spheres_leave() {
    let tablet = flat().build().unwrap();
    let spheres = tablet.spheres();
    // March inwards along the bisector of two neighbours until the first sphere is met.
    let angle = PI / 9.0;
    let direction = DVec3::new(angle.cos(), angle.sin(), 0.0);
    let (mut low, mut high) = (0.0, 10e-3);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        let inside =
            middle < 1e-3 || spheres.iter().any(|s| s.signed_distance(middle * direction) < 0.0);
        if inside { low = middle } else { high = middle }
    }
    close(tablet.rim_groove_depth().unwrap(), 2.5e-3 + 1.747e-3 - low, 1e-15);
}
