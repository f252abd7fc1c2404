//! The files that the book shows are read as the book says.

use rig_schema::{
    Case, DesignKind, MeasuredTable, Plan, Response, Rig, SimulatedTable, Simulator, TableBasis,
};

/// A file of the book, or `None` where the crate stands outside its repository.
#[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
fn shown(name: &str) -> Option<String> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/files");
    if !std::path::Path::new(folder).is_dir() {
        println!("skipped: the crate stands outside its repository, docs/ is absent");
        return None;
    }
    Some(std::fs::read_to_string(format!("{folder}/{name}")).unwrap_or_else(|e| panic!("{e}")))
}

#[test]
fn the_books_rig_is_read() {
    let Some(text) = shown("rig.toml") else { return };
    let rig = Rig::parse("rig.toml", &text).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(rig.drum.lifters.map(|l| l.count), Some(8));
    assert_eq!(rig.run.seed, 1);
    assert_eq!(rig.settings.value("friction.pp"), Some(0.5));
    assert_eq!(rig.settings.value("camera.focal_length_mm"), Some(35.0), "nominal");
}

#[test]
fn the_books_plan_is_read() {
    let Some(text) = shown("plan.toml") else { return };
    let plan = Plan::parse("plan.toml", &text).unwrap_or_else(|e| panic!("{e}"));
    let mut paths: Vec<&str> = plan.factors.iter().map(|f| f.path.as_str()).collect();
    paths.sort_unstable();
    assert_eq!(paths, ["friction.mantle", "friction.pp", "run.speed_rpm"]);
    assert_eq!(plan.design, DesignKind::FullFactorial { centre_points: 2 });
}

#[test]
fn the_books_case_is_read_and_keeps_aside_what_the_book_says() {
    let Some(text) = shown("case.toml") else { return };
    let case = Case::parse("case.toml", &text).unwrap_or_else(|e| panic!("{e}"));
    let Simulator::Table(table) = &case.simulator else { panic!("the case has a table") };
    assert_eq!(table.basis, TableBasis::Saturating { m0: 0.2 });
    // Ten measured speeds 4, 6, ... 22 rpm: 12 by its value, the second, sixth and tenth by count.
    let aside: Vec<f64> = (0..10)
        .map(|i| (i, 4.0 + 2.0 * i as f64))
        .filter(|(i, omega)| case.holds_out(*i, 10, *omega))
        .map(|(_, omega)| omega)
        .collect();
    assert_eq!(aside, [6.0, 12.0, 14.0, 22.0]);
}

#[test]
fn the_books_tables_are_read() {
    let (Some(measured), Some(simulated)) = (shown("measured.csv"), shown("simulated.csv")) else {
        return;
    };
    let table = MeasuredTable::parse("measured.csv", &measured).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(table.rows[0].n_eff, Some(10.0));
    assert_eq!(table.rows[1].n_eff, None);
    assert_eq!(table.rows[0].covariance[0][1], Some(3.1));
    let factors = SimulatedTable::factor_columns(&simulated);
    assert_eq!(factors, ["mu_wall", "mu_pp"]);
    let table = SimulatedTable::parse("simulated.csv", &simulated, &["mu_wall", "mu_pp"])
        .unwrap_or_else(|e| panic!("{e}"));
    assert!(table.rows[0].cells[Response::CenX.index()].is_none());
}
