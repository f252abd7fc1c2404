//! Malformed inputs, each with the text that the user sees. Exit code 2, nothing written.

use std::path::Path;

use tempfile::tempdir;

use crate::run::{stderr, stdout, tumble};

fn fixture(path: &str) -> String {
    tumble_fixtures::read(path).expect("is built in").to_owned()
}

/// A folder with a case and its two tables.
struct Mine {
    case: String,
    measured: String,
    simulated: String,
}

impl Mine {
    fn new() -> Self {
        Self {
            case: fixture("thesis/cases/az4_steel.toml").replace("../tables/", ""),
            measured: fixture("thesis/tables/experiment_AZ4_Steel.csv"),
            simulated: fixture("thesis/tables/edem_AZ4_Steel.csv"),
        }
    }

    /// What the user sees when the case is calibrated.
    fn shown(&self) -> String {
        let folder = tempdir().expect("a folder");
        let write = |name: &str, text: &str| {
            std::fs::write(folder.path().join(name), text).expect("written");
        };
        write("case.toml", &self.case);
        write("experiment_AZ4_Steel.csv", &self.measured);
        write("edem_AZ4_Steel.csv", &self.simulated);
        refused(folder.path(), &["calibrate", "case.toml", "--bootstrap", "0"])
    }
}

/// Standard error of a call that must fail with exit code 2 and write nothing.
fn refused(folder: &Path, args: &[&str]) -> String {
    let output = tumble(folder, args);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(stdout(&output).is_empty());
    assert!(!folder.join("tumble-out").exists(), "something was written");
    // Progress lines are not the error.
    let at = text.find("error:").expect("an error is shown");
    text[at..].to_owned()
}

fn case(from: &str, to: &str) -> String {
    let mut mine = Mine::new();
    assert!(mine.case.contains(from), "{from}");
    mine.case = mine.case.replacen(from, to, 1);
    mine.shown()
}

fn measured(from: &str, to: &str) -> String {
    let mut mine = Mine::new();
    assert!(mine.measured.contains(from), "{from}");
    mine.measured = mine.measured.replacen(from, to, 1);
    mine.shown()
}

#[test]
fn tables_that_cannot_be_used() {
    let header = "omega_rpm,aor_lin_deg,aor_lin_sd";
    insta::assert_snapshot!(
        "01_missing_sd_column",
        measured(header, "omega_rpm,aor_lin_deg,n_eff")
    );
    insta::assert_snapshot!("02_unknown_column", measured("cen_x_pct", "centre_x"));
    insta::assert_snapshot!("03_text_for_a_number", measured("31.67", "about 32"));
    insta::assert_snapshot!("04_decimal_comma", measured("31.67,", "\"31,67\","));
    insta::assert_snapshot!("05_duplicate_speed", measured("\n12,", "\n8,"));
    insta::assert_snapshot!("06_negative_sd", measured("31.67,0.16", "31.67,-0.16"));
    insta::assert_snapshot!("07_not_a_number", measured("31.67", "NaN"));
    insta::assert_snapshot!("08_infinite", measured("31.67", "inf"));
    insta::assert_snapshot!("09_short_row", measured("31.67,0.16,", ""));
    let mut mine = Mine::new();
    mine.measured = String::new();
    insta::assert_snapshot!("10_empty_table", mine.shown());
    mine.measured = "omega_rpm,aor_lin_deg,aor_lin_sd\n".to_owned();
    insta::assert_snapshot!("11_header_alone", mine.shown());
    mine.measured = "omega_rpm,aor_lin_deg,aor_lin_sd\n40,31,0.2\n".to_owned();
    insta::assert_snapshot!("12_every_speed_beyond_the_surrogate", mine.shown());
    let mut mine = Mine::new();
    // The header and every fourth run: seven, with all levels of every factor.
    let lines: Vec<&str> = mine.simulated.lines().collect();
    let runs = lines[2..].iter().enumerate().filter(|(i, _)| i % 4 == 0).map(|(_, l)| *l);
    mine.simulated = [lines[1]].into_iter().chain(runs).collect::<Vec<_>>().join("\n");
    insta::assert_snapshot!("13_fewer_runs_than_terms", mine.shown());
    let mut mine = Mine::new();
    mine.simulated = mine.simulated.replace("mu_wall", "mu_drum");
    insta::assert_snapshot!("14_missing_factor_column", mine.shown());
    let mut mine = Mine::new();
    mine.simulated = mine.simulated.replace("\n2,17,", "\n1,17,");
    insta::assert_snapshot!("15_run_stands_twice", mine.shown());
}

