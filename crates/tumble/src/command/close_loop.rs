//! `tumble close-loop`: the residual, the effect behind it, the error before and after.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use calib::attribution::CodeCovariance;
use campaign::{Laboratory, Resolution, Sampling};
use close_loop::{
    CloseLoop, CloseLoopError, Codes, Errors, LoopSettings, Outcome, ResponseErrors, Stage,
};
use indicatif::{ProgressBar, ProgressStyle};
use rig_schema::{Case, CodeDifferences, MeasuredTable, Run, Simulator};
use serde::Serialize;

use super::budget;
use crate::cli::CloseLoopArgs;
use crate::input::{self, CaseText, InputError, Text};
use crate::output;
use crate::report::closing::{Closed, page};

/// Time after which a shorter way is pointed out, min.
const LONG_MIN: f64 = 45.0;

/// Runs for the embedded drum: less than three minutes on two cores.
const EMBEDDED_RUNS: usize = 60;

#[derive(Serialize)]
struct Gate {
    chi2: f64,
    dof: usize,
    p: f64,
}

#[derive(Serialize)]
struct Interval {
    value: f64,
    lo: f64,
    hi: f64,
}

#[derive(Serialize)]
struct Side<'a> {
    fitted: BTreeMap<&'a str, f64>,
    held_out: BTreeMap<&'a str, f64>,
    chi2: f64,
}

impl<'a> Side<'a> {
    fn of(errors: &'a Errors) -> Self {
        let map = |all: &'a [ResponseErrors]| all.iter().map(|e| (e.response, e.rmse)).collect();
        Self { fitted: map(&errors.fitted), held_out: map(&errors.held_out), chi2: errors.chi2 }
    }
}

/// What a machine reads: the summary, then everything.
#[derive(Serialize)]
struct Printed<'a> {
    verdict: &'a str,
    members: &'a [String],
    strength: BTreeMap<&'a str, Interval>,
    gate: Gate,
    before: Side<'a>,
    after: Side<'a>,
    runs: usize,
    wall_s: f64,
    report: String,
    sentence: &'a str,
    confirmed: Option<bool>,
    removed: Option<f64>,
    detail: &'a Outcome,
}

pub(crate) fn run(args: &CloseLoopArgs) -> anyhow::Result<()> {
    let begun = Instant::now();
    let text = input::case_text(args.case.as_deref())?;
    let case = Case::parse(&text.case.name, &text.case.text)?;
    let table = |t: &Text| MeasuredTable::parse(&t.name, &t.text);
    let measured = table(&text.measured)?;
    let loads = text.loads.iter().map(table).collect::<Result<Vec<_>, _>>()?;
    if matches!(case.simulator, Simulator::Table(_)) {
        refuse_what_needs_a_rig(args, &text)?;
    }
    check_speeds(&case, &text.measured, &measured)?;
    check_predicted(&args.predict, &case, &measured)?;
    let codes = codes(&case, &text)?;
    let folder = output::folder(args.out.as_deref(), &format!("close_loop_{}", case.rig.name))?;
    let outcome = match &case.simulator {
        Simulator::Rig { .. } => by_runs(args, (&case, &measured, &loads), codes, &folder)?,
        Simulator::Table(_) => by_table(args, &text)?,
    };
    let inputs = text.inputs();
    let wall_s = begun.elapsed().as_secs_f64();
    let closed = Closed { outcome: &outcome, case: &case, inputs, args };
    let report = output::write(&folder, "report.html", &page(&closed).html())?;
    let printed = printed(&outcome, wall_s, report.display().to_string());
    let json = serde_json::to_string_pretty(&printed)?;
    output::write(&folder, "closed_loop.json", &json)?;
    if args.json {
        println!("{json}");
    } else {
        print(&outcome, &printed);
    }
    Ok(())
}

/// What a table of simulated responses cannot answer.
fn refuse_what_needs_a_rig(args: &CloseLoopArgs, text: &CaseText) -> Result<(), InputError> {
    if !args.predict.is_empty() {
        return Err(InputError::NeedsRig { what: "--predict" });
    }
    if text.codes.is_some() {
        return Err(InputError::NeedsRig { what: "data.code_differences" });
    }
    Ok(())
}

