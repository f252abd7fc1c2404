//! What the two compatibility laws do that no physical law may: a loop of load and shear that gains
//! energy, and a torque on two spheres that turn together. Beside each the physical law.

use dem_core::contact::kinematics::{Kinematics, PairGeometry};
use dem_core::contact::law::{NormalLaw, NormalResponse, RollingLaw, TangentialLaw};
use dem_core::contact::normal::HertzTailKept;
use dem_core::contact::rolling::{AbsoluteSpin, ConstantTorque, RollingArm};
use dem_core::contact::tangential::{Mindlin, MindlinTotalSpring};
use dem_core::glam::DVec3;

use crate::laws::coulomb;
use crate::{Check, Held};

const PAIR: PairGeometry =
    PairGeometry { r_star: 5e-3, m_star: 0.01, radius_i: 0.01, radius_j: 0.01 };
const G_STAR: f64 = 4e8;
const LOW: f64 = 2e-6;
const HIGH: f64 = 1e-5;
const SHEAR: f64 = 4e-7;

fn motion(overlap: f64, slip: f64) -> Kinematics {
    Kinematics {
        normal_i_to_j: DVec3::Z,
        overlap,
        overlap_rate: 0.0,
        slip_velocity: DVec3::X * slip,
        spin_i: DVec3::ZERO,
        spin_j: DVec3::ZERO,
        lever_i: 0.01,
        lever_j: 0.01,
        dt: 1.0,
    }
}

/// Work that the loop "press to LOW, shear, press to HIGH, shear back" takes (negative: gains), J.
fn loop_work<T: TangentialLaw>(law: &T) -> f64 {
    let normal = HertzTailKept { e_star: 1e9, damping: 0.0 };
    let mut memory = T::Memory::default();
    let (mut work, mut before) = (0.0, 0.0);
    let steps = 1000;
    for (from, to, slip) in
        [(0.0, LOW, 0.0), (LOW, LOW, SHEAR), (LOW, HIGH, 0.0), (HIGH, HIGH, -SHEAR)]
    {
        for n in 1..=steps {
            let share = f64::from(n) / f64::from(steps);
            let m = motion(from + (to - from) * share, slip / f64::from(steps));
            let load = normal.respond(&PAIR, &m, &mut ());
            let force = law.respond(&PAIR, &m, &load, &mut memory).force_on_i.x;
            work -= 0.5 * (before + force) * m.slip_velocity.x;
            before = force;
        }
    }
    work
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    const LOOP: Held = Held {
        tolerance: 1e-6,
        reason: "relative; springs are linear leg by leg, rounding only",
        source: "work of the loop by hand: k = 8 G* sqrt(R* overlap)",
    };
    let mindlin = Mindlin { g_star: G_STAR, friction: coulomb(0.5), damping: 0.0 };
    let k = |overlap: f64| 8.0 * G_STAR * (PAIR.r_star * overlap).sqrt();
    let (k1, k2) = (k(LOW), k(HIGH));
    let case = "loop of press, shear, press, shear back";
    let s2 = SHEAR * SHEAR;
    // incremental: shear k1 s on the way out, then from k1 s down by k2 s
    let incremental = 0.5 * k1 * s2 - (k1 - 0.5 * k2) * s2;
    let mut checks = vec![
        LOOP.relative(
            case,
            "work taken by EDEM's total spring (a gain), J",
            -0.5 * (k2 - k1) * s2,
            loop_work(&MindlinTotalSpring(mindlin)),
        ),
        LOOP.relative(
            case,
            "work taken by Mindlin, incremental, J",
            incremental,
            loop_work(&mindlin),
        ),
    ];
    let frame = Held {
        tolerance: 1e-12,
        reason: "relative to the torque limit; rounding only",
        source: "frame indifference: a common spin of both bodies is a turned frame",
    };
    let arm = RollingArm { length: 0.0, ratio: 0.02 };
    let load = NormalResponse { force: 2.0, friction_load: 2.0, ..Default::default() };
    let together = Kinematics { spin_i: DVec3::X, spin_j: DVec3::X, ..motion(1e-5, 0.0) };
    let case = "two spheres that turn together at 1 rad/s";
    let limit = 0.02 * 0.01 * 2.0;
    let physical = ConstantTorque { arm }.respond(&PAIR, &together, &load, &mut ());
    let edem = AbsoluteSpin { arm }.respond(&PAIR, &together, &load, &mut ());
    checks.push(frame.of_scale(
        case,
        "torque of the constant torque, N m",
        0.0,
        physical.torque_on_i.length(),
        limit,
    ));
    checks.push(frame.of_scale(
        case,
        "torque of EDEM's absolute spin, N m",
        limit,
        edem.torque_on_i.length(),
        limit,
    ));
    checks.push(frame.of_scale(
        case,
        "sum of both torques of EDEM's absolute spin, N m",
        2.0 * limit,
        (edem.torque_on_i + edem.torque_on_j).length(),
        limit,
    ));
    checks
}
