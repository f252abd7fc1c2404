//! Measured order of every integrator, alone and in the world.

use dem_core::prelude::*;

/// Integrate `force` from (`x`, `v`) over `time` in `steps`; returns position and velocity.
fn integrate<I: Integrator>(
    scheme: I,
    force: impl Fn(DVec3) -> DVec3,
    (mut x, mut v): (DVec3, DVec3),
    time: f64,
    steps: u32,
) -> (DVec3, DVec3) {
    let dt = time / f64::from(steps);
    let mut a = force(x);
    let mut memory = scheme.start(v, a, dt);
    for _ in 0..steps {
        let mean = scheme.drift(v, a, &mut memory, dt).mean_velocity;
        x += mean * dt;
        let new = force(x);
        v = scheme.kick(v, mean, a, new, &mut memory, dt);
        a = new;
    }
    (x, v)
}

/// Orders of convergence in position and velocity under halving of the step.
fn orders<I: Integrator>(
    scheme: I,
    force: impl Fn(DVec3) -> DVec3 + Copy,
    start: (DVec3, DVec3),
    end: (DVec3, DVec3),
    time: f64,
    steps: u32,
) -> (f64, f64) {
    let error = |n: u32| {
        let (x, v) = integrate(scheme, force, start, time, n);
        ((x - end.0).length(), (v - end.1).length())
    };
    let (coarse, fine) = (error(steps), error(2 * steps));
    ((coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2())
}

fn check<I: Integrator>(name: &str, scheme: I, euler_steps: u32) {
    // A harmonic contact of unit frequency for 1 rad, closed form cos and -sin.
    let spring = |x: DVec3| -x;
    let end = (DVec3::X * 1f64.cos(), DVec3::X * -1f64.sin());
    let harmonic = orders(scheme, spring, (DVec3::X, DVec3::ZERO), end, 1.0, euler_steps);
    // A circular Kepler orbit of radius and speed 1 for 1 rad.
    let kepler = |x: DVec3| -x / x.length().powi(3);
    let end = (DVec3::new(1f64.cos(), 1f64.sin(), 0.0), DVec3::new(-1f64.sin(), 1f64.cos(), 0.0));
    let orbit = orders(scheme, kepler, (DVec3::X, DVec3::Y), end, 1.0, euler_steps);
    for (what, order) in [("harmonic", harmonic), ("Kepler", orbit)] {
        for (of, measured) in [("position", order.0), ("velocity", order.1)] {
            let theory = f64::from(I::ORDER);
            assert!((measured - theory).abs() < 0.1, "{name}, {what}, {of}: {measured:.3}");
        }
    }
}

#[test]
fn every_integrator_converges_with_the_order_of_its_theory() {
    // Steps fine enough for the asymptotic range, coarse enough to stay above rounding.
    check("forward Euler", ForwardEuler, 2000);
    check("Stoermer-Verlet", StoermerVerlet, 200);
    check("velocity Verlet", VelocityVerlet, 200);
    check("leapfrog", Leapfrog, 200);
    // Often stated as third order globally; it measures 2 in position and velocity.
    check("Beeman", Beeman, 200);
}

/// Two elastic spheres collide; speed of one after the impact over that before.
fn rebound<I: Integrator>(scheme: I, dt: f64) -> f64 {
    let mut b = WorldBuilder::new(dt);
    let m = b.material(crate::scenes::bead_material());
    b.pair_law(m, m, crate::scenes::elastic());
    b.domain(DVec3::splat(-0.1), DVec3::splat(0.1)).allow_large_time_step();
    let v = DVec3::X * 0.5;
    let id = b.sphere(Sphere::at(DVec3::X * -3.05e-3, 3e-3, m).with_velocity(v));
    b.sphere(Sphere::at(DVec3::X * 3.05e-3, 3e-3, m).with_velocity(-v));
    let mut w = b.build_with(scheme).unwrap();
    w.run((2e-3 / dt) as u64).unwrap();
    -w.velocity(id).x / 0.5
}

#[test]
fn an_elastic_collision_gives_the_speed_back_under_every_integrator() {
    // A contact of 0.5 ms in 500 steps: second order leaves 1e-5; Euler gains about
    // pi^2 / 500 of the energy, half of it in speed.
    for (name, e) in [
        ("velocity Verlet", rebound(VelocityVerlet, 1e-6)),
        ("leapfrog", rebound(Leapfrog, 1e-6)),
        ("Stoermer-Verlet", rebound(StoermerVerlet, 1e-6)),
        ("Beeman", rebound(Beeman, 1e-6)),
    ] {
        assert!((e - 1.0).abs() < 1e-5, "{name}: {e}");
    }
    let euler = rebound(ForwardEuler, 1e-6);
    assert!(euler > 1.002 && euler < 1.03, "forward Euler gains: {euler}");
}

#[test]
fn restitution_is_second_order_in_the_step_and_recovered_within_a_thousandth() {
    for e in [0.1, 0.3, 0.5, 0.7, 0.9, 1.0] {
        let mut b = WorldBuilder::<crate::scenes::Model>::new(2e-6);
        let m = b.material(crate::scenes::bead_material());
        b.pair_law(m, m, crate::scenes::model(0.0, e, 0.0));
        b.domain(DVec3::splat(-0.1), DVec3::splat(0.1));
        let v = DVec3::X * 0.5;
        let id = b.sphere(Sphere::at(DVec3::X * -3.05e-3, 3e-3, m).with_velocity(v));
        b.sphere(Sphere::at(DVec3::X * 3.05e-3, 3e-3, m).with_velocity(-v));
        let mut w = b.build().unwrap();
        w.run(4000).unwrap();
        let measured = -w.velocity(id).x / 0.5;
        assert!((measured - e).abs() < 1e-3, "asked {e}, got {measured}");
    }
}