/// By how much codes differ.
fn codes(case: &Case, text: &CaseText) -> anyhow::Result<Codes> {
    let Some(codes) = &text.codes else {
        let alike = case.data.code_differences.is_some();
        return Ok(if alike { Codes::Alike } else { Codes::Usual });
    };
    let table = CodeDifferences::parse(&codes.name, &codes.text)?;
    Ok(Codes::Given(CodeCovariance::from_differences(table.speeds_rpm, table.pairs)?))
}

fn by_runs(
    args: &CloseLoopArgs,
    (case, measured, loads): (&Case, &MeasuredTable, &[MeasuredTable]),
    codes: Codes,
    folder: &std::path::Path,
) -> anyhow::Result<Outcome> {
    let resolution = Resolution { width_px: args.width, ..Resolution::default() };
    let cache = args.cache.clone().unwrap_or_else(|| folder.join("cache"));
    let sampling = Sampling { resolution, ..Sampling::default() };
    let lab = Arc::new(Laboratory::open(&cache, args.jobs, sampling)?);
    let (asked, again) = (Arc::clone(&lab), AtomicBool::new(false));
    output::on_interrupt(move || {
        asked.stop();
        again.swap(true, Ordering::Relaxed)
    })?;
    let mut settings = LoopSettings {
        runs: args.runs,
        most_speeds: args.speeds,
        predict: args.predict.clone(),
        seed: args.seed,
        codes,
        ..LoopSettings::default()
    };
    settings.attribution.bootstrap = args.bootstrap;
    settings.attribution.seed = args.seed;
    if args.case.is_none() && args.runs.is_none() && args.budget.is_none() {
        settings.runs = Some(EMBEDDED_RUNS);
    }
    let fit = |budget| {
        let this = CloseLoop { case, measured, loads, lab: &lab, settings: &settings };
        budget::fit(args.jobs, budget, &this)
    };
    let fitted = args.budget.map(fit).transpose()?;
    if let Some(fitted) = &fitted {
        settings = fitted.settings.clone();
    }
    let this = CloseLoop { case, measured, loads, lab: &lab, settings: &settings };
    let planned = this.planned()?;
    let expected = match fitted {
        Some(fitted) => fitted.longest_s,
        None => budget::expected(&this, planned, args.jobs)?,
    };
    let minutes = expected / 60.0;
    eprintln!(
        "at most {planned} runs, {} at a time, about {minutes:.0} min; kept in {}",
        args.jobs,
        cache.display()
    );
    if minutes > LONG_MIN && args.budget.is_none() {
        eprintln!("`--budget 20min` takes fewer runs, or cheaper ones: the report says which");
    }
    let bar = ProgressBar::new(planned as u64);
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos} of {len} runs, {msg}, {eta} left")?);
    let hidden = bar.is_hidden();
    let outcome = this.run(&mut |told| {
        bar.set_position(told.runs as u64);
        bar.set_message(format!("{} {} of {}", stage(told.stage), told.done, told.of));
        if hidden && told.done == told.of && told.of > 0 {
            eprintln!("{}: {} runs done, {} in all", stage(told.stage), told.of, told.runs);
        }
    });
    bar.finish_and_clear();
    Ok(outcome?)
}

/// Whether a drum can be run at the measured speeds, and they can be parted as the case asks.
fn check_speeds(case: &Case, text: &Text, measured: &MeasuredTable) -> Result<(), InputError> {
    let speeds: Vec<f64> = measured.rows.iter().map(|r| r.omega_rpm).collect();
    let file = || text.name.clone();
    if let Some(what) = case.holdout_fault(&speeds) {
        return Err(InputError::Case { file: file(), what });
    }
    let run = Run { speeds_rpm: speeds, ..case.rig.run.clone() };
    match run.fault() {
        Some((what, expected)) => {
            Err(InputError::Case { file: file(), what: format!("{what}; expected {expected}") })
        }
        None => Ok(()),
    }
}

