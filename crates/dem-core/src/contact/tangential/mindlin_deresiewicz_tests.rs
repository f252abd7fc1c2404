use super::*;
use crate::contact::law::Memory;

fn law() -> MindlinDeresiewicz {
    MindlinDeresiewicz { g_star: 1e9, friction: Friction::coulomb(0.4).unwrap() }
}

const PAIR: PairGeometry =
    PairGeometry { r_star: 0.005, m_star: 0.01, radius_i: 0.01, radius_j: 0.01 };

fn slide(m: &mut PartialSlipMemory, ds: f64, load: f64, a: f64) -> TangentialResponse {
    let motion = Kinematics {
        normal_i_to_j: DVec3::Z,
        overlap: a * a / PAIR.r_star,
        overlap_rate: 0.0,
        slip_velocity: DVec3::X * ds,
        spin_i: DVec3::ZERO,
        spin_j: DVec3::ZERO,
        lever_i: 0.01,
        lever_j: 0.01,
        dt: 1.0,
    };
    let normal = NormalResponse {
        force: load,
        friction_load: load,
        contact_radius: a,
        ..Default::default()
    };
    law().respond(&PAIR, &motion, &normal, m)
}

/// Under constant load: first loading to 0.8 of the onset of sliding, unloading to minus that,
/// reloading. The closed curves are f(s), T1 - 2 f((s1 - s)/2) and its mirror image.
#[test]
fn loading_unloading_and_reloading_follow_the_closed_curves() {
    let (load, a) = (10.0, 1e-4);
    let onset = 1.5 * 0.4 * load / (8.0 * 1e9 * a);
    let n = 40_000;
    let s1 = 0.8 * onset;
    let f = |s: f64| law().first_loading(s, load, a);
    let mut m = PartialSlipMemory::default();
    let ds = s1 / f64::from(n);
    let limit = 0.4 * load;
    // explicit steps: error of order 1/n on curves of slope up to 1.5 limits an onset
    let tol = 1e-3 * limit;
    for k in 1..=n {
        let t = -slide(&mut m, ds, load, a).force_on_i.x;
        let s = ds * f64::from(k);
        assert!((t - f(s)).abs() < tol, "loading {k}: {t} {}", f(s));
    }
    let t1 = f(s1);
    for k in 1..=2 * n {
        let t = -slide(&mut m, -ds, load, a).force_on_i.x;
        let want = t1 - 2.0 * f(0.5 * ds * f64::from(k));
        assert!((t - want).abs() < tol, "unloading {k}: {t} {want}");
    }
    for k in 1..=2 * n {
        let t = -slide(&mut m, ds, load, a).force_on_i.x;
        let want = -t1 + 2.0 * f(0.5 * ds * f64::from(k));
        assert!((t - want).abs() < tol, "reloading {k}: {t} {want}");
    }
}

/// The energy lost in one full cycle of amplitude s1 is 8 integral (f - s f') over half amplitude
/// ... by Masing 8 (2 F(s1) - s1 f(s1))/2 with F the integral of f.
#[test]
fn a_cycle_under_constant_load_loses_the_area_of_its_loop() {
    let (load, a) = (10.0, 1e-4);
    let onset = 1.5 * 0.4 * load / (8.0 * 1e9 * a);
    let n = 20_000;
    let s1 = 0.7 * onset;
    let ds = s1 / f64::from(n);
    let mut m = PartialSlipMemory::default();
    for _ in 0..n {
        slide(&mut m, ds, load, a);
    }
    let (mut lost, mut work) = (0.0, 0.0);
    let mut before = -m.shear;
    for k in 0..4 * n {
        let step = if k < 2 * n { -ds } else { ds };
        let r = slide(&mut m, step, load, a);
        assert!(r.dissipated_power >= -1e-18);
        lost += r.dissipated_power;
        work -= 0.5 * (before + r.force_on_i).x * step;
        before = r.force_on_i;
    }
    // integral of f over (0, s1), midpoint rule
    let big_f: f64 =
        (0..n).map(|k| law().first_loading((f64::from(k) + 0.5) * ds, load, a) * ds).sum();
    let loop_area = 4.0 * (2.0 * big_f - s1 * law().first_loading(s1, load, a));
    assert!((work / loop_area - 1.0).abs() < 1e-3, "{work} {loop_area}");
    assert!((lost / loop_area - 1.0).abs() < 1e-2, "{lost} {loop_area}");
}