#[test]
fn cases_that_cannot_be_used() {
    insta::assert_snapshot!("16_unknown_key", case("radius_m", "raduis_m"));
    insta::assert_snapshot!(
        "17_unknown_table",
        case("[nuisance.measure.offset_x_pct]", "[nuisnace.measure.offset_x_pct]")
    );
    insta::assert_snapshot!(
        "18_unknown_parameter",
        case("friction.mantle = { range", "friction.mantel = { range")
    );
    insta::assert_snapshot!("19_range_upside_down", case("[0.4, 0.8]", "[0.8, 0.4]"));
    insta::assert_snapshot!("20_value_out_of_range", case("pp = 0.5", "pp = 50.0"));
    insta::assert_snapshot!(
        "21_text_for_a_number",
        case("length_m = 0.150", "length_m = \"long\"")
    );
    insta::assert_snapshot!("22_not_toml", case("[drum]", "[drum"));
    insta::assert_snapshot!("23_no_such_table", case("experiment_AZ4_Steel.csv", "experiment.csv"));
    insta::assert_snapshot!("24_prior_without_width", case("sd = 2.0", "sd = 0.0"));
    insta::assert_snapshot!(
        "25_material_not_listed",
        case("mantle = \"steel\"", "mantle = \"stel\"")
    );
    insta::assert_snapshot!(
        "26_free_parameter_without_column",
        case(
            "friction.mantle = { range = [0.4, 0.8] }",
            "rolling.pp = { range = [0.0, 0.1] }\nfriction.mantle = { range = [0.4, 0.8] }"
        )
    );
}

#[test]
fn calls_that_cannot_be_carried_out() {
    let folder = tempdir().expect("a folder");
    insta::assert_snapshot!("27_no_such_case", refused(folder.path(), &["calibrate", "AZ3_Steel"]));
    insta::assert_snapshot!("28_no_such_file", refused(folder.path(), &["calibrate", "mine.toml"]));
    insta::assert_snapshot!(
        "29_case_given_twice",
        refused(folder.path(), &["calibrate", "AZ1_Steel", "az1_steel"])
    );
    std::fs::write(folder.path().join("file"), "").expect("written");
    let args = ["calibrate", "AZ1_Steel", "--bootstrap", "0", "--out", "file"];
    insta::assert_snapshot!("30_output_is_a_file", refused(folder.path(), &args));
}

#[test]
fn differences_between_codes_that_cannot_be_used() {
    let drum = fixture("demo/drum.toml");
    let named = drum.replace("[data]\n", "[data]\ncode_differences = \"codes.csv\"\n");
    assert_ne!(drum, named);
    let shown = |case: &str, codes: Option<&str>| {
        let folder = tempdir().expect("a folder");
        let write = |name: &str, text: &str| {
            std::fs::write(folder.path().join(name), text).expect("written");
        };
        write("case.toml", case);
        write("measured.csv", &fixture("demo/measured.csv"));
        write("experiment_AZ4_Steel.csv", &fixture("thesis/tables/experiment_AZ4_Steel.csv"));
        codes.iter().for_each(|text| write("codes.csv", text));
        refused(folder.path(), &["close-loop", "case.toml", "--out", "tumble-out"])
    };
    assert!(shown(&named, None).contains("codes.csv cannot be read"));
    let short = shown(&named, Some("pair,omega_rpm,aor_lin_deg\n1,20,0.5\n"));
    assert!(short.contains("codes.csv:1") && short.contains("aor_mid_deg"), "{short}");
    let of_a_table =
        Mine::new().case.replace("[data]\n", "[data]\ncode_differences = \"codes.csv\"\n");
    let header = "pair,omega_rpm,aor_lin_deg,aor_mid_deg,cen_x_pct,cen_y_pct\n";
    let text = shown(&of_a_table, Some(&format!("{header}1,20,0,0,0,0\n")));
    assert!(text.contains("data.code_differences needs simulations"), "{text}");
}

