//! Aspherical particles: constant volume, the form that was asked for, continuous to the ball.

use std::f64::consts::PI;

use dem_shapes::glam::DVec3;
use dem_shapes::{AsphericalKind, ClumpMass, ClumpShape, aspherical_clump};

use crate::close;

const KINDS: [AsphericalKind; 3] =
    [AsphericalKind::Dumbbell, AsphericalKind::Rod, AsphericalKind::Trefoil];

fn clump(kind: AsphericalKind, aspect: f64) -> ClumpShape {
    aspherical_clump(kind, aspect, 3e-3, ClumpMass::Density(2500.0)).unwrap()
}

/// Largest extent along a direction.
fn width(c: &ClumpShape, direction: DVec3) -> f64 {
    let reach = |d: DVec3| {
        c.spheres.iter().map(|s| s.center.dot(d) + s.radius).fold(f64::NEG_INFINITY, f64::max)
    };
    reach(direction) + reach(-direction)
}

#[test]
fn volume_and_mass_are_those_of_the_ball_for_every_aspect_ratio() {
    let ball = 4.0 / 3.0 * PI * 27e-9;
    for kind in KINDS {
        for k in 0..=10 {
            let aspect = 1.0 + (kind.largest_aspect_ratio() - 1.0) * f64::from(k) / 10.0;
            let c = clump(kind, aspect);
            // Two integrations at 1e-10.
            close(c.volume / ball, 1.0, 1e-9);
            close(c.mass, 2500.0 * ball, 1e-12);
            close(c.equivalent_radius(), 3e-3, 1e-12);
        }
    }
}

#[test]
fn aspect_ratio_is_length_over_width() {
    for aspect in [1.01, 1.1, 1.5, 2.0] {
        let c = clump(AsphericalKind::Dumbbell, aspect);
        close(width(&c, DVec3::X) / width(&c, DVec3::Y), aspect, 1e-12);
        let c = clump(AsphericalKind::Rod, aspect);
        close(width(&c, DVec3::X) / width(&c, DVec3::Z), aspect, 1e-12);
        let c = clump(AsphericalKind::Trefoil, aspect);
        close(2.0 * c.bounding_radius() / width(&c, DVec3::Z), aspect, 1e-9);
    }
}

#[test]
fn sphere_radius_of_the_dumbbell_is_its_closed_form() {
    for aspect in [1.05_f64, 1.3, 1.8] {
        let d = 2.0 * (aspect - 1.0);
        let lens = PI * (2.0 - d) * (2.0 - d) * (4.0 + d) / 12.0;
        let unit = 8.0 / 3.0 * PI - lens;
        let radius = 3e-3 * (4.0 / 3.0 * PI / unit).cbrt();
        close(clump(AsphericalKind::Dumbbell, aspect).spheres[0].radius, radius, 1e-12);
        // A rod of three is two lenses of neighbours short.
        let d = aspect - 1.0;
        let lens = PI * (2.0 - d) * (2.0 - d) * (4.0 + d) / 12.0;
        let radius = 3e-3 * (4.0 / 3.0 * PI / (4.0 * PI - 2.0 * lens)).cbrt();
        close(clump(AsphericalKind::Rod, aspect).spheres[0].radius, radius, 1e-12);
    }
}

#[test]
fn elongated_ones_turn_easiest_about_x_and_flat_ones_hardest_about_z() {
    for aspect in [1.02, 1.2, 1.6] {
        for kind in [AsphericalKind::Dumbbell, AsphericalKind::Rod] {
            let m = clump(kind, aspect).principal_moments;
            assert!(m.x < m.y && (m.y / m.z - 1.0).abs() < 1e-8, "{m}");
        }
        let m = clump(AsphericalKind::Trefoil, aspect).principal_moments;
        assert!(m.z > m.x && (m.x / m.y - 1.0).abs() < 1e-8, "{m}");
    }
}

#[test]
fn family_is_continuous_to_the_ball() {
    let ball = 0.4 * 2500.0 * 4.0 / 3.0 * PI * 27e-9 * 9e-6;
    for kind in KINDS {
        assert_eq!(clump(kind, 1.0).spheres.len(), 1);
        for small in [1e-12, 1e-9, 1e-6, 1e-3] {
            let c = clump(kind, 1.0 + small);
            let off = (c.principal_moments / ball - DVec3::ONE).length();
            // The moments change in proportion to the deviation, with a factor below three.
            assert!(off < 3.0 * small + 1e-8, "{kind:?} {small}: {off}");
            assert!(c.sphericity_is_at_most_one());
        }
    }
}

trait AtMostOne {
    fn sphericity_is_at_most_one(&self) -> bool;
}

impl AtMostOne for ClumpShape {
    fn sphericity_is_at_most_one(&self) -> bool {
        let ball = 4.0 * PI * self.equivalent_radius().powi(2);
        ball / self.surface_area < 1.0 + 1e-9
    }
}
