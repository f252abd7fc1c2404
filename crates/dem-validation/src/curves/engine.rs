//! The engine: orders, energies, free rotation.

use super::{Axis, Curve, Plot};
use crate::{engine_energy, engine_integrators, engine_rigid};

pub(super) fn plots() -> Vec<Plot> {
    let tumbling = engine_rigid::tumbling(60.0);
    vec![
        Plot {
            group: "engine_integrators",
            file: "integrator-order",
            title: "Error of position on Kepler's circle after 1 rad",
            caption: "Leapfrog, velocity Verlet and Stoermer-Verlet trace the same path; Beeman is of \
                      order 2 as well.",
            x: Axis::logarithmic("step (rad)"),
            y: Axis::logarithmic("error of position (radii)"),
            curves: engine_integrators::convergence()
                .into_iter()
                .map(|(name, points)| match name {
                    "Beeman" | "forward Euler" | "velocity Verlet" => Curve::line(name, points),
                    _ => Curve::points(name, points),
                })
                .collect(),
        },
        Plot {
            group: "engine_energy",
            file: "elastic-box",
            title: "Energy of an elastic box of eight spheres",
            caption: "Relative change over a million steps, some 30 steps a contact: a walk, no drift.",
            x: Axis::linear("steps"),
            y: Axis::linear("change of energy, relative"),
            curves: vec![Curve::line("ours", engine_energy::elastic_box())],
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
