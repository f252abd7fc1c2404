//! Everything that can go wrong between parameters and responses.

/// Error of a run or a campaign.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// The rig could not be read.
    #[error(transparent)]
    Schema(#[from] rig_schema::SchemaError),
    /// The simulation failed.
    #[error(transparent)]
    Rig(#[from] drum_rig::Error),
    /// The film failed.
    #[error("filming")]
    Film(#[from] drum_film::Error),
    /// A picture could not be handed from the film to the reader.
    #[error("a frame of {width} x {height} pixels could not be taken over")]
    Picture {
        /// Width, pixels.
        width: u32,
        /// Height, pixels.
        height: u32,
    },
    /// Measuring failed.
    #[error("measuring")]
    Vision(#[from] drum_vision::VisionError),
    /// A parameter that neither camera nor reader knows.
    #[error("parameter `{path}` = {value} is not taken by {by}")]
    Parameter {
        /// Path.
        path: &'static str,
        /// Value.
        value: f64,
        /// Who refuses it.
        by: &'static str,
    },
    /// The design of a plan cannot be made.
    #[error("the design cannot be made: {0}")]
    Design(#[from] doe::DoeError),
    /// A run of a plan cannot be carried out.
    #[error("run {index} of the plan ({values}) cannot be carried out")]
    Row {
        /// Number of the run.
        index: u64,
        /// Values of its factors.
        values: String,
        /// Why.
        source: Box<CampaignError>,
    },
    /// A factor has a value that its parameter does not take.
    #[error("`{path}` = {value}: expected {expected}")]
    Level {
        /// Path of the factor.
        path: String,
        /// Its value.
        value: f64,
        /// What would be accepted.
        expected: String,
    },
    /// Reading or writing failed.
    #[error("{doing} {path} failed")]
    Io {
        /// What was being done.
        doing: &'static str,
        /// File or folder.
        path: String,
        /// Words of the operating system.
        source: std::io::Error,
    },
    /// A file of the campaign is not as it was written.
    #[error("{path} is not as it was written: {problem}; expected the file as written ({remedy})")]
    Altered {
        /// The file.
        path: String,
        /// What is wrong with it.
        problem: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The folder holds the campaign of another plan.
    #[error(
        "{path} is of another plan: {difference}; expected the plan that was frozen there, or another folder"
    )]
    OtherPlan {
        /// Path of the manifest.
        path: String,
        /// First difference.
        difference: String,
    },
    /// A folder without a manifest.
    #[error("{path} holds no campaign; expected a folder with a manifest.json")]
    NoManifest {
        /// The folder.
        path: String,
    },
    /// Another process is at work.
    #[error("{what} is being run by {holder}; expected one process at a time")]
    Locked {
        /// What is locked.
        what: String,
        /// Who holds it.
        holder: String,
    },
    /// A number of no run.
    #[error("no run {index}: the plan has runs 0 to {last}")]
    NoSuchRun {
        /// Number asked for.
        index: u64,
        /// Highest number.
        last: u64,
    },
    /// A value of an option that no campaign can be run with.
    #[error("option {name} = {value}: expected {expected}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Value that was given.
        value: f64,
        /// What would have been accepted.
        expected: &'static str,
    },
    /// A fault of the program in one run.
    #[error("a fault of the program: {detail}")]
    Fault {
        /// Its own words.
        detail: String,
    },
    /// The rig has something that another code's deck cannot express.
    #[error("{code} cannot run this rig: {what}; expected {expected}")]
    NotExported {
        /// The other code.
        code: &'static str,
        /// What cannot be expressed.
        what: String,
        /// What can.
        expected: &'static str,
    },
    /// A dump of another code cannot be read.
    #[error("{file}, line {line}: {problem}; expected {expected}")]
    Dump {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
        /// What was expected.
        expected: &'static str,
    },
    /// A kept file cannot be used.
    #[error("{file} {what}")]
    Kept {
        /// The file.
        file: String,
        /// What is wrong with it.
        what: &'static str,
    },
    /// A file could not be written.
    #[error("cannot write {path}")]
    Unwritable {
        /// The file or folder.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file could not be read.
    #[error("cannot read {path}")]
    Unreadable {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// A result could not be put into words.
    #[error("cannot write {what} as JSON")]
    Json {
        /// What it was.
        what: &'static str,
        /// What went wrong.
        source: serde_json::Error,
    },
    /// Too few frames of a speed could be measured.
    #[error(
        "at {speed_rpm} rpm only {measured} frames could be measured, expected two or more; first reason: {}",
        reason.as_deref().unwrap_or("none was rejected")
    )]
    Unseen {
        /// The speed.
        speed_rpm: f64,
        /// Frames that were measured.
        measured: usize,
        /// Why the first of the others was not.
        reason: Option<String>,
    },
    /// A stop was asked for.
    #[error("stopped before it was done")]
    Stopped,
    /// An equal rig of the same list failed.
    #[error("the equal rig number {index} of the list failed")]
    Twin {
        /// Place of the equal rig.
        index: usize,
    },
}
