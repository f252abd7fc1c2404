//! What the code itself changes: the same drums by Tumble, LIGGGHTS and LAMMPS, nothing missing in any; and by
//! Tumble with half the step, and with LIGGGHTS's form of the shear spring (its present stiffness times the whole
//! displacement).

use std::fmt::Write as _;
use std::path::Path;

use anyhow::Context;
use close_loop::campaign::Run;
use close_loop::campaign::export::Code;
use close_loop::rig_schema::{Response, Rig, TangentialLaw};

use super::drums::truth;
use super::elsewhere::{self, Other};
use super::make::{Care, RESOLUTION, nature, nature_lab};

/// Frictions between particles of the matched drums.
const FRICTIONS: [f64; 3] = [0.3, 0.45, 0.6];

/// A drum that lacks nothing, in another filling for each `number`, with the step of the blind study times
/// `step`.
fn drum(friction: f64, number: u64, step: f64) -> anyhow::Result<Rig> {
    let truth = truth("null", "", friction, &[]);
    let care =
        Care { fillings: 1, photographs: None, weighed: false, coarse: false, two_loads: false };
    let mut rig = nature(&truth, 700_000 + number, care)?.remove(0);
    let own = rig.settings.value("step.scale").unwrap_or(1.0);
    rig.settings
        .set("step.scale", own * step)
        .map_err(|_| anyhow::anyhow!("step.scale {step} is refused"))?;
    Ok(rig)
}

/// Mean and standard error of the differences of paired runs, by speed and response.
fn difference(a: &[Run], b: &[Run]) -> Vec<[(f64, f64); 4]> {
    let n = a.len() as f64;
    let speeds = a.first().map_or(0, |r| r.speeds.len());
    let one = |k: usize, r: usize| {
        let each: Vec<f64> =
            a.iter().zip(b).map(|(a, b)| a.speeds[k].mean[r] - b.speeds[k].mean[r]).collect();
        let mean = each.iter().sum::<f64>() / n;
        let square = each.iter().map(|d| (d - mean).powi(2)).sum::<f64>();
        (mean, (square / (n - 1.0) / n).sqrt())
    };
    (0..speeds).map(|k| std::array::from_fn(|r| one(k, r))).collect()
}

/// One other code in all matched drums.
struct Matched {
    code: Other,
    theirs: Vec<Run>,
}

pub(crate) fn run(folder: &Path, fillings: u64, jobs: usize) -> anyhow::Result<()> {
    anyhow::ensure!(fillings >= 1, "--fillings is 1 or more");
    let mut matched = Vec::new();
    for code in [Code::Liggghts, Code::Lammps] {
        match Other::locate(code) {
            Ok(code) => matched.push(Matched { code, theirs: Vec::new() }),
            Err(why) => println!("{}: left out, {why}", code.name()),
        }
    }
    let lab = nature_lab(folder, jobs, RESOLUTION)?;
    let (mut own, mut fine, mut whole) = (Vec::new(), Vec::new(), Vec::new());
    let mut speeds = Vec::new();
    for (k, friction) in FRICTIONS.into_iter().enumerate() {
        for filling in 0..fillings {
            let number = 100 * k as u64 + filling;
            let rig = drum(friction, number, 1.0)?;
            speeds.clone_from(&rig.run.speeds_rpm);
            let mut total = rig.clone();
            total.contact.tangential = TangentialLaw::MindlinTotalSpring;
            let rigs = [rig, drum(friction, number, 0.5)?, total];
            let runs = lab.run(&rigs, |_| ()).into_iter().collect::<Result<Vec<_>, _>>()?;
            let [first, half, total]: [Run; 3] =
                runs.try_into().map_err(|_| anyhow::anyhow!("three runs were asked for"))?;
            for Matched { code, theirs } in &mut matched {
                let name = code.code.name().to_lowercase();
                let deck = folder.join("codes").join(name).join(format!("{friction}-{filling}"));
                let run = elsewhere::run(code, &rigs[0], &deck)
                    .with_context(|| format!("friction {friction}, filling {filling}"))?;
                theirs.push(run);
            }
            println!("friction {friction}, filling {filling}");
            own.push(first);
            fine.push(half);
            whole.push(total);
        }
    }
    let title = |m: &Matched, rest: &str| format!("{} less Tumble{rest}", m.code.code.name());
    for m in &matched {
        println!("{}", table(&title(m, ""), &speeds, &difference(&m.theirs, &own)));
        let rest = title(m, " with the spring as a whole");
        println!("{}", table(&rest, &speeds, &difference(&m.theirs, &whole)));
    }
    println!("{}", table("Half the step less the step", &speeds, &difference(&fine, &own)));
    let law = "The spring as a whole less what is added step by step";
    println!("{}", table(law, &speeds, &difference(&whole, &own)));
    crate::write_whole(&folder.join("codes.csv"), &differences(&speeds, &matched, &own, fillings))
}

/// Differences by code, friction and speed, means over fillings: what `data.code_differences` of a case asks for.
fn differences(speeds: &[f64], matched: &[Matched], own: &[Run], fillings: u64) -> String {
    let mut text = String::from("pair,omega_rpm");
    for r in Response::ALL {
        let _ = write!(text, ",{}", r.column());
    }
    text.push('\n');
    let n = fillings as usize;
    let pairs = matched.iter().flat_map(|m| m.theirs.chunks(n).zip(own.chunks(n)));
    for (pair, (other, own)) in pairs.enumerate() {
        for (k, speed) in speeds.iter().enumerate() {
            let _ = write!(text, "{},{speed}", pair + 1);
            for r in 0..4 {
                let mean = |runs: &[Run]| {
                    runs.iter().map(|run| run.speeds[k].mean[r]).sum::<f64>() / n as f64
                };
                let _ = write!(text, ",{:.4}", mean(other) - mean(own));
            }
            text.push('\n');
        }
    }
    text
}

fn table(title: &str, speeds: &[f64], all: &[[(f64, f64); 4]]) -> String {
    let mut text = format!("| {title}, rpm |");
    for r in Response::ALL {
        let _ = write!(text, " {} |", r.column());
    }
    text.push_str("\n|---|---|---|---|---|\n");
    for (speed, four) in speeds.iter().zip(all) {
        let _ = write!(text, "| {speed} |");
        for (mean, error) in four {
            let _ = write!(text, " {mean:+.2} ± {error:.2} |");
        }
        text.push('\n');
    }
    text
}
