//! Walls: rebound, motion, loads.

use dem_core::prelude::*;

use crate::scenes::{Model, bead_material, model};

fn builder(dt: f64, friction: f64, restitution: f64) -> (WorldBuilder<Model>, MaterialId) {
    let mut b = WorldBuilder::new(dt);
    let m = b.material(bead_material());
    b.pair_law(m, m, model(friction, restitution, 0.0));
    b.domain(DVec3::splat(-0.2), DVec3::splat(0.2));
    (b, m)
}

#[test]
fn the_restitution_of_every_shape_of_wall_is_the_one_asked_for() {
    for e in [0.3, 0.8] {
        let (mut b, m) = builder(2e-6, 0.0, e);
        let mut shots = Vec::new();
        let shoot = |b: &mut WorldBuilder<Model>, at: DVec3, v: DVec3| {
            (b.sphere(Sphere::at(at, 3e-3, m).with_velocity(v)), v)
        };
        b.wall(Wall::plane(DVec3::Z * -0.1, DVec3::Z, m));
        shots.push(shoot(&mut b, DVec3::Z * -0.0965, DVec3::Z * -0.5));
        b.wall(Wall::drum(DVec3::X * 0.1, DVec3::Z, 0.05, m));
        shots.push(shoot(&mut b, DVec3::X * 0.1465, DVec3::X * 0.5));
        let shaft = Cylinder {
            point: DVec3::X * -0.1,
            axis: DVec3::Z,
            radius: 0.02,
            side: Side::Outside,
            length: Some(0.02),
        };
        b.wall(Wall { shape: Shape::Cylinder(shaft), material: m, motion: Motion::default() });
        shots.push(shoot(&mut b, DVec3::X * -0.0765, DVec3::X * -0.5));
        // The rim of the finite shaft, met along the diagonal.
        let rim = DVec3::new(-0.1, 0.02, 0.01);
        let out = DVec3::new(0.0, 1.0, 1.0).normalize();
        shots.push(shoot(&mut b, rim + out * 3.5e-3, out * -0.5));
        b.wall(Wall::disc(DVec3::Y * 0.15, DVec3::Y, 0.01, m));
        shots.push(shoot(&mut b, DVec3::Y * 0.1535, DVec3::Y * -0.5));
        shots.push(shoot(&mut b, DVec3::new(0.0135, 0.15, 0.0), DVec3::X * -0.5));
        let mut w = b.build().unwrap();
        w.run(2000).unwrap();
        for (id, v) in shots {
            let after = w.velocity(id);
            // Second order at 250 steps a contact.
            assert!((after + v * e).length() < 1e-3 * 0.5, "{id}: {after} for {v} at e = {e}");
        }
    }
}

#[test]
fn a_turning_end_plate_takes_its_particles_along() {
    let (mut b, m) = builder(1e-5, 0.5, 0.3);
    b.gravity(DVec3::NEG_Z * 9.81);
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 2.0);
    let plate = b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.1, m).with_motion(turning));
    let id = b.sphere(Sphere::at(DVec3::new(0.03, 0.0, 2.999e-3), 3e-3, m));
    let mut w = b.build().unwrap();
    w.run(100).unwrap();
    // At first it slides: Coulomb's force along the plate's velocity, moment about the axis.
    let load = w.wall_load(plate).unwrap();
    let weight = w.mass(id) * 9.81;
    assert!((w.acceleration(id).y / (0.5 * 9.81) - 1.0).abs() < 0.2, "{}", w.acceleration(id));
    // The plate feels the opposite, at the radius of the contact.
    let expected =
        -load.force.x * 0.0 + w.position(id).x * load.force.y - w.position(id).y * load.force.x;
    assert!((load.torque.z - expected).abs() < 1e-12);
    w.run(4000).unwrap();
    // Then it rolls on the turning plate; the plate carries its weight.
    let load = w.wall_load(plate).unwrap();
    assert!((load.force.z / -weight - 1.0).abs() < 1e-3, "{}", load.force.z / weight);
    // A sphere that rolls on a turntable circles at 2/7 of its rate (Weltner 1979).
    assert!(w.velocity(id).length() > 0.01);
}

