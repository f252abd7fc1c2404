//! Everything that can go wrong while a loop is closed.

/// Error of closing a loop.
#[derive(Debug, thiserror::Error)]
pub enum CloseLoopError {
    /// The case does not ask for our own simulation.
    #[error(
        "the case `{case}` has no [simulator] rig = {{}}: expected one, since effects are simulated"
    )]
    NoRig {
        /// Name of the case.
        case: String,
    },
    /// Tables of loads that do not fit the case.
    #[error(
        "the case tells of {expected} loads beside the rig's own, {given} tables are given; expected one for each"
    )]
    Loads {
        /// Loads in the case.
        expected: usize,
        /// Tables.
        given: usize,
    },
    /// A strength outside the range of its parameter.
    #[error("`{path}` cannot be {value}: it lies outside the parameter's range")]
    Strength {
        /// Path.
        path: String,
        /// Value.
        value: f64,
    },
    /// Effects that are asked for, none of which can be tried.
    #[error(
        "`catalogue.only` names {named}, which cannot be tried ({why}): expected an effect of the catalogue that is not free"
    )]
    NothingToTry {
        /// Names.
        named: String,
        /// Why the first is left out.
        why: String,
    },
    /// A range that an effect cannot have.
    #[error("`{path}` cannot be looked for from {low} to {high}: {why}")]
    Range {
        /// Path.
        path: String,
        /// Lowest strength.
        low: f64,
        /// Highest strength.
        high: f64,
        /// What is wrong with it.
        why: String,
    },
    /// A free parameter that does not act.
    #[error("`{path}` is free but does not change the motion: expected a parameter of physics")]
    NotPhysics {
        /// Path.
        path: String,
    },
    /// An uncertain known that cannot be carried.
    #[error(
        "`{path}` is marginalised but cannot be: expected one of the measuring parameters or a parameter of physics or camera"
    )]
    Nuisance {
        /// Path.
        path: String,
    },
    /// Runs of the base design failed.
    #[error("{failed} of {asked} runs of the base design failed; the first: {first}")]
    Base {
        /// Runs that failed.
        failed: usize,
        /// Runs that were asked for.
        asked: usize,
        /// What the first of them said.
        first: String,
    },
    /// More speeds are fitted than there is budget for.
    #[error(
        "a budget of {runs} runs is too small: at least {least} are needed for {free} free parameters and {effects} effects"
    )]
    Budget {
        /// Runs allowed.
        runs: usize,
        /// Runs needed.
        least: usize,
        /// Free parameters.
        free: usize,
        /// Effects that are simulated.
        effects: usize,
    },
    /// A stop was asked for.
    #[error("stopped; what was simulated is kept, the same command goes on from there")]
    Stopped,
    /// Statistics failed.
    #[error(transparent)]
    Calib(#[from] calib::CalibError),
    /// A run failed.
    #[error(transparent)]
    Campaign(#[from] campaign::CampaignError),
    /// The stand-in could not be made.
    #[error(transparent)]
    Rig(#[from] campaign::drum_rig::Error),
}
