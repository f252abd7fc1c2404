//! Published response-surface analyses: lack of fit, blocks.

use approx::assert_abs_diff_eq;
use doe::{Factor, Fit, Model, ModelTerms, Term, Weighting, fit};

fn rows(name: &str) -> Vec<Vec<f64>> {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader.deserialize().map(|r| r.unwrap()).collect()
}

/// Yield of a reaction over time and temperature in two blocks (R's `rsm` calls it ChemReact).
pub(crate) fn chemreact() -> Fit {
    let table = rows("chemreact.csv");
    let points: Vec<&[f64]> = table.iter().map(|r| &r[..3]).collect();
    let y: Vec<f64> = table.iter().map(|r| r[3]).collect();
    let factors = [
        Factor::new("time", 80.0, 90.0).unwrap(),
        Factor::new("temperature", 170.0, 180.0).unwrap(),
        Factor::uncoded("block").unwrap(),
    ];
    let mut terms = ModelTerms::quadratic(&factors[..2]);
    terms.push(Term::linear("block"));
    let model = Model::new(&factors, &terms).unwrap();
    fit(&model, &points, &y, Weighting::Ordinary).unwrap()
}

#[test]
fn central_composite_with_blocks_agrees_with_the_published_analysis() {
    // Values printed to six decimals.
    let fit = chemreact();
    let published = [
        ("1", 84.095427),
        ("block", -4.457530),
        ("time", 0.932541),
        ("temperature", 0.577712),
        ("time*temperature", 0.125),
        ("time^2", -1.308555),
        ("temperature^2", -0.933442),
    ];
    let names = fit.model().term_names();
    for (name, value) in published {
        let i = names.iter().position(|n| n == name).unwrap();
        assert_abs_diff_eq!(fit.coefficients()[i], value, epsilon = 6.0e-7);
    }
    assert_abs_diff_eq!(fit.r2(), 0.998082, epsilon = 6.0e-7);
    assert_abs_diff_eq!(fit.press().unwrap(), 0.760261, epsilon = 6.0e-7);
    assert_abs_diff_eq!(fit.q2().unwrap(), 0.992178, epsilon = 6.0e-7);
    let split = fit.anova().lack_of_fit.unwrap();
    assert_eq!((split.lack_of_fit.df, split.pure_error.df), (3, 4));
    assert_abs_diff_eq!(split.f.unwrap(), 0.530712, epsilon = 6.0e-7);
    assert_abs_diff_eq!(split.p.unwrap(), 0.685088, epsilon = 6.0e-7);
    assert_abs_diff_eq!(fit.model_validity().unwrap(), 0.90531, epsilon = 6.0e-6);
    assert_abs_diff_eq!(fit.reproducibility().unwrap(), 0.995542, epsilon = 6.0e-7);
}

#[test]
fn a_straight_line_through_the_load_cell_lacks_fit_as_the_handbook_says() {
    let table = rows("strd/pontius.csv");
    let points: Vec<&[f64]> = table.iter().map(|r| &r[1..]).collect();
    let y: Vec<f64> = table.iter().map(|r| r[0]).collect();
    let load = [Factor::new("load", 150_000.0, 3_000_000.0).unwrap()];
    let model = Model::new(&load, &ModelTerms::linear(&load)).unwrap();
    let fit = fit(&model, &points, &y, Weighting::Ordinary).unwrap();
    assert_eq!(fit.df(), 38);
    // Printed with ten and four decimals.
    assert_abs_diff_eq!(fit.rmse(), 0.0021712694, epsilon = 6.0e-11);
    let split = fit.anova().lack_of_fit.unwrap();
    assert_eq!((split.lack_of_fit.df, split.pure_error.df), (18, 20));
    assert_abs_diff_eq!(split.f.unwrap(), 214.7464, epsilon = 6.0e-5);
    assert!(split.p.unwrap() < 1.0e-15);
    assert!(fit.summary().warnings().iter().any(|w| w.contains("lack of fit")));
}
