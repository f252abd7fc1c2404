//! What no scene may break: momentum balance, frame indifference, the same bits whatever looks on.

use dem_core::observe::CoordinationNumber;
use dem_core::prelude::*;

use crate::scenes::{Model, Random, cloud, model, one_material};
use crate::{Check, Held};

fn momentum(w: &World<Model>) -> (DVec3, DVec3) {
    w.particles().fold((DVec3::ZERO, DVec3::ZERO), |(p, l), id| {
        let (m, v, x) = (w.mass(id), w.velocity(id), w.position(id));
        let moment = 0.4 * m * w.radius(id).powi(2);
        (p + v * m, l + x.cross(v * m) + w.spin(id) * moment)
    })
}

fn balance(checks: &mut Vec<Check>) -> Result<(), Error> {
    const HELD: Held = Held {
        tolerance: 1e-10,
        reason: "relative to the sum of moduli; rounding of 5000 steps",
        source: "action and reaction",
    };
    let mut w = cloud(1e-5, model(0.5, 0.7, 0.02)).build()?;
    let (p0, l0) = momentum(&w);
    let scale: f64 = w.particles().map(|k| w.mass(k) * w.velocity(k).length()).sum();
    w.run(5000)?;
    let (p1, l1) = momentum(&w);
    let case = "64 spheres collide with friction and rolling resistance";
    let drift = (p1 - p0).length();
    checks.push(HELD.of_scale(case, "change of momentum, kg m/s", 0.0, drift, scale));
    let drift = (l1 - l0).length();
    let scale = scale * 0.01;
    checks.push(HELD.of_scale(case, "change of angular momentum, kg m2/s", 0.0, drift, scale));
    Ok(())
}

/// A small drum with turning ends, the whole of it turned by `q`.
fn drum(q: DQuat) -> WorldBuilder<Model> {
    let (mut b, m) = one_material(1e-5, model(0.4, 0.8, 0.01));
    b.gravity(q * DVec3::NEG_Y * 9.81);
    let spin = Motion::rotating(DVec3::ZERO, q * DVec3::Z, 5.0);
    b.wall(Wall::drum(DVec3::ZERO, q * DVec3::Z, 0.02, m).with_motion(spin));
    b.wall(Wall::disc(q * DVec3::Z * -0.01, q * DVec3::Z, 0.02, m).with_motion(spin));
    b.wall(Wall::disc(q * DVec3::Z * 0.01, q * DVec3::NEG_Z, 0.02, m).with_motion(spin));
    let mut random = Random(11);
    for k in 0..16u32 {
        let (i, j) = (f64::from(k % 4), f64::from(k / 4));
        let p = DVec3::new(i - 1.5, j - 1.5, random.next() - 0.5) * 5e-3;
        b.sphere(Sphere::at(q * p, 2e-3, m).with_velocity(q * random.vector() * 0.1));
    }
    b
}

fn equivariance(checks: &mut Vec<Check>) -> Result<(), Error> {
    const HELD: Held = Held {
        tolerance: 1e-9,
        reason: "absolute; rounding, spread by about a hundred collisions",
        source: "laws see relative motion only (musen: rolling torque from absolute spin)",
    };
    let turn = DQuat::from_xyzw(0.3, -0.5, 0.2, 0.7).normalize();
    let (mut a, mut b) = (drum(DQuat::IDENTITY).build()?, drum(turn).build()?);
    a.run(6000)?;
    b.run(6000)?;
    let apart = a.particles().map(|k| (turn * a.position(k) - b.position(k)).length());
    checks.push(HELD.absolute(
        "a drum and the same drum turned in space, 6000 steps",
        "largest distance of a sphere from its turned twin, m",
        0.0,
        apart.fold(0.0, f64::max),
    ));
    Ok(())
}

fn same_bits(checks: &mut Vec<Check>) -> Result<(), Error> {
    const EXACT: Held = Held {
        tolerance: 0.0,
        reason: "exact: hashes of the whole state",
        source: "sums run in one order, observers only read (lammps#1631)",
    };
    let plain = |threads: usize| -> Result<u64, Error> {
        let mut b = drum(DQuat::IDENTITY);
        let mut w = b.threads(threads).build()?;
        w.run(4000)?;
        Ok(w.state_hash())
    };
    let one = plain(1)?;
    let case = "a drum, 4000 steps";
    for threads in [2, 4] {
        let quantity = format!("{threads} threads give the bits of one");
        checks.push(EXACT.fact(case, quantity, true, plain(threads)? == one));
    }
    let mut watched = drum(DQuat::IDENTITY).build()?;
    let mut contacts = CoordinationNumber::new(7);
    watched.run_observed(4000, &mut [&mut contacts])?;
    checks.push(EXACT.fact(case, "an observer changes no bit", true, watched.state_hash() == one));
    let mut first = drum(DQuat::IDENTITY).build()?;
    first.run(1500)?;
    let bytes = first.snapshot().to_bytes();
    let mut again = drum(DQuat::IDENTITY).build()?;
    again.restore(&dem_core::snapshot::Snapshot::from_bytes(&bytes)?)?;
    again.run(2500)?;
    let same = again.state_hash() == one;
    checks.push(EXACT.fact(case, "a restart goes on bit by bit (lethe#959)", true, same));
    Ok(())
}

fn end_plates(checks: &mut Vec<Check>) -> Result<(), Error> {
    const HELD: Held = Held {
        tolerance: 5e-3,
        reason: "relative; a creeping contact spring under the load",
        source: "Weltner 1979, doi:10.1119/1.11602: a sphere rolling on a turntable circles at 2/7 of its rate (lethe#1422)",
    };
    let (mut b, m) = one_material(1e-5, model(0.8, 0.2, 0.0));
    b.gravity(DVec3::NEG_Z * 9.81);
    let (rate, r, x) = (3.0, 3e-3, 0.03);
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, rate);
    b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.19, m).with_motion(turning));
    let s = Sphere::at(DVec3::new(x, 0.0, r - 1e-6), r, m);
    // pure rolling from the start: at rest in space, its lowest point moves with the table
    let id = b.sphere(s.with_spin(DVec3::X * (rate * x / r)));
    let mut w = b.build()?;
    w.run(20_000)?;
    let before = w.velocity(id);
    w.run(100_000)?;
    let after = w.velocity(id);
    let turned = before.truncate().angle_to(after.truncate());
    let expected = 2.0 / 7.0 * rate * 1.0;
    checks.push(HELD.relative(
        "a sphere rolls on a turning end plate",
        "turn of its velocity in 1 s, rad",
        expected,
        turned,
    ));
    Ok(())
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    let mut checks = Vec::new();
    for part in [balance, equivariance, same_bits, end_plates] {
        if let Err(error) = part(&mut checks) {
            let held = Held { tolerance: 0.0, reason: "it must run", source: "-" };
            checks.push(held.fact(error.to_string(), "the case runs", true, false));
        }
    }
    checks
}
