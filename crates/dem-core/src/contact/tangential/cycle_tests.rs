//! Closed cycles of load, shear and unload: no physical law returns more work than it took.

use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;
use crate::contact::friction::{Friction, FrictionSpec};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{Memory, NormalLaw, TangentialLaw};
use crate::contact::normal::HertzTailKept;

const PAIR: PairGeometry =
    PairGeometry { r_star: 0.005, m_star: 0.01, radius_i: 0.01, radius_j: 0.01 };
const NORMAL: HertzTailKept = HertzTailKept { e_star: 1e9, damping: 0.0 };
const G_STAR: f64 = 4e8;

/// Corner of a path: overlap and tangential position, m.
type Corner = (f64, f64, f64);

/// Work done on the contact by the shear along the closed path through `corners`, which starts
/// and ends at zero overlap, and the dissipation that the law reports, J.
fn cycle<T: TangentialLaw>(law: &T, corners: &[Corner], steps: usize) -> (f64, f64) {
    let mut memory = T::Memory::default();
    let mut force = DVec3::ZERO;
    let (mut work, mut lost) = (0.0, 0.0);
    for leg in corners.windows(2) {
        let (from, to) = (leg[0], leg[1]);
        let slip = DVec3::new(to.1 - from.1, to.2 - from.2, 0.0) / steps as f64;
        for k in 1..=steps {
            let overlap = from.0 + (to.0 - from.0) * k as f64 / steps as f64;
            let motion = Kinematics {
                normal_i_to_j: DVec3::Z,
                overlap,
                overlap_rate: 0.0,
                slip_velocity: slip,
                spin_i: DVec3::ZERO,
                spin_j: DVec3::ZERO,
                lever_i: 0.01,
                lever_j: 0.01,
                dt: 1.0,
            };
            let normal = NORMAL.respond(&PAIR, &motion, &mut ());
            memory.transport(DVec3::Z, 0.0);
            let r = law.respond(&PAIR, &motion, &normal, &mut memory);
            work -= 0.5 * (force + r.force_on_i).dot(slip);
            lost += r.dissipated_power;
            force = r.force_on_i;
        }
    }
    (work, lost)
}

fn friction() -> FrictionSpec {
    FrictionSpec { mu_static: 0.5, mu_kinetic: Some(0.3), decay_speed: None }
}

fn mindlin() -> Mindlin {
    MindlinSpec { g_star: G_STAR, friction: friction(), damping: 0.0 }.try_into().unwrap()
}

/// Closed paths: legs that change the load alone, the shear alone, or both, with shears from far
/// inside the stick to far beyond the onset of sliding (some 5 um).
fn closed_path() -> impl Strategy<Value = Vec<Corner>> {
    let leg = (0.1f64..1.0, -1.0f64..1.0, -1.0f64..1.0, 0..3u8);
    (prop::collection::vec(leg, 2..9), -3.0f64..0.0).prop_map(|(legs, size)| {
        let shear = 5e-6 * 10f64.powf(size);
        let mut at = (legs[0].0 * 1e-5, 0.0, 0.0);
        let mut path = vec![(0.0, 0.0, 0.0), at];
        for (load, x, y, kind) in legs {
            if kind != 1 {
                at.0 = load * 1e-5;
            }
            if kind != 0 {
                (at.1, at.2) = (x * shear, y * shear);
            }
            path.push(at);
        }
        // Back to where the shear began, then apart.
        path.push((at.0, 0.0, 0.0));
        path.push((0.0, 0.0, 0.0));
        path
    })
}

