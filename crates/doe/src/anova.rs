//! Where the variation of a response goes: regression, lack of fit, pure error.

/// A sum of squares with its degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SumOfSquares {
    /// Sum of squares, in squared units of the response (whitened, if weighted).
    pub ss: f64,
    /// Degrees of freedom.
    pub df: usize,
}

impl SumOfSquares {
    /// Sum of squares over its degrees of freedom; none without any.
    pub fn mean_square(&self) -> Option<f64> {
        (self.df > 0).then(|| self.ss / self.df as f64)
    }
}

/// The residual of a fit split into what replicates scatter and what the model misses.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LackOfFit {
    /// Variation of the replicates' means about the model.
    pub lack_of_fit: SumOfSquares,
    /// Variation of replicates about their means.
    pub pure_error: SumOfSquares,
    /// Ratio of the two mean squares. None if the replicates agree exactly (a deterministic
    /// simulator without a change of seed) or if every distinct point has its own term.
    pub f: Option<f64>,
    /// Probability of so large a ratio where the model is right; none where `f` is.
    pub p: Option<f64>,
}

/// The analysis of variance of a fit.
///
/// The total is corrected for the mean if the model has an intercept, and the plain sum of
/// squares if it has none.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Anova {
    /// What the terms besides the intercept explain.
    pub regression: SumOfSquares,
    /// What they leave.
    pub residual: SumOfSquares,
    /// Regression and residual together.
    pub total: SumOfSquares,
    /// Ratio of the mean squares of regression and residual: infinite for an exact fit, none
    /// for a model of the intercept alone.
    pub f: Option<f64>,
    /// Probability of so large a ratio where no term has an influence.
    pub p: Option<f64>,
    /// The residual split by replicates; none where no two runs share a point.
    pub lack_of_fit: Option<LackOfFit>,
}

/// Test that a set of terms has no influence.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FTest {
    /// Mean square that the terms explain beyond the others, over the residual mean square.
    pub f: f64,
    /// Number of terms tested.
    pub df1: usize,
    /// Residual degrees of freedom.
    pub df2: usize,
    /// Probability of so large a ratio where the terms have no influence.
    pub p: f64,
}
