//! Everything that the thesis's tables allow, computed anew beside what was printed.

pub(crate) mod beads;
mod campaigns;
pub(crate) mod dem;
mod documents;
mod markdown;
mod materials;
pub(crate) mod own;
mod own_beads;
mod own_tube;
mod printed;
mod ranges;
pub(crate) mod sizes;
mod surrogates;
pub(crate) mod tube;
pub(crate) mod variants;

use std::time::Instant;

use anyhow::Context;
use calib::Study;
use rig_schema::{Case, Errata, ErrataLevel, MeasuredTable, SimulatedTable};
use serde::Serialize;

/// One printed number beside ours.
#[derive(Serialize)]
pub(crate) struct Row {
    /// What it is.
    item: String,
    /// As printed.
    printed: String,
    /// As computed here.
    ours: String,
    /// Whether they agree.
    agree: bool,
    /// Why not, or what to note.
    why: String,
}

impl Row {
    pub(crate) fn new(
        item: impl Into<String>,
        printed: impl Into<String>,
        ours: impl Into<String>,
        agree: bool,
        why: impl Into<String>,
    ) -> Self {
        Self {
            item: item.into(),
            printed: printed.into(),
            ours: ours.into(),
            agree,
            why: why.into(),
        }
    }
}

/// Everything.
#[derive(Serialize)]
pub(crate) struct Reproduction {
    tables: Vec<(String, Vec<Row>)>,
    fits: Vec<surrogates::FitRow>,
    ranges: Vec<ranges::RangeRow>,
    hits: Vec<ranges::Hits>,
    materials: Vec<materials::Material>,
    outliers: Vec<surrogates::CertainMisprint>,
    other_outliers: usize,
    duplicates: Vec<String>,
    seconds: f64,
}

/// One configuration, its tables mended at a level.
pub(crate) fn study(name: &str, level: ErrataLevel) -> anyhow::Result<Study> {
    let (case, measured, simulated) = tables(name, level)?;
    Study::new(&case, &measured, simulated).with_context(|| name.to_owned())
}

pub(crate) fn fixture(path: &str) -> anyhow::Result<&'static str> {
    tumble_fixtures::read(path).with_context(|| format!("no fixture {path}"))
}

pub(crate) fn tables(
    name: &str,
    level: ErrataLevel,
) -> anyhow::Result<(Case, MeasuredTable, SimulatedTable)> {
    let file = format!("thesis/cases/{}.toml", name.to_lowercase());
    let case = Case::parse(&file, fixture(&file)?)?;
    let errata = Errata::parse("errata.csv", fixture("thesis/errata.csv")?)?;
    let file = format!("experiment_{name}.csv");
    let mut measured = MeasuredTable::parse(&file, fixture(&format!("thesis/tables/{file}"))?)?;
    errata.apply_measured(&mut measured, level)?;
    let columns = Study::columns(&case)?;
    let columns: Vec<&str> = columns.iter().map(|(c, _)| c.as_str()).collect();
    let file = format!("edem_{name}.csv");
    let mut simulated =
        SimulatedTable::parse(&file, fixture(&format!("thesis/tables/{file}"))?, &columns)?;
    errata.apply_simulated(&mut simulated, level)?;
    Ok((case, measured, simulated))
}

/// Rows of a table of the thesis, comments left out.
pub(crate) fn records(file: &str) -> anyhow::Result<Vec<csv::StringRecord>> {
    let text = fixture(&format!("thesis/tables/{file}"))?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    Ok(reader.records().collect::<Result<_, _>>()?)
}

/// Compute everything and write docs/reproduction.md and docs/reproduction.json.
pub(crate) fn run(json: bool) -> anyhow::Result<()> {
    let start = Instant::now();
    eprintln!("tables 3, 6, 8");
    let tables = documents::all()?;
    eprintln!("48 response surfaces");
    let (fits, outliers, other_outliers, duplicates) = surrogates::all()?;
    eprintln!("36 friction ranges");
    let (ranges, hits) = ranges::all()?;
    eprintln!("one friction a material");
    let materials = materials::all()?;
    let seconds = start.elapsed().as_secs_f64();
    let all = Reproduction {
        tables,
        fits,
        ranges,
        hits,
        materials,
        outliers,
        other_outliers,
        duplicates,
        seconds,
    };
    let text = serde_json::to_string_pretty(&all)?;
    let docs = crate::root().join("docs");
    crate::write_whole(&docs.join("reproduction.md"), &markdown::page(&all))?;
    crate::write_whole(&docs.join("reproduction.json"), &text)?;
    if json {
        println!("{text}");
    } else {
        println!("{}", markdown::digest(&all));
        println!("docs/reproduction.md written in {seconds:.1} s");
    }
    Ok(())
}