/// Largest shear energy met on the path if it stuck throughout, or if it slid: the smaller.
fn scale(corners: &[Corner]) -> f64 {
    let overlap = corners.iter().map(|c| c.0).fold(0.0, f64::max);
    let shear2 = corners.iter().map(|c| c.1 * c.1 + c.2 * c.2).fold(0.0, f64::max);
    let a = (PAIR.r_star * overlap).sqrt();
    let limit = 0.5 * 4.0 / 3.0 * 1e9 * a * overlap;
    let k = 8.0 * G_STAR * a;
    (limit * limit / k).min(k * shear2).max(1e-30)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..Default::default()
    })]

    // The incremental springs are passive step by step, so rounding is the only tolerance.
    #[test]
    fn mindlin_never_returns_more_work_than_it_took(path in closed_path()) {
        let (work, lost) = cycle(&mindlin(), &path, 200);
        prop_assert!(work >= -1e-9 * scale(&path), "{work} of {}", scale(&path));
        prop_assert!((work - lost).abs() < 1e-9 * scale(&path));
    }

    #[test]
    fn the_linear_spring_never_returns_more_work_than_it_took(path in closed_path()) {
        let law = LinearSpring {
            stiffness: 1e6, friction: Friction::try_from(friction()).unwrap(), damping_ratio: 0.0,
        };
        let (work, lost) = cycle(&law, &path, 200);
        prop_assert!(work >= -1e-9 * scale(&path));
        prop_assert!((work - lost).abs() < 1e-9 * scale(&path));
    }

    // Passive by construction: rounding only.
    #[test]
    fn mindlin_deresiewicz_never_returns_more_work_than_it_took(path in closed_path()) {
        let law = MindlinDeresiewicz { g_star: G_STAR, friction: Friction::coulomb(0.5).unwrap() };
        let (work, lost) = cycle(&law, &path, 400);
        prop_assert!(work >= -1e-9 * scale(&path), "{work} of {}", scale(&path));
        prop_assert!((work - lost).abs() < 1e-9 * scale(&path));
    }

    #[test]
    fn walton_braun_never_returns_more_work_than_it_took(path in closed_path()) {
        for stiffness in [ShearStiffness::Fixed(1e6), ShearStiffness::OfNormal(0.8)] {
            let law: WaltonBraunShear = WaltonBraunShearSpec {
                stiffness, gamma: 1.0 / 3.0, friction: friction(),
            }.try_into().unwrap();
            let (work, lost) = cycle(&law, &path, 400);
            prop_assert!(work >= -1e-9 * scale(&path), "{work} of {}", scale(&path));
            prop_assert!((work - lost).abs() < 1e-9 * scale(&path));
        }
    }
}

/// Shear under a light load, press, shear back, let go.
const FEEDING: [Corner; 5] =
    [(0.0, 0.0, 0.0), (2e-6, 0.0, 0.0), (2e-6, 4e-7, 0.0), (1e-5, 4e-7, 0.0), (1e-5, 0.0, 0.0)];

#[test]
fn the_total_spring_creates_energy_and_its_ledger_says_so() {
    let mut path = FEEDING.to_vec();
    path.push((0.0, 0.0, 0.0));
    let (work, lost) = cycle(&MindlinTotalSpring(mindlin()), &path, 1000);
    let (work_incremental, _) = cycle(&mindlin(), &path, 1000);
    // by hand: -(k2 - k1) s^2/2, k = 8 G* a
    let k = |overlap: f64| 8.0 * G_STAR * (PAIR.r_star * overlap).sqrt();
    let gain = 0.5 * (k(1e-5) - k(2e-6)) * 4e-7f64.powi(2);
    // the shear that is left at the end relaxes with the load and does no work
    assert!((work / -gain - 1.0).abs() < 1e-6, "{work} {gain}");
    assert!((lost - work).abs() < 1e-9 * gain);
    assert!(work_incremental > 0.0);
}

#[test]
fn static_friction_is_felt_before_kinetic_in_every_law() {
    fn largest_and_last<T: TangentialLaw>(law: &T) -> (f64, f64) {
        let mut memory = T::Memory::default();
        let (mut most, mut last) = (0f64, 0.0);
        for _ in 0..4000 {
            let motion = Kinematics {
                normal_i_to_j: DVec3::Z,
                overlap: 1e-5,
                overlap_rate: 0.0,
                slip_velocity: DVec3::Y * 1e-8,
                spin_i: DVec3::ZERO,
                spin_j: DVec3::ZERO,
                lever_i: 0.01,
                lever_j: 0.01,
                dt: 1.0,
            };
            let normal = NORMAL.respond(&PAIR, &motion, &mut ());
            last = law.respond(&PAIR, &motion, &normal, &mut memory).force_on_i.length()
                / normal.friction_load;
            most = most.max(last);
        }
        (most, last)
    }
    let f = Friction::try_from(friction()).unwrap();
    let wb =
        WaltonBraunShear { stiffness: 0.0, stiffness_ratio: 0.8, gamma: 1.0 / 3.0, friction: f };
    for (most, last) in [
        largest_and_last(&mindlin()),
        largest_and_last(&MindlinTotalSpring(mindlin())),
        largest_and_last(&LinearSpring { stiffness: 1e6, friction: f, damping_ratio: 0.0 }),
        largest_and_last(&MindlinDeresiewicz { g_star: G_STAR, friction: f }),
        largest_and_last(&wb),
    ] {
        // one step of slip is about 1e-3 of the displacement at the limit
        assert!((most - 0.5).abs() < 5e-3 && (last - 0.3).abs() < 1e-12, "{most} {last}");
    }
}
