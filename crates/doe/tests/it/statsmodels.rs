//! The 48 response surfaces of the thesis's simulated tables, against statsmodels.

use doe::{Factor, Fit, Model, ModelTerms, Weighting, fit};
use serde_json::Value;

const ORACLE: &str = include_str!("../data/statsmodels.json");

pub(crate) fn thesis_factors() -> [Factor; 3] {
    [("omega_rpm", 4.0, 30.0), ("mu_wall", 0.4, 0.8), ("mu_pp", 0.1, 0.9)]
        .map(|(name, low, high)| Factor::new(name, low, high).unwrap())
}

pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) points: Vec<Vec<f64>>,
    pub(crate) y: Vec<f64>,
    pub(crate) oracle: Value,
}

impl Case {
    fn quadratic(&self, weighting: Weighting<'_>) -> Fit {
        let factors = thesis_factors();
        let model = Model::new(&factors, &ModelTerms::quadratic(&factors)).unwrap();
        fit(&model, &self.points, &self.y, weighting).unwrap()
    }

    /// Relative 1e-9, as promised; 1e-11 absolute for figures near zero, which the 12 digits of
    /// the fixture and statsmodels' pseudo-inverse limit.
    fn same(&self, what: &str, ours: f64, theirs: &Value) {
        let theirs = theirs.as_f64().unwrap_or_else(|| panic!("{} {what}", self.name));
        let error = (ours - theirs).abs();
        assert!(
            error <= 1.0e-9 * theirs.abs() + 1.0e-11,
            "{} {what}: {ours} against {theirs}",
            self.name
        );
    }

    fn all_same(&self, what: &str, ours: &[f64], theirs: &Value) {
        let theirs = theirs.as_array().unwrap();
        assert_eq!(ours.len(), theirs.len(), "{what}");
        ours.iter().zip(theirs).for_each(|(o, t)| self.same(what, *o, t));
    }
}

pub(crate) fn cases() -> Vec<Case> {
    let oracle: Value = serde_json::from_str(ORACLE).unwrap();
    let numbers = |v: &Value| -> Vec<f64> {
        v.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
    };
    let mut points: Vec<Vec<f64>> = vec![];
    let mut cases = vec![];
    for entry in oracle["fits"].as_array().unwrap() {
        // The points are written once a table.
        if let Some(rows) = entry["points"].as_array() {
            points = rows.iter().map(numbers).collect();
        }
        cases.push(Case {
            name: format!("{} {}", entry["config"], entry["response"]),
            points: points.clone(),
            y: numbers(&entry["y"]),
            oracle: entry.clone(),
        });
    }
    assert_eq!(cases.len(), 48);
    cases
}

fn known(values: &[Option<f64>]) -> Vec<f64> {
    values.iter().map(|v| v.expect("no run of the plan has leverage one")).collect()
}

#[test]
fn coefficients_and_their_errors_agree() {
    for case in cases() {
        let (fit, o) = (case.quadratic(Weighting::Ordinary), &case.oracle);
        case.all_same("coefficient", fit.coefficients(), &o["coefficients"]);
        case.all_same("standard error", &fit.standard_errors(), &o["standard_errors"]);
        case.all_same("p", &fit.p_values(), &o["p_values"]);
        let table = fit.coefficient_table(0.95).unwrap();
        let ends: Vec<f64> = table.iter().flat_map(|row| [row.low, row.high]).collect();
        case.all_same("t interval", &ends, &o["interval_95"]);
    }
}

#[test]
fn summaries_agree() {
    for case in cases() {
        let (fit, o) = (case.quadratic(Weighting::Ordinary), &case.oracle);
        case.same("R2", fit.r2(), &o["r2"]);
        case.same("R2 adjusted", fit.r2_adjusted(), &o["r2_adjusted"]);
        case.same("residual sd", fit.rmse(), &o["rmse"]);
        case.same("PRESS", fit.press().unwrap(), &o["press"]);
        case.same("Q2", fit.q2().unwrap(), &o["q2"]);
        case.same("F", fit.anova().f.unwrap(), &o["f"]);
    }
}

