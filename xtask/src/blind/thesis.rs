//! The thesis's twelve configurations with the tables of EDEM, the beads also with our own: what do they lack?

use calib::Study;
use close_loop::{Errors, LoopSettings, Outcome, close_with_table};
use rig_schema::{Case, ErrataLevel, MeasuredTable, SimulatedTable};

use crate::reproduce::own::{CONFIGS, TABLE_8_WALL, own_study};
use crate::reproduce::tables;

const HEAD: &str = "\
# The thesis's configurations, closed\n\n\
Written by `cargo xtask blind thesis`. The simulator is EDEM's table of responses, as the surrogate of the case \
file; every second measured speed is kept aside. A table cannot be asked for physics that it does not vary, so \
only a turned camera (`camera.roll_deg`), a wrong speed (`speed.scale`) and a wrong radius (`measure.scale`) are \
candidates; offsets of the circle and both biases of the lines are marginalised in the model before and after \
alike. `unknown` means: physics is missing that the table does not hold, or none of the candidates carries over \
to the speeds kept aside. Errors are root mean squares, angles (both) in deg, centre of area (both coordinates) \
in % R; noise: what a true model would leave. A strength at the end of its range \
(a roll of 5 deg, a radius off by 6 %) would be seen in the photographs: it stands for something else.\n\n";

fn root_mean(errors: &Errors, held: bool, angles: bool, floor: bool) -> f64 {
    let all = if held { &errors.held_out } else { &errors.fitted };
    let of = all.iter().filter(|e| e.response.ends_with("deg") == angles);
    let (mut sum, mut points) = (0.0, 0);
    for e in of {
        let value = if floor { e.floor } else { e.rmse };
        sum += e.points as f64 * value.powi(2);
        points += e.points;
    }
    (sum / points.max(1) as f64).sqrt()
}

fn row(name: &str, n_eff: f64, o: &Outcome) -> String {
    let pair = |held: bool, angles: bool| {
        let at = |e: &Errors, floor: bool| root_mean(e, held, angles, floor);
        let (before, after) = (&o.before.errors, &o.after.errors);
        format!("{:.2}, {:.2} ({:.2})", at(before, false), at(after, false), at(before, true))
    };
    let calibrated: Vec<String> = o
        .calibrated
        .iter()
        .map(|(p, v, _)| format!("{} {v:.2}", p.trim_start_matches("friction.")))
        .collect();
    let said = if o.members.is_empty() {
        o.verdict.to_owned()
    } else {
        let all: Vec<String> =
            o.strengths.iter().map(|s| format!("{} = {:.3}", s.name, s.value)).collect();
        format!("{}: {}", o.verdict, all.join("; "))
    };
    format!(
        "| {name} | {n_eff} | {} | {said} | {:.0}, {:.0} of {} | {} | {} | {} | {} |\n",
        calibrated.join(", "),
        o.before.errors.chi2,
        o.after.errors.chi2,
        o.before.errors.dof,
        pair(false, true),
        pair(true, true),
        pair(false, false),
        pair(true, false)
    )
}

/// Close a configuration with a table of simulated responses, every second measured speed kept aside, and
/// add its rows.
fn add(
    text: &mut String,
    mut case: Case,
    measured: &MeasuredTable,
    simulated: &SimulatedTable,
) -> anyhow::Result<()> {
    let name = case.rig.name.clone();
    case.holdout.every = Some(2);
    let mut settings = LoopSettings::default().attribution;
    settings.stability_bootstrap = 0;
    for n_eff in [5.0, 15.0, 30.0] {
        case.data.n_eff = Some(n_eff);
        let study = Study::new(&case, measured, simulated.clone())?;
        let line = match close_with_table(&case, &study, &settings) {
            Ok(outcome) => row(&name, n_eff, &outcome),
            Err(e) => format!("| {name} | {n_eff} | | {e} | | | | | |\n"),
        };
        print!("{line}");
        text.push_str(&line);
    }
    Ok(())
}

pub(crate) fn run() -> anyhow::Result<()> {
    const COLUMNS: &str = "| configuration | n_eff | calibrated | verdict | chi-square before, after | angles, fitted: before, after (noise) | angles, kept aside | centre, fitted | centre, kept aside |\n|---|---|---|---|---|---|---|---|---|\n";
    const OWN: &str = "\n## Beads by our own runs\n\nThe same, the simulator being the runs of `fixtures/own` with walls from 0.4 on ([Calibrated by our own simulation](own-dem-calibration.md)), with its priors on reading.\n\n";
    let mut text = HEAD.to_owned() + COLUMNS;
    for name in tumble_fixtures::CASES {
        let (case, measured, simulated) = tables(name, ErrataLevel::Certain)?;
        add(&mut text, case, &measured, &simulated)?;
    }
    text = text + OWN + COLUMNS;
    for name in CONFIGS {
        let (_, measured, _) = tables(name, ErrataLevel::Certain)?;
        let (case, own) = own_study(name, TABLE_8_WALL)?;
        add(&mut text, case, &measured, own.table())?;
    }
    crate::write_whole(&crate::root().join("docs/src/closing-the-thesis.md"), &text)
}
