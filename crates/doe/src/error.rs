//! What can be wrong with a factor, a model, a design or the data.

use thiserror::Error;

/// One column of a design matrix that others already span.
#[derive(Debug, Clone, PartialEq)]
pub struct Alias {
    /// The term that brings nothing new.
    pub term: String,
    /// The terms whose combination it is on these runs, with their factors; empty when the
    /// column is zero on every run.
    pub combination: Vec<(String, f64)>,
}

impl std::fmt::Display for Alias {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} =", self.term)?;
        if self.combination.is_empty() {
            return write!(f, " 0 on every run");
        }
        for (i, (name, factor)) in self.combination.iter().enumerate() {
            let sign = match (i, *factor < 0.0) {
                (0, false) => "",
                (0, true) => "-",
                (_, false) => "+ ",
                (_, true) => "- ",
            };
            write!(f, " {sign}{:.4} {name}", factor.abs())?;
        }
        Ok(())
    }
}

/// Everything that this crate refuses, with the values that made it refuse.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum DoeError {
    /// A factor's range is not an interval.
    #[error("factor `{name}`: low {low} must be finite and below high {high}")]
    FactorRange {
        /// Name of the factor.
        name: String,
        /// Its lower end as given.
        low: f64,
        /// Its upper end as given.
        high: f64,
    },
    /// A factor's name is empty or holds a character that term names use.
    #[error("factor name `{name}` must not be empty nor hold any of `*`, `^`, `(`, `)`, `/`")]
    FactorName {
        /// The name as given.
        name: String,
    },
    /// Two factors share a name.
    #[error("factor `{name}` is given twice")]
    DuplicateFactor {
        /// The shared name.
        name: String,
    },
    /// A term names a factor that the model does not have.
    #[error("term `{term}` names factor `{factor}`, expected one of: {}", known.join(", "))]
    UnknownFactor {
        /// The term's printed name.
        term: String,
        /// The factor that is not there.
        factor: String,
        /// The factors that are there.
        known: Vec<String>,
    },
    /// Two terms of a model are the same.
    #[error("term `{term}` is given twice")]
    DuplicateTerm {
        /// The term's printed name.
        term: String,
    },
    /// The scale of a saturating term is not a positive length.
    #[error("term `{term}`: the scale of exp(-x/m0) must be finite and not zero, got {scale}")]
    SaturationScale {
        /// The term's printed name.
        term: String,
        /// The scale as given.
        scale: f64,
    },
    /// A model without terms, or a design without factors or runs.
    #[error("no {what} given")]
    Empty {
        /// What is missing: `terms`, `factors`, `runs`.
        what: &'static str,
    },
    /// Two inputs that belong together differ in length.
    #[error("{what}: expected {expected} values, got {got}")]
    Length {
        /// Which input.
        what: String,
        /// How many values belong there.
        expected: usize,
        /// How many came.
        got: usize,
    },
    /// A value that must be a number is infinite or not a number.
    #[error("{what} is {value}, expected a finite number")]
    NotFinite {
        /// Which value.
        what: String,
        /// What it is.
        value: f64,
    },
    /// Not enough runs to estimate the terms and a residual variance.
    #[error("{runs} runs cannot determine {terms} terms and a residual variance: at least {} runs are needed", terms + 1)]
    TooFewRuns {
        /// Runs given.
        runs: usize,
        /// Terms asked for.
        terms: usize,
    },
    /// Terms that the design cannot tell apart.
    #[error("the design cannot tell these terms apart: {}", aliases.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Aliased {
        /// Each term that is a combination of terms before it.
        aliases: Vec<Alias>,
    },
    /// The response does not vary, so there is nothing to explain.
    #[error("the response is {value} on every run: nothing to fit")]
    ConstantResponse {
        /// The common value.
        value: f64,
    },
    /// A weight is not a positive number.
    #[error("weight of run {run} is {weight}, expected a positive finite number")]
    Weight {
        /// Index of the run, from 0.
        run: usize,
        /// Its weight as given.
        weight: f64,
    },
    /// A covariance matrix that is not symmetric.
    #[error("covariance of runs {row} and {column} is {upper} one way and {lower} the other")]
    AsymmetricCovariance {
        /// Row index, from 0.
        row: usize,
        /// Column index, from 0.
        column: usize,
        /// Entry (row, column).
        upper: f64,
        /// Entry (column, row).
        lower: f64,
    },
    /// A covariance matrix that no random vector can have, or a singular one.
    #[error("the covariance of the {runs} runs is not positive definite")]
    NotPositiveDefinite {
        /// Order of the matrix.
        runs: usize,
    },
    /// A probability or confidence level outside the open interval from 0 to 1.
    #[error("{what} is {value}, expected a number between 0 and 1, both excluded")]
    Probability {
        /// Which input.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// An index that points past the terms of the model.
    #[error("term index {index} is past the model's {terms} terms")]
    TermIndex {
        /// The index as given.
        index: usize,
        /// Number of terms.
        terms: usize,
    },
    /// A term that an operation needs is not in the model.
    #[error("term `{term}` is not in the model")]
    MissingTerm {
        /// The term's printed name.
        term: String,
    },
    /// A term that an operation cannot handle.
    #[error("term `{term}` stands in the way: {reason}")]
    UnsuitableTerm {
        /// The term's printed name.
        term: String,
        /// Why the operation cannot take it.
        reason: &'static str,
    },
    /// A transform that the response's values do not allow.
    #[error("response {value} of run {run} has no {transform}: {needs}")]
    TransformDomain {
        /// Index of the run, from 0.
        run: usize,
        /// The response there.
        value: f64,
        /// Name of the transform.
        transform: &'static str,
        /// What the values must satisfy.
        needs: &'static str,
    },
    /// A design that cannot be built from these numbers.
    #[error("{design}: {what} is {got}, expected {expected}")]
    Design {
        /// Which design.
        design: &'static str,
        /// Which of its numbers.
        what: &'static str,
        /// The number as given.
        got: usize,
        /// What is allowed.
        expected: &'static str,
    },
    /// A matrix iteration of the linear algebra library did not converge.
    #[error("the {what} did not converge")]
    NoConvergence {
        /// Which decomposition.
        what: &'static str,
    },
}
