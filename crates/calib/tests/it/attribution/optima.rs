//! Every optimum of an effect, and trials of points: a slope that is the square of a strength has two.

use calib::attribution::Settings;

use super::linear::{Line, SD, question};

const SPEEDS: [f64; 5] = [4.0, 7.0, 10.0, 13.0, 16.0];

#[test]
fn both_optima_are_found_and_points_are_tried_with_the_numbers_of_algebra() {
    // Slope 0.16 about 30 deg, with a residual that neither a level nor a slope takes.
    let apart = [0.1, -0.2, 0.2, -0.2, 0.1];
    let angles = SPEEDS.into_iter().zip(apart).map(|(w, e)| (w, 30.0 + 0.16 * (w - 10.0) + e));
    let (base, square) = (Line(None), Line(Some(|strength| strength * strength)));
    let range = ((-1.0, 1.0), Some(0.2));
    let attribution = question((&base, &square), angles, range, Settings::default());
    let noise: f64 = apart.iter().map(|e| (e / SD).powi(2)).sum();
    let (without, optima) = attribution.fits().expect("is well posed");
    // Sum of squares of the speeds about 10: 90.
    assert!((without.chi2 - noise - 0.16_f64.powi(2) * 90.0 / (SD * SD)).abs() < 1e-6);
    let mut found: Vec<f64> = optima[0].iter().map(|f| f.theta[1]).collect();
    found.sort_by(f64::total_cmp);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!((found[0] + 0.4).abs() < 1e-4 && (found[1] - 0.4).abs() < 1e-4, "{found:?}");
    let points = [vec![30.0, 0.4], vec![30.0, 0.0], vec![30.5, 0.4]];
    let tried = attribution.trials(0, &points).expect("is well posed");
    assert!((tried[0].chi2 - noise).abs() < 1e-9 && (tried[0].penalty - 4.0).abs() < 1e-9);
    // The fits' deviance holds the penalty too.
    assert!((tried[0].deviance - optima[0][0].deviance).abs() < 1e-6);
    assert!((tried[1].chi2 - without.chi2).abs() < 1e-6 && tried[1].penalty == 0.0);
    let shifted: f64 = apart.iter().map(|e| ((e - 0.5) / SD).powi(2)).sum();
    assert!((tried[2].chi2 - shifted).abs() < 1e-9);
    assert!(tried[2].p < tried[0].p);
}
