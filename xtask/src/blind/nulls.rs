//! False alarms on simulated drums that lack nothing.

use std::path::Path;

use close_loop::calib::attribution::Verdict;
use close_loop::campaign::{Laboratory, Sampling};
use close_loop::rig_schema::{Case, MeasuredTable};
use close_loop::{CloseLoop, LoopSettings};

use super::drums::truth;
use super::make::{case_text, nature, nature_lab, table};
use super::score::fit_sampling;

pub(crate) fn run(folder: &Path, count: usize, runs: usize, jobs: usize) -> anyhow::Result<()> {
    let nature_lab = nature_lab(folder, jobs)?;
    let rigs = (0..count)
        .map(|k| {
            let truth = truth("null", "tumble", [0.28, 0.37, 0.46][k % 3], &[]);
            nature(&truth, 900_000 + k as u64)
        })
        .collect::<anyhow::Result<Vec<_>>>()?;
    let data = nature_lab.run(&rigs, |_| ());
    let sampling: Sampling = fit_sampling();
    let lab = Laboratory::open(&folder.join("fits"), jobs, sampling)?;
    let case = Case::parse("null.toml", &case_text(&[]))?;
    let (mut alarms, mut sets, mut below) = (0, 0, 0);
    for (k, run) in data.into_iter().enumerate() {
        let Ok(run) = run else {
            println!("{k}: the drum failed");
            continue;
        };
        let measured = MeasuredTable::parse("null.csv", &table(&run))?;
        let mut settings = LoopSettings { runs: Some(runs), ..LoopSettings::default() };
        settings.attribution.bootstrap = 299;
        settings.attribution.stability_bootstrap = 0;
        let looped = CloseLoop { case: &case, measured: &measured, lab: &lab, settings: &settings };
        let finding = looped.find(&mut |_| ())?;
        sets += 1;
        below += usize::from(finding.gate.p_combined < 0.1);
        if finding.verdict != Verdict::None {
            alarms += 1;
        }
        println!(
            "{k}: {:?}, chi-square {:.1} of {}, p {:.3}; {alarms} alarms in {sets}, {below} below 0.1",
            finding.verdict, finding.gate.chi2, finding.gate.dof, finding.gate.p_combined
        );
    }
    Ok(())
}
