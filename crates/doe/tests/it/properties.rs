//! What must hold for any data.

use doe::{Factor, Fit, Model, ModelTerms, Weighting, fit};
use proptest::prelude::*;

/// Random runs of two factors and a response: 12 runs determine the 6 quadratic terms.
fn runs() -> impl Strategy<Value = (Vec<Vec<f64>>, Vec<f64>)> {
    let point = prop::collection::vec(-1.0_f64..1.0, 2);
    let points = prop::collection::vec(point, 12..20);
    points.prop_flat_map(|points| {
        let n = points.len();
        (Just(points), prop::collection::vec(-5.0_f64..5.0, n))
    })
}

fn quadratic(low: f64, high: f64) -> Model {
    let f = ["a", "b"].map(|n| Factor::new(n, low, high).unwrap());
    Model::new(&f, &ModelTerms::quadratic(&f)).unwrap()
}

/// A fit of runs that are not near an alias by chance.
fn sound(model: &Model, points: &[Vec<f64>], y: &[f64], w: Weighting<'_>) -> Option<Fit> {
    fit(model, points, y, w).ok().filter(|f| f.condition_number() < 1.0e3)
}

fn close(a: f64, b: f64) -> bool {
    // Condition numbers up to 1e3 and responses up to 5: a thousand times the rounding of both.
    (a - b).abs() <= 1.0e-9 * (1.0 + a.abs().max(b.abs()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_order_of_runs_does_not_matter((points, y) in runs(), shift in 1_usize..11) {
        let model = quadratic(-1.0, 1.0);
        let Some(one) = sound(&model, &points, &y, Weighting::Ordinary) else { return Ok(()) };
        let (mut p, mut z) = (points, y);
        p.rotate_left(shift);
        z.rotate_left(shift);
        let other = fit(&model, &p, &z, Weighting::Ordinary).unwrap();
        for (a, b) in one.coefficients().iter().zip(other.coefficients()) {
            prop_assert!(close(*a, *b));
        }
        prop_assert!(close(one.q2().unwrap(), other.q2().unwrap()));
    }

    #[test]
    fn coding_does_not_change_what_is_predicted((points, y) in runs(), a in -1.0_f64..1.0) {
        let Some(one) = sound(&quadratic(-1.0, 1.0), &points, &y, Weighting::Ordinary) else {
            return Ok(());
        };
        let other = fit(&quadratic(-3.0, 2.0), &points, &y, Weighting::Ordinary).unwrap();
        let (p, q) = (one.predict(&[a, 0.3]).unwrap(), other.predict(&[a, 0.3]).unwrap());
        prop_assert!(close(p.mean, q.mean));
        prop_assert!(close(p.var_mean, q.var_mean));
        prop_assert!(close(one.press().unwrap(), other.press().unwrap()));
        prop_assert!(close(other.natural_form().unwrap().mean(&[a, 0.3]), p.mean));
    }

    #[test]
    fn a_weight_of_two_is_a_run_done_twice((points, y) in runs(), twice in 0_usize..12) {
        let model = quadratic(-1.0, 1.0);
        let mut weights = vec![1.0; y.len()];
        weights[twice] = 2.0;
        let Some(one) = sound(&model, &points, &y, Weighting::Weights(&weights)) else {
            return Ok(());
        };
        let (mut p, mut z) = (points, y);
        p.push(p[twice].clone());
        z.push(z[twice]);
        let other = fit(&model, &p, &z, Weighting::Ordinary).unwrap();
        for i in 0..6 {
            prop_assert!(close(one.coefficients()[i], other.coefficients()[i]));
            prop_assert!(close(one.unscaled_covariance(i, i), other.unscaled_covariance(i, i)));
        }
        prop_assert!(close(one.anova().residual.ss, other.anova().residual.ss));
        prop_assert!(close(one.anova().total.ss, other.anova().total.ss));
    }

    #[test]
    fn a_diagonal_covariance_is_the_inverse_of_weights((points, y) in runs(), w in 0.2_f64..5.0) {
        let (model, n) = (quadratic(-1.0, 1.0), y.len());
        let weights: Vec<f64> = (0..n).map(|i| if i % 3 == 0 { w } else { 1.0 }).collect();
        let mut covariance = vec![0.0; n * n];
        (0..n).for_each(|i| covariance[i * n + i] = 1.0 / weights[i]);
        let Some(one) = sound(&model, &points, &y, Weighting::Weights(&weights)) else {
            return Ok(());
        };
        let other = fit(&model, &points, &y, Weighting::Covariance(&covariance)).unwrap();
        for i in 0..6 {
            prop_assert!(close(one.coefficients()[i], other.coefficients()[i]));
        }
        for i in 0..n {
            prop_assert!(close(one.leverage()[i], other.leverage()[i]));
            let deleted = |f: &Fit| f.studentised_deleted_residuals()[i].unwrap();
            prop_assert!((deleted(&one) / deleted(&other) - 1.0).abs() < 1.0e-6);
        }
        prop_assert!(close(one.press().unwrap(), other.press().unwrap()));
    }

    #[test]
    fn deleted_residuals_are_those_of_refitting_without_the_run((points, y) in runs()) {
        let model = quadratic(-1.0, 1.0);
        let Some(all) = sound(&model, &points, &y, Weighting::Ordinary) else { return Ok(()) };
        for run in 0..y.len() {
            let (mut p, mut z) = (points.clone(), y.clone());
            let (x, value) = (p.remove(run), z.remove(run));
            let Some(rest) = sound(&model, &p, &z, Weighting::Ordinary) else { continue };
            let deleted = all.deleted_residuals()[run].unwrap();
            let at = rest.predict(&x).unwrap();
            prop_assert!(close(deleted, value - at.mean));
            let t = (value - at.mean) / at.var_new.sqrt();
            prop_assert!(close(all.studentised_deleted_residuals()[run].unwrap(), t));
        }
    }

    #[test]
    fn correlated_runs_are_predicted_with_their_neighbours((points, y) in runs()) {
        // Leaving out run i of a generalised fit: its prediction is the surface plus what the
        // correlation with the residuals of the others tells, S_i,rest S_rest^-1 e_rest.
        let (model, n) = (quadratic(-1.0, 1.0), y.len());
        let rho = |i: usize, j: usize| 0.5_f64.powi(i.abs_diff(j) as i32);
        let full: Vec<f64> = (0..n * n).map(|k| rho(k / n, k % n)).collect();
        let Some(all) = sound(&model, &points, &y, Weighting::Covariance(&full)) else {
            return Ok(());
        };
        // Run 0 of an autoregressive chain depends on run 1 alone: S_0,rest S_rest^-1 = (rho, 0, ..).
        let rest: Vec<f64> =
            (0..(n - 1) * (n - 1)).map(|k| rho(k / (n - 1), k % (n - 1))).collect();
        let w = Weighting::Covariance(&rest);
        let Some(without) = sound(&model, &points[1..], &y[1..], w) else { return Ok(()) };
        let predicted = without.mean(&points[0]) + 0.5 * without.residuals()[0];
        prop_assert!(close(all.deleted_residuals()[0].unwrap(), y[0] - predicted));
    }

    #[test]
    fn leverages_sum_to_the_number_of_terms((points, y) in runs()) {
        let Some(f) = sound(&quadratic(-1.0, 1.0), &points, &y, Weighting::Ordinary) else {
            return Ok(());
        };
        prop_assert!(close(f.leverage().iter().sum(), 6.0));
        prop_assert!(f.leverage().iter().all(|h| *h > 0.0 && *h <= 1.0 + 1.0e-12));
    }

    #[test]
    fn residuals_are_orthogonal_to_every_term((points, y) in runs()) {
        let model = quadratic(-1.0, 1.0);
        let Some(f) = sound(&model, &points, &y, Weighting::Ordinary) else { return Ok(()) };
        for i in 0..6 {
            let along: f64 =
                f.residuals().iter().zip(&points).map(|(e, x)| e * model.row(x)[i]).sum();
            prop_assert!(along.abs() < 1.0e-12);
        }
    }

    #[test]
    fn testing_one_term_is_the_square_of_its_t((points, y) in runs(), term in 0_usize..6) {
        let Some(f) = sound(&quadratic(-1.0, 1.0), &points, &y, Weighting::Ordinary) else {
            return Ok(());
        };
        let test = f.f_test(&[term]).unwrap();
        prop_assert!(close(test.f.sqrt(), f.t_values()[term].abs()));
        prop_assert!((test.p - f.p_values()[term]).abs() < 1.0e-9);
    }

    #[test]
    fn testing_all_terms_is_the_analysis_of_variance((points, y) in runs()) {
        let Some(f) = sound(&quadratic(-1.0, 1.0), &points, &y, Weighting::Ordinary) else {
            return Ok(());
        };
        prop_assert!(close(f.f_test(&[1, 2, 3, 4, 5]).unwrap().f, f.anova().f.unwrap()));
    }
}
