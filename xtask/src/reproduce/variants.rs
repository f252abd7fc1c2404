//! One drum of the thesis with one thing changed at a time: end plates, laws, step.
//!
//! AZ1_Plexi at 17 rpm with friction 0.5 between beads and 0.6 at walls (run N14 of Table 8). Rows are
//! kept in `target/reproduce/variants`; the same call goes on where it was stopped.

use std::fmt::Write as _;

use close_loop::campaign::{Laboratory, Run, Sampling};
use close_loop::rig_schema::{Response, Rig};
use serde::Serialize;

use super::fixture;

/// A change: what it is called, a line of the rig file for another, or a parameter.
struct Variant {
    group: &'static str,
    name: &'static str,
    lines: &'static [(&'static str, &'static str)],
    set: &'static [(&'static str, f64)],
    fillings: u64,
}

const fn law(name: &'static str, lines: &'static [(&'static str, &'static str)]) -> Variant {
    Variant { group: "laws", name, lines, set: &[], fillings: 1 }
}

const VARIANTS: [Variant; 13] = [
    Variant { group: "end plates", name: "turning", lines: &[], set: &[], fillings: 2 },
    Variant {
        group: "end plates",
        name: "still",
        lines: &[("ends = \"turning\"", "ends = \"still\"")],
        set: &[],
        fillings: 2,
    },
    Variant {
        group: "end plates",
        name: "periodic",
        // Constants of plates that are not there would be refused.
        lines: &[("ends = \"turning\"", "ends = \"periodic\""), ("end_plate = 0.01", "")],
        set: &[],
        fillings: 2,
    },
    law(
        "spring as a whole with new stiffness (EDEM, LIGGGHTS)",
        &[("tangential = \"mindlin\"", "tangential = \"mindlin_total_spring\"")],
    ),
    law(
        "rolling torque on the absolute spin (EDEM)",
        &[("rolling = \"constant_torque\"", "rolling = \"absolute_spin\"")],
    ),
    law(
        "both",
        &[
            ("tangential = \"mindlin\"", "tangential = \"mindlin_total_spring\""),
            ("rolling = \"constant_torque\"", "rolling = \"absolute_spin\""),
        ],
    ),
    law(
        "no rolling resistance",
        &[("rolling = \"constant_torque\"", "rolling = \"none\""), ("[rolling]", "[rolling-off]")],
    ),
    law(
        "damping may pull",
        &[(
            "rolling = \"constant_torque\"",
            "rolling = \"constant_torque\"\nattractive_tail = true",
        )],
    ),
    Variant { group: "step", name: "half", lines: &[], set: &[("step.scale", 0.5)], fillings: 1 },
    Variant {
        group: "step",
        name: "a quarter",
        lines: &[],
        set: &[("step.scale", 0.25)],
        fillings: 1,
    },
    Variant {
        group: "constants",
        name: "ten times the rolling resistance",
        lines: &[],
        set: &[("rolling.pp", 0.1), ("rolling.mantle", 0.1)],
        fillings: 1,
    },
    Variant {
        group: "constants",
        name: "restitution 0.6",
        lines: &[],
        set: &[("restitution.pp", 0.6), ("restitution.mantle", 0.6)],
        fillings: 1,
    },
    Variant {
        group: "constants",
        name: "camera at 8 m instead of 0.8 m",
        lines: &[],
        set: &[("camera.distance_m", 8.0), ("camera.focal_length_mm", 350.0)],
        fillings: 1,
    },
];

#[derive(Serialize)]
struct Row {
    group: &'static str,
    name: &'static str,
    fillings: usize,
    mean: [f64; 4],
    error: [f64; 4],
}

