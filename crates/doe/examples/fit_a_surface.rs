//! Fits the slope of a bed of beads over speed and friction, and asks whether to believe it.
//!
//! The numbers are simulated responses of glass beads in a Plexiglas drum at a wall friction of
//! 0.6, lines through the whole surface (`fixtures/thesis/tables/edem_AZ1_Plexi.csv`).
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use doe::{DoeError, Factor, Model, ModelTerms, Weighting, eliminate, fit};

fn main() -> Result<(), DoeError> {
    let factors = [Factor::new("omega_rpm", 4.0, 30.0)?, Factor::new("mu_pp", 0.1, 0.9)?];
    let points = [
        [4.0, 0.1],
        [17.0, 0.1],
        [30.0, 0.1],
        [4.0, 0.5],
        [17.0, 0.5],
        [30.0, 0.5],
        [4.0, 0.9],
        [17.0, 0.9],
        [30.0, 0.9],
        [17.0, 0.5],
    ];
    let slope_deg = [20.87, 22.52, 24.66, 28.72, 28.62, 30.13, 30.02, 31.03, 31.99, 28.97];

    // ANCHOR: fit
    let model = Model::new(&factors, &ModelTerms::quadratic(&factors))?;
    let surface = fit(&model, &points, &slope_deg, Weighting::Ordinary)?;
    for row in surface.coefficient_table(0.95)? {
        println!(
            "{:16} {:8.3}  [{:7.3}, {:7.3}]  p {:.4}",
            row.term, row.estimate, row.low, row.high, row.p
        );
    }
    // ANCHOR_END: fit

    // ANCHOR: believe
    let summary = surface.summary();
    println!("R2 {:.3}, Q2 {:.3}", summary.r2, summary.q2.unwrap_or(f64::NAN));
    for warning in summary.warnings() {
        println!("warning: {warning}");
    }
    // ANCHOR_END: believe

    // ANCHOR: reduce
    let reduced = eliminate(&model, &points, &slope_deg, Weighting::Ordinary, 0.05, &[])?;
    for step in &reduced.steps {
        println!("without {} (p {:.2}): Q2 {:.3?}", step.removed, step.p, step.summary.q2);
    }
    println!("slope = {}", reduced.fit.natural_form()?);
    // ANCHOR_END: reduce

    let at = surface.predict(&[17.0, 0.3])?;
    let (low, high) = at.interval_new(0.95)?;
    println!("at 17 rpm and 0.3: {:.2} deg, a new run within [{low:.2}, {high:.2}]", at.mean);
    Ok(())
}
