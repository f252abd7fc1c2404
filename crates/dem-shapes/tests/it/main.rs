//! Integration tests of the shapes, through the public interface only.

#![expect(clippy::unwrap_used, reason = "a test's helper fails its test by panicking")]

mod aspherical;
mod bad_input;
mod clump;
mod fidelity;
mod monte_carlo;
mod solids;
mod tablets;
mod union;

use dem_shapes::glam::{DQuat, DVec3, EulerRot};
use dem_shapes::{RingTabletSpec, Sphere};

/// The coated tablet: nine spheres and a middle one.
fn coated(ring_radius: f64) -> RingTabletSpec {
    RingTabletSpec {
        ring_spheres: 9,
        ring_radius,
        sphere_radius: 1.87e-3,
        middle_radius: Some(2.3e-3),
    }
}

/// The flat tablet: ten equal spheres, nine on a ring and one in the middle.
fn flat() -> RingTabletSpec {
    RingTabletSpec {
        ring_spheres: 9,
        ring_radius: 2.5e-3,
        sphere_radius: 1.747e-3,
        middle_radius: Some(1.747e-3),
    }
}

/// A ring with a hole: ten spheres.
fn open_ring() -> RingTabletSpec {
    RingTabletSpec { ring_spheres: 10, middle_radius: None, ..flat() }
}

fn some_turn() -> DQuat {
    DQuat::from_euler(EulerRot::XYZ, 0.7, -1.1, 2.3)
}

fn moved(spheres: &[Sphere], turn: DQuat, shift: DVec3) -> Vec<Sphere> {
    spheres.iter().map(|s| Sphere::new(turn * s.center + shift, s.radius)).collect()
}

#[track_caller]
fn close(got: f64, expected: f64, tolerance: f64) {
    assert!(
        (got - expected).abs() <= tolerance,
        "{got:e} against {expected:e}, off by {:e}",
        got - expected
    );
}
