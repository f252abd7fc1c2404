//! Rigs by file or built-in name, with what the command line changes in them.

use std::path::Path;

use campaign::drum_rig::{Coarsening, coarse};
use rig_schema::{Case, Rig};

use crate::input::{self, InputError};

/// What the command line changes in a rig.
pub(crate) struct Changes<'a> {
    /// A result whose parameters the rig takes before the settings.
    pub(crate) calibrated: Option<&'a Path>,
    pub(crate) settings: &'a [(String, f64)],
    pub(crate) speeds: &'a [f64],
    pub(crate) frames: Option<u32>,
    pub(crate) seed: Option<u64>,
    pub(crate) coarse: bool,
}

/// Bytes of the mesh that a rig names, beside the rig's file.
pub(crate) fn liner(file: &str, rig: &Rig) -> Result<Option<Vec<u8>>, InputError> {
    let Some(named) = &rig.drum.liner else { return Ok(None) };
    let path = Path::new(file).parent().unwrap_or(Path::new("")).join(named);
    std::fs::read(&path).map(Some).map_err(|source| InputError::Run {
        what: format!("{} cannot be read: {source}", path.display()),
        expected: "the STL file that drum.liner names, beside the rig".to_owned(),
    })
}

/// The rig of a rig file, a case file or a built-in case, with what the arguments change.
pub(crate) fn rig(name: &str, changes: &Changes<'_>) -> anyhow::Result<(Rig, String)> {
    let path = Path::new(name);
    let text = if path.is_file() {
        input::read(path)?
    } else if let Some(known) = input::built_in(name) {
        input::fixture(&format!("thesis/cases/{}.toml", known.to_lowercase()))?
    } else if path.extension().is_some() {
        input::read(path)?
    } else {
        let known = tumble_fixtures::CASES.join(", ");
        return Err(InputError::NoCase { name: name.to_owned(), known }.into());
    };
    let is_case = text.text.lines().any(|l| l.trim_start().starts_with("[data]"));
    let mut rig = if is_case {
        Case::parse(&text.name, &text.text)?.rig
    } else {
        Rig::parse(&text.name, &text.text)?
    };
    let calibrated = changes.calibrated.map(crate::calibrated::settings).transpose()?;
    for (path, value) in calibrated.iter().flatten().chain(changes.settings) {
        rig.settings.set(path, *value).map_err(|refused| InputError::Setting {
            path: path.clone(),
            value: *value,
            expected: match refused {
                Some(p) => format!("{} to {} {}", p.range.0, p.range.1, p.unit),
                None => format!(
                    "a known parameter, the nearest is {}",
                    rig_schema::namespace::nearest(path)
                ),
            },
        })?;
    }
    if !changes.speeds.is_empty() {
        rig.run.speeds_rpm = changes.speeds.to_vec();
    }
    if let Some(frames) = changes.frames {
        rig.run.frames = frames;
    }
    if let Some(seed) = changes.seed {
        rig.run.seed = seed;
    }
    if let Some((what, expected)) = rig.run.fault() {
        return Err(InputError::Run { what, expected }.into());
    }
    if changes.coarse {
        rig = coarse(&rig, Coarsening::default())?;
    }
    Ok((rig, text.input().hash))
}
