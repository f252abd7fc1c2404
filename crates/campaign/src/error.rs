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
}
