//! One friction between the beads for four configurations: two walls, two fills.
//!
//! The data are the thesis's AZ1 and AZ2 as printed: 7807 and 10789 glass beads.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use calib::{JointMatch, JointMember, Study};
use rig_schema::{Case, MeasuredTable, SimulatedTable};

fn fixture(path: &str) -> &'static str {
    tumble_fixtures::read(path).expect("is compiled in")
}

fn study(name: &str) -> Result<Study, Box<dyn std::error::Error>> {
    let file = format!("thesis/cases/{}.toml", name.to_lowercase());
    let case = Case::parse(&file, fixture(&file))?;
    let file = format!("thesis/tables/experiment_{name}.csv");
    let measured = MeasuredTable::parse(&file, fixture(&file))?;
    let columns = Study::columns(&case)?;
    let factors: Vec<&str> = columns.iter().map(|(column, _)| column.as_str()).collect();
    let file = format!("thesis/tables/edem_{name}.csv");
    let simulated = SimulatedTable::parse(&file, fixture(&file), &factors)?;
    Ok(Study::new(&case, &measured, simulated)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let names = ["AZ1_Plexi", "AZ2_Plexi", "AZ1_Steel", "AZ2_Steel"];
    let studies = names.into_iter().map(study).collect::<Result<Vec<Study>, _>>()?;

    // ANCHOR: joint
    let members: Vec<JointMember<'_>> = studies.iter().map(Study::member).collect();
    let beads = JointMatch::solve("friction.pp", &members)?;
    println!("one friction: {:.3}, from {:.3?} to {:.3?}", beads.value, beads.lo, beads.hi);
    println!("do the configurations agree? p = {:.1e}", beads.tie.p);
    for m in &beads.members {
        println!("{}: alone {:.3}, the tie costs {:.1}", m.name, m.alone, m.strain);
    }
    // ANCHOR_END: joint

    // ANCHOR: withhold
    for w in JointMatch::withhold_each("friction.pp", &members)? {
        println!(
            "{} from the others: {:.3}, chi-square {:.0} for {} (own best {:.3}: {:.0})",
            w.name, w.value, w.goodness.chi2, w.goodness.dof, w.own_value, w.own.chi2
        );
    }
    // ANCHOR_END: withhold
    Ok(())
}
