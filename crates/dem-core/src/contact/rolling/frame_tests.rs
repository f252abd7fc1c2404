//! Frame indifference, passivity and limits of the rolling laws.

use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::torsion::TorsionMemory;
use super::*;
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{Memory, NormalResponse, RollingLaw, RollingResponse};

const PAIR: PairGeometry =
    PairGeometry { r_star: 0.005, m_star: 0.01, radius_i: 0.01, radius_j: 0.01 };
const NORMAL: NormalResponse = NormalResponse {
    force: 2.0,
    friction_load: 2.0,
    stiffness: 1e6,
    contact_radius: 1e-4,
    elastic_energy: 0.0,
    dissipated_power: 0.0,
};

fn motion(spin_i: DVec3, spin_j: DVec3) -> Kinematics {
    Kinematics {
        normal_i_to_j: DVec3::Z,
        overlap: 1e-5,
        overlap_rate: 0.0,
        slip_velocity: DVec3::ZERO,
        spin_i,
        spin_j,
        lever_i: 0.01,
        lever_j: 0.01,
        dt: 1e-5,
    }
}

fn once<R: RollingLaw>(law: &R, spin_i: DVec3, spin_j: DVec3) -> RollingResponse {
    law.respond(&PAIR, &motion(spin_i, spin_j), &NORMAL, &mut R::Memory::default())
}

const ARM: RollingArm = RollingArm { length: 0.0, ratio: 0.02 };
const CONSTANT: ConstantTorque = ConstantTorque { arm: ARM };
const VISCOUS: ViscousCapped = ViscousCapped { arm: ARM, viscosity: 1e-5, viscosity_per_load: 0.0 };
const ZHU: Zhu = Zhu { torque: VISCOUS, inertia_share: zhu::SOLID_SPHERE_SHARE };
const SPRING: RollingSpringDashpot =
    RollingSpringDashpot { arm: ARM, stiffness: 0.0, stiffness_ratio: 2.25, damping_ratio: 0.3 };
const TWIST: WithTorsion<RollingSpringDashpot> =
    WithTorsion { rolling: SPRING, torsion: Torsion { g_series: 1e9, friction: 0.4 } };

fn vector() -> impl Strategy<Value = DVec3> {
    (-50.0f64..50.0, -50.0f64..50.0, -50.0f64..50.0).prop_map(|v| DVec3::new(v.0, v.1, v.2))
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 256,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..Default::default()
    })]

    // Rounding of the subtraction of two spins of some 100 rad/s is the only tolerance.
    #[test]
    fn a_common_spin_changes_no_torque_and_torques_cancel(
        a in vector(), b in vector(), common in vector()
    ) {
        fn same<R: RollingLaw>(law: &R, a: DVec3, b: DVec3, common: DVec3) -> bool {
            let (one, two) = (once(law, a, b), once(law, a + common, b + common));
            let scale = one.torque_on_i.length().max(1e-12);
            (one.torque_on_i - two.torque_on_i).length() < 1e-9 * scale
                && one.torque_on_i == -one.torque_on_j
                && one.dissipated_power >= 0.0
        }
        prop_assert!(same(&FreeRolling, a, b, common));
        prop_assert!(same(&CONSTANT, a, b, common));
        prop_assert!(same(&VISCOUS, a, b, common));
        prop_assert!(same(&ZHU, a, b, common));
        prop_assert!(same(&SPRING, a, b, common));
        prop_assert!(same(&TWIST, a, b, common));
    }

    #[test]
    fn no_rolling_law_returns_more_work_than_it_took(
        legs in prop::collection::vec((vector(), 0.1f64..3.0), 2..8)
    ) {
        fn work<R: RollingLaw>(law: &R, legs: &[(DVec3, f64)]) -> (f64, f64) {
            let mut memory = R::Memory::default();
            let (mut work, mut before) = (0.0, DVec3::ZERO);
            let (mut lost, mut most) = (0.0, 0f64);
            for (spin, load) in legs {
                // the load changes with the leg, and with it the stiffness
                let normal = NormalResponse {
                    force: *load, friction_load: *load, stiffness: 1e6 * load.cbrt(),
                    contact_radius: 1e-4 * load.cbrt(), ..NORMAL
                };
                for _ in 0..200 {
                    let m = motion(*spin, DVec3::ZERO);
                    let r = law.respond(&PAIR, &m, &normal, &mut memory);
                    work -= 0.5 * (before + r.torque_on_i).dot(*spin) * m.dt;
                    lost += r.dissipated_power * m.dt;
                    before = r.torque_on_i;
                    most = most.max(r.elastic_energy);
                }
            }
            (work.min(lost), most)
        }
        // a jump of viscous torque at a corner is misread by the mean force by half a step of work
        let half_step = 0.5 * 0.02 * 0.005 * 3.0 * 87.0 * 1e-5 * 8.0;
        for (work, most) in [
            work(&CONSTANT, &legs), work(&VISCOUS, &legs), work(&ZHU, &legs),
            work(&SPRING, &legs), work(&TWIST, &legs),
        ] {
            prop_assert!(work >= -1e-9 * most - 2.0 * half_step, "{work}");
        }
    }
}

