use rig_schema::{Case, Errata, ErrataLevel, MeasuredTable, Response, SimulatedTable, Simulator};
use tumble_fixtures::read;

fn fixture(path: &str) -> &'static str {
    read(path).unwrap_or_else(|| panic!("no fixture {path}"))
}

#[test]
fn the_twelve_cases_read_and_name_their_tables() {
    for name in tumble_fixtures::CASES {
        let file = format!("thesis/cases/{}.toml", name.to_lowercase());
        let case = Case::parse(&file, fixture(&file)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(case.rig.name, name);
        assert_eq!(case.free.len(), 2);
        assert_eq!(case.nuisance.len(), 4);
        let Simulator::Table(simulator) = &case.simulator else { panic!("{name} has a table") };
        let table = format!("thesis/tables/edem_{name}.csv");
        assert!(simulator.file.ends_with(&format!("edem_{name}.csv")));
        let simulated = SimulatedTable::parse(&table, fixture(&table), &["mu_wall", "mu_pp"])
            .unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(simulated.rows.len(), 28, "{name}");
        let table = format!("thesis/tables/experiment_{name}.csv");
        let measured =
            MeasuredTable::parse(&table, fixture(&table)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(measured.rows.len(), case.rig.run.speeds_rpm.len(), "{name}");
        assert!(measured.absent.is_empty());
    }
}

#[test]
fn certain_errata_mend_the_cell_that_equals_its_neighbour() {
    let errata = Errata::parse("errata.csv", fixture("thesis/errata.csv")).expect("reads");
    let path = "thesis/tables/edem_AZ5_Plexi.csv";
    let mut table =
        SimulatedTable::parse("edem_AZ5_Plexi.csv", fixture(path), &["mu_wall", "mu_pp"])
            .expect("reads");
    let at =
        |t: &SimulatedTable| t.rows[18].cells[Response::AorMid.index()].expect("is there").mean;
    assert_eq!(at(&table), 47.48);
    assert!(errata.apply_simulated(&mut table, ErrataLevel::None).expect("fits").is_empty());
    assert_eq!(at(&table), 47.48);
    errata.apply_simulated(&mut table, ErrataLevel::Certain).expect("fits");
    assert_eq!(at(&table), 38.0);
}

#[test]
fn every_erratum_that_acts_fits_its_table() {
    let errata = Errata::parse("errata.csv", fixture("thesis/errata.csv")).expect("reads");
    for name in tumble_fixtures::CASES {
        let file = format!("edem_{name}.csv");
        let text = fixture(&format!("thesis/tables/{file}")).to_owned();
        let mut table = SimulatedTable::parse(&file, &text, &["mu_wall", "mu_pp"]).expect("reads");
        errata.apply_simulated(&mut table, ErrataLevel::Likely).unwrap_or_else(|e| panic!("{e}"));
        let file = format!("experiment_{name}.csv");
        let text = fixture(&format!("thesis/tables/{file}")).to_owned();
        let mut table = MeasuredTable::parse(&file, &text).expect("reads");
        errata.apply_measured(&mut table, ErrataLevel::Likely).unwrap_or_else(|e| panic!("{e}"));
    }
}
