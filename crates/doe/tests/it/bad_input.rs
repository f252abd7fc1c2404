//! Input that cannot be fitted is refused with what, where and what was expected.

use doe::{DoeError, Factor, Model, ModelTerms, Term, Weighting, eliminate, fit};

fn line() -> Model {
    let x = [Factor::new("x", 0.0, 10.0).unwrap()];
    Model::new(&x, &ModelTerms::linear(&x)).unwrap()
}

const POINTS: [[f64; 1]; 4] = [[0.0], [3.0], [7.0], [10.0]];
const Y: [f64; 4] = [1.0, 2.0, 2.5, 4.0];

/// The error of fitting a line to these.
fn refusal(points: &[Vec<f64>], y: &[f64], weighting: Weighting<'_>) -> DoeError {
    fit(&line(), points, y, weighting).unwrap_err()
}

fn points() -> Vec<Vec<f64>> {
    POINTS.iter().map(|p| p.to_vec()).collect()
}

#[test]
fn too_few_runs_are_refused_with_how_many_are_needed() {
    let error = refusal(&points()[..2], &Y[..2], Weighting::Ordinary);
    assert_eq!(
        error.to_string(),
        "2 runs cannot determine 2 terms and a residual variance: at least 3 runs are needed"
    );
}

#[test]
fn no_runs_at_all_are_refused() {
    assert_eq!(refusal(&[], &[], Weighting::Ordinary), DoeError::Empty { what: "runs" });
}

#[test]
fn numbers_that_are_none_are_refused_with_their_run() {
    let mut y = Y;
    y[2] = f64::NAN;
    let error = refusal(&points(), &y, Weighting::Ordinary);
    assert_eq!(error.to_string(), "response of run 2 is NaN, expected a finite number");
    let mut p = points();
    p[1][0] = f64::INFINITY;
    let error = refusal(&p, &Y, Weighting::Ordinary);
    assert_eq!(error.to_string(), "factor `x` of run 1 is inf, expected a finite number");
}

#[test]
fn lengths_that_do_not_match_are_refused() {
    let error = refusal(&points(), &Y[..3], Weighting::Ordinary);
    assert_eq!(error.to_string(), "points of the runs: expected 3 values, got 4");
    let mut p = points();
    p[3].push(1.0);
    let error = refusal(&p, &Y, Weighting::Ordinary);
    assert_eq!(error.to_string(), "factor values of a point (run 3): expected 1 values, got 2");
    let error = refusal(&points(), &Y, Weighting::Weights(&[1.0; 3]));
    assert_eq!(error.to_string(), "weights: expected 4 values, got 3");
    let error = refusal(&points(), &Y, Weighting::Covariance(&[1.0; 15]));
    assert_eq!(error.to_string(), "covariance of the runs (n x n): expected 16 values, got 15");
}

#[test]
fn weights_must_be_positive() {
    for bad in [0.0, -2.0, f64::NAN, f64::INFINITY] {
        let weights = [1.0, bad, 1.0, 1.0];
        let error = refusal(&points(), &Y, Weighting::Weights(&weights));
        assert!(matches!(error, DoeError::Weight { run: 1, .. }), "{bad}");
    }
}

#[test]
fn a_covariance_must_be_positive_definite_and_finite() {
    // Correlation 1 between all runs.
    let error = refusal(&points(), &Y, Weighting::Covariance(&[1.0; 16]));
    assert_eq!(error, DoeError::NotPositiveDefinite { runs: 4 });
    let zero = refusal(&points(), &Y, Weighting::Covariance(&[0.0; 16]));
    assert_eq!(zero, DoeError::NotPositiveDefinite { runs: 4 });
    let mut s = [0.0; 16];
    (0..4).for_each(|i| s[5 * i] = 1.0);
    s[1] = f64::NAN;
    let error = refusal(&points(), &Y, Weighting::Covariance(&s));
    assert!(matches!(error, DoeError::NotFinite { .. }));
}

#[test]
fn a_response_that_does_not_vary_is_refused() {
    let error = refusal(&points(), &[2.5; 4], Weighting::Ordinary);
    assert_eq!(error, DoeError::ConstantResponse { value: 2.5 });
}

#[test]
fn a_cube_on_three_levels_is_named_as_an_alias_of_its_linear_term() {
    let x = [Factor::new("mu", 0.1, 0.9).unwrap()];
    let model = Model::new(&x, &ModelTerms::cubic(&x)).unwrap();
    let points: Vec<[f64; 1]> = (0..9).map(|i| [0.1 + 0.4 * f64::from(i % 3)]).collect();
    let y: Vec<f64> = (0..9).map(f64::from).collect();
    let error = fit(&model, &points, &y, Weighting::Ordinary).unwrap_err();
    assert_eq!(error.to_string(), "the design cannot tell these terms apart: mu^3 = 1.0000 mu");
}

