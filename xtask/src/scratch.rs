//! `cargo xtask scratch`: a program outside the workspace that depends on dem-core alone.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, ensure};

/// Crates that dem-core may need without its features, itself included.
const MOST_CRATES: usize = 30;

/// Make the program under target/scratch, build it from nothing, run it.
pub(crate) fn run() -> anyhow::Result<()> {
    let root = crate::root().canonicalize()?;
    let folder = root.join("target/scratch");
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    std::fs::create_dir_all(folder.join("src"))?;
    let core = root.join("crates/dem-core");
    let manifest = format!(
        "[package]\nname = \"scratch\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n\
         [dependencies]\ndem-core = {{ path = {core:?} }}\n\n[workspace]\n"
    );
    std::fs::write(folder.join("Cargo.toml"), manifest)?;
    // 1000 spheres in a turning drum.
    std::fs::copy(core.join("examples/drum.rs"), folder.join("src/main.rs"))?;

    let tree = cargo(&folder, &["tree", "--edges", "normal", "--prefix", "none"])?;
    let crates: BTreeSet<&str> =
        tree.lines().filter_map(|l| l.split(' ').next()).filter(|n| *n != "scratch").collect();
    println!("{} crates: {crates:?}", crates.len());
    let begun = Instant::now();
    cargo(&folder, &["build", "--release", "--quiet"])?;
    println!("built from nothing in {:.0} s", begun.elapsed().as_secs_f64());
    let begun = Instant::now();
    print!("{}", cargo(&folder, &["run", "--release", "--quiet"])?);
    println!("ran in {:.1} s", begun.elapsed().as_secs_f64());
    ensure!(crates.len() <= MOST_CRATES, "more than {MOST_CRATES} crates");
    Ok(())
}

/// Run cargo in `folder`; what it printed.
fn cargo(folder: &Path, args: &[&str]) -> anyhow::Result<String> {
    let done = Command::new(env!("CARGO"))
        .args(args)
        .current_dir(folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .output()
        .with_context(|| format!("cannot start cargo {}", args.join(" ")))?;
    let said = String::from_utf8_lossy(&done.stderr);
    ensure!(done.status.success(), "cargo {} failed: {said}", args.join(" "));
    Ok(String::from_utf8_lossy(&done.stdout).into_owned())
}
