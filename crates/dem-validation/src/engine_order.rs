//! Measured order of the integrators, on a harmonic contact and on a Kepler orbit.

use dem_core::glam::DVec3;
use dem_core::integrate::{
    Beeman, ForwardEuler, Integrator, Leapfrog, StoermerVerlet, VelocityVerlet,
};

use crate::{Check, Held};

const ORDER: Held = Held {
    tolerance: 0.1,
    reason: "absolute; what the next term of the error leaves at the steps chosen",
    source: "theory of each scheme; errors against cos t and the circular orbit after 1 rad",
};

fn error<I: Integrator>(
    scheme: I,
    force: impl Fn(DVec3) -> DVec3,
    (mut x, mut v): (DVec3, DVec3),
    end: (DVec3, DVec3),
    steps: u32,
) -> [f64; 2] {
    let dt = 1.0 / f64::from(steps);
    let mut a = force(x);
    let mut memory = scheme.start(v, a, dt);
    for _ in 0..steps {
        let mean = scheme.drift(v, a, &mut memory, dt).mean_velocity;
        x += mean * dt;
        let new = force(x);
        v = scheme.kick(v, mean, a, new, &mut memory, dt);
        a = new;
    }
    [(x - end.0).length(), (v - end.1).length()]
}

fn order<I: Integrator>(name: &str, scheme: I, steps: u32, checks: &mut Vec<Check>) {
    let spring = |x: DVec3| -x;
    let kepler = |x: DVec3| -x / x.length().powi(3);
    let (s, c) = 1f64.sin_cos();
    let swing = (DVec3::X * c, DVec3::X * -s);
    let orbit = (DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0));
    let harmonic = |n| error(scheme, spring, (DVec3::X, DVec3::ZERO), swing, n);
    let circular = |n| error(scheme, kepler, (DVec3::X, DVec3::Y), orbit, n);
    let runs: [(&str, [[f64; 2]; 2]); 2] = [
        ("harmonic contact", [harmonic(steps), harmonic(2 * steps)]),
        ("Kepler orbit", [circular(steps), circular(2 * steps)]),
    ];
    for (what, [coarse, fine]) in runs {
        for (of, k) in [("position", 0), ("velocity", 1)] {
            let measured = (coarse[k] / fine[k]).log2();
            let case = format!("{name}, {what}");
            checks.push(ORDER.absolute(
                case,
                format!("order in {of}"),
                f64::from(I::ORDER),
                measured,
            ));
        }
    }
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    let mut checks = Vec::new();
    order("forward Euler", ForwardEuler, 2000, &mut checks);
    order("Störmer-Verlet", StoermerVerlet, 200, &mut checks);
    order("velocity Verlet", VelocityVerlet, 200, &mut checks);
    order("leapfrog", Leapfrog, 200, &mut checks);
    order("Beeman (often stated as 3)", Beeman, 200, &mut checks);
    checks
}