#[test]
fn full_sliding_loses_friction_times_path_and_holds_the_limit() {
    let mut m = PartialSlipMemory::default();
    for _ in 0..2000 {
        slide(&mut m, 1e-8, 10.0, 1e-4);
    }
    let r = slide(&mut m, 1e-8, 10.0, 1e-4);
    assert!((r.force_on_i.x + 4.0).abs() < 1e-12);
    assert!((r.dissipated_power / (4.0 * 1e-8) - 1.0).abs() < 1e-9);
}

#[test]
fn a_growing_load_alone_changes_no_shear_and_a_falling_one_pulls_it_to_the_limit() {
    let mut m = PartialSlipMemory::default();
    for _ in 0..100 {
        slide(&mut m, 1e-8, 10.0, 1e-4);
    }
    let held = m.shear.x;
    for k in 1..=100 {
        slide(&mut m, 0.0, 10.0 + f64::from(k), 1.2e-4);
    }
    assert_eq!(m.shear.x, held);
    for k in 1..=1000 {
        slide(&mut m, 0.0, 110.0 * (1.0 - f64::from(k) / 1000.0), 1.2e-4);
        assert!(m.shear.length() <= 0.4 * m.load + 1e-12);
    }
    assert_eq!(m.shear, DVec3::ZERO);
    m.transport(DVec3::Y, 0.0);
}

/// Contact radius of Hertz under `load`, m.
fn radius(load: f64) -> f64 {
    (0.75 * load * PAIR.r_star / 2e9).cbrt()
}

/// At a held displacement the circle that sticks shrinks with c^2 = a^2 - const, so the shear under
/// a falling load stays on the curves of first loading of that displacement.
#[test]
fn a_falling_load_takes_the_shear_down_the_curves_of_first_loading() {
    let (load, n) = (10.0, 20_000);
    let mut m = PartialSlipMemory::default();
    let onset = 1.5 * 0.4 * load / (8.0 * 1e9 * radius(load));
    let s = 0.3 * onset;
    for _ in 0..n {
        slide(&mut m, s / f64::from(n), load, radius(load));
    }
    for k in 1..=n {
        let now = load * (1.0 - 0.8 * f64::from(k) / f64::from(n));
        let t = -slide(&mut m, 0.0, now, radius(now)).force_on_i.x;
        let want = law().first_loading(s, now, radius(now));
        // explicit steps: of order 1/n of the limit
        assert!((t - want).abs() < 1e-3 * 0.4 * load, "{now}: {t} {want}");
    }
}

/// After growth of the load at held shear, slip starts anew from the rim of the larger circle.
#[test]
fn shear_after_a_growth_of_the_load_starts_a_curve_of_first_loading_anew() {
    let (low, high, n) = (5.0, 20.0, 20_000);
    let mut m = PartialSlipMemory::default();
    for _ in 0..n {
        slide(&mut m, 0.5e-7 / f64::from(n), low, radius(low));
    }
    for k in 1..=n {
        let now = low + (high - low) * f64::from(k) / f64::from(n);
        slide(&mut m, 0.0, now, radius(now));
    }
    let held = m.shear.x;
    // up to where the added shear reaches mu (high - low)
    let onset = 1.5 * 0.4 * high / (8.0 * 1e9 * radius(high));
    let ds = 0.4 * onset / f64::from(n);
    for k in 1..=n {
        let t = -slide(&mut m, ds, high, radius(high)).force_on_i.x;
        let want = held + law().first_loading(ds * f64::from(k), high, radius(high));
        assert!(want - held < 0.4 * (high - low));
        assert!((t - want).abs() < 1e-3 * 0.4 * high, "{k}: {t} {want}");
    }
}
