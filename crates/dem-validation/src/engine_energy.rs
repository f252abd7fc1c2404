//! The energy of many steps: an elastic box for a million, the ledger's remainder against the
//! step, grazing impacts.

use dem_core::prelude::*;

use crate::scenes::{Model, Random, cloud, model, one_material};
use crate::{Check, Held};

/// Relative change of the mechanical energy of an elastic, frictionless box of eight spheres, every
/// 10 000 of a million steps of `dt`, s.
pub(crate) fn elastic_box(seed: u64, dt: f64) -> Vec<(f64, f64)> {
    let law = ContactModel {
        normal: model(0.0, 1.0, 0.0).normal,
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    };
    let (mut b, m) = one_material(dt, law);
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        b.wall(Wall::plane(axis * -0.01, axis, m));
        b.wall(Wall::plane(axis * 0.01, -axis, m));
    }
    let mut random = Random(seed);
    for k in 0..8 {
        let corner = DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2));
        b.sphere(Sphere::at((corner - 0.5) * 8e-3, 2e-3, m).with_velocity(random.vector()));
    }
    let run = || -> Result<Vec<(f64, f64)>, Error> {
        let mut w = b.build()?;
        w.open_ledger()?;
        let start = w.energy().mechanical();
        let mut drift = vec![(0.0, 0.0)];
        for _ in 0..100 {
            w.run(10_000)?;
            drift.push((w.step_number() as f64, w.energy().mechanical() / start - 1.0));
        }
        Ok(drift)
    };
    run().unwrap_or_else(|_| vec![(0.0, f64::NAN)])
}

/// Laws of the cloud whose ledger is watched, with the order expected of the remainder.
fn ledger_laws() -> [(&'static str, Model, f64); 4] {
    let undamped = |rolling| {
        let law = model(0.3, 0.6, rolling);
        Model { tangential: Mindlin { damping: 0.0, ..law.tangential }, ..law }
    };
    [
        ("normal damping", model(0.0, 0.6, 0.0), 1.9),
        ("and friction", undamped(0.0), 1.9),
        ("and rolling", undamped(0.05), 1.7),
        ("normal damping, friction, shear damping", model(0.3, 0.6, 0.0), 1.3),
    ]
}

/// Step (s) and the ledger's remainder over the energy at the start, for each law.
pub(crate) fn remainders() -> Vec<(&'static str, Vec<(f64, f64)>)> {
    let remainder = |dt: f64, law: Model| {
        let run = || -> Result<f64, Error> {
            let mut w = cloud(dt, law).build()?;
            w.open_ledger()?;
            let start = w.energy().mechanical();
            w.run((4e-3 / dt).round() as u64)?;
            Ok(w.energy().remainder.abs() / start)
        };
        run().unwrap_or(f64::NAN)
    };
    ledger_laws()
        .into_iter()
        .map(|(name, law, _)| {
            let steps = (0..4).map(|k| 8e-6 / f64::from(1 << k));
            (name, steps.map(|dt| (dt, remainder(dt, law))).collect())
        })
        .collect()
}

fn ledger(checks: &mut Vec<Check>) {
    const SLOPE: Held = Held {
        tolerance: 0.0,
        reason: "a bound; second order where laws see the end of the step, a shear dashpot sees its middle and is booked to first order",
        source: "each dissipation is its own law's; the remainder is the error of integration",
    };
    const SIZE: Held =
        Held { tolerance: 0.0, reason: "a bound; some 500 steps a contact", source: SLOPE.source };
    for ((name, curve), (_, _, least)) in remainders().into_iter().zip(ledger_laws()) {
        let case = format!("64 spheres collide; {name}");
        let order = (curve[0].1 / curve[3].1).log2() / 3.0;
        checks.push(SLOPE.at_least(&case, "order of the ledger's remainder", least, order));
        checks.push(SIZE.at_most(&case, "remainder over energy at 1 us", 1e-4, curve[3].1));
    }
}

fn grazing(checks: &mut Vec<Check>) {
    const GAIN: Held = Held {
        tolerance: 0.0,
        reason: "a bound; rounding of 4000 steps",
        source: "no physical law creates energy (lammps#5007)",
    };
    for angle_deg in [0.5f64, 1.0, 3.0, 10.0] {
        for spin in [-100.0, 0.0, 200.0] {
            let (mut b, m) = one_material(2e-6, model(0.5, 0.9, 0.0));
            b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m));
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            let s = Sphere::at(DVec3::Z * 3e-3, 3e-3, m).with_velocity(DVec3::new(cos, 0.0, -sin));
            b.sphere(s.with_spin(DVec3::Y * spin));
            let run = || -> Result<f64, Error> {
                let mut w = b.build()?;
                w.open_ledger()?;
                let before = w.energy().mechanical();
                let mut most = 0.0f64;
                for _ in 0..200 {
                    w.run(20)?;
                    most = most.max(w.energy().mechanical() / before - 1.0);
                }
                Ok(most)
            };
            checks.push(GAIN.at_most(
                format!("grazing impact on a wall at {angle_deg} deg, spin {spin} rad/s"),
                "largest gain of energy, relative",
                1e-9,
                run().unwrap_or(f64::NAN),
            ));
        }
    }
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    const DRIFT: Held = Held {
        tolerance: 0.0,
        reason: "a bound; contacts of some 30 steps err by 1e-4 with random sign, ten thousand of them may walk to a percent",
        source: "velocity Verlet is symplectic: no drift, only a walk",
    };
    const FALLS: Held = Held {
        tolerance: 0.0,
        reason: "a bound; a contact errs by the square of the step, so half the step and half the time leave 4 times the root of 2 less, where a drift of first order leaves a quarter",
        source: DRIFT.source,
    };
    // One box walks where chance takes it: of 24 the median is 0.8 percent, seven go beyond one.
    let typical = |dt: f64| {
        let worst = move |seed| elastic_box(seed, dt).iter().map(|p| p.1.abs()).fold(0.0, f64::max);
        let mut all: Vec<f64> = std::thread::scope(|scope| {
            let boxes: Vec<_> = (5..12).map(|seed| scope.spawn(move || worst(seed))).collect();
            boxes.into_iter().map(|b| b.join().unwrap_or(f64::NAN)).collect()
        });
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let (whole, half) = (typical(1e-5), typical(5e-6));
    let case = "elastic, frictionless boxes of 8 spheres, 1e6 steps, median of seven";
    let mut checks = vec![
        DRIFT.at_most(case, "largest change of energy, relative", 0.01, whole),
        FALLS.at_least(case, "the same with a step over that with half of it", 4.5, whole / half),
    ];
    ledger(&mut checks);
    grazing(&mut checks);
    checks
}
