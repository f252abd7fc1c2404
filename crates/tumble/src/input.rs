//! Cases and tables, from files or built in, each with its hash.

use std::path::{Path, PathBuf};

use anyhow::Context;
use calib::Study;
use calib_report::page::InputFile;
use rig_schema::{
    Case, Errata, ErrataLevel, Erratum, MeasuredTable, NO_DIFFERENCES, SimulatedTable, Simulator,
};

/// Something that the user named and that cannot be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum InputError {
    /// Neither a file nor a built-in case.
    #[error("no case `{name}`: no such file, and the built-in cases are {known}")]
    NoCase { name: String, known: String },
    /// A file that cannot be read.
    #[error("{path} cannot be read; expected a text file")]
    Unreadable { path: String, source: std::io::Error },
    /// Cases that are given twice.
    #[error("case `{name}` is given twice; expected each once")]
    Twice { name: String },
    /// A setting on the command line.
    #[error("`{path}` = {value}: expected {expected}")]
    Setting { path: String, value: f64, expected: String },
    /// A run that cannot be carried out, or data that cannot be parted.
    #[error("{what}; expected {expected}")]
    Run { what: String, expected: String },
    /// Measured data that a case does not fit.
    #[error("{file}: {what}")]
    Case { file: String, what: String },
    /// A file of pictures that is not there.
    #[error("{path} does not exist; expected a picture, or a folder of pictures")]
    NoPicture { path: String },
    /// A file that holds no calibrated parameters.
    #[error(
        "{path} holds no calibrated parameters; expected result.json of `tumble calibrate` for one case or closed_loop.json of `tumble close-loop`"
    )]
    NotCalibrated { path: String },
    /// Something that a table of simulated responses cannot answer.
    #[error("{what} needs simulations; expected a case with [simulator.rig]")]
    NeedsRig { what: &'static str },
    /// A row of a table of positions.
    #[error(
        "{path}, line {line}: {problem}; expected frame,x,y,z,radius with a whole number and four finite lengths, m"
    )]
    Position { path: String, line: u64, problem: String },
    /// Every frame was rejected.
    #[error("no frame of {total} could be measured; the first: {reason}")]
    NothingMeasured { total: usize, reason: String },
    /// Runs of a campaign that would fail again.
    #[error("{failed} of {runs} runs failed; run {index} ({class}): {reason}")]
    RunsFailed { failed: usize, runs: usize, index: u64, class: String, reason: String },
    /// Dumps that another code has not written.
    #[error("{path} holds no dump of {code}; expected the files that its deck writes")]
    NoDumps { path: String, code: &'static str },
    /// An output folder that is a file.
    #[error("{path} is not a folder; expected a folder to write to, or a path that does not exist")]
    NotFolder { path: String },
}

/// Whether the input, not the machine, is at fault.
pub(crate) fn is_input_fault(error: &anyhow::Error) -> bool {
    let machine = |e: &campaign::CampaignError| {
        matches!(
            e,
            campaign::CampaignError::Io { .. }
                | campaign::CampaignError::Locked { .. }
                | campaign::CampaignError::Fault { .. }
                | campaign::CampaignError::Json { .. }
                | campaign::CampaignError::Unwritable { .. }
        )
    };
    error.chain().any(|e| {
        e.is::<InputError>()
            || e.is::<rig_schema::SchemaError>()
            || e.is::<calib::CalibError>()
            || e.is::<doe::DoeError>()
            || e.is::<drum_vision::VisionError>()
            || e.is::<drum_film::Error>()
            || e.downcast_ref().is_some_and(crate::command::close_loop::is_input_fault)
            || e.downcast_ref::<campaign::CampaignError>().is_some_and(|e| !machine(e))
            || e.is::<campaign::drum_rig::Error>()
    })
}

/// A text with the name it is known by.
pub(crate) struct Text {
    pub(crate) name: String,
    pub(crate) text: String,
}

impl Text {
    pub(crate) fn input(&self) -> InputFile {
        InputFile {
            name: self.name.clone(),
            hash: blake3::hash(self.text.as_bytes()).to_hex()[..16].to_owned(),
        }
    }
}

/// Read a file as the user named it.
pub(crate) fn read(path: &Path) -> Result<Text, InputError> {
    let name = path.display().to_string();
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(Text { name, text }),
        Err(source) => Err(InputError::Unreadable { path: name, source }),
    }
}

