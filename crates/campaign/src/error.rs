//! Everything that can go wrong between parameters and responses.

/// Error of a run.
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
