//! `tumble calibrate`: measured responses matched by a surrogate.

use std::path::{Path, PathBuf};

use anyhow::Context;
use calib::{
    Basis, JointMatch, Match, ResponseSet, Sensitivity, Study, Surrogate, duplicate_rows,
    duplicate_tables, measured_outliers, simulated_outliers,
};
use calib_report::page::{
    Block, Column, Figure, Page, Provenance, Row, Section, Table, Tone, Verdict,
};
use calib_report::pictures::PosteriorDensity;
use rig_schema::{ErrataLevel, SimulatedTable};

use crate::cli::CalibrateArgs;
use crate::input::{self, InputError, Loaded};
use crate::output;
use crate::report::calibration::{Parts, report, sentence, warnings};
use crate::report::json::{Calibration, Found, Joint, Several, outliers};
use crate::report::{interval, number};

struct Solved {
    json: Calibration,
    study: Study,
    lines: Vec<String>,
    loaded: Loaded,
}

pub(crate) fn run(args: &CalibrateArgs) -> anyhow::Result<()> {
    let level = args.errata.into();
    let mut loaded = Vec::new();
    for name in &args.cases {
        let case = input::load(name, level)?;
        if loaded.iter().any(|l: &Loaded| l.case.rig.name == case.case.rig.name) {
            return Err(InputError::Twice { name: case.case.rig.name }.into());
        }
        loaded.push(case);
    }
    let duplicates = built_in_duplicates(&loaded)?;
    let several = loaded.len() > 1;
    let mut solved = Vec::new();
    for l in loaded {
        let folder = match (&args.out, several) {
            (Some(out), true) => out.join(&l.case.rig.name),
            (Some(out), false) => out.clone(),
            (None, _) => Path::new("tumble-out").join(&l.case.rig.name),
        };
        solved.push(one(l, &duplicates, args, &folder)?);
    }
    if several {
        return joint(args, solved);
    }
    let Some(only) = solved.pop() else { return Ok(()) };
    if args.json {
        println!("{}", serde_json::to_string_pretty(&only.json)?);
    } else {
        only.lines.iter().for_each(|l| println!("{l}"));
    }
    Ok(())
}

/// Copies among the built-in tables, as sentences with the tables that they concern.
fn built_in_duplicates(loaded: &[Loaded]) -> anyhow::Result<Vec<(String, String)>> {
    if loaded.iter().all(|l| !l.built_in) {
        return Ok(Vec::new());
    }
    let mut tables: Vec<(SimulatedTable, Surrogate)> = Vec::new();
    for name in tumble_fixtures::CASES {
        let l = input::load(name, ErrataLevel::None)?;
        let columns = Study::columns(&l.case)?;
        let columns: Vec<(&str, &str)> =
            columns.iter().map(|(c, p)| (c.as_str(), p.as_str())).collect();
        let surrogate = Surrogate::from_table(&l.simulated, &columns, &Basis::Quadratic)?;
        tables.push((l.simulated, surrogate));
    }
    let pairs: Vec<(&SimulatedTable, &Surrogate)> = tables.iter().map(|(t, s)| (t, s)).collect();
    let mut found = Vec::new();
    for d in duplicate_tables(&pairs) {
        let text = format!(
            "{} and {} are one set of runs measured twice: {} of {} rows agree in both angles within 0.06 deg, and after a constant shift the rest differ by {:.0} % of what independent runs do",
            d.first,
            d.second,
            d.equal_rows.0,
            d.equal_rows.1,
            100.0 * d.ratio
        );
        found.extend([(d.first, text.clone()), (d.second, text)]);
    }
    let all: Vec<&SimulatedTable> = tables.iter().map(|(t, _)| t).collect();
    for d in duplicate_rows(&all) {
        let text = format!(
            "run {} is the same in {} and {}: {} of 8 printed numbers are equal",
            d.run, d.first, d.second, d.equal
        );
        found.extend([(d.first, text.clone()), (d.second, text)]);
    }
    Ok(found)
}

