//! Matches the measured responses of one configuration against its table of simulated runs.
//!
//! The data are the thesis's AZ4_Steel: 5997 coated tablets on a steel mantle, with the errata
//! that are certain applied.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use calib::{ResponseSet, Study};
use rig_schema::{Case, Errata, ErrataLevel, MeasuredTable, SimulatedTable};

fn fixture(path: &str) -> &'static str {
    tumble_fixtures::read(path).expect("is compiled in")
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // ANCHOR: read
    let case = Case::parse("az4_steel.toml", fixture("thesis/cases/az4_steel.toml"))?;
    let measured = fixture("thesis/tables/experiment_AZ4_Steel.csv");
    let mut measured = MeasuredTable::parse("experiment_AZ4_Steel.csv", measured)?;
    let columns = Study::columns(&case)?;
    let factors: Vec<&str> = columns.iter().map(|(column, _)| column.as_str()).collect();
    let simulated = fixture("thesis/tables/edem_AZ4_Steel.csv");
    let mut simulated = SimulatedTable::parse("edem_AZ4_Steel.csv", simulated, &factors)?;
    let errata = Errata::parse("errata.csv", fixture("thesis/errata.csv"))?;
    errata.apply_measured(&mut measured, ErrataLevel::Certain)?;
    errata.apply_simulated(&mut simulated, ErrataLevel::Certain)?;
    // ANCHOR_END: read

    // ANCHOR: solve
    let study = Study::new(&case, &measured, simulated)?;
    println!("left out, beyond the simulated speeds: {:?} rpm", study.left_out_rpm);
    let all = study.problem().solve(200, 1)?; // 200 bootstrap draws, seed 1
    for e in &all.estimates {
        println!("{} {:.3}, from {:.3?} to {:.3?}", e.name, e.value, e.lo, e.hi);
        println!("  identified: {}, posterior mean {:.3}", e.flatness.identified, e.marginal.mean);
    }
    let g = all.goodness;
    println!("chi-square {:.1} for {} degrees of freedom, p {:.1e}", g.chi2, g.dof, g.p);
    // ANCHOR_END: solve

    // ANCHOR: look
    for n in &all.nuisances {
        println!("{} {:.2} +- {:.2}, pulled by {:.1} sd", n.name, n.value, n.sd, n.pull);
    }
    let worst = all.residuals.iter().max_by(|a, b| a.in_sd().abs().total_cmp(&b.in_sd().abs()));
    if let Some(r) = worst {
        println!("worst: {} at {} rpm, {:.1} sd", r.response, r.omega_rpm, r.in_sd());
    }
    // ANCHOR_END: look

    // ANCHOR: speed
    if let Some(found) = study.at_speed(17.0, ResponseSet::Angles)? {
        println!("17 rpm by both angles: {:.3}", found.estimates[0].value);
    }
    // ANCHOR_END: speed
    Ok(())
}