#[test]
fn a_sphere_on_a_turntable_circles_at_two_sevenths_of_its_rate() {
    // Weltner, Am. J. Phys. 47 (1979) 984, doi:10.1119/1.11602: without slip the velocity vector
    // turns at 2/7 of the table's rate, whatever the radius and the start.
    let (mut b, m) = builder(1e-5, 0.8, 0.2);
    b.gravity(DVec3::NEG_Z * 9.81);
    let rate = 3.0;
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, rate);
    b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.19, m).with_motion(turning));
    // Pure rolling from the start: at rest in space, its lowest point moves with the table.
    let (r, x) = (3e-3, 0.03);
    let spin = DVec3::new(rate * x / r, 0.0, 0.0);
    let s = Sphere::at(DVec3::new(x, 0.0, r - 1e-6), r, m).with_spin(spin);
    let id = b.sphere(s.with_velocity(DVec3::Y * 0.03));
    let mut w = b.build().unwrap();
    w.run(20_000).unwrap();
    let v0 = w.velocity(id);
    w.run(20_000).unwrap();
    let v1 = w.velocity(id);
    let turned = v0.y.atan2(v0.x) - v1.y.atan2(v1.x);
    let turned = (-turned).rem_euclid(std::f64::consts::TAU);
    let expected = 2.0 / 7.0 * rate * 0.2;
    // Shear springs let the contact lag by a deflection over the path: a percent.
    assert!((turned / expected - 1.0).abs() < 0.02, "{turned} {expected}");
}

#[test]
fn a_vibrating_plate_throws_a_resting_sphere_when_its_acceleration_passes_g() {
    let lift = |acceleration_in_g: f64| {
        let (mut b, m) = builder(1e-5, 0.0, 0.2);
        b.gravity(DVec3::NEG_Z * 9.81);
        let w = std::f64::consts::TAU * 25.0;
        let amplitude = DVec3::Z * (acceleration_in_g * 9.81 / (w * w));
        let motion = Motion::vibrating(amplitude, 25.0);
        b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m).with_motion(motion));
        let id = b.sphere(Sphere::at(DVec3::Z * 2.999e-3, 3e-3, m));
        let mut world = b.build().unwrap();
        world.run(20_000).unwrap();
        let mut most = f64::NEG_INFINITY;
        for _ in 0..4000 {
            world.run(1).unwrap();
            let plate = amplitude.z * (w * world.time()).sin();
            most = most.max(world.position(id).z - plate - 3e-3);
        }
        most
    };
    // Below 1 g contact is kept (the gap stays an overlap); above it the sphere flies.
    assert!(lift(0.7) < 0.0, "{}", lift(0.7));
    assert!(lift(2.0) > 1e-4, "{}", lift(2.0));
}

#[test]
fn a_wall_that_stops_stays_where_it_is() {
    let (mut b, m) = builder(1e-5, 0.5, 0.3);
    b.gravity(DVec3::NEG_Z * 9.81);
    let lift = Motion::translating(DVec3::Z * 0.1);
    let wall = b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m).with_motion(lift));
    let id = b.sphere(Sphere::at(DVec3::Z * 2.99e-3, 3e-3, m));
    let mut w = b.build().unwrap();
    w.open_ledger().unwrap();
    w.run(20_000).unwrap();
    w.set_wall_motion(wall, Motion::default()).unwrap();
    w.run(30_000).unwrap();
    // 0.2 s at 0.1 m/s, then rest on the stopped plate: the overlap under its weight is microns.
    assert!((w.position(id).z - 0.023).abs() < 1e-5, "{}", w.position(id).z);
    let e = w.energy();
    // The work of the wall went into height and losses.
    let height = w.mass(id) * 9.81 * 0.02;
    assert!(e.work_of_walls > height);
    assert!(e.remainder.abs() < 1e-2 * height, "{:e}", e.remainder / height);
}

#[test]
fn work_of_a_turning_drum_balances_what_the_bed_dissipates() {
    let mut w = crate::scenes::drum(300, 1.0, 1).build().unwrap();
    w.run(10_000).unwrap();
    w.open_ledger().unwrap();
    w.run(10_000).unwrap();
    let e = w.energy();
    assert!(e.work_of_walls > 0.0 && e.dissipated.tangential > 0.0);
    // A step of a tenth of a contact: the remainder is a few percent of what flows.
    assert!(e.remainder.abs() < 0.05 * e.work_of_walls, "{e:?}");
}
