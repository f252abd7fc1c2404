//! A sphere dropped on a plane: free fall with a soft linear contact (MFIX DEM01) and bouncing in
//! the limit of hard spheres (MFIX DEM02).

use dem_core::contact::cohesion::Cohesionless;
use dem_core::contact::model::ContactModel;
use dem_core::contact::normal::{AttractiveTail, LinearTailKept, restitution::damping_ratio};
use dem_core::contact::rolling::FreeRolling;
use dem_core::contact::tangential::Frictionless;
use dem_core::glam::DVec3;
use dem_core::impact::{Body, Partner, Settings, TwoBody};

use crate::{Check, Held};

const G: f64 = 9.81;
const R: f64 = 0.1;
const START: f64 = 0.5;

const FALL: Held = Held {
    tolerance: 5e-3,
    reason: "relative to the height of fall; 1e-5 s steps, a force that jumps at first touch",
    source: "piecewise closed solution with gravity in contact (MFIX DEM01 set-up)",
};
const HARD: Held = Held {
    tolerance: 0.02,
    reason: "relative to the height of fall; kn 5e6 N/m is not quite hard: overlap and duration are left",
    source: "hard-sphere limit y_k = r + (y0 - r) e^(2k) (MFIX DEM02)",
};

/// A ball of test DEM01 about to fall.
pub(crate) fn drop(
    k: f64,
    e: f64,
    dt: f64,
) -> TwoBody<ContactModel<LinearTailKept, Frictionless, FreeRolling, Cohesionless>> {
    let zeta = damping_ratio(e, AttractiveTail::Kept).expect("the cases lie in (0, 1]");
    let model = ContactModel {
        normal: LinearTailKept { stiffness: k, damping_ratio: zeta },
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    };
    let body = Body::solid_sphere(R, 2600.0);
    TwoBody::new(model, body, Partner::Plane, START - R, Settings::new(dt)).in_gravity(DVec3::X * G)
}

/// Height of the centre at time `t` of a sphere that falls, is in contact once, and flies.
pub(crate) fn closed_height(k: f64, e: f64, t: f64) -> f64 {
    let m = Body::solid_sphere(R, 2600.0).mass;
    let zeta = damping_ratio(e, AttractiveTail::Kept).expect("the cases lie in (0, 1]");
    let t1 = (2.0 * (START - R) / G).sqrt();
    if t <= t1 {
        return START - 0.5 * G * t * t;
    }
    let v = G * t1;
    let w0 = (k / m).sqrt();
    let (b, w) = (zeta * w0, w0 * (1.0 - zeta * zeta).sqrt());
    let rest = G / (w0 * w0);
    // overlap x = rest + e^(-bs)(A cos ws + B sin ws), x(0) = 0, x'(0) = v
    let (a, c) = (-rest, (v - b * rest) / w);
    let overlap = |s: f64| rest + (-b * s).exp() * (a * (w * s).cos() + c * (w * s).sin());
    let rate = |s: f64| {
        (-b * s).exp() * ((-b * a + w * c) * (w * s).cos() - (b * c + w * a) * (w * s).sin())
    };
    // end of contact: the zero after half a period, by bisection
    let (mut low, mut high) = (0.75 * std::f64::consts::PI / w, 2.0 * std::f64::consts::PI / w);
    for _ in 0..100 {
        let mid = 0.5 * (low + high);
        if overlap(mid) > 0.0 { low = mid } else { high = mid }
    }
    let s = t - t1;
    if s <= low {
        return R - overlap(s);
    }
    let u = s - low;
    R - rate(low) * u - 0.5 * G * u * u
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    let mut checks = Vec::new();
    for k in [1e4, 2.5e4, 5e4, 1e5] {
        for e in [0.6, 0.7, 0.8, 0.9, 1.0] {
            let mut ball = drop(k, e, 1e-5);
            let case = format!("MFIX DEM01, kn = {k:e} N/m, e = {e}");
            for t in [0.2, 0.3, 0.33, 0.4, 0.5] {
                while ball.time < t - 1e-9 {
                    ball.step();
                }
                checks.push(FALL.of_scale(
                    &case,
                    format!("height at {t} s, m"),
                    closed_height(k, e, ball.time),
                    -ball.position_i.x,
                    START - R,
                ));
            }
        }
    }
    for e in [0.5, 0.6, 0.7, 0.8, 0.9, 1.0] {
        let mut ball = drop(5e6, e, 2e-6);
        for bounce in 1..=3 {
            // fall to the plane, then rise to the apex
            while ball.i.velocity.x >= 0.0 {
                ball.step();
            }
            while ball.i.velocity.x < 0.0 {
                ball.step();
            }
            checks.push(HARD.of_scale(
                format!("MFIX DEM02, kn = 5e6 N/m, e = {e}"),
                format!("apex {bounce}, m"),
                R + (START - R) * f64::powi(e, 2 * bounce),
                -ball.position_i.x,
                START - R,
            ));
        }
    }
    checks
}
