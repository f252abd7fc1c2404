//! Two plans over the same three factors: a factorial with replicated centre, and a Latin
//! hypercube of as many runs.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use doe::design::{LatinHypercube, full_factorial, latin_hypercube};
use doe::{DoeError, Factor};

fn main() -> Result<(), DoeError> {
    // ANCHOR: plans
    let factors = [
        Factor::new("omega_rpm", 4.0, 30.0)?,
        Factor::new("mu_wall", 0.4, 0.8)?,
        Factor::new("mu_pp", 0.1, 0.9)?,
    ];
    let factorial = full_factorial(&factors, &[3, 3, 3])?.with_centre_points(2).randomised(1);
    let hypercube = latin_hypercube(&factors, &LatinHypercube::new(29, 1))?;
    // ANCHOR_END: plans

    println!("factorial: {} runs, first to do {:?}", factorial.runs(), factorial.run_order[0]);
    println!(
        "hypercube: {} runs, at least {:.3} apart in the unit cube",
        hypercube.runs(),
        hypercube.least_distance().unwrap_or_default()
    );
    for point in &hypercube.points[..5] {
        println!("{point:.3?}");
    }
    Ok(())
}
