//! Drums of the thesis with one thing changed at a time: end plates, laws, step, constants.
//!
//! Rows are kept in `target/reproduce/variants`; the same call goes on where it was stopped.

use std::fmt::Write as _;

use close_loop::campaign::{Laboratory, Run, Sampling};
use close_loop::rig_schema::{Response, Rig};

use super::campaigns::{EDEM_LAWS, TUBE};
use super::fixture;

/// A drum that is changed.
struct Drum {
    title: &'static str,
    /// Its plan, whose constants it has.
    plan: &'static str,
    /// Lines of the plan and what stands in their place.
    lines: &'static [(&'static str, &'static str)],
    rpm: f64,
    /// What the printed table says, deg, deg.
    edem: [f64; 2],
    variants: &'static [Variant],
}

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

const fn constant(name: &'static str, set: &'static [(&'static str, f64)]) -> Variant {
    Variant { group: "constants", name, lines: &[], set, fillings: 1 }
}

/// The printed diameter as that of the tube's outside.
const NARROWER: Variant = Variant {
    group: "constants",
    name: "240 mm inside instead of 250 mm",
    lines: &[TUBE],
    set: &[],
    fillings: 2,
};

static DRUMS: [Drum; 2] = [
    Drum {
        title: "AZ1 at 17 rpm (run N14 of Table 8), by our laws",
        plan: "az1",
        lines: &[],
        rpm: 17.0,
        edem: [28.62, 27.76],
        variants: &VARIANTS,
    },
    Drum {
        title: "AZ2 at 30 rpm, by EDEM's laws",
        plan: "az2",
        lines: &EDEM_LAWS,
        rpm: 30.0,
        edem: [33.39, 38.28],
        variants: &CASCADING,
    },
];

/// What could make a bed at 30 rpm more S-shaped.
static CASCADING: [Variant; 10] = [
    Variant { group: "as it is", name: "", lines: &[], set: &[], fillings: 2 },
    law(
        "our laws",
        &[
            ("tangential = \"mindlin_total_spring\"", "tangential = \"mindlin\""),
            ("rolling = \"absolute_spin\"", "rolling = \"constant_torque\""),
        ],
    ),
    law(
        "damping may pull",
        &[("rolling = \"absolute_spin\"", "rolling = \"absolute_spin\"\nattractive_tail = true")],
    ),
    Variant { group: "step", name: "half", lines: &[], set: &[("step.scale", 0.5)], fillings: 1 },
    Variant {
        group: "end plates",
        name: "still",
        lines: &[("ends = \"turning\"", "ends = \"still\"")],
        set: &[],
        fillings: 1,
    },
    constant("restitution 0.5", &[("restitution.pp", 0.5), ("restitution.mantle", 0.5)]),
    constant(
        "three times the rolling resistance",
        &[("rolling.pp", 0.03), ("rolling.mantle", 0.03)],
    ),
    constant("a tenth more speed", &[("speed.scale", 1.1)]),
    constant("a twentieth more beads", &[("fill.scale", 1.05)]),
    NARROWER,
];

static VARIANTS: [Variant; 14] = [
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
    law("both", &EDEM_LAWS),
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
    constant("ten times the rolling resistance", &[("rolling.pp", 0.1), ("rolling.mantle", 0.1)]),
    constant("restitution 0.6", &[("restitution.pp", 0.6), ("restitution.mantle", 0.6)]),
    constant(
        "camera at 8 m instead of 0.8 m",
        &[("camera.distance_m", 8.0), ("camera.focal_length_mm", 350.0)],
    ),
    NARROWER,
];

struct Row {
    group: &'static str,
    name: &'static str,
    fillings: usize,
    mean: [f64; 4],
    error: [f64; 4],
}

fn rig(drum: &Drum, variant: &Variant, filling: u64) -> anyhow::Result<Rig> {
    let file = format!("{}.toml", drum.plan);
    let plan = fixture(&format!("thesis/plans/{file}"))?;
    let mut text: String = plan
        .lines()
        .filter(|l| !l.starts_with("factors.") && !l.starts_with("design"))
        .flat_map(|l| [l, "\n"])
        .collect();
    for (old, new) in drum.lines.iter().chain(variant.lines) {
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
    let mut rig = Rig::parse(&file, &text)?;
    for (path, value) in [("friction.pp", 0.5), ("friction.mantle", 0.6)].iter().chain(variant.set)
    {
        let set = rig.settings.set(path, *value);
        set.map_err(|_| anyhow::anyhow!("{}: {path} = {value} is refused", variant.name))?;
    }
    rig.run.speeds_rpm = vec![drum.rpm];
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
    let (mut rigs, mut names) = (Vec::new(), Vec::new());
    for drum in &DRUMS {
        for variant in drum.variants {
            for filling in 1..=variant.fillings {
                rigs.push(rig(drum, variant, filling)?);
                names.push(variant.name);
            }
        }
    }
    let mut results = lab
        .run(&rigs, |done| {
            let name = names[done.index];
            match done.run {
                Ok(run) => eprintln!("{name}: {:.0} s", run.cost_s),
                Err(e) => eprintln!("{name}: {e}"),
            }
        })
        .into_iter();
    let mut text = String::from(
        "# One thing changed at a time\n\n\
         Friction 0.5 between beads and 0.6 at the walls, 30 frames a filling, angles as photographs define them (EDEM's pictures were read a\n\
         little otherwise: its figures are for the direction only); standard errors from the frames. `cargo xtask reproduce --variants`.\n",
    );
    for drum in &DRUMS {
        let [lin, mid] = drum.edem;
        let _ = write!(
            text,
            "\n## {}\n\nEDEM prints {lin} and {mid} deg.\n\n\
             | what | changed to | fillings | aor_lin, deg | aor_mid, deg | cen_x, % R | cen_y, % R |\n|---|---|---:|---:|---:|---:|---:|\n",
            drum.title
        );
        for variant in drum.variants {
            let own = results.by_ref().take(variant.fillings as usize);
            let runs: Vec<Run> = own.filter_map(Result::ok).collect();
            if !runs.is_empty() {
                line(&mut text, &row(variant, &runs));
            }
        }
    }
    crate::write_whole(&root.join("docs/src/own-dem-variants.md"), &text)?;
    println!("{text}");
    Ok(())
}

fn line(text: &mut String, r: &Row) {
    let _ = write!(text, "| {} | {} | {} |", r.group, r.name, r.fillings);
    for k in 0..Response::ALL.len() {
        let _ = write!(text, " {:.2} ({:.2}) |", r.mean[k], r.error[k]);
    }
    text.push('\n');
}