fn one(
    loaded: Loaded,
    duplicates: &[(String, String)],
    args: &CalibrateArgs,
    folder: &Path,
) -> anyhow::Result<Solved> {
    let name = loaded.case.rig.name.clone();
    eprintln!("{name}: fitting the surrogate and matching");
    let study = Study::new(&loaded.case, &loaded.measured, loaded.simulated.clone())
        .with_context(|| name.clone())?;
    let joint = study.problem().solve(args.bootstrap, args.seed)?;
    let mut per_speed: Vec<(f64, Match)> = Vec::new();
    for omega in study.observations.speeds_rpm() {
        if let Some(m) = study.at_speed(omega, ResponseSet::All)? {
            per_speed.push((omega, m));
        }
    }
    eprintln!("{name}: repeating the match under other assumptions");
    let sensitivity = Sensitivity::of(&study, args.bootstrap, args.seed)?;
    let theta: Vec<f64> = joint.estimates.iter().map(|e| e.value).collect();
    let held_out = if study.held_out.items.is_empty() {
        Vec::new()
    } else {
        study.problem_for(study.held_out.clone()).residuals_at(&theta)?
    };
    let doubtful = outliers(
        &study,
        &measured_outliers(&loaded.measured),
        &loaded.measured.file,
        &simulated_outliers(study.table(), &study.surrogate)?,
    );
    let concerned: Vec<String> = duplicates
        .iter()
        .filter(|(file, _)| *file == loaded.simulated.file)
        .map(|(_, text)| text.clone())
        .collect();
    let printed = if loaded.built_in { input::printed_ranges(&name)? } else { Vec::new() };
    let parts = Parts {
        loaded: &loaded,
        study: &study,
        joint: &joint,
        per_speed: &per_speed,
        sensitivity: &sensitivity,
        held_out: &held_out,
        outliers: &doubtful,
        printed: &printed,
        duplicates: &concerned,
        seed: args.seed,
        command: format!("tumble calibrate {name} --seed {}", args.seed),
    };
    let page = report(&parts)?.html();
    let mut lines = friction_lines(&parts);
    lines.extend(warnings(&parts).into_iter().map(|w| format!("note: {w}")));
    lines.extend(doubtful.iter().map(|o| format!("doubtful: {}", o.line())));
    let folder = output::folder(Some(folder), &name)?;
    let path = output::write(&folder, "report.html", &page)?;
    lines.push(format!("report: {}", path.display()));
    let found = Found {
        study: &study,
        joint: &joint,
        per_speed: &per_speed,
        by_n_eff: &sensitivity.by_n_eff,
        held_out: &held_out,
    };
    let mut json = Calibration::new(&found, doubtful);
    json.report = path.display().to_string();
    output::write(&folder, "result.json", &serde_json::to_string_pretty(&json)?)?;
    output::write(&folder, "residuals.csv", &residual_csv(&joint))?;
    Ok(Solved { json, study, lines, loaded })
}

fn friction_lines(parts: &Parts<'_>) -> Vec<String> {
    let mut lines = vec![
        format!("{}: {}", parts.study.name, parts.loaded.case.rig.title),
        format!(
            "{:>6}  {:>6}  {:<20} {:<14} {:>9}",
            "rpm", "mu_pp", "95 % interval", "printed", "chi2/dof"
        ),
    ];
    for (omega, m) in parts.per_speed {
        let e = &m.estimates[0];
        let printed = parts.printed.iter().find(|p| p.0 == *omega);
        let printed = printed.map_or(String::new(), |p| format!("{:.2} to {:.2}", p.1, p.2));
        lines.push(format!(
            "{omega:>6}  {:>6.3}  {:<20} {printed:<14} {:>6.1}/{}",
            e.value,
            interval(e.lo, e.hi),
            m.goodness.chi2,
            m.goodness.dof
        ));
    }
    let e = &parts.joint.estimates[0];
    lines.push(format!(
        "{:>6}  {:>6.3}  {:<20} {:<14} {:>6.1}/{}",
        "all",
        e.value,
        interval(e.lo, e.hi),
        "",
        parts.joint.goodness.chi2,
        parts.joint.goodness.dof
    ));
    lines.push(sentence(parts.joint).0);
    lines
}

fn residual_csv(m: &Match) -> String {
    let mut text = String::from("omega_rpm,response,measured,model,sd,residual_sd\n");
    for r in &m.residuals {
        text.push_str(&format!(
            "{},{},{},{:.4},{:.4},{:.4}\n",
            r.omega_rpm,
            r.response,
            r.measured,
            r.model,
            r.sd,
            r.in_sd()
        ));
    }
    text
}

