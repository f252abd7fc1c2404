//! The saturating basis and elimination on the thesis's simulated tables.

use crate::statsmodels::{cases, thesis_factors};
use doe::{Model, ModelTerms, Weighting, eliminate, fit};

#[test]
fn the_saturating_basis_predicts_tablet_angles_that_level_off() {
    // The slope of tablets hardly grows above mu_pp 0.5; a square turns down again there, the
    // exponential does not. Both have ten terms, so R2 and Q2 compare directly.
    let factors = thesis_factors();
    let quadratic = Model::new(&factors, &ModelTerms::quadratic(&factors)).unwrap();
    for case in cases() {
        let curved = fit(&quadratic, &case.points, &case.y, Weighting::Ordinary).unwrap();
        for m0 in [0.07, 0.2, 0.4] {
            let terms = ModelTerms::saturating(&factors, "mu_pp", m0).unwrap();
            let model = Model::new(&factors, &terms).unwrap();
            let saturating = fit(&model, &case.points, &case.y, Weighting::Ordinary).unwrap();
            // On three levels 1, x, exp(-x/m0) span the same functions as 1, x, x^2: the fits
            // agree at the levels and differ only between them. That is why three levels do not
            // determine m0. 1e-9: the exponential's column is nearly dependent for small m0.
            assert!((saturating.r2() - curved.r2()).abs() < 1.0e-9, "{} {m0}", case.name);
            for (a, b) in saturating.fitted().iter().zip(curved.fitted()) {
                assert!((a - b).abs() < 1.0e-8, "{} {m0}", case.name);
            }
        }
    }
}

#[test]
fn elimination_never_lowers_the_adjusted_r2_of_the_thesis_fits_by_much() {
    // A term with p > 0.1 has F below 2.9: taking it out lowers R2adj by at most
    // (F - 1)/df (1 - R2adj) a step, and a step with F < 1 raises it.
    let factors = thesis_factors();
    let model = Model::new(&factors, &ModelTerms::quadratic(&factors)).unwrap();
    let mut removed = 0;
    for case in cases() {
        let done = eliminate(&model, &case.points, &case.y, Weighting::Ordinary, 0.1, &[]).unwrap();
        let mut before = done.start;
        for step in &done.steps {
            let bound = 2.0 / before.df as f64 * (1.0 - before.r2_adjusted);
            assert!(step.summary.r2_adjusted > before.r2_adjusted - bound, "{}", case.name);
            before = step.summary;
        }
        removed += done.steps.len();
        assert_eq!(done.fit.coefficients().len() + done.steps.len(), 10);
    }
    assert!(removed > 48, "{removed} terms removed from 48 fits");
}
