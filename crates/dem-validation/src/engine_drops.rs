//! The engine on drops and squeezes: MFIX DEM01 to DEM03 through public world, lists and walls.

use dem_core::contact::normal::{AttractiveTail, LinearTailKept, restitution::damping_ratio};
use dem_core::prelude::*;

use crate::{Check, Held};

type Linear = ContactModel<LinearTailKept, Frictionless, FreeRolling, Cohesionless>;

const G: f64 = 9.81;

const HARD: Held = Held {
    tolerance: 0.02,
    reason: "relative to the height of fall; kn 5e6 N/m is not quite hard: overlap and duration are left",
    source: "hard-sphere limit y_k = r + (y0 - r) e^(2k) (MFIX DEM02)",
};
const FALL: Held = Held {
    tolerance: 5e-3,
    reason: "relative to the height of fall; 1e-5 s steps, a force that jumps at first touch",
    source: "integration of the piecewise equation by Runge-Kutta 4 at 1e-7 s (MFIX DEM01 set-up)",
};
const SQUEEZE: Held = Held {
    tolerance: 5e-3,
    reason: "relative to the radius; second order at 500 steps a period, contacts that open within a step",
    source: "integration of both equations by Runge-Kutta 4 at 1e-8 s (MFIX DEM03 set-up)",
};

fn linear(stiffness: f64, e: f64) -> Linear {
    ContactModel {
        normal: LinearTailKept {
            stiffness,
            damping_ratio: damping_ratio(e, AttractiveTail::Kept).expect("cases lie in (0, 1]"),
        },
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    }
}

/// Force of the linear law, N.
fn force(k: f64, e: f64, mass: f64, overlap: f64, rate: f64) -> f64 {
    let zeta = damping_ratio(e, AttractiveTail::Kept).expect("cases lie in (0, 1]");
    if overlap > 0.0 { k * overlap + 2.0 * zeta * (k * mass).sqrt() * rate } else { 0.0 }
}

/// One step of Runge-Kutta 4 for `y'' = a(y, y')`.
fn rk4<const N: usize>(
    y: &mut [f64; N],
    v: &mut [f64; N],
    dt: f64,
    a: impl Fn(&[f64; N], &[f64; N]) -> [f64; N],
) {
    let add = |x: &[f64; N], d: &[f64; N], s: f64| -> [f64; N] {
        std::array::from_fn(|k| x[k] + s * d[k])
    };
    let (v1, a1) = (*v, a(y, v));
    let v2 = add(v, &a1, 0.5 * dt);
    let a2 = a(&add(y, &v1, 0.5 * dt), &v2);
    let v3 = add(v, &a2, 0.5 * dt);
    let a3 = a(&add(y, &v2, 0.5 * dt), &v3);
    let v4 = add(v, &a3, dt);
    let a4 = a(&add(y, &v3, dt), &v4);
    for k in 0..N {
        y[k] += dt / 6.0 * (v1[k] + 2.0 * v2[k] + 2.0 * v3[k] + v4[k]);
        v[k] += dt / 6.0 * (a1[k] + 2.0 * a2[k] + 2.0 * a3[k] + a4[k]);
    }
}

fn material(density: f64) -> Material {
    Material { youngs_modulus: 1e7, poisson_ratio: 0.3, density }
}

fn ball(k: f64, e: f64, dt: f64) -> (World<Linear>, ParticleId) {
    let mut b = WorldBuilder::new(dt);
    let m = b.material(material(2600.0));
    b.pair_law(m, m, linear(k, e)).gravity(DVec3::NEG_Z * G);
    // The softest of these springs is pressed in by nine tenths of the radius.
    b.domain(DVec3::splat(-1.0), DVec3::splat(1.0)).largest_overlap(1.2);
    b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m));
    let id = b.sphere(Sphere::at(DVec3::Z * 0.5, 0.1, m));
    (b.build().expect("a valid case"), id)
}

