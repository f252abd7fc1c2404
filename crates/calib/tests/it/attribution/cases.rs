//! Single findings looked at closely.

use calib::attribution::{CodeCovariance, Experiment, Finding, Verdict};
use calib::{CalibError, OperatingPoint, Predicted, Simulator};
use rig_schema::Response;

use super::world::{
    ALL, Drum, EFFECTS, SPEEDS, attribution, measure, simulators, strengths, truth,
};

fn found(a: &calib::attribution::Attribution<'_>) -> Finding {
    a.attribute().expect("is well posed")
}

#[test]
fn the_fit_of_the_base_is_that_of_the_grid_search() {
    let (base, effects) = (Drum(None), simulators());
    for mu in [0.2, 0.4, 0.7] {
        let a = attribution(measure(1, mu, &strengths(&[]), 1.0), &base, &effects, &[2]);
        let fit = found(&a).base;
        let grid = a.base.solve(0, 0).expect("is well posed");
        // The pattern search of the grid ends at steps of 0.8 / 320 / 2^13 of the range; a
        // quarter of the chi-square's last step remains.
        assert!((fit.theta[0] - grid.estimates[0].value).abs() < 1e-5, "{fit:?}");
        assert!((fit.chi2 - grid.goodness.chi2).abs() < 1e-6);
        let (a, b) = (fit.residuals[5], grid.residuals[5]);
        assert!((a.value - (b.measured - b.model)).abs() < 1e-4 && (a.sd - b.sd).abs() < 1e-12);
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_seed_other_draws() {
    let (base, effects) = (Drum(None), simulators());
    let data = measure(2, 0.4, &strengths(&[(2, 0.15)]), 1.0);
    let mut a = attribution(data, &base, &effects, &ALL);
    a.settings.stability_bootstrap = 99;
    let first = found(&a);
    assert_eq!(format!("{first:?}"), format!("{:?}", found(&a)));
    a.settings.seed = 8;
    let other = found(&a);
    let p = |f: &Finding| f.ranked.iter().map(|r| r.p_single).collect::<Vec<_>>();
    assert_ne!(p(&first), p(&other));
    assert_eq!(first.base, other.base);
}

#[test]
fn a_finding_is_complete_and_consistent() {
    let (base, effects) = (Drum(None), simulators());
    let s = strengths(&[(2, 0.5)]);
    let mut a = attribution(measure(3, 0.4, &s, 1.0), &base, &effects, &ALL);
    a.settings.stability_bootstrap = 199;
    let mut given = measure(77, 0.4, &s, 1.0);
    for (k, item) in given.items.iter_mut().enumerate() {
        // Speeds between the fitted ones.
        item.omega_rpm += 1.3;
        let noise = item.mean - truth(SPEEDS[k / 4], 0.4, &s, 0.0)[k % 4];
        item.mean = truth(item.omega_rpm, 0.4, &s, 0.0)[k % 4] + noise;
    }
    a.held_out = Some(given);
    let f = found(&a);
    assert_eq!(f.verdict, Verdict::Effect("cohesion.pp".to_owned()), "{:#?}", f.ranked[0]);
    let total: f64 = f.evidence.iter().map(|e| e.posterior).sum();
    assert!((total - 1.0).abs() < 1e-12);
    let prior: f64 = f.evidence.iter().map(|e| e.prior).sum();
    assert!((prior - 1.0).abs() < 1e-12);
    assert!(f.evidence.iter().all(|e| e.halved <= e.posterior && e.posterior <= e.doubled));
    let kinds: Vec<&str> = f.held_out.iter().map(|h| h.kind).collect();
    assert_eq!(kinds, ["leave one speed out", "both ends", "given set"]);
    for h in &f.held_out {
        println!("{} removed {:?} p {:.4}", h.kind, h.removed, h.permutation_p);
        assert!(h.removed.expect("there was an excess") > 0.7, "{h:?}");
        assert_eq!(h.responses.len(), 4);
    }
    // Eight speeds: the smallest possible p is 1 / 256.
    assert!(f.held_out[0].permutation_p < 0.05);
    // 8 speeds, 4 responses, 2 standard deviations.
    assert_eq!(f.stability.len(), 14);
    for row in &f.stability {
        println!("{}: {:?}", row.change, row.verdict);
    }
    let named = |v: &Verdict| match v {
        Verdict::Effect(n) => n == "cohesion.pp",
        Verdict::Class(n) => n.contains(&"cohesion.pp".to_owned()),
        _ => false,
    };
    let stable = f.stability.iter().filter(|r| r.verdict.as_ref().is_ok_and(named)).count();
    assert!(stable >= 12, "{:?}", f.stability);
    let overturn = f.overturn.expect("the gate fails");
    println!("overturn {overturn:?}");
    assert!(overturn.independent.expect("is below 30") > 0.5);
    // Rolling and blocky particles are one class of signatures, cohesion is none of it.
    let place = |n: &str| f.ranked.iter().find(|r| r.name == n).expect("is ranked").class;
    assert_eq!(place("rolling.pp"), place("shape.blockiness"));
    assert_ne!(place("rolling.pp"), place("cohesion.pp"));
    assert!(f.pairs.is_empty());
}

#[test]
fn frames_that_scatter_more_than_stated_are_shown_by_the_scatter_that_overturns() {
    let (base, effects) = (Drum(None), simulators());
    // Stated 1 deg over 15 frames, 0.26 deg; true 2.5 times that, so 0.59 deg is missing in
    // squares (0.47 % R for the centre of area). The gate passes at 1 %, hence with less.
    let (mut sizes, mut named) = (Vec::new(), 0);
    for seed in 0..10 {
        let data = measure(50 + seed, 0.4, &strengths(&[]), 2.5);
        let f = found(&attribution(data, &base, &effects, &ALL));
        named += usize::from(matches!(f.verdict, Verdict::Effect(_)));
        sizes.extend(f.overturn.and_then(|o| o.independent));
    }
    println!("overturning sd {sizes:.2?}, named {named} of 10");
    assert!(sizes.len() >= 8 && named <= 1, "{sizes:?} {named}");
    assert!(sizes.iter().all(|s| (0.1..0.8).contains(s)), "{sizes:?}");
}

#[test]
fn an_effect_that_worsens_data_never_fitted_is_rejected() {
    let (base, effects) = (Drum(None), simulators());
    let s = strengths(&[(5, 0.7)]);
    let mut a = attribution(measure(4, 0.4, &s, 1.0), &base, &effects, &ALL);
    assert_eq!(found(&a).verdict, Verdict::Effect("camera.exposure".to_owned()));
    // Other speeds' data show none of it.
    a.held_out = Some(measure(5, 0.4, &strengths(&[]), 1.0));
    let f = found(&a);
    assert_eq!(f.verdict, Verdict::Unknown);
    let exposure = &f.ranked[0];
    assert_eq!(exposure.name, "camera.exposure");
    assert!(exposure.worsens.contains(&"aor_mid_deg"), "{:?}", exposure.objections);
    assert!(!exposure.eligible && exposure.objections.len() >= 2);
}

#[test]
fn a_difference_between_codes_can_take_an_effect_away() {
    let (base, effects) = (Drum(None), simulators());
    let mut a = attribution(measure(6, 0.4, &strengths(&[(5, 0.6)]), 1.0), &base, &effects, &ALL);
    // Matched runs of two codes differ in the middle line, more so at speed: as exposure does.
    let like = |w: &f64| [0.0, w / 8.0, 0.32 * w / 8.0, -0.25 * w / 8.0];
    let modes = vec![SPEEDS.iter().map(like).collect()];
    a.code_covariance = Some(CodeCovariance::new(SPEEDS.to_vec(), modes).expect("fits"));
    let f = found(&a);
    println!("with {:?}, without {:?}", f.verdict, f.verdict_without_code);
    assert_eq!(f.verdict_without_code, Some(Verdict::Effect("camera.exposure".to_owned())));
    assert_ne!(f.verdict, Verdict::Effect("camera.exposure".to_owned()));
}

/// Blocky particles packed so that blockiness acts thrice as much.
struct Packed(Drum);

impl Simulator for Packed {
    fn parameters(&self) -> Vec<String> {
        self.0.parameters()
    }
    fn speed_range_rpm(&self) -> (f64, f64) {
        self.0.speed_range_rpm()
    }
    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        self.0.predict(&[theta[0], 3.0 * theta[1]], at)
    }
}

#[test]
fn the_experiment_that_treats_the_class_differently_is_the_next() {
    let (base, effects) = (Drum(None), simulators());
    let packed = Packed(Drum(Some(6)));
    let data = measure(7, 0.4, &strengths(&[(0, 0.6)]), 1.0);
    let mut a = attribution(data, &base, &effects, &ALL);
    let experiment = |name: &str| Experiment {
        name: name.to_owned(),
        points: [5.0, 15.0, 25.0].map(OperatingPoint::from).to_vec(),
        sd: [Some(0.3); 4],
        nuisances: Vec::new(),
        simulators: EFFECTS
            .iter()
            .zip(&effects)
            .map(|(e, s)| (e.0.to_owned(), s as &dyn Simulator))
            .collect(),
    };
    let mut other = experiment("packed");
    other.simulators[6].1 = &packed;
    // Less is learnt where less is measured.
    let lines = Experiment {
        name: "lines".to_owned(),
        sd: [Some(0.3), Some(0.3), None, None],
        ..other.clone()
    };
    a.experiments = vec![lines, experiment("again"), other];
    let f = found(&a);
    assert!(matches!(&f.verdict, Verdict::Class(n) if n.len() == 2), "{:?}", f.verdict);
    for n in &f.next {
        println!("{}: {:.3} of {:.3} bits", n.name, n.gain_bits, n.most_bits);
    }
    assert_eq!(f.next[0].name, "packed");
    assert!(f.next[0].gain_bits > 0.8 * f.next[0].most_bits);
    assert_eq!([&f.next[1].name, &f.next[2].name], ["lines", "again"]);
    assert!(f.next[1].gain_bits < f.next[0].gain_bits && f.next[2].gain_bits < 0.1);
}

#[test]
fn missing_responses_and_few_speeds_are_judged_from_what_is_there() {
    let (base, effects) = (Drum(None), simulators());
    let all = measure(8, 0.4, &strengths(&[(2, 0.6)]), 1.0);
    let gaps = all.filter(|o| {
        let early = o.omega_rpm < 12.0;
        o.response != Response::CenY && !(early && o.response == Response::CenX)
    });
    let f = found(&attribution(gaps, &base, &effects, &ALL));
    assert_eq!(f.verdict, Verdict::Effect("cohesion.pp".to_owned()));
    assert_eq!(f.held_out[0].responses.len(), 3);
    let three = all.filter(|o| [4.0, 13.0, 28.0].contains(&o.omega_rpm));
    let f = found(&attribution(three, &base, &effects, &ALL));
    println!("three speeds: {:?}", f.verdict);
    assert_ne!(f.verdict, Verdict::None);
    let two = all.filter(|o| [4.0, 28.0].contains(&o.omega_rpm));
    let f = found(&attribution(two, &base, &effects, &ALL));
    println!("two speeds: {:?}", f.verdict);
    assert!(f.held_out.is_empty() && f.ranked.iter().all(|r| r.held_out_gain.is_none()));
}

#[test]
fn an_effect_of_the_wrong_sign_gains_nothing() {
    let (base, effects) = (Drum(None), simulators());
    // Cohesion below 0 is not in its range.
    let f =
        found(&attribution(measure(9, 0.4, &strengths(&[(2, -0.4)]), 1.0), &base, &effects, &[2]));
    let cohesion = &f.ranked[0];
    assert_eq!((cohesion.strength.value, cohesion.improvement), (0.0, 0.0));
    assert_eq!(cohesion.p_single, 1.0);
    assert_eq!(f.verdict, Verdict::Unknown);
}

#[cfg(feature = "serde")]
#[test]
fn a_finding_is_written_as_json() {
    let (base, effects) = (Drum(None), simulators());
    let a = attribution(measure(3, 0.4, &strengths(&[(2, 0.5)]), 1.0), &base, &effects, &[2, 5]);
    let json = serde_json::to_value(found(&a)).expect("has no map with odd keys");
    assert_eq!(json["verdict"]["effect"], "cohesion.pp");
    assert_eq!(json["ranked"][0]["layer"], "physics");
    assert!(json["gate"]["p_combined"].is_number());
}
