//! Models of runs that are made by formulas.

use calib::Simulator as _;

use super::*;
use crate::scale::Scale;

#[test]
fn means_over_four_fillings_shift_half_as_far() {
    let noise = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * 1e-4));
    // Ten drums of one friction: fillings differ by half a degree at both speeds alike.
    let run = |k: u32| {
        let mean = [20.0 + if k.is_multiple_of(2) { 0.5 } else { -0.5 }; 4];
        let (mean, covariance) = (vec![mean; 2], vec![noise; 2]);
        Sample { at: vec![0.4], mean, covariance, variance: vec![[1e-3; 4]; 2], excess: vec![0.0] }
    };
    let runs: Vec<Sample> = (0..10).map(run).collect();
    let axis =
        Axis { path: "friction.pp".to_owned(), scale: Scale::Log, unit: 0.35, roughness: 1.0 };
    let knots = [20.0, 40.0].map(OperatingPoint::from);
    let one = Emulator::fit(vec![axis], vec![0.4], knots.to_vec(), &runs).unwrap();
    let four = one.clone().with_fillings(&[4]);
    let shift = one.shift(0)[0];
    assert!((0.3..0.8).contains(&shift), "{shift}");
    let of = |m: &Emulator, i, j| m.predict(&[0.4], &knots).unwrap().covariance(i, j);
    for (i, j) in [(0, 0), (0, 4), (3, 3)] {
        // What is left is what ten simulated fillings do not know of their mean.
        let less = of(&one, i, j) - of(&four, i, j);
        let expected = 0.75 * one.shift(0)[i % 4].powi(2);
        assert!((less - expected).abs() < 1e-9, "{i} {j}: {less} {expected}");
    }
    // And what runs have to say is held against what was measured.
    assert!((four.doubt(&[0.4]) / one.doubt(&[0.4]) - 4.0).abs() < 1e-12);
    assert_eq!(one.with_fillings(&[0]).loads[0].fillings, 1.0);
}

#[test]
fn loads_have_their_own_fillings_and_surfaces() {
    let noise = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * 1e-4));
    // Fillings of the full drum differ by a degree at both its speeds, those of the half one by half as much at its own.
    let run = |k: u32| {
        let side = |of: u32| if (k / of).is_multiple_of(2) { 1.0 } else { -1.0 };
        let (full, half) = (30.0 + side(1), 20.0 + 0.5 * side(2));
        let mean = vec![[full; 4], [full + 2.0; 4], [half; 4]];
        let (covariance, variance) = (vec![noise; 3], vec![[1e-3; 4]; 3]);
        Sample { at: vec![0.4], mean, covariance, variance, excess: vec![0.0; 2] }
    };
    let runs: Vec<Sample> = (0..24).map(run).collect();
    let axis =
        Axis { path: "friction.pp".to_owned(), scale: Scale::Log, unit: 0.35, roughness: 1.0 };
    let point = |load, omega_rpm| OperatingPoint { load, omega_rpm };
    let knots = vec![point(0, 20.0), point(0, 40.0), point(1, 30.0)];
    let model = Emulator::fit(vec![axis], vec![0.4], knots.clone(), &runs).unwrap();
    // Between its speeds and beyond them each load goes on by itself.
    let there = [point(0, 30.0), point(0, 60.0), point(1, 20.0)];
    let mean = model.expected(&[0.4], &there).unwrap();
    for (m, expected) in mean.chunks(4).zip([31.0, 32.0, 20.0]) {
        assert!((m[0] - expected).abs() < 0.02, "{mean:?}");
    }
    let [full, half] = [0, 1].map(|load| model.shift(load)[0]);
    assert!((0.7..1.3).contains(&full) && (0.1..0.6).contains(&half), "{full} {half}");
    // What fillings share is shared by the speeds of one load alone.
    let predicted = model.predict(&[0.4], &knots).unwrap();
    let [one, other] = [4, 8].map(|j| predicted.covariance(0, j));
    assert!(one > 0.9 * full * full && other.abs() < 0.05 * one, "{one} {other}");
    let third = model.predict(&[0.4], &[point(2, 20.0)]);
    assert!(matches!(third, Err(CalibError::Load { at }) if at.load == 2));
    // Knots and runs that cannot be are refused.
    let refit = |knots: &[OperatingPoint], runs: &[Sample]| {
        let axes = model.axes().to_vec();
        Emulator::fit(axes, vec![0.4], knots.to_vec(), runs).unwrap_err()
    };
    let turned: Vec<OperatingPoint> = knots.iter().rev().copied().collect();
    assert_eq!(refit(&turned, &runs), CalibError::Knot { at: point(1, 30.0) });
    let skipped = [point(0, 20.0), point(0, 40.0), point(2, 30.0)];
    assert_eq!(refit(&skipped, &runs), CalibError::Knot { at: point(2, 30.0) });
    let fault = refit(&knots[..2], &runs);
    assert!(matches!(fault, CalibError::Lengths { expected: 2, given: 3, .. }), "{fault}");
    let mut short = runs.clone();
    short[3].excess.pop();
    let fault = refit(&knots, &short);
    assert!(matches!(fault, CalibError::Lengths { expected: 2, given: 1, .. }), "{fault}");
}