/// A case with its tables.
pub(crate) struct Loaded {
    pub(crate) case: Case,
    pub(crate) measured: MeasuredTable,
    pub(crate) simulated: SimulatedTable,
    pub(crate) errata: Vec<Erratum>,
    pub(crate) inputs: Vec<InputFile>,
    pub(crate) built_in: bool,
}

/// The built-in case of this name, in any letter case.
pub(crate) fn built_in(name: &str) -> Option<&'static str> {
    tumble_fixtures::CASES.into_iter().find(|c| c.eq_ignore_ascii_case(name))
}

pub(crate) fn fixture(path: &str) -> anyhow::Result<Text> {
    let text = tumble_fixtures::read(path).with_context(|| format!("{path} is not built in"))?;
    Ok(Text { name: path.to_owned(), text: text.to_owned() })
}

/// A table that a built-in case names.
pub(crate) fn table(named: &str) -> anyhow::Result<Text> {
    fixture(&format!("thesis/tables/{}", file_name(named)))
}

/// Where the files that a case names are.
enum Place {
    BuiltIn,
    Folder(PathBuf),
}

impl Place {
    fn read(&self, named: &str) -> anyhow::Result<Text> {
        match self {
            Self::Folder(folder) => Ok(read(&folder.join(named))?),
            Self::BuiltIn => table(named),
        }
    }
}

/// A case file with its measured table, whatever its simulator is.
pub(crate) struct CaseText {
    /// What the user asked for.
    pub(crate) asked: String,
    pub(crate) case: Text,
    pub(crate) measured: Text,
    /// The same of each other load.
    pub(crate) loads: Vec<Text>,
    /// What codes differ by, where the case names a table of it.
    pub(crate) codes: Option<Text>,
}

impl CaseText {
    /// All files, with their hashes.
    pub(crate) fn inputs(&self) -> Vec<InputFile> {
        let tables = [&self.case, &self.measured].into_iter().chain(&self.loads);
        tables.chain(&self.codes).map(Text::input).collect()
    }
}

/// Read a case by file or built-in name; without one, the embedded drum.
pub(crate) fn case_text(name: Option<&str>) -> anyhow::Result<CaseText> {
    let Some(name) = name else {
        return Ok(CaseText {
            asked: String::new(),
            case: fixture("demo/drum.toml")?,
            measured: fixture("demo/measured.csv")?,
            loads: Vec::new(),
            codes: None,
        });
    };
    let path = Path::new(name);
    let (case, place) = if path.is_file() || path.extension().is_some() {
        (read(path)?, Place::Folder(path.parent().map(Path::to_path_buf).unwrap_or_default()))
    } else if let Some(known) = built_in(name) {
        (fixture(&format!("thesis/cases/{}.toml", known.to_lowercase()))?, Place::BuiltIn)
    } else {
        let known = tumble_fixtures::CASES.join(", ");
        return Err(InputError::NoCase { name: name.to_owned(), known }.into());
    };
    let data = Case::parse(&case.name, &case.text)?.data;
    let measured = place.read(&data.responses)?;
    let loads = data.loads.iter().map(|l| place.read(&l.responses)).collect::<Result<_, _>>()?;
    let named = data.code_differences.filter(|name| name != NO_DIFFERENCES);
    let codes = named.map(|file| place.read(&file)).transpose()?;
    Ok(CaseText { asked: name.to_owned(), case, measured, loads, codes })
}

