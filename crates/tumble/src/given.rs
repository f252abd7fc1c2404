//! Built-in cases as files, for a case of one's own to start from.

use std::path::{Path, PathBuf};

use rig_schema::{Case, Simulator};

use crate::input::{self, InputError};
use crate::output;

/// Name of the drum that `tumble close-loop` closes without arguments.
pub(crate) const DEMO: &str = "demo";

/// Write a built-in case and its tables to a folder, none of which may be there yet; the case comes first.
pub(crate) fn write(name: &str, folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let files = files(name)?;
    if let Some(there) = files.iter().map(|(file, _)| folder.join(file)).find(|p| p.exists()) {
        let what = format!("{} exists", there.display());
        let expected = "a folder without it, since nothing is overwritten".to_owned();
        return Err(InputError::Run { what, expected }.into());
    }
    let folder = output::folder(Some(folder), name)?;
    files.iter().map(|(file, text)| output::write(&folder, file, text)).collect()
}

/// Names and texts of the files, each of which names the others as lying beside it.
fn files(name: &str) -> anyhow::Result<Vec<(String, String)>> {
    let known = if name.eq_ignore_ascii_case(DEMO) { None } else { Some(known(name)?) };
    let given = input::case_text(known)?;
    let case = Case::parse(&given.case.name, &given.case.text)?;
    let mut tables = vec![(case.data.responses.clone(), given.measured.text)];
    if let Simulator::Table(table) = &case.simulator {
        tables.push((table.file.clone(), input::table(&table.file)?.text));
    }
    let mut text = given.case.text;
    for (named, _) in &mut tables {
        let file = input::file_name(named);
        text = text.replace(&format!("\"{named}\""), &format!("\"{file}\""));
        *named = file;
    }
    let own = format!("{}.toml", known.unwrap_or(DEMO).to_lowercase());
    Ok(std::iter::once((own, text)).chain(tables).collect())
}

fn known(name: &str) -> Result<&'static str, InputError> {
    input::built_in(name).ok_or_else(|| InputError::NoCase {
        name: name.to_owned(),
        known: format!("{DEMO}, {}", tumble_fixtures::CASES.join(", ")),
    })
}