#[test]
fn two_factors_that_move_together_are_named() {
    let f = [Factor::new("a", 0.0, 1.0).unwrap(), Factor::new("b", 0.0, 2.0).unwrap()];
    let model = Model::new(&f, &ModelTerms::linear(&f)).unwrap();
    let points: Vec<[f64; 2]> = (0..5).map(|i| [0.25 * f64::from(i), 0.5 * f64::from(i)]).collect();
    let error = fit(&model, &points, &[0.0, 1.0, 2.5, 2.0, 4.0], Weighting::Ordinary).unwrap_err();
    let DoeError::Aliased { aliases } = error else { panic!("{error}") };
    assert_eq!(aliases.len(), 1);
    assert_eq!(aliases[0].term, "b");
    assert_eq!(aliases[0].combination[0].0, "a");
}

#[test]
fn an_exponential_that_overflows_is_named_with_its_run() {
    let x = [Factor::new("x", 0.0, 10.0).unwrap()];
    let terms = [Term::intercept(), Term::saturating("x", -0.001)];
    let model = Model::new(&x, &terms).unwrap();
    let error = fit(&model, &POINTS, &Y, Weighting::Ordinary).unwrap_err();
    assert_eq!(
        error.to_string(),
        "term `exp(-x/-0.001)` of run 1 is inf, expected a finite number"
    );
}

#[test]
fn numbers_whose_squares_overflow_or_vanish_are_refused() {
    for size in [1.0e200, 1.0e-200, 1.0e305] {
        let y = Y.map(|y| y * size);
        let error = refusal(&points(), &y, Weighting::Ordinary);
        assert!(matches!(error, DoeError::Magnitude { .. }), "{error}");
        let weights = [size; 4];
        let weighted = fit(&line(), &POINTS, &Y, Weighting::Weights(&weights));
        // Square roots of weights have half the exponent: only the largest ones are too large.
        assert_eq!(weighted.is_err(), size == 1.0e305, "{size}");
        let x = [Factor::uncoded("x").unwrap()];
        let model = Model::new(&x, &ModelTerms::linear(&x)).unwrap();
        let far: Vec<[f64; 1]> = POINTS.iter().map(|p| [p[0] * size]).collect();
        let error = fit(&model, &far, &Y, Weighting::Ordinary).unwrap_err();
        let refused = matches!(error, DoeError::Magnitude { .. } | DoeError::NotFinite { .. });
        assert!(refused, "{error}");
    }
}

#[test]
fn questions_to_a_fit_are_tested_too() {
    let fit = fit(&line(), &POINTS, &Y, Weighting::Ordinary).unwrap();
    assert!(matches!(fit.interval(2, 0.95), Err(DoeError::TermIndex { index: 2, terms: 2 })));
    for level in [0.0, 1.0, -0.5, f64::NAN] {
        assert!(matches!(fit.interval(0, level), Err(DoeError::Probability { .. })));
        assert!(fit.predict(&[1.0]).unwrap().interval(level).is_err());
    }
    assert!(matches!(fit.predict(&[1.0, 2.0]), Err(DoeError::Length { .. })));
    assert!(matches!(fit.predict(&[f64::NAN]), Err(DoeError::NotFinite { .. })));
    assert!(matches!(fit.f_test(&[]), Err(DoeError::Empty { .. })));
    assert!(matches!(fit.f_test(&[7]), Err(DoeError::TermIndex { .. })));
    assert!(matches!(fit.gradient(&[]), Err(DoeError::Length { .. })));
    assert!(matches!(fit.stationary_point(&["z"], &[0.0]), Err(DoeError::UnknownFactor { .. })));
    assert!(eliminate(&line(), &POINTS, &Y, Weighting::Ordinary, 1.5, &[]).is_err());
}

#[test]
fn a_run_that_alone_carries_a_term_leaves_q2_undefined() {
    // The last run is the only one off zero.
    let points = [[0.0], [0.0], [0.0], [10.0]];
    let fit = fit(&line(), &points, &Y, Weighting::Ordinary).unwrap();
    assert_eq!((fit.q2(), fit.press()), (None, None));
    assert_eq!(fit.studentised_deleted_residuals()[3], None);
    assert!(fit.studentised_deleted_residuals()[0].is_some());
    assert!(fit.summary().warnings()[0].contains("leverage 1"));
}

#[test]
fn an_exact_fit_has_no_outliers_and_certain_coefficients() {
    let y = [1.0, 2.5, 4.5, 6.0];
    let fit = fit(&line(), &POINTS, &y, Weighting::Ordinary).unwrap();
    assert!(fit.r2() > 1.0 - 1.0e-15);
    assert!(fit.p_values().iter().all(|p| *p < 1.0e-12));
    assert!(fit.cooks_distance().iter().flatten().all(|d| d.is_finite()));
}
