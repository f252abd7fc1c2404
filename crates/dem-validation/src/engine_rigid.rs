//! Free rotation of an asymmetric body: energy, angular momentum, the period of Dzhanibekov's flips.

use dem_core::glam::{DQuat, DVec3};
use dem_core::rigid::FreeRotation;

use crate::{Check, Held};

const MOMENTS: DVec3 = DVec3::new(1.0, 2.0, 3.0);
const DT: f64 = 1e-3;

fn start() -> DVec3 {
    DVec3::new(0.05, 1.0, 0.0) * MOMENTS
}

/// Complete elliptic integral of the first kind by the arithmetic-geometric mean.
fn complete_elliptic(k2: f64) -> f64 {
    let (mut a, mut g) = (1.0, (1.0 - k2).sqrt());
    for _ in 0..40 {
        (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
    }
    std::f64::consts::FRAC_PI_2 / a
}

/// Period of the spin about the middle axis, s (Landau and Lifshitz, Mechanics, section 37).
fn period() -> f64 {
    let l = start();
    let (i1, i2, i3) = (MOMENTS.x, MOMENTS.y, MOMENTS.z);
    let (twice_energy, l2) = (l.dot(l / MOMENTS), l.length_squared());
    // l2 < 2 E i2 here: the first and third axes change places in the textbook's formula
    let p = ((i2 - i1) * (twice_energy * i3 - l2) / (i1 * i2 * i3)).sqrt();
    let k2 = (i2 - i3) * (twice_energy * i1 - l2) / ((i2 - i1) * (twice_energy * i3 - l2));
    4.0 * complete_elliptic(k2) / p
}

/// Time (s) and spin about the three body axes (rad/s).
pub(crate) fn tumbling(seconds: f64) -> Vec<(f64, DVec3)> {
    let (l, mut q) = (start(), DQuat::IDENTITY);
    let mut spins = Vec::new();
    for step in 0..(seconds / DT) as u32 {
        if step.is_multiple_of(50) {
            spins.push((f64::from(step) * DT, (q.conjugate() * l) / MOMENTS));
        }
        q = FreeRotation::turn(MOMENTS, q, l, DT).orientation;
    }
    spins
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    const ROUNDING: Held = Held {
        tolerance: 1e-11,
        reason: "relative; 2e5 steps of rounding at 2e-16 each",
        source: "the midpoint rule keeps quadratic invariants",
    };
    const PERIOD: Held = Held {
        tolerance: 1e-5,
        reason: "relative; second order, (omega dt)^2/12 = 1e-7, felt through a logarithm",
        source: "elliptic integral, Landau and Lifshitz, Mechanics, section 37",
    };
    let (l, mut q) = (start(), DQuat::IDENTITY);
    let energy = |q: DQuat| {
        let body = q.conjugate() * l;
        0.5 * body.dot(body / MOMENTS)
    };
    let (mut last, mut crossings, mut worst) = (1.0, Vec::new(), 0.0f64);
    for step in 1..200_000u32 {
        q = FreeRotation::turn(MOMENTS, q, l, DT).orientation;
        let middle = (q.conjugate() * l).y;
        if last < 0.0 && middle >= 0.0 {
            crossings.push((f64::from(step) - middle / (middle - last)) * DT);
        }
        last = middle;
        worst = worst.max((energy(q) / energy(DQuat::IDENTITY) - 1.0).abs());
    }
    let flips = crossings.len().saturating_sub(1);
    let measured =
        (crossings.last().unwrap_or(&f64::NAN) - crossings.first().unwrap_or(&0.0)) / flips as f64;
    let case = "free body with moments 1, 2, 3, spun about its middle axis, 2e5 steps";
    vec![
        PERIOD.relative(case, "period of the flips, s", period(), measured),
        ROUNDING.absolute(case, "largest change of energy, relative", 0.0, worst),
    ]
}
