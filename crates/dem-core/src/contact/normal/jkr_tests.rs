use super::*;

const PAIR: PairGeometry =
    PairGeometry { r_star: 1e-4, m_star: 1e-9, radius_i: 2e-4, radius_j: 2e-4 };

fn law() -> Jkr {
    JkrSpec { e_star: 1e7, work_of_adhesion: 0.05, restitution: 1.0 }.try_into().unwrap()
}

fn motion(overlap: f64) -> Kinematics {
    Kinematics {
        normal_i_to_j: DVec3::X,
        overlap,
        overlap_rate: 0.0,
        slip_velocity: DVec3::ZERO,
        spin_i: DVec3::ZERO,
        spin_j: DVec3::ZERO,
        lever_i: 1.0,
        lever_j: 1.0,
        dt: 1.0,
    }
}

fn force_at(overlap: f64) -> NormalResponse {
    law().respond(&PAIR, &motion(overlap), &mut Bond { formed: true })
}

#[test]
fn the_largest_pull_is_the_pull_off_force_of_one_and_a_half_pi_w_r() {
    let tear = law().tear_gap(PAIR.r_star);
    let n = 100_000;
    let least = (0..=n)
        .map(|k| force_at(-tear * f64::from(k) / f64::from(n)).force)
        .fold(f64::INFINITY, f64::min);
    let want = 1.5 * std::f64::consts::PI * 0.05 * 1e-4;
    // a sampled minimum misses by the square of the spacing
    assert!((-least / want - 1.0).abs() < 1e-8);
}

#[test]
fn the_force_at_first_touch_is_eight_ninths_and_at_the_tear_five_ninths_of_pull_off() {
    let p = law().pull_off_force(PAIR.r_star);
    assert!((force_at(0.0).force / p + 8.0 / 9.0).abs() < 1e-12);
    // the two roots meet at the tear, so the radius is known to sqrt(eps) only
    let tear = law().tear_gap(PAIR.r_star);
    assert!((force_at(-tear * (1.0 - 1e-12)).force / p + 5.0 / 9.0).abs() < 1e-5);
}

#[test]
fn the_neck_stands_to_the_tear_and_not_beyond_and_forms_only_on_touch() {
    let tear = law().tear_gap(PAIR.r_star);
    let mut bond = Bond::default();
    let before = law().respond(&PAIR, &motion(-0.5 * tear), &mut bond);
    assert_eq!(before, NormalResponse::default());
    law().respond(&PAIR, &motion(1e-8), &mut bond);
    assert!(bond.formed);
    assert!(law().respond(&PAIR, &motion(-0.99 * tear), &mut bond).force < 0.0);
    let after = law().respond(&PAIR, &motion(-1.01 * tear), &mut bond);
    assert_eq!((after, bond.formed), (NormalResponse::default(), false));
}

#[test]
fn radius_and_force_satisfy_the_closed_curve() {
    for k in 1..40 {
        let delta = law().tear_gap(PAIR.r_star) * (f64::from(k) * 0.5 - 0.99);
        let r = force_at(delta);
        let under = law().radius_under(r.force, PAIR.r_star).unwrap();
        if delta > -0.3 * law().tear_gap(PAIR.r_star) {
            assert!((under / r.contact_radius - 1.0).abs() < 1e-9, "{delta}");
        }
    }
    assert!(law().radius_under(-1.01 * law().pull_off_force(1e-4), 1e-4).is_none());
}

#[test]
fn the_force_is_the_slope_of_the_energy_in_the_neck_and_under_load() {
    let tear = law().tear_gap(PAIR.r_star);
    for x in [-0.9, -0.5, 0.0, 0.7, 5.0] {
        let h = 1e-5 * tear;
        let slope = (force_at(x * tear + h).elastic_energy - force_at(x * tear - h).elastic_energy)
            / (2.0 * h);
        let f = force_at(x * tear).force;
        // central difference; its error grows towards the tear, where the slope is infinite
        assert!((slope / f - 1.0).abs() < 1e-6, "{x}");
    }
}

#[test]
fn a_cycle_of_touch_and_tear_loses_exactly_the_hysteresis() {
    let (l, tear) = (law(), law().tear_gap(PAIR.r_star));
    let n = 200_000;
    // slow pull from touch to tear: midpoint rule, the curve's end is a square root
    let h = tear / f64::from(n);
    let work: f64 = (0..n).map(|k| -force_at(-(f64::from(k) + 0.5) * h).force * h).sum();
    assert!((work / l.hysteresis(PAIR.r_star) - 1.0).abs() < 1e-5);
    let mut bond = Bond::default();
    let formed = l.respond(&PAIR, &motion(0.0), &mut bond);
    let booked = formed.dissipated_power * 1.0;
    assert!((booked / l.hysteresis(PAIR.r_star) - 1.0).abs() < 1e-12);
    // before: no energy; after: the well, paid for by what was booked
    assert!((formed.elastic_energy + booked).abs() < 1e-12 * booked);
}

#[test]
fn without_adhesion_the_curve_is_hertz() {
    let l = Jkr { e_star: 1e7, work_of_adhesion: 0.0, damping: 0.0 };
    let d = 1e-6;
    let r = l.respond(&PAIR, &motion(d), &mut Bond::default());
    let hertz = 4.0 / 3.0 * 1e7 * (1e-4f64).sqrt() * d.powf(1.5);
    assert!((r.force / hertz - 1.0).abs() < 1e-12);
}