#[test]
fn diagnostics_of_runs_agree() {
    for case in cases() {
        let (fit, o) = (case.quadratic(Weighting::Ordinary), &case.oracle);
        case.all_same("leverage", fit.leverage(), &o["leverage"]);
        let deleted = known(fit.studentised_deleted_residuals());
        case.all_same("studentised deleted residual", &deleted, &o["studentised_deleted"]);
        case.all_same("Cook", &known(fit.cooks_distance()), &o["cooks_distance"]);
    }
}

#[test]
fn the_test_of_all_wall_terms_agrees() {
    for case in cases() {
        let (fit, o) = (case.quadratic(Weighting::Ordinary), &case.oracle);
        let wall = fit.model().positions_involving("mu_wall");
        assert_eq!(wall.len(), 4);
        let test = fit.f_test(&wall).unwrap();
        assert_eq!((test.df1, test.df2), (4, 18));
        case.same("F of the wall terms", test.f, &o["f_wall"]);
        case.same("p of the wall terms", test.p, &o["p_wall"]);
    }
}

#[test]
fn lack_of_fit_agrees() {
    let mut without_scatter = 0;
    for case in cases() {
        let (fit, o) = (case.quadratic(Weighting::Ordinary), &case.oracle);
        let split = fit.anova().lack_of_fit.expect("run 28 repeats run 14");
        assert_eq!((split.lack_of_fit.df, split.pure_error.df), (17, 1));
        case.same("lack of fit", split.lack_of_fit.ss, &o["lack_of_fit_ss"]);
        case.same("pure error", split.pure_error.ss, &o["pure_error_ss"]);
        if o["f_lack"].is_null() {
            assert_eq!((split.f, split.p, fit.model_validity()), (None, None, None));
            without_scatter += 1;
        } else {
            case.same("F of lack of fit", split.f.unwrap(), &o["f_lack"]);
            case.same("p of lack of fit", split.p.unwrap(), &o["p_lack"]);
        }
    }
    // Replicates that repeat to the last printed digit leave no pure error to test against.
    assert!(without_scatter < 48);
}

#[test]
fn predictions_between_the_runs_agree() {
    let factors = thesis_factors();
    for case in cases() {
        let (fit, o) = (case.quadratic(Weighting::Ordinary), &case.oracle);
        let coded = [0.5, -0.25, 0.75];
        let x: Vec<f64> = factors.iter().zip(coded).map(|(f, c)| f.decode(c)).collect();
        let at = fit.predict(&x).unwrap();
        case.same("prediction", at.mean, &o["predicted_mean"]);
        let (low, high) = at.interval(0.95).unwrap();
        case.all_same("its interval", &[low, high], &o["predicted_interval_95"]);
        let (low, high) = at.interval_new(0.95).unwrap();
        case.all_same("interval of a new run", &[low, high], &o["predicted_new_interval_95"]);
    }
}

#[test]
fn weighted_and_generalised_fits_agree() {
    for case in cases() {
        let n = case.y.len();
        let weights: Vec<f64> = (0..n).map(|i| 1.0 + 0.1 * i as f64).collect();
        let (fit, o) = (case.quadratic(Weighting::Weights(&weights)), &case.oracle["weighted"]);
        case.all_same("weighted coefficient", fit.coefficients(), &o["coefficients"]);
        case.all_same("weighted error", &fit.standard_errors(), &o["standard_errors"]);
        case.same("weighted R2", fit.r2(), &o["r2"]);
        let covariance: Vec<f64> =
            (0..n * n).map(|k| 0.4_f64.powi((k / n).abs_diff(k % n) as i32)).collect();
        let fit = case.quadratic(Weighting::Covariance(&covariance));
        let o = &case.oracle["generalised"];
        case.all_same("generalised coefficient", fit.coefficients(), &o["coefficients"]);
        case.all_same("generalised error", &fit.standard_errors(), &o["standard_errors"]);
    }
}