#[test]
fn what_cannot_be_is_said_with_its_place() {
    let says = |text: String, words: &[&str]| {
        assert!(words.iter().all(|w| text.contains(w)), "{words:?} not in: {text}");
    };
    says(case("[0.4, 0.8]", "[0.4, 0.6, 0.8]"), &["case.toml:", "3 numbers", "[low, high]"]);
    says(case("[0.1, 0.9]", "[0.1, 2.0]"), &["edem_AZ4_Steel.csv", "0.1 to 0.9", "0.1 to 2"]);
    let holdout = |what: &str| case("[drum]", &format!("[holdout]\n{what}\n[drum]"));
    says(holdout("speeds_rpm = [13.0]"), &["13 rpm", "was not measured"]);
    says(holdout("every = 1"), &["case.toml:", "`every`"]);
    says(case("name = \"AZ4_Steel\"", "name = \"../mine\""), &["case.toml:", "name of a folder"]);
    says(measured("31.67,0.16", "1e300,0.16"), &["experiment_AZ4_Steel.csv:", "aor_lin_deg"]);
    says(measured("omega_rpm,", "omega_rpm;"), &["semicolons"]);
    let mut mine = Mine::new();
    let rows: Vec<&str> = mine.simulated.lines().collect();
    let first = rows.iter().position(|l| l.starts_with("1,")).expect("run 1");
    let factor = rows[first - 1].split(',').position(|c| c == "mu_pp").expect("a factor");
    let mut fields: Vec<&str> = rows[first].split(',').collect();
    fields[factor] = "-3";
    mine.simulated = mine.simulated.replacen(rows[first], &fields.join(","), 1);
    says(mine.shown(), &["edem_AZ4_Steel.csv", "friction.pp", "-3"]);
}

/// A rig of few beads; other lines instead of some.
fn few_beads(changes: &[(&str, &str)]) -> String {
    let mut rig = fixture("demo/drum.toml");
    let end = rig.find("[data]").expect("a case");
    rig.truncate(end);
    for (from, to) in changes {
        assert!(rig.contains(from), "{from}");
        rig = rig.replacen(from, to, 1);
    }
    rig
}