/// Speeds to predict: they are run last, and a drum that has no steady bed there would cost the answer.
fn check_predicted(asked: &[f64], case: &Case, measured: &MeasuredTable) -> Result<(), InputError> {
    /// Slowest speed, as a part of the slowest that was measured: slower ones take for ever.
    const SLOWEST: f64 = 0.1;
    /// Gravity, m/s2.
    const GRAVITY: f64 = 9.81;
    let slowest = measured.rows.iter().map(|r| r.omega_rpm).fold(f64::INFINITY, f64::min);
    let least = SLOWEST * slowest;
    // Froude number 1: from here on the bed is carried round.
    let most = (GRAVITY / case.rig.drum.radius_m).sqrt() * 30.0 / std::f64::consts::PI;
    match asked.iter().find(|rpm| !(least..most).contains(*rpm)) {
        Some(rpm) => Err(InputError::Run {
            what: format!("--predict {rpm}"),
            expected: format!(
                "speeds from {least:.3} rpm (a tenth of the slowest measured) to {most:.1} rpm (Froude number 1)"
            ),
        }),
        None => Ok(()),
    }
}

fn by_table(args: &CloseLoopArgs, text: &CaseText) -> anyhow::Result<Outcome> {
    let loaded = input::load(&text.asked, rig_schema::ErrataLevel::Certain)?;
    let study = calib::Study::new(&loaded.case, &loaded.measured, loaded.simulated)?;
    let mut settings = LoopSettings { seed: args.seed, ..LoopSettings::default() }.attribution;
    settings.bootstrap = args.bootstrap;
    settings.seed = args.seed;
    Ok(close_loop::close_with_table(&loaded.case, &study, &settings)?)
}

fn stage(stage: Stage) -> &'static str {
    match stage {
        Stage::Base => "calibrating over the whole range",
        Stage::Zoom => "calibrating about the best point",
        Stage::Replicates => "filling the calibrated drum anew",
        Stage::Full => "the full rig beside its stand-in",
        Stage::Probes => "trying every effect",
        Stage::Filming => "filming by other cameras",
        Stage::Refine => "about the promising effects",
        Stage::Confirm => "fresh runs",
        Stage::Next => "what would tell a class apart",
        Stage::Prove => "drums that would have been seen",
    }
}

fn printed(outcome: &Outcome, wall_s: f64, report: String) -> Printed<'_> {
    let gate = &outcome.finding.gate;
    let interval = |s: &close_loop::StrengthOf| Interval { value: s.value, lo: s.lo, hi: s.hi };
    Printed {
        verdict: outcome.verdict,
        members: &outcome.members,
        strength: outcome.strengths.iter().map(|s| (s.name.as_str(), interval(s))).collect(),
        gate: Gate { chi2: gate.chi2, dof: gate.dof, p: gate.p_combined },
        before: Side::of(&outcome.before.errors),
        after: Side::of(&outcome.after.errors),
        runs: outcome.runs,
        wall_s,
        report,
        sentence: &outcome.sentence,
        confirmed: outcome.confirmed,
        removed: outcome.removed,
        detail: outcome,
    }
}

fn print(outcome: &Outcome, printed: &Printed<'_>) {
    println!("{}", outcome.sentence);
    if let Some(closest) = &outcome.closest {
        println!("  closest: {}", closest.words());
    }
    for (path, value, sd) in &outcome.calibrated {
        let sd = sd.map_or_else(String::new, |s| format!(" ± {s:.3}"));
        println!("  calibrated {path} = {value:.3}{sd}");
    }
    println!(
        "{:>12} {:>14} {:>10} {:>10} {:>12}",
        "", "response", "before", "after", "noise alone"
    );
    let sets = [
        ("fitted", &outcome.before.errors.fitted, &outcome.after.errors.fitted),
        ("held out", &outcome.before.errors.held_out, &outcome.after.errors.held_out),
    ];
    for (name, before, after) in sets {
        for (b, a) in before.iter().zip(after) {
            println!(
                "{name:>12} {:>14} {:>10.2} {:>10.2} {:>12.2}",
                b.response, b.rmse, a.rmse, b.floor
            );
        }
    }
    for side in outcome.models() {
        for four in side.predictions.chunks(4) {
            let model = side.effect.as_deref().unwrap_or("the calibrated model");
            let each: Vec<String> = four
                .iter()
                .map(|p| format!("{} {:.2} ± {:.2}", p.response, p.mean, p.sd))
                .collect();
            println!("  {:.1} rpm by {model}: {}", four[0].omega_rpm, each.join(", "));
        }
    }
    if let Some(removed) = outcome.removed.filter(|_| outcome.confirmed != Some(false)) {
        println!("{:.0} % of the error above the noise goes away", 100.0 * removed);
    }
    // The first is the most telling.
    if let Some(next) = outcome.finding.next.first() {
        let part = 100.0 * next.gain_bits / next.most_bits;
        println!("next: {} ({part:.0} % of what is open between them)", next.name);
    }
    println!("{} runs, {:.0} s; report: {}", printed.runs, printed.wall_s, printed.report);
}

