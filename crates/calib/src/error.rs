//! Everything that can be wrong with a calibration.

use crate::OperatingPoint;

/// Error of a calibration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CalibError {
    /// No observation is left to match.
    #[error(
        "no observation to match: every speed lies outside {low} to {high} rpm, or none has a response"
    )]
    NoObservations {
        /// Lowest speed that the simulator covers, rpm.
        low: f64,
        /// Highest speed that the simulator covers, rpm.
        high: f64,
    },
    /// A standard deviation is missing and cannot be replaced.
    #[error("{response} has no standard deviation at any speed; expected at least one")]
    NoScatter {
        /// Column of the response.
        response: &'static str,
    },
    /// A value that must be a positive number is not.
    #[error("{what} is {value}; expected a finite number above 0")]
    NotPositive {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A covariance is not positive definite.
    #[error(
        "the covariance of {what} is not positive definite (size {size}); a correlation is too strong or a variance is 0"
    )]
    Covariance {
        /// Of what.
        what: &'static str,
        /// Number of rows.
        size: usize,
    },
    /// A free parameter's range is empty.
    #[error("the range {low} to {high} of `{name}` is empty; expected low below high")]
    Range {
        /// Parameter.
        name: String,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// More free parameters than the grid can hold.
    #[error("{count} free parameters; the grid search takes 1 to {most}")]
    TooManyFree {
        /// How many were asked for.
        count: usize,
        /// How many are possible.
        most: usize,
    },
    /// The simulator and the problem disagree on the parameters.
    #[error("the simulator takes {expected} parameters, {given} were given")]
    Parameters {
        /// What the simulator takes.
        expected: usize,
        /// What was given.
        given: usize,
    },
    /// The simulator returned a number that is not finite.
    #[error("the simulator gave no finite response at {at}, parameters {theta:?}")]
    NotFinite {
        /// Where.
        at: OperatingPoint,
        /// Parameters.
        theta: Vec<f64>,
    },
    /// Too few runs in the table of a surrogate.
    #[error("{runs} runs for {terms} terms of the surrogate; expected at least {needed}")]
    TooFewRuns {
        /// Runs with all four responses.
        runs: usize,
        /// Terms.
        terms: usize,
        /// Least number of runs.
        needed: usize,
    },
    /// The regression failed.
    #[error("the surrogate of {response} cannot be fitted")]
    Regression {
        /// Column of the response.
        response: &'static str,
        /// Why.
        source: doe::DoeError,
    },
    /// A parameter that is not one of the simulator's.
    #[error("`{name}` is not a parameter of the simulator; it has {known}")]
    Unknown {
        /// Parameter asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// A nuisance whose effect on the responses needs a simulation.
    #[error(
        "the effect of nuisance `{name}` on a given table is not known; expected one of {known}"
    )]
    Nuisance {
        /// Path.
        name: String,
        /// Paths that can be marginalised without a simulation.
        known: String,
    },
    /// A case whose simulator is not a table.
    #[error("case `{case}` has no table of simulated responses; expected [simulator.table]")]
    NoTable {
        /// Name of the case.
        case: String,
    },
    /// A value that neither the case nor the namespace gives.
    #[error(
        "`{name}` is neither free nor set in case `{case}`; expected it in [free] or with a value"
    )]
    Unset {
        /// Path.
        name: String,
        /// Name of the case.
        case: String,
    },
    /// The design of a surrogate cannot be used.
    #[error("the runs of the surrogate cannot be used")]
    Design(#[from] doe::DoeError),
    /// Cases to be fitted together share nothing.
    #[error("no parameter is shared by all cases; expected one label `shared` that every case has")]
    NothingShared,
    /// Two lists that belong together have different lengths.
    #[error("{given} {what}; expected {expected}")]
    Lengths {
        /// Of what.
        what: &'static str,
        /// Expected length.
        expected: usize,
        /// Given length.
        given: usize,
    },
    /// Too few observations to judge a model.
    #[error(
        "no verdict can be reached: {observations} observations for {parameters} parameters of `{model}`; expected more observations than parameters (more speeds or more responses)"
    )]
    TooFewObservations {
        /// Model or candidate.
        model: String,
        /// Observations.
        observations: usize,
        /// Fitted parameters.
        parameters: usize,
    },
    /// A load of which a model knows nothing.
    #[error(
        "the model knows nothing of the load that was measured at {at}; expected simulations of it"
    )]
    Load {
        /// Where.
        at: OperatingPoint,
    },
    /// Knots of a model that are out of order.
    #[error(
        "{at} is no knot that can follow; expected ascending speeds, load after load, counted from 0"
    )]
    Knot {
        /// The knot.
        at: OperatingPoint,
    },
    /// A speed at which a model cannot predict.
    #[error("`{model}` covers {low} to {high} rpm; there is an observation at {omega_rpm} rpm")]
    SpeedRange {
        /// Model or candidate.
        model: String,
        /// Speed of an observation, rpm.
        omega_rpm: f64,
        /// Lowest speed that the model covers, rpm.
        low: f64,
        /// Highest speed that the model covers, rpm.
        high: f64,
    },
    /// A candidate effect that cannot be used.
    #[error("candidate `{name}`: {fault}")]
    Candidate {
        /// Path.
        name: String,
        /// What is wrong, with what was expected.
        fault: String,
    },
    /// A setting of the attribution that cannot be used.
    #[error("setting `{name}` is {value}; expected {expected}")]
    Setting {
        /// Which.
        name: &'static str,
        /// Value given.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
}
