//! A linear simulator, for which least squares has a closed form.

use calib::{
    CalibError, FrameCorrelation, FreeParameter, Nuisance, Observation, Observations,
    OperatingPoint, Predicted, Problem, Simulator,
};
use rig_schema::Response;

/// `aor_lin = 20 + 30 theta + 0.1 omega`, exact; the others do not depend on theta.
struct Line;

impl Simulator for Line {
    fn parameters(&self) -> Vec<String> {
        vec!["friction.pp".to_owned()]
    }
    fn speed_range_rpm(&self) -> (f64, f64) {
        (1.0, 40.0)
    }
    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        let mean: Vec<f64> = at
            .iter()
            .flat_map(|p| [20.0 + 30.0 * theta[0] + 0.1 * p.omega_rpm, 30.0, 30.0, 50.0])
            .collect();
        let n = mean.len();
        Ok(Predicted { mean, covariance: vec![0.0; n * n] })
    }
}

fn problem(angles: &[(f64, f64, f64)], nuisances: Vec<Nuisance>) -> Problem<'static> {
    let items = angles
        .iter()
        .map(|(omega_rpm, mean, sd)| Observation {
            load: 0,
            omega_rpm: *omega_rpm,
            response: Response::AorLin,
            mean: *mean,
            sd: *sd,
        })
        .collect();
    Problem {
        observations: Observations::new(items, 4.0, FrameCorrelation::Independent).expect("valid"),
        simulator: &Line,
        free: vec![FreeParameter { name: "friction.pp".to_owned(), range: (0.0, 1.0) }],
        nuisances,
    }
}

const ANGLES: [(f64, f64, f64); 3] = [(4.0, 35.6, 0.8), (17.0, 36.4, 0.4), (30.0, 38.1, 0.6)];

#[test]
fn the_estimate_and_interval_are_those_of_weighted_least_squares() {
    let found = problem(&ANGLES, Vec::new()).solve(0, 0).expect("solves");
    // Means of 4 frames: sd / 2. Each speed gives theta = (angle - 20 - 0.1 omega) / 30.
    let (mut sum, mut weights, mut chi2) = (0.0, 0.0, 0.0);
    for (omega, angle, sd) in ANGLES {
        let (theta, se) = ((angle - 20.0 - 0.1 * omega) / 30.0, sd / 2.0 / 30.0);
        sum += theta / (se * se);
        weights += 1.0 / (se * se);
    }
    let theta = sum / weights;
    for (omega, angle, sd) in ANGLES {
        chi2 += ((angle - 20.0 - 0.1 * omega - 30.0 * theta) / (sd / 2.0)).powi(2);
    }
    let e = &found.estimates[0];
    // The search halves its step to 2e-7 of the range.
    assert!((e.value - theta).abs() < 1e-6, "{} {theta}", e.value);
    assert!((found.goodness.chi2 - chi2).abs() < 1e-8);
    assert_eq!(found.goodness.dof, 2);
    let half = 1.959964 * (found.goodness.inflation() / weights).sqrt();
    // Crossings are interpolated linearly between grid points 1/160 apart.
    assert!((e.lo.expect("bounded") - (theta - half)).abs() < 1e-3);
    assert!((e.hi.expect("bounded") - (theta + half)).abs() < 1e-3);
    assert!((e.marginal.mean - theta).abs() < 1e-4);
}

#[test]
fn a_marginalised_shift_widens_the_interval_by_its_prior() {
    let shift = Nuisance::from_path("measure.bias_lin_deg", 1.2, 0.9).expect("is linear");
    let found = problem(&ANGLES, vec![shift]).solve(0, 0).expect("solves");
    let plain = problem(&ANGLES, Vec::new()).solve(0, 0).expect("solves");
    // One shift common to all angles: theta falls by mean / 30, its variance grows by (sd / 30)^2.
    let moved = plain.estimates[0].value - found.estimates[0].value;
    assert!((moved - 1.2 / 30.0).abs() < 1e-6, "{moved}");
    let half = |e: &calib::Estimate| 0.5 * (e.hi.expect("bounded") - e.lo.expect("bounded"));
    let scale = |g: calib::Goodness| 1.959964 * g.inflation().sqrt();
    let variance =
        (half(&plain.estimates[0]) / scale(plain.goodness)).powi(2) + (0.9f64 / 30.0).powi(2);
    let expected = scale(found.goodness) * variance.sqrt();
    assert!((half(&found.estimates[0]) / expected - 1.0).abs() < 0.01);
    // At the best theta the data cannot pull the shift, and hold it as four frames a speed do.
    let weights: f64 = ANGLES.iter().map(|(_, _, sd)| 4.0 / (sd * sd)).sum();
    let held = (1.0 / (1.0 / 0.81 + weights)).sqrt();
    assert!((found.nuisances[0].sd - held).abs() < 1e-9, "{:?}", found.nuisances[0]);
    assert!(found.nuisances[0].pull.abs() < 1e-4);
}

#[test]
fn a_flat_direction_is_said_to_be_flat() {
    let items = vec![Observation {
        load: 0,
        omega_rpm: 4.0,
        response: Response::CenX,
        mean: 30.2,
        sd: 0.5,
    }];
    let flat = Problem {
        observations: Observations::new(items, 1.0, FrameCorrelation::Independent).expect("valid"),
        ..problem(&ANGLES, Vec::new())
    };
    let e = &flat.solve(0, 0).expect("solves").estimates[0];
    assert_eq!((e.lo, e.hi, e.flatness.identified), (None, None, false));
    assert!(e.flatness.deviance_range.abs() < 1e-9);
}

#[test]
fn an_ill_posed_problem_is_refused_by_name() {
    let mut p = problem(&ANGLES, Vec::new());
    p.free[0].range = (0.9, 0.1);
    assert!(matches!(p.solve(0, 0), Err(CalibError::Range { .. })));
    p.free.push(p.free[0].clone());
    assert!(matches!(p.solve(0, 0), Err(CalibError::Parameters { expected: 1, given: 2 })));
    let none = Observations::new(Vec::new(), 1.0, FrameCorrelation::Independent).expect("valid");
    let p = Problem { observations: none, ..problem(&ANGLES, Vec::new()) };
    assert!(matches!(p.solve(0, 0), Err(CalibError::NoObservations { .. })));
}