/// Whether an error is the input's fault.
pub(crate) fn is_input_fault(e: &CloseLoopError) -> bool {
    !matches!(e, CloseLoopError::Stopped)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_runs_of_the_embedded_drum_are_enough_for_its_plan() {
        let text = input::case_text(None).unwrap();
        let case = Case::parse(&text.case.name, &text.case.text).unwrap();
        let measured = MeasuredTable::parse(&text.measured.name, &text.measured.text).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
        let settings = LoopSettings { runs: Some(EMBEDDED_RUNS), ..LoopSettings::default() };
        let this = CloseLoop {
            case: &case,
            measured: &measured,
            loads: &[],
            lab: &lab,
            settings: &settings,
        };
        assert!(this.planned().unwrap() <= EMBEDDED_RUNS);
    }

    #[test]
    fn tables_of_all_loads_are_read_and_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let drum = input::case_text(None).expect("is embedded");
        let path = folder.path().join("case.toml");
        std::fs::write(folder.path().join("measured.csv"), &drum.measured.text).expect("written");
        let load = "\n[[data.loads]]\nresponses = \"half.csv\"\nfill.count = 280\n[free]";
        std::fs::write(&path, drum.case.text.replace("\n[free]", load)).expect("written");
        let missing = input::case_text(path.to_str()).err().expect("half.csv is not there");
        assert!(missing.to_string().contains("half.csv"), "{missing}");
        std::fs::write(folder.path().join("half.csv"), &drum.measured.text).expect("written");
        let text = input::case_text(path.to_str()).expect("is read");
        assert_eq!((text.loads.len(), text.inputs().len()), (1, 3));
        let case = Case::parse(&text.case.name, &text.case.text).expect("is well formed");
        assert_eq!(case.data.loads[0].of(&case.rig).settings.value("fill.count"), Some(280.0));
    }

    #[test]
    fn a_case_says_by_how_much_codes_differ() {
        let folder = tempfile::tempdir().expect("a folder");
        let drum = input::case_text(None).expect("is embedded");
        let path = folder.path().join("case.toml");
        std::fs::write(folder.path().join("measured.csv"), &drum.measured.text).expect("written");
        let table = "pair,omega_rpm,aor_lin_deg,aor_mid_deg,cen_x_pct,cen_y_pct\n1,20,0.5,0,0,0\n";
        std::fs::write(folder.path().join("codes.csv"), table).expect("written");
        let said = |what: &str| {
            let text = drum.case.text.replace("[data]\n", &format!("[data]\n{what}\n"));
            std::fs::write(&path, &text).expect("written");
            let text = input::case_text(path.to_str()).expect("is read");
            let case = Case::parse(&text.case.name, &text.case.text).expect("is well formed");
            codes(&case, &text).expect("is well formed")
        };
        assert_eq!(said(""), Codes::Usual);
        assert_eq!(said("code_differences = \"none\""), Codes::Alike);
        let Codes::Given(given) = said("code_differences = \"codes.csv\"") else {
            panic!("not as given")
        };
        assert!((given.covariance((20.0, 0), (30.0, 0)) - 0.25).abs() < 1e-12);
    }
}
