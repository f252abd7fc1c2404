//! Instructions of the contact loop under valgrind, held against frozen counts.
//!
//! A count does not depend on the load of the machine, so it can guard the speed of a commit in
//! continuous integration. It depends on the compiler and on which kernels valgrind can run:
//! portable and AVX2. A change for the better needs a new count here as well.

use std::process::Command;

use anyhow::{Context, bail};

/// Largest relative difference that passes.
const TOLERANCE: f64 = 0.03;

/// Kernels, beads, and millions of instructions of `measured` in the example `instructions`.
const FROZEN: [(&str, u32, f64); 2] = [("avx2", 500, 44.81), ("portable", 500, 147.50)];

/// Count and compare.
pub(crate) fn run() -> anyhow::Result<()> {
    if cfg!(not(all(target_arch = "x86_64", target_os = "linux"))) {
        println!("instructions: skipped: counts are frozen for Linux on x86-64");
        return Ok(());
    }
    if !Command::new("valgrind").arg("--version").output().is_ok_and(|o| o.status.success()) {
        println!("instructions: skipped: no valgrind here (apt-get install valgrind)");
        return Ok(());
    }
    let built = Command::new(env!("CARGO"))
        .args(["build", "--release", "--quiet", "--package", "dem-core"])
        .args(["--example", "instructions", "--message-format", "json-render-diagnostics"])
        .output()
        .context("cannot start cargo")?;
    if !built.status.success() {
        bail!("the example does not build: {}", String::from_utf8_lossy(&built.stderr));
    }
    let program = executable(&String::from_utf8_lossy(&built.stdout))
        .context("cargo does not say where the example is")?;
    let mut off = Vec::new();
    for (kernels, beads, frozen) in FROZEN {
        if kernels == "avx2" && !has_avx2() {
            println!("instructions: {kernels} skipped: this processor has no AVX2");
            continue;
        }
        let count = count(&program, kernels, beads)? / 1e6;
        let change = count / frozen - 1.0;
        println!(
            "instructions, {kernels} kernels: {count:.2} million, frozen {frozen:.2} million ({:+.1} %)",
            100.0 * change
        );
        if change.abs() > TOLERANCE {
            off.push(format!("{kernels} {count:.2}"));
        }
    }
    if !off.is_empty() {
        bail!(
            "instruction counts differ by more than {:.0} %: {}; if that is meant, freeze them in \
             xtask/src/instructions.rs and say why in docs/performance.md",
            100.0 * TOLERANCE,
            off.join(", ")
        );
    }
    Ok(())
}

fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}

/// Path of the executable in cargo's messages.
fn executable(messages: &str) -> Option<String> {
    messages.lines().rev().find_map(|line| {
        let message: serde_json::Value = serde_json::from_str(line).ok()?;
        message["executable"].as_str().map(str::to_owned)
    })
}

/// Instructions inside `measured`.
fn count(program: &str, kernels: &str, beads: u32) -> anyhow::Result<f64> {
    let done = Command::new("valgrind")
        .args(["--tool=callgrind", "--toggle-collect=*measured*"])
        .args(["--callgrind-out-file=/dev/null", program, kernels])
        .arg(beads.to_string())
        .output()
        .context("cannot start valgrind")?;
    let text = String::from_utf8_lossy(&done.stderr);
    if !done.status.success() {
        bail!("{kernels}: {}", text.lines().last().unwrap_or("valgrind failed"));
    }
    collected(&text).with_context(|| format!("no count in valgrind's words: {text}"))
}

fn collected(text: &str) -> Option<f64> {
    let line = text.lines().find(|l| l.contains("Collected :"))?;
    line.split_whitespace().last()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_count_and_the_program_are_found_in_what_the_tools_say() {
        let said = "==7== \n==7== Collected : 84844701\n==7== \n";
        assert_eq!(collected(said), Some(84_844_701.0));
        assert_eq!(collected("==7== nothing"), None);
        let messages = "{\"executable\":null}\n{\"executable\":\"/a/b\"}\n{\"success\":true}\n";
        assert_eq!(executable(messages).as_deref(), Some("/a/b"));
    }
}