fn free_fall(checks: &mut Vec<Check>) {
    let mass = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-3;
    for (k, e) in [(1e4, 0.6), (1e4, 1.0), (1e5, 0.8)] {
        let (mut world, id) = ball(k, e, 1e-5);
        let (mut y, mut v) = ([0.5], [0.0]);
        for tenth in 1..=5 {
            world.run(10_000).expect("no fault");
            for _ in 0..1_000_000 {
                rk4(&mut y, &mut v, 1e-7, |y, v| [force(k, e, mass, 0.1 - y[0], -v[0]) / mass - G]);
            }
            checks.push(FALL.of_scale(
                format!("engine, MFIX DEM01, kn = {k:e} N/m, e = {e}"),
                format!("height at 0.{tenth} s, m"),
                y[0],
                world.position(id).z,
                0.4,
            ));
        }
    }
}

fn bouncing(checks: &mut Vec<Check>) {
    for e in [0.5, 0.8, 1.0] {
        let (mut world, id) = ball(5e6, e, 2e-6);
        for bounce in 1..=3 {
            while world.velocity(id).z <= 0.0 {
                world.run(1).expect("no fault");
            }
            while world.velocity(id).z > 0.0 {
                world.run(1).expect("no fault");
            }
            checks.push(HARD.of_scale(
                format!("engine, MFIX DEM02, kn = 5e6 N/m, e = {e}"),
                format!("apex {bounce}, m"),
                0.1 + 0.4 * f64::powi(e, 2 * bounce),
                world.position(id).z,
                0.4,
            ));
        }
    }
}

fn stacked(checks: &mut Vec<Check>) {
    let (r, k, top) = (0.5e-3, 1e3, 1.8e-3);
    let mass = [2e4, 1e4].map(|rho| rho * 4.0 / 3.0 * std::f64::consts::PI * r * r * r);
    let both = mass[0] * mass[1] / (mass[0] + mass[1]);
    for e in [0.5, 0.75, 1.0] {
        let dt = 2e-7;
        let mut b = WorldBuilder::new(dt);
        let (lower, upper) = (b.material(material(2e4)), b.material(material(1e4)));
        for (a, c) in [(lower, lower), (lower, upper), (upper, upper)] {
            b.pair_law(a, c, linear(k, e));
        }
        b.gravity(DVec3::NEG_Z * G).domain(DVec3::splat(-0.01), DVec3::splat(0.01));
        b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, lower));
        b.wall(Wall::plane(DVec3::Z * top, DVec3::NEG_Z, upper));
        let ids = [
            b.sphere(Sphere::at(DVec3::Z * 0.45e-3, r, lower)),
            b.sphere(Sphere::at(DVec3::Z * 1.35e-3, r, upper)),
        ];
        let mut world = b.build().expect("a valid case");
        let (mut y, mut v) = ([0.45e-3, 1.35e-3], [0.0; 2]);
        for part in 1..=5 {
            world.run(1000).expect("no fault");
            for _ in 0..20_000 {
                rk4(&mut y, &mut v, 1e-8, |y, v| {
                    let floor = force(k, e, mass[0], r - y[0], -v[0]);
                    let middle = force(k, e, both, 2.0 * r - (y[1] - y[0]), v[0] - v[1]);
                    let lid = force(k, e, mass[1], r - (top - y[1]), v[1]);
                    [(floor - middle) / mass[0] - G, (middle - lid) / mass[1] - G]
                });
            }
            for (nth, id) in ids.into_iter().enumerate() {
                checks.push(SQUEEZE.of_scale(
                    format!("engine, MFIX DEM03, two stacked spheres, e = {e}"),
                    format!("height of sphere {} at 0.{} ms, m", nth + 1, 2 * part),
                    y[nth],
                    world.position(id).z,
                    r,
                ));
            }
        }
    }
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    let mut checks = Vec::new();
    free_fall(&mut checks);
    bouncing(&mut checks);
    stacked(&mut checks);
    checks
}
