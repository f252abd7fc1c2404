//! The engine: orders, energies, free rotation.

use dem_core::prelude::*;

use super::{Axis, Curve, Plot};
use crate::{engine_energy, engine_rigid};

pub(super) fn plots() -> Vec<Plot> {
    let tumbling = engine_rigid::tumbling(60.0);
    vec![
        Plot {
            group: "engine_order",
            file: "integrator-order",
            title: "Error of position on Kepler's circle after 1 rad",
            caption: "Leapfrog, velocity Verlet and Stoermer-Verlet trace the same path; Beeman is of \
                      order 2 as well.",
            x: Axis::logarithmic("step (rad)"),
            y: Axis::logarithmic("error of position (radii)"),
            curves: convergence(),
        },
        Plot {
            group: "engine_energy",
            file: "elastic-box",
            title: "Energy of an elastic box of eight spheres",
            caption: "Relative change over a million steps, some 30 steps a contact: a walk, no drift.",
            x: Axis::linear("steps"),
            y: Axis::linear("change of energy, relative"),
            curves: vec![Curve::line("ours", engine_energy::elastic_box(5, 1e-5))],
        },
        Plot {
            group: "engine_energy",
            file: "ledger-remainder",
            title: "The ledger's remainder against the step",
            caption: "64 colliding spheres. Every loss is booked by its own law; the remainder is the \
                      error of integration. A shear dashpot is booked to first order.",
            x: Axis::logarithmic("step (s)"),
            y: Axis::logarithmic("remainder / energy"),
            curves: engine_energy::remainders()
                .into_iter()
                .map(|(name, points)| Curve::line(name, points))
                .collect(),
        },
        Plot {
            group: "engine_rigid",
            file: "dzhanibekov",
            title: "A free body spun about its middle axis",
            caption: "Moments 1, 2, 3; the spin about the middle axis turns over again and again.",
            x: Axis::linear("time (s)"),
            y: Axis::linear("spin about a body axis (rad/s)"),
            curves: vec![
                Curve::line("middle axis", tumbling.iter().map(|(t, w)| (*t, w.y)).collect()),
                Curve::line(
                    "axis of least inertia",
                    tumbling.iter().map(|(t, w)| (*t, w.x)).collect(),
                ),
                Curve::line(
                    "axis of most inertia",
                    tumbling.iter().map(|(t, w)| (*t, w.z)).collect(),
                ),
            ],
        },
    ]
}

/// Error of position (radii) on Kepler's circle after 1 rad in `steps`.
fn circle_error<I: Integrator>(scheme: I, steps: u32) -> f64 {
    let force = |x: DVec3| -x / x.length().powi(3);
    let dt = 1.0 / f64::from(steps);
    let (mut x, mut v) = (DVec3::X, DVec3::Y);
    let mut a = force(x);
    let mut memory = scheme.start(v, a, dt);
    for _ in 0..steps {
        let mean = scheme.drift(v, a, &mut memory, dt).mean_velocity;
        x += mean * dt;
        let new = force(x);
        v = scheme.kick(v, mean, a, new, &mut memory, dt);
        a = new;
    }
    let (sin, cos) = 1f64.sin_cos();
    (x - DVec3::new(cos, sin, 0.0)).length()
}

/// Step (rad) and error on Kepler's circle, a row a scheme.
fn convergence() -> Vec<Curve> {
    fn row<I: Integrator>(scheme: I) -> Vec<(f64, f64)> {
        let steps = (3..12).map(|k| 1u32 << k);
        steps.map(|n| (1.0 / f64::from(n), circle_error(scheme, n))).collect()
    }
    vec![
        Curve::line("forward Euler", row(ForwardEuler)),
        Curve::line("velocity Verlet", row(VelocityVerlet)),
        Curve::line("Beeman", row(Beeman)),
        Curve::points("leapfrog", row(Leapfrog)),
        Curve::points("Stoermer-Verlet", row(StoermerVerlet)),
    ]
}
