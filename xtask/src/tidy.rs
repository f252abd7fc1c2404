//! House rules that a compiler does not know.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, bail};

/// Lines above which a source file must be split.
const MOST_LINES: usize = 800;

/// Lines of a library's root: a page about the crate and its parts, no code.
const MOST_ROOT_LINES: usize = 80;

/// Bytes above which a file does not belong in the repository.
const MOST_BYTES: u64 = 1 << 20;

/// Which crates of the workspace each may use; arrows point downwards only.
const LAYERS: &[(&str, &[&str])] = &[
    ("dem-core", &[]),
    ("dem-shapes", &["dem-core"]),
    ("dem-validation", &["dem-core", "dem-shapes"]),
    ("rig-schema", &[]),
    ("tumble-fixtures", &[]),
    ("drum-rig", &["dem-core", "dem-shapes", "rig-schema"]),
    ("drum-film", &["rig-schema"]),
    ("drum-vision", &["rig-schema"]),
    ("doe", &[]),
    ("calib", &["doe", "rig-schema"]),
    ("calib-report", &[]),
    ("campaign", &["drum-rig", "drum-film", "drum-vision", "doe", "rig-schema"]),
    ("close-loop", &["campaign", "calib", "rig-schema"]),
];

/// Crates that stand above all others and may use every one.
const TOP: &[&str] = &["tumble", "xtask", "benches"];

/// Names that say nothing.
const NAMELESS: &[&str] = &["utils", "util", "common", "helpers", "helper", "misc"];

/// Check every rule and report every breach.
pub(crate) fn run() -> anyhow::Result<()> {
    let mut breaches = layering()?;
    for file in tracked()? {
        breaches.extend(check_file(&file)?);
    }
    if breaches.is_empty() {
        println!("tidy: nothing to say");
        return Ok(());
    }
    for b in &breaches {
        eprintln!("tidy: {b}");
    }
    bail!("{} breaches of the house rules", breaches.len())
}

fn output(program: &str, args: &[&str]) -> anyhow::Result<String> {
    let done = Command::new(program)
        .args(args)
        .output()
        .with_context(|| format!("cannot start {program}"))?;
    if !done.status.success() {
        bail!("{program} {}: {}", args.join(" "), String::from_utf8_lossy(&done.stderr));
    }
    Ok(String::from_utf8_lossy(&done.stdout).into_owned())
}

/// Files of the repository; those not yet added count, ignored ones do not.
fn tracked() -> anyhow::Result<Vec<String>> {
    let list = output("git", &["ls-files", "--cached", "--others", "--exclude-standard"])?;
    Ok(list.lines().filter(|f| Path::new(f).is_file()).map(str::to_owned).collect())
}

fn layering() -> anyhow::Result<Vec<String>> {
    let text = output(env!("CARGO"), &["metadata", "--no-deps", "--format-version", "1"])?;
    let metadata: serde_json::Value = serde_json::from_str(&text)?;
    let allowed: BTreeMap<&str, &[&str]> = LAYERS.iter().copied().collect();
    let packages = metadata["packages"].as_array().context("metadata without packages")?;
    let name_of = |v: &serde_json::Value| v["name"].as_str().unwrap_or_default().to_owned();
    let ours: Vec<String> = packages.iter().map(name_of).collect();
    let mut breaches = Vec::new();
    for package in packages {
        let name = name_of(package);
        if TOP.contains(&name.as_str()) {
            continue;
        }
        let Some(may_use) = allowed.get(name.as_str()) else {
            breaches.push(format!("crate {name} has no place in the layers (xtask/src/tidy.rs)"));
            continue;
        };
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            // Tests may look sideways; what is shipped may not.
            let used = name_of(dependency);
            let shipped = dependency["kind"].as_str() != Some("dev");
            if shipped && ours.contains(&used) && !may_use.contains(&used.as_str()) {
                breaches.push(format!("{name} must not use {used}"));
            }
        }
    }
    Ok(breaches)
}

fn check_file(file: &str) -> anyhow::Result<Vec<String>> {
    let mut breaches = Vec::new();
    let path = Path::new(file);
    let bytes = std::fs::metadata(path)?.len();
    if bytes > MOST_BYTES {
        breaches.push(format!("{file}: {bytes} bytes; larger than {MOST_BYTES}"));
    }
    let Ok(text) = std::fs::read_to_string(path) else { return Ok(breaches) };
    let in_tests = file.contains("/tests/") || file.ends_with("_tests.rs");
    for pattern in machine_paths() {
        let shared = pattern.ends_with("shared");
        if shared && in_tests {
            continue;
        }
        if let Some(line) = text.lines().position(|l| l.contains(&pattern)) {
            breaches.push(format!("{file}:{}: names `{pattern}`, a path of one machine", line + 1));
        }
    }
    if path.extension().is_some_and(|e| e == "rs") {
        breaches.extend(check_source(file, &text, in_tests));
    }
    Ok(breaches)
}

/// Prefixes of paths that hold on one machine only, put together so that this file has none.
fn machine_paths() -> Vec<String> {
    let mut patterns: Vec<String> =
        ["work", "root", "farm", "home"].iter().map(|d| format!("/{d}/")).collect();
    patterns.push(format!("../{}", "shared"));
    patterns
}

fn check_source(file: &str, text: &str, in_tests: bool) -> Vec<String> {
    let mut breaches = Vec::new();
    let lines = text.lines().count();
    if !in_tests && lines > MOST_LINES {
        breaches.push(format!("{file}: {lines} lines; split it by concept"));
    }
    if file.ends_with("/src/lib.rs") && !file.starts_with("fixtures/") && lines > MOST_ROOT_LINES {
        breaches.push(format!(
            "{file}: {lines} lines in a crate's root; expected at most {MOST_ROOT_LINES}"
        ));
    }
    let stem = Path::new(file).file_stem().and_then(|s| s.to_str()).unwrap_or_default();
    if NAMELESS.contains(&stem) {
        breaches.push(format!("{file}: `{stem}` names nothing"));
    }
    let head = text.lines().find(|l| !l.trim().is_empty() && !l.starts_with("#!["));
    if file.contains("/src/") && !in_tests && !head.is_some_and(|l| l.starts_with("//!")) {
        breaches.push(format!("{file}: no `//!` head that says what the module is for"));
    }
    breaches
}