#[test]
fn the_absolute_spin_of_edem_resists_a_common_spin_and_loses_angular_momentum() {
    let law = AbsoluteSpin { arm: ARM };
    let r = once(&law, DVec3::X, DVec3::X);
    // ratio x lever x load on each body, both the same way
    assert!((r.torque_on_i.x + 0.02 * 0.01 * 2.0).abs() < 1e-18);
    assert_eq!(r.torque_on_i, r.torque_on_j);
    assert_eq!(once(&CONSTANT, DVec3::X, DVec3::X).torque_on_i, DVec3::ZERO);
}

#[test]
fn a_sphere_at_rest_feels_no_torque_and_no_nan() {
    for r in [
        once(&CONSTANT, DVec3::ZERO, DVec3::ZERO),
        once(&VISCOUS, DVec3::ZERO, DVec3::ZERO),
        once(&ZHU, DVec3::ZERO, DVec3::ZERO),
        once(&TWIST, DVec3::ZERO, DVec3::ZERO),
        once(&AbsoluteSpin { arm: ARM }, DVec3::ZERO, DVec3::ZERO),
    ] {
        assert_eq!(r.torque_on_i.length(), 0.0);
        assert_eq!(r.torque_on_j.length(), 0.0);
    }
}

#[test]
fn steady_rolling_meets_the_cap_of_every_law_and_twisting_that_of_torsion() {
    fn steady<R: RollingLaw>(law: &R, spin: DVec3) -> f64 {
        let mut m = R::Memory::default();
        (0..2000)
            .map(|_| law.respond(&PAIR, &motion(spin, DVec3::ZERO), &NORMAL, &mut m))
            .last()
            .unwrap()
            .torque_on_i
            .length()
    }
    let cap = 0.02 * 0.005 * 2.0;
    let fast = DVec3::Y * 100.0;
    assert!((steady(&CONSTANT, fast) - cap).abs() < 1e-15);
    assert!((steady(&VISCOUS, fast) - cap).abs() < 1e-15);
    assert!((steady(&ZHU, fast) - 2.0 / 7.0 * cap).abs() < 1e-15);
    assert!((steady(&SPRING, fast) - cap).abs() < 1e-15);
    let twist = steady(&TWIST, DVec3::Z * 100.0);
    assert!((twist - TWIST.torsion.limit(2.0, 1e-4)).abs() < 1e-15);
    // slow: the viscous law is below its cap
    assert!((steady(&VISCOUS, DVec3::Y) - 1e-5).abs() < 1e-15);
}

#[test]
fn the_limit_of_torsion_is_the_moment_of_a_sliding_hertz_pressure() {
    // p = 3N/(2 pi a^2) sqrt(1 - r^2/a^2); midpoint rule over r
    let n = 100_000;
    let moment: f64 = (0..n)
        .map(|k| {
            let r = (f64::from(k) + 0.5) / f64::from(n);
            3.0 * r * r * (1.0 - r * r).sqrt() / f64::from(n)
        })
        .sum();
    let law = Torsion { g_series: 1.0, friction: 1.0 };
    assert!((law.limit(1.0, 1.0) - moment).abs() < 1e-6);
}

#[test]
fn coefficients_as_length_and_as_number_agree_at_their_radius() {
    let length = RollingArm::try_from(RollingCoefficient::LengthM(1e-4)).unwrap();
    assert!((length.of(&PAIR) - ARM.of(&PAIR)).abs() < 1e-18);
    assert!(RollingArm::try_from(RollingCoefficient::Ratio(-0.1)).is_err());
}

#[test]
fn memory_of_torsion_survives_the_store() {
    let m = TorsionMemory {
        rolling: crate::contact::spring::SpringMemory {
            force: DVec3::new(1.0, 2.0, 3.0),
            stiffness: 4.0,
            sliding: true,
        },
        torque: 5.0,
        stiffness: 6.0,
    };
    let mut slots = [0.0; 6];
    m.store(&mut slots);
    assert_eq!(TorsionMemory::load(&slots), m);
}
