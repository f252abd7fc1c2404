//! Balances: momentum, energy, and the ledger.

use dem_core::prelude::*;

use crate::scenes::{Model, Random, bead_material, drum, elastic, model};

fn momentum<M: ContactLaw + 'static, I: Integrator>(w: &World<M, I>) -> (DVec3, DVec3) {
    w.particles().fold((DVec3::ZERO, DVec3::ZERO), |(p, l), id| {
        let (m, v, x) = (w.mass(id), w.velocity(id), w.position(id));
        let moment = 0.4 * m * w.radius(id).powi(2);
        (p + v * m, l + x.cross(v * m) + w.spin(id) * moment)
    })
}

/// A cloud of spheres that fly into one another.
fn cloud(dt: f64, law: Model) -> WorldBuilder<Model> {
    let mut b = WorldBuilder::new(dt);
    let m = b.material(bead_material());
    b.pair_law(m, m, law).domain(DVec3::splat(-1.0), DVec3::splat(1.0));
    let mut random = Random(3);
    for i in 0..4 {
        for j in 0..4 {
            for k in 0..4 {
                let p = (DVec3::new(i as f64, j as f64, k as f64) - 1.5) * 6.5e-3;
                let v = -p * 20.0 + random.vector() * 0.2;
                let radius = 2e-3 + 1e-3 * random.next();
                b.sphere(
                    Sphere::at(p, radius, m).with_velocity(v).with_spin(random.vector() * 50.0),
                );
            }
        }
    }
    b
}

#[test]
fn collisions_conserve_linear_and_angular_momentum() {
    let mut w = cloud(1e-5, model(0.5, 0.7, 0.02)).build().unwrap();
    let (p0, l0) = momentum(&w);
    let scale_p: f64 = w.particles().map(|k| w.mass(k) * w.velocity(k).length()).sum();
    let scale_l = scale_p * 0.01;
    w.run(5000).unwrap();
    let (p1, l1) = momentum(&w);
    // Forces are exactly opposite: rounding of 5000 steps is left.
    assert!((p1 - p0).length() < 1e-12 * scale_p, "{:e}", (p1 - p0).length() / scale_p);
    // The torque balance holds at the positions where forces act; the drift of x x v is that of
    // velocity Verlet, which conserves angular momentum of central forces exactly and that of
    // friction couples to rounding, too.
    assert!((l1 - l0).length() < 1e-10 * scale_l, "{:e}", (l1 - l0).length() / scale_l);
}

#[test]
fn walls_take_exactly_the_momentum_that_particles_lose() {
    let mut w = drum(200, 1.0, 1).build().unwrap();
    w.run(2000).unwrap();
    let total: f64 = w.particles().map(|k| w.mass(k)).sum();
    let dt = w.time_step();
    let load =
        |w: &World<Model>| (0..w.walls()).map(|k| w.wall_load(k).unwrap().force).sum::<DVec3>();
    for _ in 0..50 {
        let (p0, f0) = (momentum(&w).0, load(&w));
        w.run(1).unwrap();
        let (p1, f1) = (momentum(&w).0, load(&w));
        // Velocity Verlet: the change is the mean of the forces at both ends.
        let expected = (DVec3::NEG_Y * 9.81 * total - 0.5 * (f0 + f1)) * dt;
        assert!((p1 - p0 - expected).length() < 1e-11 * total * 9.81 * dt + 1e-17);
    }
}

#[test]
fn turning_the_whole_system_turns_the_result() {
    let turn = DQuat::from_xyzw(0.3, -0.5, 0.2, 0.7).normalize();
    let run = |q: DQuat| {
        let mut b = WorldBuilder::<Model>::new(1e-5);
        let m = b.material(bead_material());
        b.pair_law(m, m, model(0.4, 0.8, 0.01));
        b.domain(DVec3::splat(-1.0), DVec3::splat(1.0)).gravity(q * DVec3::new(0.0, -9.81, 0.0));
        let spin = Motion::rotating(DVec3::ZERO, q * DVec3::Z, 5.0);
        b.wall(Wall::drum(DVec3::ZERO, q * DVec3::Z, 0.02, m).with_motion(spin));
        b.wall(Wall::plane(q * DVec3::Z * -0.01, q * DVec3::Z, m).with_motion(spin));
        b.wall(Wall::plane(q * DVec3::Z * 0.01, q * DVec3::NEG_Z, m).with_motion(spin));
        let mut random = Random(11);
        for i in 0..4 {
            for j in 0..4 {
                let p = DVec3::new(i as f64 - 1.5, j as f64 - 1.5, random.next() - 0.5) * 5e-3;
                b.sphere(Sphere::at(q * p, 2e-3, m).with_velocity(q * random.vector() * 0.1));
            }
        }
        let mut w = b.build().unwrap();
        w.run(6000).unwrap();
        w
    };
    let (a, b) = (run(DQuat::IDENTITY), run(turn));
    let mut contacts = 0;
    for id in a.particles() {
        // Rounding, amplified by about a hundred collisions that each spread by a factor of few.
        assert!((turn * a.position(id) - b.position(id)).length() < 1e-9);
        assert!((turn * a.spin(id) - b.spin(id)).length() < 1e-4);
        contacts += usize::from(a.spin(id).length() > 0.1);
    }
    assert!(contacts > 10);
}

