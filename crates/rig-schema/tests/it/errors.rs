use rig_schema::{Case, MeasuredTable, Plan, Rig, SchemaError};

const RIG: &str = r#"
name = "beads"
drum = { radius_m = 0.125, length_m = 0.15, mantle = "steel", end_plates = "steel" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.006 } } }
fill.count = 7807
friction = { pp = 0.5, mantle = 0.6 }
run = { speeds_rpm = [17.0] }
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e7 }
steel = { density_kg_m3 = 8000.0, poisson_ratio = 0.265, shear_modulus_pa = 8e10 }
"#;

fn message(result: Result<impl Sized, SchemaError>) -> String {
    match result {
        Ok(_) => panic!("was accepted"),
        Err(e) => e.to_string(),
    }
}

#[test]
fn an_unknown_key_shows_its_line_and_the_nearest_known_one() {
    let text = RIG.replace("name =", "nmae =");
    let shown = message(Rig::parse("drum.toml", &text));
    assert!(shown.contains("`name` is missing"), "{shown}");
    let text = format!("frction.pp = 0.3\n{RIG}");
    let shown = message(Rig::parse("drum.toml", &text));
    assert!(shown.contains("drum.toml:1") && shown.contains("`friction`"), "{shown}");
    let shown = message(Rig::parse("drum.toml", &RIG.replace("mantle = 0.6", "mantel = 0.6")));
    assert!(shown.contains("friction.mantle") && shown.contains(":6"), "{shown}");
    let shown = message(Rig::parse("drum.toml", &RIG.replace("radius_m", "radius")));
    assert!(shown.contains("radius_m") && shown.contains(":3"), "{shown}");
}

#[test]
fn a_value_out_of_range_names_the_range() {
    let shown = message(Rig::parse("drum.toml", &RIG.replace("pp = 0.5", "pp = 5.0")));
    assert!(shown.contains("expected 0 to 2"), "{shown}");
    let shown = message(Rig::parse("drum.toml", &RIG.replace("0.125", "-0.125")));
    assert!(shown.contains("no volume"), "{shown}");
    let shown =
        message(Rig::parse("drum.toml", &RIG.replace("mantle = \"steel\"", "mantle = \"stel\"")));
    assert!(shown.contains("nearest: `steel`"), "{shown}");
}

#[test]
fn a_plan_and_a_case_refuse_what_they_do_not_know() {
    let plan = format!("factors.friction.pp = [0.1, 0.9]\ndesign.full_factorial = {{}}\n{RIG}");
    assert_eq!(Plan::parse("plan.toml", &plan).expect("reads").factors[0].levels, [0.1, 0.9]);
    let shown =
        message(Plan::parse("plan.toml", &plan.replace("friction.pp = [0.1", "friction.p = [0.1")));
    assert!(shown.contains("nearest known parameter"), "{shown}");
    let case = format!(
        "data.responses = \"m.csv\"\nfree.friction.pp = {{ range = [0.1, 0.9] }}\nsimulator.rig = {{}}\n{RIG}"
    );
    assert!(Case::parse("case.toml", &case).is_ok());
    let shown = message(Case::parse("case.toml", &case.replace("[0.1, 0.9]", "[0.9, 0.1]")));
    assert!(shown.contains("cannot be fitted"), "{shown}");
    let with = |n: &str| case.replace("\"m.csv\"", &format!("\"m.csv\"\ndata.fillings = {n}"));
    assert_eq!(Case::parse("case.toml", &with("3")).expect("reads").data.fillings, Some(3));
    let shown = message(Case::parse("case.toml", &with("0")));
    assert!(shown.contains("no number of fillings") && shown.contains("1 or more"), "{shown}");
    let table = "simulator.table = { file = \"t.csv\", columns = { mu = \"friction.pp\" } }";
    let shown = message(Case::parse("case.toml", &with("3").replace("simulator.rig = {}", table)));
    assert!(shown.contains("does not say how fillings of a drum differ"), "{shown}");
    let load = |n: &str| {
        case.replace(
            "\"m.csv\"",
            &format!("\"m.csv\"\ndata.loads = [{{ responses = \"h.csv\", {n} }}]"),
        )
    };
    let read = Case::parse("case.toml", &load("fill.count = 450")).expect("reads").data.loads;
    assert_eq!(read[0].fill.setting(), ("fill.count", 450.0));
    for (bad, needle) in [
        ("fill.mass_kg = 0.1", "the rig by another measure"),
        ("fill.count = -3", "is no load of a drum"),
        ("fill.count = 7807", "is that of the rig itself"),
        ("fill.count = 450, fillings = 0", "no number of fillings"),
        ("fill.count = 450, n_eff = 0.5", "not a number of frames"),
        ("fill.volume = 2", "unknown choice"),
        ("fillings = 2", "missing field"),
    ] {
        let shown = message(Case::parse("case.toml", &load(bad)));
        assert!(shown.contains(needle), "{bad}: {shown}");
    }
    let shown = load("fill.count = 450").replace("simulator.rig = {}", table);
    let shown = message(Case::parse("case.toml", &shown));
    assert!(shown.contains("simulated runs is of one load"), "{shown}");
}

