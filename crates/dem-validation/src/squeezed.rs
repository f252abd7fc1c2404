//! Two stacked spheres squeezed between walls (MFIX DEM03): paths to draw, in the engine and by a
//! scalar Runge-Kutta integration. `engine_drops` has the checks.

use dem_core::contact::normal::LinearTailKept;
use dem_core::contact::normal::restitution::{AttractiveTail, damping_ratio};
use dem_core::prelude::*;

const R: f64 = 0.5e-3;
const GAP: f64 = 1.8e-3;
const START: [f64; 2] = [0.45e-3, 1.35e-3];
const RHO: [f64; 2] = [2e4, 1e4];
const K: f64 = 1e3;
const G: f64 = 9.81;

fn masses() -> [f64; 2] {
    RHO.map(|rho| rho * 4.0 / 3.0 * std::f64::consts::PI * R.powi(3))
}

fn zeta(e: f64) -> f64 {
    damping_ratio(e, AttractiveTail::Kept).expect("restitutions of the case lie in (0, 1]")
}

/// Heights of both centres (m) at `times` (s) by a fourth-order Runge-Kutta integration.
pub(crate) fn reference(e: f64, times: &[f64]) -> Vec<[f64; 2]> {
    let [m1, m2] = masses();
    // force of a linear contact that keeps its tail; nothing across a gap
    let contact = |overlap: f64, rate: f64, m: f64| {
        if overlap > 0.0 { K * overlap + 2.0 * zeta(e) * (K * m).sqrt() * rate } else { 0.0 }
    };
    let rates = |y: [f64; 4]| {
        let [y1, y2, v1, v2] = y;
        let floor = contact(R - y1, -v1, m1);
        let pair = contact(2.0 * R - (y2 - y1), v1 - v2, m1 * m2 / (m1 + m2));
        let lid = contact(y2 + R - GAP, v2, m2);
        [v1, v2, (floor - pair) / m1 - G, (pair - lid) / m2 - G]
    };
    let dt = 2e-8;
    let (mut y, mut n) = ([START[0], START[1], 0.0, 0.0], 0u32);
    let add = |y: [f64; 4], k: [f64; 4], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    let mut heights = Vec::new();
    for &time in times {
        while f64::from(n) * dt < time - 0.5 * dt {
            let k1 = rates(y);
            let k2 = rates(add(y, k1, 0.5 * dt));
            let k3 = rates(add(y, k2, 0.5 * dt));
            let k4 = rates(add(y, k3, dt));
            y = std::array::from_fn(|i| {
                y[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
            });
            n += 1;
        }
        heights.push([y[0], y[1]]);
    }
    heights
}

/// Heights of both centres (m) at `times` (s) in a world.
pub(crate) fn engine(e: f64, times: &[f64]) -> Result<Vec<[f64; 2]>, Error> {
    let law = ContactModel {
        normal: LinearTailKept { stiffness: K, damping_ratio: zeta(e) },
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    };
    let mut b = WorldBuilder::new(1e-7);
    b.allow_large_time_step();
    let ids = RHO
        .map(|density| b.material(Material { youngs_modulus: 1e7, poisson_ratio: 0.3, density }));
    b.pair_law(ids[0], ids[0], law).pair_law(ids[0], ids[1], law).pair_law(ids[1], ids[1], law);
    b.gravity(DVec3::NEG_Y * G).domain(DVec3::splat(-0.01), DVec3::splat(0.01));
    b.wall(Wall::plane(DVec3::ZERO, DVec3::Y, ids[0]));
    b.wall(Wall::plane(DVec3::Y * GAP, DVec3::NEG_Y, ids[0]));
    let spheres = [0, 1].map(|k| b.sphere(Sphere::at(DVec3::Y * START[k], R, ids[k])));
    let mut w = b.build()?;
    times
        .iter()
        .map(|time| {
            let steps = (time / w.time_step()).round() as u64;
            w.run(steps - w.step_number())?;
            Ok(spheres.map(|s| w.position(s).y))
        })
        .collect()
}
