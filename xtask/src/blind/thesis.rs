//! The thesis's twelve configurations with the tables of EDEM: what do they lack?

use calib::Study;
use close_loop::{Errors, LoopSettings, Outcome, close_with_table};
use rig_schema::ErrataLevel;

use crate::reproduce::own::{CONFIGS, own_study};
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

/// Close a configuration, every second measured speed kept aside.
fn line(name: &str, n_eff: f64, own: bool) -> anyhow::Result<String> {
    let (mut case, simulated) = if own {
        let (case, study) = own_study(name, 0.4)?;
        let table = study.table().clone();
        (case, table)
    } else {
        let (case, _, simulated) = tables(name, ErrataLevel::Certain)?;
        (case, simulated)
    };
    let (_, measured, _) = tables(name, ErrataLevel::Certain)?;
    case.holdout.every = Some(2);
    case.data.n_eff = Some(n_eff);
    let study = Study::new(&case, &measured, simulated)?;
    let mut settings = LoopSettings::default().attribution;
    settings.stability_bootstrap = 0;
    Ok(match close_with_table(&case, &study, &settings) {
        Ok(outcome) => row(name, n_eff, &outcome),
        Err(e) => format!("| {name} | {n_eff} | | {e} | | | | | |\n"),
    })
}

/// Add the rows of a configuration.
fn add(text: &mut String, name: &str, own: bool) -> anyhow::Result<()> {
    for n_eff in [5.0, 15.0, 30.0] {
        let line = line(name, n_eff, own)?;
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
        add(&mut text, name, false)?;
    }
    text = text + OWN + COLUMNS;
    for name in CONFIGS {
        add(&mut text, name, true)?;
    }
    std::fs::write(crate::root().join("docs/src/closing-the-thesis.md"), text)?;
    Ok(())
}
