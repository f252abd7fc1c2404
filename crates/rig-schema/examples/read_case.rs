//! Reads a case with its tables, and a file with a wrong key.
//!
//! The case is the thesis's AZ4_Steel: coated tablets, steel mantle.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use rig_schema::{Case, MeasuredTable, Rig, SchemaError, namespace};

fn fixture(path: &str) -> &'static str {
    tumble_fixtures::read(path).expect("is compiled in")
}

fn main() -> Result<(), SchemaError> {
    // ANCHOR: read
    let case = Case::parse("az4_steel.toml", fixture("thesis/cases/az4_steel.toml"))?;
    let table = "thesis/tables/experiment_AZ4_Steel.csv";
    let measured = MeasuredTable::parse("experiment_AZ4_Steel.csv", fixture(table))?;
    println!("{}: {} speeds measured", case.rig.name, measured.rows.len());
    for free in &case.free {
        println!("fit {} within {} to {}", free.path, free.range.0, free.range.1);
    }
    // ANCHOR_END: read

    // ANCHOR: parameter
    let roll = namespace::find("camera.roll_deg").expect("is declared");
    println!("{} ({}): {}", roll.path, roll.unit, roll.meaning);
    println!("here {:?}", case.rig.settings.value(roll.path));
    // ANCHOR_END: parameter

    // ANCHOR: error
    let text = fixture("thesis/cases/az4_steel.toml").replace("mantle = 0.6", "mantel = 0.6");
    if let Err(error) = Case::parse("my.toml", &text) {
        println!("{error}");
    }
    // ANCHOR_END: error
    assert!(Rig::parse("empty.toml", "").is_err());
    Ok(())
}
