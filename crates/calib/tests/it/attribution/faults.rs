//! What is refused, and with which words.

use calib::CalibError;
use calib::attribution::{Attribution, CodeCovariance, Settings};

use super::world::{Drum, attribution, measure, simulators, strengths};

/// The error of an attribution changed by `change`.
fn refused(change: impl Fn(&mut Attribution<'_>)) -> String {
    let (base, effects) = (Drum(None), simulators());
    let data = measure(1, 0.4, &strengths(&[]), 1.0);
    let mut a = attribution(data, &base, &effects, &[2, 5]);
    change(&mut a);
    a.attribute().expect_err("must be refused").to_string()
}

#[test]
fn too_few_observations_reach_no_verdict() {
    let text = refused(|a| {
        let first = |o: &calib::Observation| o.omega_rpm == 4.0 && o.response.index() < 2;
        a.base.observations = a.base.observations.filter(first);
    });
    assert!(text.contains("no verdict can be reached: 2 observations for 2 parameters"), "{text}");
    assert!(text.contains("cohesion.pp"), "{text}");
}

#[test]
fn a_candidate_must_take_the_base_and_one_strength() {
    let plain = Drum(None);
    let (base, effects) = (Drum(None), simulators());
    let data = measure(1, 0.4, &strengths(&[]), 1.0);
    let mut a = attribution(data, &base, &effects, &[2]);
    a.candidates[0].simulator = &plain;
    let text = a.attribute().expect_err("must be refused").to_string();
    assert!(text.contains("takes (friction.pp); expected (friction.pp) followed"), "{text}");
}

#[test]
fn a_speed_beyond_the_simulated_ones_is_refused() {
    let text = refused(|a| {
        a.base.observations.items[0].omega_rpm = 1.0;
    });
    assert!(text.contains("covers 2 to 30 rpm; there is an observation at 1 rpm"), "{text}");
}

#[test]
fn impossible_candidates_and_settings_are_refused_by_name() {
    let text = refused(|a| a.candidates[0].null = -1.0);
    assert!(text.contains("`cohesion.pp`: absent at -1"), "{text}");
    let text = refused(|a| a.candidates[0].range = (1.0, 1.0));
    assert!(text.contains("`cohesion.pp` is empty"), "{text}");
    let text = refused(|a| a.candidates[0].prior = f64::NAN);
    assert!(text.contains("prior weight NaN"), "{text}");
    let text = refused(|a| a.candidates[1].name = "cohesion.pp".to_owned());
    assert!(text.contains("stands twice"), "{text}");
    let text = refused(|a| a.settings.level = 0.0);
    assert!(text.contains("`level` is 0"), "{text}");
    let text = refused(|a| a.settings.bootstrap = 50);
    assert!(text.contains("`bootstrap` is 50"), "{text}");
    let text = refused(|a| a.settings = Settings { prior_none: 0.9, ..Settings::default() });
    assert!(text.contains("below 1"), "{text}");
}

#[test]
fn modes_of_another_length_are_refused() {
    let wrong = CodeCovariance::new(vec![4.0, 8.0], vec![vec![[0.0; 4]; 3]]);
    assert!(matches!(wrong, Err(CalibError::Lengths { expected: 2, given: 3, .. })));
}
