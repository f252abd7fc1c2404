//! Oblique and spinning impacts.

use super::{Axis, Curve, Plot, spread};
use crate::contact_oblique::{
    DIGITISED_ANGLES, DIGITISED_E_T, DIGITISED_SPIN, KHARAZ, psi_after, runge_kutta_psi,
    spinning_beta, tangential_restitution_and_spin,
};
use crate::laws::{ALUMINA, ALUMINIUM_ALLOY, NYLON, POLYETHYLENE, STEEL};

pub(super) fn plots() -> Vec<Plot> {
    let group = "contact_oblique";
    let angles = || spread(2.0, 88.0, 86);
    let ours: Vec<(f64, f64, f64)> = angles()
        .map(|theta| {
            let (e_t, spin) = tangential_restitution_and_spin(&ALUMINA, theta);
            (theta, e_t, spin)
        })
        .collect();
    let impulse = 0.092 * 1.98;
    let digitised =
        |y: &[f64; 11]| DIGITISED_ANGLES.iter().copied().zip(y.iter().copied()).collect();
    let mut plots = vec![
        Plot {
            group,
            file: "chung-ooi-4-restitution",
            title: "Chung-Ooi 4: tangential restitution",
            caption: "Al2O3 on a rigid plane at 3.9 m/s. No-slip Mindlin leaves the digitised curve \
                      below some 10 degrees, where micro-slip counts; beyond some 30 degrees the \
                      contact slides throughout.",
            x: Axis::linear("angle of impact (deg)"),
            y: Axis::linear("tangential restitution"),
            curves: vec![
                Curve::line("ours", ours.iter().map(|p| (p.0, p.1)).collect()),
                Curve::line(
                    "sliding throughout",
                    spread(28.0, 88.0, 60)
                        .map(|t| (t, 1.0 - impulse / t.to_radians().tan()))
                        .collect(),
                ),
                Curve::points("Chung and Ooi, digitised", digitised(&DIGITISED_E_T)),
                Curve::points("measured, Kharaz et al.", KHARAZ.to_vec()),
            ],
        },
        Plot {
            group,
            file: "chung-ooi-4-spin",
            title: "Chung-Ooi 4: spin after impact",
            caption: "The same impacts.",
            x: Axis::linear("angle of impact (deg)"),
            y: Axis::linear("-omega (rad/s)"),
            curves: vec![
                Curve::line("ours", ours.iter().map(|p| (p.0, p.2)).collect()),
                Curve::line(
                    "sliding throughout",
                    spread(28.0, 88.0, 60)
                        .map(|t| (t, 2.5 * impulse * 3.9 * t.to_radians().cos() / 2.5e-3))
                        .collect(),
                ),
                Curve::points("Chung and Ooi, digitised", digitised(&DIGITISED_SPIN)),
            ],
        },
    ];
    plots.push(Plot {
        group,
        file: "chung-ooi-5-psi",
        title: "Chung-Ooi 5: slip after impact against slip before",
        caption: "psi = v_t/(mu v_n), elastic. Beyond psi = 6.5 the contact slides throughout; below, \
                  the reference is a Runge-Kutta integration of its own of the same no-slip law.",
        x: Axis::linear("psi before"),
        y: Axis::linear("psi after"),
        curves: vec![
            Curve::line(
                "steel, Runge-Kutta",
                spread(0.05, 6.5, 60).map(|p| (p, runge_kutta_psi(&STEEL, p).0)).collect(),
            ),
            Curve::line("sliding throughout", vec![(5.8, -1.2), (14.0, 7.0)]),
            Curve::points(
                "steel, ours",
                spread(0.25, 13.75, 27).map(|p| (p, psi_after(&STEEL, p).0)).collect(),
            ),
            Curve::points(
                "polyethylene, ours",
                spread(0.5, 13.5, 13).map(|p| (p, psi_after(&POLYETHYLENE, p).0)).collect(),
            ),
        ],
    });
    plots.push(Plot {
        group,
        file: "chung-ooi-6-beta",
        title: "Chung-Ooi 6: slip kept after a spinning impact",
        caption: "s = 3.5 mu (1 + e) v_n/(R omega), beta = -(slip after)/(slip before). Sliding \
                  throughout (s below about 1): beta = s - 1; beyond, the spring throws the slip back.",
        x: Axis::linear("s"),
        y: Axis::linear("beta"),
        curves: vec![
            Curve::line("beta = s - 1", vec![(0.1, -0.9), (1.2, 0.2)]),
            Curve::points(
                "aluminium alloy, ours",
                spread(0.1, 3.0, 29).map(|s| (s, spinning_beta(&ALUMINIUM_ALLOY, s))).collect(),
            ),
            Curve::points(
                "nylon, ours",
                spread(0.15, 2.95, 14).map(|s| (s, spinning_beta(&NYLON, s))).collect(),
            ),
        ],
    });
    plots
}
