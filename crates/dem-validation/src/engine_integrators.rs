//! Measured order of every integrator, and what a collision of few steps makes of it.

use dem_core::prelude::*;

use crate::{Check, Held};

const ORDER: Held = Held {
    tolerance: 0.1,
    reason: "absolute; steps in the asymptotic range, far above rounding",
    source: "theory of the scheme (Beeman: 2 in position and velocity, often stated as 3)",
};

/// An acceleration, its start and its state at time 1 in closed form.
#[derive(Clone, Copy)]
struct Orbit {
    name: &'static str,
    force: fn(DVec3) -> DVec3,
    start: (DVec3, DVec3),
    end: (DVec3, DVec3),
}

fn orbits() -> [Orbit; 2] {
    let (sin, cos) = 1f64.sin_cos();
    [
        Orbit {
            name: "harmonic contact",
            force: |x| -x,
            start: (DVec3::X, DVec3::ZERO),
            end: (DVec3::X * cos, DVec3::X * -sin),
        },
        Orbit {
            name: "Kepler's circle",
            force: |x| -x / x.length().powi(3),
            start: (DVec3::X, DVec3::Y),
            end: (DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0)),
        },
    ]
}

/// Errors of position and velocity at time 1 after `steps`.
fn errors<I: Integrator>(scheme: I, orbit: &Orbit, steps: u32) -> (f64, f64) {
    let dt = 1.0 / f64::from(steps);
    let (mut x, mut v) = orbit.start;
    let mut a = (orbit.force)(x);
    let mut memory = scheme.start(v, a, dt);
    for _ in 0..steps {
        x += scheme.drift(v, a, &mut memory, dt).displacement;
        let new = (orbit.force)(x);
        v = scheme.kick(v, a, new, &mut memory, dt);
        a = new;
    }
    ((x - orbit.end.0).length(), (v - orbit.end.1).length())
}

fn orders<I: Integrator>(name: &str, scheme: I, steps: u32, checks: &mut Vec<Check>) {
    for orbit in &orbits() {
        let (coarse, fine) = (errors(scheme, orbit, steps), errors(scheme, orbit, 2 * steps));
        for (of, order) in
            [("position", (coarse.0 / fine.0).log2()), ("velocity", (coarse.1 / fine.1).log2())]
        {
            checks.push(ORDER.absolute(
                format!("{name} on {}", orbit.name),
                format!("order in {of}"),
                f64::from(I::ORDER),
                order,
            ));
        }
    }
}

/// Steps in a unit of time, and the error of position after it, on Kepler's circle: one row a
/// scheme.
pub(crate) fn convergence() -> Vec<(&'static str, Vec<(f64, f64)>)> {
    fn row<I: Integrator>(scheme: I) -> Vec<(f64, f64)> {
        let circle = &orbits()[1];
        (3..12)
            .map(|k| {
                let steps = 1u32 << k;
                (1.0 / f64::from(steps), errors(scheme, circle, steps).0)
            })
            .collect()
    }
    vec![
        ("forward Euler", row(ForwardEuler)),
        ("Stoermer-Verlet", row(StoermerVerlet)),
        ("velocity Verlet", row(VelocityVerlet)),
        ("leapfrog", row(Leapfrog)),
        ("Beeman", row(Beeman)),
    ]
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    let mut checks = Vec::new();
    orders("forward Euler", ForwardEuler, 2000, &mut checks);
    orders("Stoermer-Verlet", StoermerVerlet, 200, &mut checks);
    orders("velocity Verlet", VelocityVerlet, 200, &mut checks);
    orders("leapfrog", Leapfrog, 200, &mut checks);
    orders("Beeman", Beeman, 200, &mut checks);
    checks
}
