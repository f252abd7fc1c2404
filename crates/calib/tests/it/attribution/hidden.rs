//! An effect that hides behind a friction: what is said to be visible of it.

use calib::attribution::{Candidate, Settings, Verdict};
use calib::{CalibError, OperatingPoint, Predicted, Simulator};

use super::linear::{Line, SPEEDS, question};

/// Lowers a level by 4 deg for one of its strength and tilts the line by a twentieth of what is missing from 30 deg then: a bed
/// of 30 + 4 s deg reads as one of 30 deg without it.
struct Hiding;

impl Simulator for Hiding {
    fn parameters(&self) -> Vec<String> {
        Line(Some(|slope| slope)).parameters()
    }
    fn speed_range_rpm(&self) -> (f64, f64) {
        (1.0, 30.0)
    }
    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        let level = theta[0] - 4.0 * theta[1];
        let tilted = [level, 0.05 * theta[1] * (level - 30.0)];
        Line(Some(|slope| slope)).predict(&tilted, at)
    }
}

#[test]
fn what_another_friction_hides_is_not_called_visible() {
    let (base, line, hiding) = (Line(None), Line(Some(|slope| slope)), Hiding);
    let settings = Settings { stability_bootstrap: 0, ..Settings::default() };
    let flat = SPEEDS.into_iter().map(|s| (s, 30.0));
    let mut all = question((&base, &line), flat, ((0.0, 2.0), None), settings);
    let second =
        Candidate { name: "hiding".to_owned(), simulator: &hiding, ..all.candidates[0].clone() };
    all.candidates.push(second);
    let f = all.attribute().expect("is well posed");
    assert_eq!(f.verdict, Verdict::None);
    let of = |name: &str| f.detectable.iter().find(|d| d.name == name).expect("is listed");
    // At the level found, 30 deg, a strength of 2 would tilt the line by 0.8 deg a rpm, which nobody could miss.
    let [seen, unseen] = [of("slope"), of("hiding")];
    assert!(seen.strength.is_some_and(|s| s < 0.2) && (seen.at[0] - 30.0).abs() < 0.5, "{seen:?}");
    assert!(unseen.strength.is_none() && unseen.power_at_end < 0.01, "{unseen:?}");
    assert!((unseen.at[0] - 38.0).abs() < 1e-3, "{unseen:?}");
}
