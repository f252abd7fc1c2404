//! Restitution in the engine: what was asked, on every shape of wall and between spheres, and what
//! few steps a contact make of it.

use dem_core::contact::elasticity::{ElasticPair, Elasticity};
use dem_core::contact::normal::hertz::ElasticImpact;
use dem_core::impact::RateAt;
use dem_core::prelude::*;

use crate::contact_restitution::restitution_at_steps;
use crate::scenes::{bead, bead_pair, model, one_material};
use crate::{Check, Held};

const R: f64 = 3e-3;
const SPEED: f64 = 0.5;

fn mass() -> f64 {
    bead().density * 4.0 / 3.0 * std::f64::consts::PI * R.powi(3)
}

/// A place from which a sphere flies at something, and the direction in which it flies.
struct Shot {
    name: &'static str,
    wall: fn(MaterialId) -> Wall,
    at: DVec3,
    along: DVec3,
}

fn shots() -> [Shot; 5] {
    let gap = R + 1e-5;
    [
        Shot {
            name: "plane",
            wall: |m| Wall::plane(DVec3::ZERO, DVec3::Z, m),
            at: DVec3::Z * gap,
            along: DVec3::NEG_Z,
        },
        Shot {
            name: "drum of 0.1 m from inside",
            wall: |m| Wall::drum(DVec3::ZERO, DVec3::Z, 0.05, m),
            at: DVec3::X * (0.05 - gap),
            along: DVec3::X,
        },
        Shot {
            name: "shaft of 40 mm from outside",
            wall: |m| {
                let shaft = Cylinder {
                    point: DVec3::ZERO,
                    axis: DVec3::Z,
                    radius: 0.02,
                    side: Side::Outside,
                    length: Some(0.1),
                };
                Wall { shape: Shape::Cylinder(shaft), material: m, motion: Motion::default() }
            },
            at: DVec3::Y * (0.02 + gap),
            along: DVec3::NEG_Y,
        },
        Shot {
            name: "face of a disc",
            wall: |m| Wall::disc(DVec3::ZERO, DVec3::Y, 0.01, m),
            at: DVec3::Y * gap,
            along: DVec3::NEG_Y,
        },
        Shot {
            name: "rim of a disc",
            wall: |m| Wall::disc(DVec3::ZERO, DVec3::Y, 0.01, m),
            at: DVec3::X * (0.01 + gap),
            along: DVec3::NEG_X,
        },
    ]
}

fn rebound(shot: &Shot, e: f64, dt: f64) -> Result<f64, Error> {
    let (mut b, m) = one_material(dt, model(0.0, e, 0.0));
    b.wall((shot.wall)(m));
    let id = b.sphere(Sphere::at(shot.at, R, m).with_velocity(shot.along * SPEED));
    let mut w = b.build()?;
    w.run((2.5e-3 / dt) as u64)?;
    Ok(-w.velocity(id).dot(shot.along) / SPEED)
}

fn pair(e: f64, dt: f64) -> Result<f64, Error> {
    let (mut b, m) = one_material(dt, model(0.0, e, 0.0));
    let v = DVec3::X * SPEED;
    let id = b.sphere(Sphere::at(DVec3::X * -(R + 5e-6), R, m).with_velocity(v));
    b.sphere(Sphere::at(DVec3::X * (R + 5e-6), R, m).with_velocity(-v));
    let mut w = b.build()?;
    w.run((2.5e-3 / dt) as u64)?;
    Ok(-w.velocity(id).x / SPEED)
}

/// Mean restitution on a plane over 50 places of first touch, at `steps` an elastic contact.
fn at_steps(e: f64, steps: f64) -> Result<f64, Error> {
    let duration = ElasticImpact::new(bead_pair().e_star, R, mass(), SPEED).duration;
    let dt = duration / steps;
    let mut sum = 0.0;
    for k in 0..50 {
        let gap = (f64::from(k) + 0.5) / 50.0 * SPEED * dt;
        let (mut b, m) = one_material(dt, model(0.0, e, 0.0));
        b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m));
        let v = DVec3::NEG_Z * SPEED;
        let id = b.sphere(Sphere::at(DVec3::Z * (R + gap), R, m).with_velocity(v));
        let mut w = b.build()?;
        w.run((3.0 * steps) as u64)?;
        sum += w.velocity(id).z / SPEED;
    }
    Ok(sum / 50.0)
}

