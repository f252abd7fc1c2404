//! What must pass before a change lands, in the order of what fails soonest.

use std::process::Command;
use std::time::Instant;

use anyhow::{Context, bail};

/// One step: its name, arguments of cargo, and environment.
struct Step {
    name: &'static str,
    args: &'static [&'static str],
    env: &'static [(&'static str, &'static str)],
}

const STEPS: &[Step] = &[
    Step { name: "format", args: &["fmt", "--all", "--check"], env: &[] },
    Step {
        name: "lints",
        args: &[
            "clippy",
            "--workspace",
            "--all-targets",
            "--release",
            "--quiet",
            "--",
            "-D",
            "warnings",
        ],
        env: &[],
    },
    Step { name: "tests", args: &["test", "--workspace", "--release", "--quiet"], env: &[] },
    Step {
        name: "documentation",
        args: &["doc", "--workspace", "--no-deps", "--release", "--quiet"],
        env: &[("RUSTDOCFLAGS", "-D warnings")],
    },
    Step {
        name: "main job",
        args: &["run", "--release", "--quiet", "--", "close-loop", "--out", "target/ci-loop"],
        env: &[],
    },
    Step {
        name: "calibration",
        args: &[
            "run",
            "--release",
            "--quiet",
            "--",
            "calibrate",
            "AZ4_Steel",
            "--out",
            "target/ci-report",
        ],
        env: &[],
    },
];

/// Run every step; stop at the first that fails.
pub(crate) fn run() -> anyhow::Result<()> {
    let start = Instant::now();
    crate::tidy::run()?;
    for step in STEPS {
        println!("== {}", step.name);
        let begun = Instant::now();
        let status = Command::new(env!("CARGO"))
            .args(step.args)
            .envs(step.env.iter().copied())
            .status()
            .with_context(|| format!("cannot start cargo for {}", step.name))?;
        if !status.success() {
            bail!("{} failed: cargo {}", step.name, step.args.join(" "));
        }
        println!("   {:.0} s", begun.elapsed().as_secs_f64());
    }
    println!("== instructions");
    crate::instructions::run()?;
    println!("== validation");
    crate::validate::run(false)?;
    println!("all passed in {:.0} s", start.elapsed().as_secs_f64());
    Ok(())
}