fn rig(variant: &Variant, filling: u64) -> anyhow::Result<Rig> {
    let plan = fixture("thesis/plans/az1.toml")?;
    let mut text: String = plan
        .lines()
        .filter(|l| !l.starts_with("factors.") && !l.starts_with("design"))
        .flat_map(|l| [l, "\n"])
        .collect();
    for (old, new) in variant.lines {
        if *new == "[rolling-off]" {
            // Coefficients of a law that is not there would be refused.
            let (before, after) = text.split_once(old).unwrap_or((&text, ""));
            let rest = after.find("\n[").map_or("", |k| &after[k..]);
            text = format!("{before}{rest}");
        } else {
            anyhow::ensure!(text.contains(old), "{}: no line `{old}`", variant.name);
            text = text.replace(old, new);
        }
    }
    let mut rig = Rig::parse("az1.toml", &text)?;
    for (path, value) in [("friction.pp", 0.5), ("friction.mantle", 0.6)].iter().chain(variant.set)
    {
        let set = rig.settings.set(path, *value);
        set.map_err(|_| anyhow::anyhow!("{}: {path} = {value} is refused", variant.name))?;
    }
    rig.run.speeds_rpm = vec![17.0];
    rig.run.frames = 30;
    rig.run.seed = filling;
    Ok(rig)
}

fn row(variant: &Variant, runs: &[Run]) -> Row {
    let n = runs.len() as f64;
    let mut mean = [0.0; 4];
    let mut error = [0.0; 4];
    for r in 0..4 {
        mean[r] = runs.iter().map(|run| run.speeds[0].mean[r]).sum::<f64>() / n;
        let variance: f64 = runs.iter().map(|run| run.speeds[0].covariance[r][r]).sum();
        error[r] = variance.sqrt() / n;
    }
    Row { group: variant.group, name: variant.name, fillings: runs.len(), mean, error }
}

/// Simulate what is not there yet and write docs/src/own-dem-variants.md.
pub(crate) fn run(jobs: usize) -> anyhow::Result<()> {
    let root = crate::root();
    let folder = root.join("target/reproduce/variants");
    let lab = Laboratory::open(&folder, jobs, Sampling::default())?;
    let mut rigs = Vec::new();
    let mut whose = Vec::new();
    for (k, variant) in VARIANTS.iter().enumerate() {
        for filling in 1..=variant.fillings {
            rigs.push(rig(variant, filling)?);
            whose.push(k);
        }
    }
    let results = lab.run(&rigs, |done| {
        let name = VARIANTS[whose[done.index]].name;
        match done.run {
            Ok(run) => eprintln!("{name}: {:.0} s", run.cost_s),
            Err(e) => eprintln!("{name}: {e}"),
        }
    });
    let mut by_variant: Vec<Vec<Run>> = VARIANTS.iter().map(|_| Vec::new()).collect();
    for (k, result) in whose.into_iter().zip(results) {
        by_variant[k].extend(result.ok());
    }
    let each = VARIANTS.iter().zip(&by_variant).filter(|(_, runs)| !runs.is_empty());
    let rows: Vec<Row> = each.map(|(v, runs)| row(v, runs)).collect();
    let mut text = String::from(
        "# One thing changed at a time\n\n\
         AZ1_Plexi at 17 rpm, friction 0.5 between beads and 0.6 at the walls (run N14 of Table 8), 30 frames a filling, angles as\n\
         photographs define them; standard errors from the frames. `cargo xtask reproduce --variants`.\n\n\
         | what | changed to | fillings | aor_lin, deg | aor_mid, deg | cen_x, % R | cen_y, % R |\n|---|---|---:|---:|---:|---:|---:|\n",
    );
    for r in &rows {
        let _ = write!(text, "| {} | {} | {} |", r.group, r.name, r.fillings);
        for k in 0..Response::ALL.len() {
            let _ = write!(text, " {:.2} ({:.2}) |", r.mean[k], r.error[k]);
        }
        text.push('\n');
    }
    crate::write_whole(&root.join("docs/src/own-dem-variants.md"), &text)?;
    println!("{text}");
    Ok(())
}