/// Duration of an elastic contact between unlike moduli, sphere on sphere and sphere on wall.
fn mixed_moduli(checks: &mut Vec<Check>) -> Result<(), Error> {
    const HELD: Held = Held {
        tolerance: 5e-3,
        reason: "relative; some 500 steps a contact, each end known to one of them",
        source: "Hertz's elastic impact with 1/E* = sum of (1 - nu^2)/E (lammps#4141)",
    };
    let materials = [1e8, 1e9].map(|youngs_modulus| Material {
        youngs_modulus,
        poisson_ratio: 0.25,
        density: 2500.0,
    });
    let [soft, stiff] = materials
        .map(|m| Elasticity { young_modulus: m.youngs_modulus, poisson_ratio: m.poisson_ratio });
    let e_star = ElasticPair::new(&soft, &stiff).e_star;
    let law = ContactModel {
        normal: HertzTailCut { e_star, damping: 0.0 },
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    };
    for wall in [false, true] {
        let (r_star, m_star) = if wall { (R, mass()) } else { (0.5 * R, 0.5 * mass()) };
        let duration = ElasticImpact::new(e_star, r_star, m_star, SPEED).duration;
        let mut b = WorldBuilder::new(duration / 500.0);
        b.allow_large_time_step().domain(DVec3::splat(-0.1), DVec3::splat(0.1));
        let [m, partner] = materials.map(|m| b.material(m));
        b.pair_law(m, m, law).pair_law(m, partner, law).pair_law(partner, partner, law);
        b.sphere(Sphere::at(DVec3::X * -(R + 1e-6), R, m).with_velocity(DVec3::X * SPEED));
        let plane = wall.then(|| b.wall(Wall::plane(DVec3::ZERO, DVec3::NEG_X, partner)));
        if !wall {
            b.sphere(Sphere::at(DVec3::X * R, R, partner));
        }
        let mut w = b.build()?;
        let mut steps = 0;
        for _ in 0..700 {
            w.run(1)?;
            let touching = match plane {
                Some(plane) => w.wall_load(plane)?.contacts > 0,
                None => w.contact_count() > 0,
            };
            steps += usize::from(touching);
        }
        checks.push(HELD.relative(
            format!("0.1 GPa on 1 GPa, {}", if wall { "wall" } else { "sphere" }),
            "duration of the contact, s",
            duration,
            steps as f64 * w.time_step(),
        ));
    }
    Ok(())
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    const ASKED: Held = Held {
        tolerance: 1e-3,
        reason: "absolute; second order at some 400 steps a contact",
        source: "the law's own input (lammps#2812)",
    };
    let mut checks = Vec::new();
    for e in [0.1, 0.3, 0.5, 0.7, 0.9, 1.0] {
        for shot in shots() {
            let ours = rebound(&shot, e, 2e-6).unwrap_or(f64::NAN);
            let case = format!("sphere on the {} in the engine, e = {e}", shot.name);
            checks.push(ASKED.absolute(case, "restitution", e, ours));
        }
        let ours = pair(e, 2e-6).unwrap_or(f64::NAN);
        checks.push(ASKED.absolute(
            format!("sphere on sphere in the engine, e = {e}"),
            "restitution",
            e,
            ours,
        ));
    }
    const SAME: Held = Held {
        tolerance: 1e-6,
        reason: "absolute; the same scheme; restitution does not depend on speed, size or stiffness",
        source: "the two-body impact of `dem_core::impact`",
    };
    for steps in [5.0, 10.0, 20.0, 50.0] {
        for e in [0.5, 0.9] {
            checks.push(SAME.absolute(
                format!("plane in the engine, {steps} steps a contact, e = {e}"),
                "mean restitution over 50 places of first touch",
                restitution_at_steps(e, steps, RateAt::End, true),
                at_steps(e, steps).unwrap_or(f64::NAN),
            ));
        }
    }
    if mixed_moduli(&mut checks).is_err() {
        checks.push(ASKED.fact("unlike moduli", "the case runs", true, false));
    }
    checks
}
