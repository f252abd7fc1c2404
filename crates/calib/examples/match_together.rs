//! One friction between the beads for four configurations: two walls, two fills.
//!
//! The data are the thesis's AZ1 and AZ2, 7807 and 10789 glass beads, with the errata that are
//! certain applied. Without them one misprinted angle of AZ2_Plexi drags the shared value along.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use calib::{JointMatch, JointMember, Study};
use rig_schema::{Case, Errata, ErrataLevel, MeasuredTable, SimulatedTable};

fn fixture(path: &str) -> &'static str {
    tumble_fixtures::read(path).expect("is compiled in")
}

fn study(name: &str) -> Result<Study, Box<dyn std::error::Error>> {
    let file = format!("thesis/cases/{}.toml", name.to_lowercase());
    let case = Case::parse(&file, fixture(&file))?;
    let file = format!("experiment_{name}.csv");
    let text = fixture(&format!("thesis/tables/{file}"));
    let mut measured = MeasuredTable::parse(&file, text)?;
    let columns = Study::columns(&case)?;
    let factors: Vec<&str> = columns.iter().map(|(column, _)| column.as_str()).collect();
    let file = format!("edem_{name}.csv");
    let text = fixture(&format!("thesis/tables/{file}"));
    let mut simulated = SimulatedTable::parse(&file, text, &factors)?;
    // Errata name tables by their file names.
    let errata = Errata::parse("errata.csv", fixture("thesis/errata.csv"))?;
    errata.apply_measured(&mut measured, ErrataLevel::Certain)?;
    errata.apply_simulated(&mut simulated, ErrataLevel::Certain)?;
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
