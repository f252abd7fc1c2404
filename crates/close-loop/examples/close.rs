//! Close the loop of a case file: `close CASE.toml CACHE [RUNS] [JOBS]`.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example shows its result")]

use std::path::Path;

use close_loop::campaign::{Laboratory, Resolution, Sampling};
use close_loop::rig_schema::{Case, MeasuredTable};
use close_loop::{CloseLoop, LoopSettings};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, cache, rest @ ..] = arguments.as_slice() else {
        return Err("expected CASE.toml CACHE [RUNS] [JOBS]".into());
    };
    let case = Case::parse(file, &std::fs::read_to_string(file)?)?;
    let table = Path::new(file).with_file_name(&case.data.responses);
    let measured =
        MeasuredTable::parse(&table.display().to_string(), &std::fs::read_to_string(&table)?)?;
    let jobs = rest.get(1).map_or(Ok(2), |j| j.parse())?;
    let resolution = Resolution { width_px: 484, ..Resolution::default() };
    let sampling = Sampling { resolution, ..Sampling::default() };
    let lab = Laboratory::open(Path::new(cache), jobs, sampling)?;
    let settings = LoopSettings {
        runs: rest.first().map(|r| r.parse()).transpose()?,
        ..LoopSettings::default()
    };
    let looped =
        CloseLoop { case: &case, measured: &measured, loads: &[], lab: &lab, settings: &settings };
    eprintln!("{} runs at most", looped.planned()?);
    let outcome = looped.run(&mut |t| {
        eprint!("\r{:?} {}/{} ({} runs)   ", t.stage, t.done, t.of, t.runs);
    })?;
    println!("\n{}", outcome.sentence);
    println!("calibrated {:?}", outcome.calibrated);
    println!("gate {:?}", outcome.finding.gate);
    println!(
        "inflation {:.2}, cost {:.0} s, runs {}",
        outcome.inflation, outcome.cost_s, outcome.runs
    );
    for r in &outcome.finding.ranked {
        println!(
            "{:32} {:9.4} [{:?}, {:?}] gain {:7.1} p_abs {:.3} fam {:.3} ev {:.3} held {:?} {} {:?}",
            r.name,
            r.strength.value,
            r.strength.lo,
            r.strength.hi,
            r.improvement,
            r.p_absolute,
            r.p_family,
            r.evidence,
            r.held_out_gain.map(|g| (g * 100.0).round() / 100.0),
            r.class,
            r.objections
        );
    }
    for (name, side) in [("before", &outcome.before), ("after", &outcome.after)] {
        println!(
            "{name}: {:?} chi2 {:.1}/{} p {:.4}",
            side.at, side.errors.chi2, side.errors.dof, side.errors.p
        );
        for (set, all) in [("fitted", &side.errors.fitted), ("held out", &side.errors.held_out)] {
            for e in all {
                println!(
                    "  {set:9} {:12} rmse {:.2} ({:.2} sd), floor {:.2}",
                    e.response, e.rmse, e.rmse_sd, e.floor
                );
            }
        }
    }
    println!(
        "removed {:?}, confirmed {:?}, failed {:?}",
        outcome.removed, outcome.confirmed, outcome.failed
    );
    for p in &outcome.points {
        println!(
            "{:5} {:12} {} measured {:7.2} sd {:.2} before {:7.2} after {:7.2}",
            p.omega_rpm,
            p.response,
            if p.fitted { "fit " } else { "held" },
            p.measured,
            p.sd,
            p.before,
            p.after
        );
    }
    println!("left out {:?}", outcome.left_out);
    Ok(())
}