#[test]
fn a_bad_cell_of_a_table_shows_file_line_and_expectation() {
    let header = "omega_rpm,aor_lin_deg,aor_lin_sd\n";
    for (row, needle) in [
        ("4,abc,0.1\n", "not a number"),
        ("4,NaN,0.1\n", "not finite"),
        ("4,30,-0.1\n", "negative"),
        ("4,30,0.1\n4,31,0.1\n", "stands twice"),
        ("4,30\n", "2 values in a row"),
        ("0,30,1\n", "not above 0"),
        ("", "no rows"),
    ] {
        let shown = message(MeasuredTable::parse("m.csv", &format!("{header}{row}")));
        assert!(shown.contains(needle) && shown.contains("m.csv"), "{shown}");
    }
    let shown = message(MeasuredTable::parse("m.csv", "omega_rpm,aor_ln_deg,aor_lin_sd\n4,1,1\n"));
    assert!(shown.contains("aor_lin_deg"), "{shown}");
}

#[test]
fn a_simulated_table_says_how_many_frames_it_is_made_of() {
    let text = "run,omega_rpm,friction.pp,aor_lin_deg,aor_lin_sd,n_frames,n_eff\n\
                0,17,0.5,27.5,0.4,30,12.5\n1,17,0.6,28.1,0.5,,\n";
    assert_eq!(rig_schema::SimulatedTable::factor_columns(text), ["friction.pp"]);
    let table = rig_schema::SimulatedTable::parse("runs.csv", text, &["friction.pp"])
        .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((table.rows[0].n_frames, table.rows[0].n_eff), (Some(30.0), Some(12.5)));
    assert_eq!((table.rows[1].n_frames, table.rows[1].n_eff), (None, None));
    let none = text.replace("12.5", "0");
    let shown = message(rig_schema::SimulatedTable::parse("runs.csv", &none, &["friction.pp"]));
    assert!(shown.contains("runs.csv:2") && shown.contains("n_eff"), "{shown}");
}

#[test]
fn a_case_says_how_far_an_effect_is_looked_for() {
    let case = format!(
        "data.responses = \"m.csv\"\nfree.friction.pp = {{ range = [0.1, 0.9] }}\nsimulator.rig = {{}}\ncatalogue.range.fill.scale = [0.5, 1.6]\n{RIG}"
    );
    let read = Case::parse("case.toml", &case).expect("is well formed");
    assert_eq!(read.catalogue.ranges["fill.scale"], (0.5, 1.6));
    let shown = message(Case::parse("case.toml", &case.replace("fill.scale", "fill.scael")));
    assert!(shown.contains("unknown effect `fill.scael`") && shown.contains(":4"), "{shown}");
    for wrong in ["[1.6, 0.5]", "[-1.0, 1.6]", "[0.5, nan]"] {
        let shown = message(Case::parse("case.toml", &case.replace("[0.5, 1.6]", wrong)));
        assert!(shown.contains("`fill.scale` cannot be looked for"), "{wrong}: {shown}");
    }
}