/// Fit all cases together where they share a parameter.
fn joint(args: &CalibrateArgs, solved: Vec<Solved>) -> anyhow::Result<()> {
    let labels = |s: &Solved| s.study.shared.clone();
    let shared = solved
        .first()
        .map(labels)
        .unwrap_or_default()
        .into_iter()
        .find(|pair| solved.iter().all(|s| labels(s).contains(pair)));
    let Some((path, label)) = shared else {
        return Err(calib::CalibError::NothingShared.into());
    };
    eprintln!("fitting one {path} for all: {label}");
    let members: Vec<_> = solved.iter().map(|s| s.study.member()).collect();
    let fitted = JointMatch::solve(&path, &members)?;
    let withheld =
        if members.len() > 2 { JointMatch::withhold_each(&path, &members)? } else { Vec::new() };
    let folder =
        output::folder(args.out.as_deref(), &format!("joint_{}", label.replace(' ', "_")))?;
    let page = joint_page(&fitted, &withheld, &label, &solved, args).html();
    let report: PathBuf = output::write(&folder, "report.html", &page)?;
    let verdict = joint_sentence(&fitted, &label);
    let json = Joint::new(&fitted, &withheld);
    let mut lines: Vec<String> = Vec::new();
    let mut cases = Vec::new();
    for s in solved {
        lines.extend(s.lines);
        lines.push(String::new());
        cases.push(s.json);
    }
    let all = Several { cases, joint: Some(json), report: report.display().to_string() };
    let text = serde_json::to_string_pretty(&all)?;
    output::write(&folder, "result.json", &text)?;
    if args.json {
        println!("{text}");
        return Ok(());
    }
    lines.iter().for_each(|l| println!("{l}"));
    println!("{verdict}");
    for m in &fitted.members {
        println!("{:<11} alone {:.3}, the tie costs it {:.1}", m.name, m.alone, m.strain);
    }
    for w in &withheld {
        println!(
            "{:<11} predicted from the others ({:.3}): chi-square {:.0} for {} (own best {:.3}: {:.0})",
            w.name, w.value, w.goodness.chi2, w.goodness.dof, w.own_value, w.own.chi2
        );
    }
    println!("report: {}", report.display());
    Ok(())
}

fn joint_sentence(fitted: &JointMatch, label: &str) -> String {
    format!(
        "One {} for every {label}: {:.3} (95 %: {}); the configurations {} (p of the tie {:.2e}).",
        fitted.name,
        fitted.value,
        interval(fitted.lo, fitted.hi),
        if fitted.tie.p > 0.01 { "agree" } else { "do not agree" },
        fitted.tie.p
    )
}

fn joint_page(
    fitted: &JointMatch,
    withheld: &[calib::WithheldPrediction],
    label: &str,
    solved: &[Solved],
    args: &CalibrateArgs,
) -> Page {
    let members = Table {
        caption: "Configurations under one shared value".to_owned(),
        columns: vec![
            Column::text("configuration"),
            Column::number("alone", ""),
            Column::number("cost of the tie", ""),
            Column::number("chi-square", ""),
            Column::number("observations", ""),
        ],
        rows: fitted
            .members
            .iter()
            .map(|m| Row {
                flagged: m.strain > 4.0,
                ..Row::new(vec![
                    m.name.clone(),
                    format!("{:.3}", m.alone),
                    format!("{:.1}", m.strain),
                    format!("{:.1}", m.chi2),
                    m.observations.to_string(),
                ])
            })
            .collect(),
    };
    let predictions = Table {
        caption: "Each configuration predicted from the others".to_owned(),
        columns: vec![
            Column::text("configuration"),
            Column::number("friction of the others", ""),
            Column::number("from", ""),
            Column::number("to", ""),
            Column::number("own best", ""),
            Column::number("chi-square", ""),
            Column::number("chi-square at own best", ""),
            Column::number("degrees of freedom", ""),
        ],
        rows: withheld
            .iter()
            .map(|w| {
                Row::new(vec![
                    w.name.clone(),
                    format!("{:.3}", w.value),
                    number(w.interval.0),
                    number(w.interval.1),
                    format!("{:.3}", w.own_value),
                    format!("{:.1}", w.goodness.chi2),
                    format!("{:.1}", w.own.chi2),
                    w.goodness.dof.to_string(),
                ])
            })
            .collect(),
    };
    let m = &fitted.marginal;
    let posterior = PosteriorDensity {
        title: format!("Posterior of {} for every {label}", fitted.name),
        parameter: fitted.name.clone(),
        points: m.values.iter().copied().zip(m.density.iter().copied()).collect(),
        prior: Vec::new(),
        centre: Some(m.mean),
        centre_label: "mean".to_owned(),
        interval: Some(m.interval),
        level: "95 %".to_owned(),
    };
    let mut section = Section::new("One value for all")
        .with(Block::Table(members))
        .with(Block::Figures(vec![Figure::new(&posterior, "Shared value under a uniform prior.")]));
    if !withheld.is_empty() {
        section = section.with(Block::Table(predictions));
    }
    let mut page = Page::new(format!("{label}: joint calibration")).with(section);
    page.verdict = Some(Verdict {
        sentence: joint_sentence(fitted, label),
        tone: if fitted.tie.p > 0.01 { Tone::Good } else { Tone::Caution },
    });
    let names: Vec<&str> = solved.iter().map(|s| s.study.name.as_str()).collect();
    page.provenance = Some(Provenance {
        inputs: solved.iter().flat_map(|s| s.loaded.inputs.clone()).collect(),
        seed: Some(args.seed),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        command: format!("tumble calibrate {} --seed {}", names.join(" "), args.seed),
        settings: Vec::new(),
    });
    page
}
