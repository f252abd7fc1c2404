//! False alarms on simulated drums that lack nothing.

use std::fs::File;
use std::ops::Range;
use std::path::Path;

use close_loop::campaign::Laboratory;
use close_loop::campaign::export::Code;
use close_loop::rig_schema::{Case, MeasuredTable};
use close_loop::{CloseLoop, LoopSettings};
use serde::{Deserialize, Serialize};

use super::drums::truth;
use super::elsewhere::{self, Other};
use super::make::{Care, case_text, measured, nature, nature_lab, table_of};
use super::score::fit_sampling;

/// What a drum that lacks nothing was called.
#[derive(Serialize, Deserialize)]
struct Called {
    verdict: String,
    chi2: f64,
    dof: usize,
    p: f64,
    members: Vec<String>,
    /// Answers that fresh runs refuted on the way.
    refuted: usize,
}

/// Drums are taken one at a time; several of these commands may share the work, and what is done is kept.
pub(crate) fn run(
    folder: &Path,
    numbers: Range<usize>,
    runs: usize,
    liggghts: bool,
    care: Care,
    jobs: usize,
) -> anyhow::Result<()> {
    let other = liggghts.then(|| Other::locate(Code::Liggghts)).transpose();
    let other = other.map_err(|e| anyhow::anyhow!(e))?;
    let named = [(liggghts, "_liggghts"), (care.coarse, "_coarse"), (care.two_loads, "_two_loads")];
    let name: String = named.iter().filter(|(with, _)| *with).map(|(_, name)| *name).collect();
    let own = folder.join(format!("nulls{name}"));
    std::fs::create_dir_all(&own)?;
    let picture = fit_sampling();
    let drums = nature_lab(folder, jobs, picture.resolution)?;
    let lab = Laboratory::open(&folder.join("fits"), jobs, picture)?;
    let case = Case::parse("null.toml", &case_text(&[], care))?;
    for k in numbers {
        let done = own.join(format!("{k:03}.json"));
        // The lock ends with the process that holds it, however that ends.
        let claim = File::create(own.join(format!("{k:03}.taken")))?;
        if claim.try_lock().is_err() || done.exists() {
            continue;
        }
        let truth = truth("null", "tumble", [0.28, 0.37, 0.46][k % 3], &[]);
        let rigs = nature(&truth, 900_000 + k as u64, care)?;
        let fillings: Option<Vec<_>> = match &other {
            None => drums.run(&rigs, |_| ()).into_iter().collect::<Result<_, _>>().ok(),
            Some(other) => elsewhere::run_all(other, &rigs, &own.join(format!("{k:03}"))).ok(),
        };
        let texts = fillings.map_or_else(Vec::new, |f| measured(&f, care));
        let parse = |text: &String| MeasuredTable::parse("null.csv", text);
        let tables = texts.iter().map(parse).collect::<Result<Vec<_>, _>>()?;
        let Some((measured, loads)) = tables.split_first() else {
            println!("{k}: the drum failed");
            continue;
        };
        let mut settings = LoopSettings { runs: Some(runs), ..LoopSettings::default() };
        settings.attribution.bootstrap = 299;
        settings.attribution.stability_bootstrap = 0;
        let looped = CloseLoop { case: &case, measured, loads, lab: &lab, settings: &settings };
        let outcome = looped.run(&mut |_| ())?;
        let finding = &outcome.finding;
        // To look into an alarm.
        for (load, text) in texts.iter().enumerate() {
            std::fs::write(own.join(format!("{k:03}_{}", table_of(load))), text)?;
        }
        let detail = serde_json::to_string(finding)?;
        std::fs::write(own.join(format!("{k:03}.finding")), detail)?;
        let called = Called {
            verdict: outcome.verdict.to_owned(),
            members: outcome.members.clone(),
            refuted: outcome.refuted,
            chi2: finding.gate.chi2,
            dof: finding.gate.dof,
            p: finding.gate.p_combined,
        };
        std::fs::write(done, serde_json::to_string(&called)?)?;
        println!("{k}: {}, chi-square {:.1}, p {:.3}", called.verdict, called.chi2, called.p);
    }
    summary(&own)
}

fn summary(own: &Path) -> anyhow::Result<()> {
    let (mut sets, mut alarms, mut below, mut chi2) = (0, 0, 0, 0.0);
    for entry in std::fs::read_dir(own)? {
        let path = entry?.path();
        if path.extension().is_none_or(|e| e != "json") {
            continue;
        }
        let called: Called = serde_json::from_str(&std::fs::read_to_string(path)?)?;
        sets += 1;
        below += usize::from(called.p < 0.1);
        chi2 += called.chi2;
        if called.verdict != "none" {
            alarms += 1;
            println!("alarm: {} {}, p {:.3}", called.verdict, called.members.join(", "), called.p);
        }
    }
    println!(
        "{sets} drums that lack nothing: {alarms} alarms; p below 0.1 in {below}; mean chi-square {:.1}",
        chi2 / f64::from(sets)
    );
    Ok(())
}