/// Remainder over the energy in play after the cloud has collided.
fn remainder(dt: f64, law: Model) -> f64 {
    let mut w = cloud(dt, law).build().unwrap();
    w.open_ledger().unwrap();
    let start = w.energy().mechanical();
    w.run((4e-3 / dt).round() as u64).unwrap();
    let e = w.energy();
    assert!(e.dissipated.total() > 0.05 * start);
    e.remainder.abs() / start
}

#[test]
fn the_remainder_of_the_ledger_falls_as_the_square_of_the_step() {
    let undamped = |rolling| {
        let law = model(0.3, 0.6, rolling);
        Model { tangential: Mindlin { damping: 0.0, ..law.tangential }, ..law }
    };
    // A shear dashpot acts on the mean velocity of the step, half a step behind its end: its share
    // of the loss is booked to first order only.
    for (name, law, least) in [
        ("normal damping", model(0.0, 0.6, 0.0), 1.9),
        ("friction", undamped(0.0), 1.9),
        ("rolling", undamped(0.05), 1.7),
        ("shear damping", model(0.3, 0.6, 0.0), 1.3),
    ] {
        let errors: Vec<f64> = (0..4).map(|k| remainder(8e-6 / f64::from(1 << k), law)).collect();
        let order = (errors[0] / errors[3]).log2() / 3.0;
        assert!(order > least, "{name}: order {order:.2} of {errors:?}");
        assert!(errors[3] < 1e-4, "{name}: {errors:?}");
    }
}

#[test]
fn an_elastic_box_keeps_its_energy_for_a_million_steps() {
    let mut b = WorldBuilder::new(5e-6);
    let m = b.material(bead_material());
    b.pair_law(m, m, elastic()).domain(DVec3::splat(-0.02), DVec3::splat(0.02));
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        b.wall(Wall::plane(axis * -0.01, axis, m));
        b.wall(Wall::plane(axis * 0.01, -axis, m));
    }
    let mut random = Random(5);
    for k in 0..8 {
        let corner = DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2));
        let v = random.vector();
        b.sphere(Sphere::at((corner - 0.5) * 8e-3, 2e-3, m).with_velocity(v));
    }
    let mut w = b.build().unwrap();
    w.open_ledger().unwrap();
    let start = w.energy().mechanical();
    let mut worst = 0.0f64;
    for _ in 0..100 {
        w.run(10_000).unwrap();
        worst = worst.max((w.energy().mechanical() / start - 1.0).abs());
    }
    // Contacts of some 60 steps: a collision errs by about 5e-5 of its energy with random sign,
    // so ten thousand of them may walk to a percent.
    assert!(worst < 0.01, "{worst:e}");
}

#[test]
fn grazing_wall_impacts_create_no_energy() {
    for angle_deg in [0.5f64, 1.0, 3.0, 10.0] {
        for spin in [-100.0, 0.0, 200.0] {
            let mut b = WorldBuilder::<Model>::new(2e-6);
            let m = b.material(bead_material());
            b.pair_law(m, m, model(0.5, 0.9, 0.0)).domain(DVec3::splat(-1.0), DVec3::splat(1.0));
            b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m));
            let a = angle_deg.to_radians();
            let v = DVec3::new(a.cos(), 0.0, -a.sin());
            let s = Sphere::at(DVec3::Z * 3.0e-3, 3e-3, m).with_velocity(v);
            let id = b.sphere(s.with_spin(DVec3::Y * spin));
            let mut w = b.build().unwrap();
            w.open_ledger().unwrap();
            let before = w.energy().mechanical();
            for _ in 0..200 {
                w.run(20).unwrap();
                // Rounding only: the law is passive and the step is a thousandth of the contact.
                assert!(w.energy().mechanical() <= before * (1.0 + 1e-9), "{angle_deg} {spin}");
            }
            assert!(w.velocity(id).z > 0.0);
        }
    }
}