/// Load a case by file or built-in name.
pub(crate) fn load(name: &str, level: ErrataLevel) -> anyhow::Result<Loaded> {
    let path = Path::new(name);
    let (text, place) = if path.is_file() {
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        (read(path)?, Place::Folder(folder))
    } else if let Some(known) = built_in(name) {
        let text = fixture(&format!("thesis/cases/{}.toml", known.to_lowercase()))?;
        (text, Place::BuiltIn)
    } else if path.extension().is_some() {
        return Err(read(path)
            .err()
            .map_or_else(|| anyhow::anyhow!("{name} is not a file"), anyhow::Error::from));
    } else {
        let known = tumble_fixtures::CASES.join(", ");
        return Err(InputError::NoCase { name: name.to_owned(), known }.into());
    };
    let case = Case::parse(&text.name, &text.text)?;
    let measured_text = place.read(&case.data.responses)?;
    let columns = Study::columns(&case)?;
    let Simulator::Table(table) = &case.simulator else {
        return Err(calib::CalibError::NoTable { case: case.rig.name.clone() }.into());
    };
    let simulated_text = place.read(&table.file)?;
    let paths: Vec<String> = columns.iter().map(|(_, path)| path.clone()).collect();
    let columns: Vec<&str> = columns.iter().map(|(column, _)| column.as_str()).collect();
    let mut inputs = vec![text.input(), measured_text.input(), simulated_text.input()];
    let mut measured = MeasuredTable::parse(&measured_text.name, &measured_text.text)?;
    let mut simulated =
        SimulatedTable::parse(&simulated_text.name, &simulated_text.text, &columns)?;
    check_tables(&case, (&measured, &simulated), &paths)?;
    let mut applied = Vec::new();
    let built_in = matches!(place, Place::BuiltIn);
    if built_in {
        let list = fixture("thesis/errata.csv")?;
        let errata = Errata::parse(&list.name, &list.text)?;
        inputs.push(list.input());
        // Errata name tables by file alone.
        measured.file = file_name(&measured.file);
        simulated.file = file_name(&simulated.file);
        applied.extend(errata.apply_measured(&mut measured, level)?);
        applied.extend(errata.apply_simulated(&mut simulated, level)?);
    }
    Ok(Loaded { case, measured, simulated, errata: applied, inputs, built_in })
}

/// Whether a case and its tables go together: factors that their parameters can have, free parameters no farther than anything
/// was simulated, speeds that are kept aside among those that were measured.
fn check_tables(
    case: &Case,
    (measured, simulated): (&MeasuredTable, &SimulatedTable),
    paths: &[String],
) -> Result<(), InputError> {
    let speeds: Vec<f64> = measured.rows.iter().map(|r| r.omega_rpm).collect();
    if let Some(what) = case.holdout_fault(&speeds) {
        return Err(InputError::Case { file: measured.file.clone(), what });
    }
    let file = || simulated.file.clone();
    for (k, path) in paths.iter().enumerate() {
        let Some(parameter) = rig_schema::namespace::find(path) else { continue };
        let value = |row: &rig_schema::SimulatedRow| row.factors.get(k).copied();
        let wrong =
            |row: &&rig_schema::SimulatedRow| value(row).is_some_and(|v| !parameter.accepts(v));
        if let Some(row) = simulated.rows.iter().find(wrong) {
            let (low, high) = parameter.range;
            let what = format!(
                "line {}: `{path}` cannot be {}; expected {low} to {high} {}",
                row.line,
                value(row).unwrap_or(f64::NAN),
                parameter.unit
            );
            return Err(InputError::Case { file: file(), what });
        }
        let Some(free) = case.free.iter().find(|f| f.path == *path) else { continue };
        let all = || simulated.rows.iter().filter_map(value);
        let least = all().fold(f64::INFINITY, f64::min);
        let most = all().fold(f64::NEG_INFINITY, f64::max);
        let slack = BEYOND * (most - least);
        if free.range.0 < least - slack || free.range.1 > most + slack {
            let (low, high) = free.range;
            let what = format!(
                "`{path}` was simulated from {least} to {most}, and is to be searched from {low} to {high}; expected a range within what was simulated"
            );
            return Err(InputError::Case { file: file(), what });
        }
    }
    Ok(())
}

/// How far a free parameter may go beyond the runs of a table, as a part of their span.
const BEYOND: f64 = 0.05;

pub(crate) fn file_name(path: &str) -> String {
    Path::new(path)
        .file_name()
        .map_or_else(|| path.to_owned(), |n| n.to_string_lossy().into_owned())
}

/// Friction ranges that the author of a built-in case printed: (speed, low, high).
pub(crate) fn printed_ranges(case: &str) -> anyhow::Result<Vec<(f64, f64, f64)>> {
    let table = fixture("thesis/tables/mu_ranges_section5_1.csv")?;
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(table.text.as_bytes());
    let mut ranges = Vec::new();
    for record in reader.deserialize::<(String, f64, f64, f64, String)>() {
        let (config, omega, lo, hi, _) = record?;
        if config == case {
            ranges.push((omega, lo, hi));
        }
    }
    Ok(ranges)
}