#[test]
fn runs_that_cannot_be_carried_out_are_refused_before_they_begin() {
    let folder = tempdir().expect("a folder");
    std::fs::write(folder.path().join("rig.toml"), few_beads(&[])).expect("written");
    let shown = |args: &[&str]| refused(folder.path(), args);
    let simulate = |more: &[&str]| shown(&[&["simulate", "rig.toml"], more].concat());
    assert!(simulate(&["--speeds", "0"]).contains("0.001 to 10000 rpm"));
    assert!(simulate(&["--speeds", "nan"]).contains("NaN rpm"));
    assert!(simulate(&["--speeds", "20,20"]).contains("20 rpm stands twice"));
    assert!(simulate(&["--frames", "0"]).contains("0 frames"));
    assert!(simulate(&["--width", "0"]).contains("16384 pixels"));
    let export = |more: &[&str]| shown(&[&["export", "rig.toml", "--to", "lammps"], more].concat());
    assert!(export(&["--speeds=-5,30"]).contains("-5 rpm"));
    assert!(export(&["--times", "1,1"]).contains("times of frames that rise"));
    assert!(export(&["--approach-turns", "1e300"]).contains("1000 turns"));
    let misspelt = few_beads(&[("[particles]", "[particels]")]);
    std::fs::write(folder.path().join("rig.toml"), misspelt).expect("written");
    let said = simulate(&[]);
    assert!(said.contains("`particels`") && said.contains("`particles` is missing"), "{said}");
    for (fill, says) in [
        ("count = 560\nmass_kg = 0.1", "the fill is given twice"),
        ("count = 56.5", "a whole number of particles"),
    ] {
        let rig = few_beads(&[("count = 560", fill)]);
        std::fs::write(folder.path().join("rig.toml"), rig).expect("written");
        let said = simulate(&[]);
        let line = 26 + fill.lines().count() - 1;
        assert!(said.contains(says) && said.contains(&format!("rig.toml:{line}:")), "{said}");
    }
    let rings = "ring_tablet = { ring_spheres = 1000000000, sphere_radius_m = 0.002, ring_radius_m = 0.002 }";
    let text = few_beads(&[]);
    let at = text.find("sphere = {").expect("a sphere");
    let shape = &text[at..=at + text[at..].find('}').expect("its end")];
    std::fs::write(folder.path().join("rig.toml"), few_beads(&[(shape, rings)])).expect("written");
    assert!(shown(&["simulate", "rig.toml"]).contains("3 to 200 spheres"));
}

#[test]
fn a_table_without_responses_and_too_many_draws_are_refused() {
    let folder = tempdir().expect("a folder");
    let table = fixture("thesis/tables/edem_AZ4_Steel.csv");
    let head = table.lines().find(|l| l.starts_with("run,")).expect("a header");
    let columns: Vec<&str> = head.split(',').collect();
    let row = |run: usize| -> String {
        let cell = |name: &&str| match *name {
            "run" => run.to_string(),
            "omega_rpm" => "15".to_owned(),
            c if c.starts_with("mu_") => "0.3".to_owned(),
            _ => String::new(),
        };
        columns.iter().map(cell).collect::<Vec<_>>().join(",")
    };
    let text = format!("{head}\n{}\n{}\n", row(0), row(1));
    std::fs::write(folder.path().join("blank.csv"), text).expect("written");
    let said = refused(folder.path(), &["fit", "blank.csv"]);
    assert!(said.contains("blank.csv") && said.contains("no row holds a response"), "{said}");
    let said = refused(folder.path(), &["calibrate", "AZ4_Steel", "--bootstrap", "4000000000"]);
    assert!(said.contains("0 to 1000000 draws"), "{said}");
}

#[test]
fn loops_that_cannot_be_closed_are_refused_before_they_begin() {
    let folder = tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("written");
    };
    let drum = fixture("demo/drum.toml");
    write("case.toml", &drum);
    write("measured.csv", &fixture("demo/measured.csv"));
    let shown =
        |more: &[&str]| refused(folder.path(), &[&["close-loop", "case.toml"], more].concat());
    assert!(shown(&["--bootstrap", "49"]).contains("below 99"));
    assert!(shown(&["--predict", "800"]).contains("Froude number 1"));
    let with = |more: &str| {
        let end = drum.find("[holdout]").expect("held-out speeds");
        let rest = drum.find("[simulator.rig]").expect("a simulator");
        write("case.toml", &format!("{}{more}{}", &drum[..end], &drum[rest..]));
        shown(&[])
    };
    assert!(with("[holdout]\nspeeds_rpm = [41.0]\n").contains("41 rpm, which was not measured"));
    let both = "[catalogue]\nonly = [\"rolling.pp\"]\nwithout = [\"rolling.pp\"]\n";
    assert!(with(both).contains("asked for and left out"));
    assert!(with("[catalogue]\nonly = []\n").contains("names no effect"));
}
