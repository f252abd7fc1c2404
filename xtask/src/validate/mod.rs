//! Every case that `dem-core` must reproduce: docs/validation.md, its plots, and JSON.

mod bulk;
mod faults;
mod markdown;
mod plots;
mod summaries;

use std::path::Path;

use anyhow::{Context, bail};
use dem_validation::{Check, GROUPS, Group};

/// A group with its checks and the files of its plots (file, title, caption).
pub(crate) struct Section {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) checks: Vec<Check>,
    pub(crate) pictures: Vec<Picture>,
}

/// A plot as the page shows it.
pub(crate) struct Picture {
    pub(crate) file: String,
    pub(crate) title: String,
    pub(crate) caption: String,
    pub(crate) svg: String,
}

/// Run every case, write the page and its plots; fail if a case fails.
pub(crate) fn run(json: bool) -> anyhow::Result<()> {
    let root = crate::root();
    let mut sections: Vec<Section> = GROUPS.into_iter().map(section).collect();
    for picture in plots::all() {
        let (group, picture) = picture;
        let found = sections.iter_mut().find(|s| s.name == group);
        found.with_context(|| format!("plot of an unknown group {group}"))?.pictures.push(picture);
    }
    let faults = faults::rows(&root)?;
    let mut notes = String::new();
    if crate::dosta::frozen(&root).join("tumble-1.csv").is_file() {
        let bulk = bulk::section(&root)?;
        sections.push(bulk.section);
        notes = bulk.notes;
    } else {
        eprintln!("bulk_dosta left out: no frozen counts; `cargo xtask dosta --freeze` makes them");
    }
    write(&root, &markdown::page(&sections, &notes, faults), &sections)?;
    let checks: Vec<&Check> = sections.iter().flat_map(|s| &s.checks).collect();
    let failed: Vec<&&Check> = checks.iter().filter(|c| !c.pass).collect();
    if json {
        println!("{}", serde_json::to_string_pretty(&checks)?);
    } else {
        println!("{} of {} checks pass", checks.len() - failed.len(), checks.len());
    }
    for c in &failed {
        eprintln!(
            "FAILED {}: {}: reference {:e}, ours {:e}, deviation {:.2e} > {:.1e}",
            c.case, c.quantity, c.reference, c.ours, c.deviation, c.tolerance
        );
    }
    if !failed.is_empty() {
        bail!("{} of {} checks failed", failed.len(), checks.len());
    }
    Ok(())
}

fn section(group: Group) -> Section {
    eprintln!("{}", group.title);
    Section { name: group.name, title: group.title, checks: (group.cases)(), pictures: Vec::new() }
}

fn write(root: &Path, page: &str, sections: &[Section]) -> anyhow::Result<()> {
    let folder = root.join("docs/img/validation");
    std::fs::create_dir_all(&folder)?;
    for picture in sections.iter().flat_map(|s| &s.pictures) {
        let path = folder.join(&picture.file);
        std::fs::write(&path, &picture.svg).with_context(|| path.display().to_string())?;
    }
    let path = root.join("docs/validation.md");
    std::fs::write(&path, page).with_context(|| path.display().to_string())
}
