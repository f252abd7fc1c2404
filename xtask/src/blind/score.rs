//! Close the loop on every sealed case, then open the truth.

use std::path::Path;

use anyhow::Context;
use close_loop::campaign::{Laboratory, Resolution, Sampling};
use close_loop::rig_schema::{Case, MeasuredTable};
use close_loop::{CloseLoop, LoopSettings, Outcome};
use serde::{Deserialize, Serialize};

use super::matrix;
use super::sealed::{Truth, open};

/// How fits look at their drums.
pub(crate) fn fit_sampling() -> Sampling {
    let resolution = Resolution { width_px: 400, ..Resolution::default() };
    Sampling { resolution, frame_interval_s: Some(0.12), ..Sampling::default() }
}

/// What a closed loop answered.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Answer {
    pub(crate) case: String,
    pub(crate) verdict: String,
    pub(crate) members: Vec<String>,
    pub(crate) strengths: Vec<(String, f64, f64, f64)>,
    pub(crate) p: f64,
    pub(crate) removed: Option<f64>,
    pub(crate) confirmed: Option<bool>,
    /// Root mean square error in standard deviations over all held-out points.
    pub(crate) held_out_sd: (f64, f64),
    pub(crate) runs: usize,
    pub(crate) cost_s: f64,
}

impl Answer {
    fn of(case: &str, o: &Outcome) -> Self {
        let overall = |side: &close_loop::Side| {
            let all = &side.errors.held_out;
            let points: usize = all.iter().map(|e| e.points).sum();
            let square: f64 = all.iter().map(|e| e.points as f64 * e.rmse_sd.powi(2)).sum();
            (square / points.max(1) as f64).sqrt()
        };
        Self {
            case: case.to_owned(),
            verdict: o.verdict.to_owned(),
            members: o.members.clone(),
            strengths: o.strengths.iter().map(|s| (s.name.clone(), s.value, s.lo, s.hi)).collect(),
            p: o.finding.gate.p_combined,
            removed: o.removed,
            confirmed: o.confirmed,
            held_out_sd: (overall(&o.before), overall(&o.after)),
            runs: o.runs,
            cost_s: o.cost_s,
        }
    }
}

pub(crate) fn run(
    folder: &Path,
    runs: usize,
    jobs: usize,
    only: Option<&str>,
    json: bool,
) -> anyhow::Result<()> {
    let lab = Laboratory::open(&folder.join("fits"), jobs, fit_sampling())?;
    let mut names: Vec<String> = std::fs::read_dir(folder.join("cases"))
        .with_context(|| {
            format!("no cases in {}; `cargo xtask blind make` makes them", folder.display())
        })?
        .filter_map(|e| Some(e.ok()?.file_name().to_string_lossy().into_owned()))
        .filter(|n| only.is_none_or(|o| n.contains(o)))
        .collect();
    names.sort();
    let answers = folder.join("answers");
    let details = folder.join("details");
    std::fs::create_dir_all(&answers)?;
    std::fs::create_dir_all(&details)?;
    let mut given = Vec::new();
    for name in &names {
        let kept = answers.join(format!("{name}.json"));
        if let Ok(text) = std::fs::read_to_string(&kept)
            && let Ok(answer) = serde_json::from_str::<Answer>(&text)
        {
            given.push(answer);
            continue;
        }
        let own = folder.join("cases").join(name);
        let case = Case::parse(name, &std::fs::read_to_string(own.join("case.toml"))?)?;
        let table = |file: &str| -> anyhow::Result<MeasuredTable> {
            Ok(MeasuredTable::parse(name, &std::fs::read_to_string(own.join(file))?)?)
        };
        let measured = table(&case.data.responses)?;
        let others = case.data.loads.iter().map(|load| table(&load.responses));
        let loads = others.collect::<anyhow::Result<Vec<_>>>()?;
        let mut settings =
            LoopSettings { runs: Some(runs), next: false, ..LoopSettings::default() };
        settings.attribution.stability_bootstrap = 0;
        let looped = CloseLoop {
            case: &case,
            measured: &measured,
            loads: &loads,
            lab: &lab,
            settings: &settings,
        };
        let outcome = looped.run(&mut |_| ()).with_context(|| name.clone())?;
        let answer = Answer::of(name, &outcome);
        if !json {
            println!("{name}: {}", outcome.sentence);
        }
        let detail = details.join(format!("{name}.json"));
        std::fs::write(detail, serde_json::to_string(&outcome)?)?;
        std::fs::write(&kept, serde_json::to_string_pretty(&answer)?)?;
        given.push(answer);
    }
    // Only now.
    let hex = std::fs::read_to_string(folder.join("truth/key"))?;
    let mut key = [0; 32];
    for (k, b) in key.iter_mut().enumerate() {
        *b = u8::from_str_radix(hex.get(2 * k..2 * k + 2).context("the key is cut short")?, 16)?;
    }
    let mut pairs = Vec::new();
    for answer in given {
        let path = folder.join("truth").join(format!("{}.sealed", answer.case));
        let truth: Truth = serde_json::from_str(&open(&std::fs::read_to_string(path)?, &key)?)?;
        pairs.push((truth, answer));
    }
    let summary = matrix::summarise(&pairs);
    if json {
        println!("{}", serde_json::to_string_pretty(&summary)?);
    } else {
        println!("{}", matrix::markdown(&pairs, &summary));
    }
    Ok(())
}
