//! The summary of a fit: how well it explains, how well it predicts, whether to believe it.
//!
//! These are the four bars of a MODDE summary (R2, Q2, model validity, reproducibility) with
//! their guides, and the diagnostics of single runs behind them.

use crate::fit::Fit;

/// Slope of the model validity, chosen so that p = 0.05 gives 0.25: 0.75 / log10(20).
const VALIDITY_SLOPE: f64 = 0.576_47;

/// The figures that tell at a glance whether a fit is worth using.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Summary {
    /// Share of the variation that the model explains.
    pub r2: f64,
    /// The same, corrected for the number of terms.
    pub r2_adjusted: f64,
    /// Share of the variation that the model predicts; none if a run alone carries a term.
    pub q2: Option<f64>,
    /// Residual standard deviation.
    pub rmse: f64,
    /// Residual degrees of freedom.
    pub df: usize,
    /// Model validity; none without replicates that scatter.
    pub validity: Option<f64>,
    /// Reproducibility; none without replicates.
    pub reproducibility: Option<f64>,
    /// Condition number of the design matrix.
    pub condition_number: f64,
}

impl Summary {
    /// The usual guides that this fit misses, each as a sentence; empty for a sound fit.
    ///
    /// Q2 above 0.5, R2 less Q2 below 0.3, validity above 0.25, reproducibility above 0.5,
    /// condition number below 8.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        match self.q2 {
            None => warnings.push(
                "Q2 is undefined: at least one run has leverage 1 and alone carries a term".into(),
            ),
            Some(q2) => {
                if q2 <= 0.5 {
                    warnings
                        .push(format!("Q2 {q2:.3} is not above 0.5: the model predicts poorly"));
                }
                if self.r2 - q2 >= 0.3 {
                    warnings.push(format!(
                        "R2 {:.3} exceeds Q2 {q2:.3} by 0.3 or more: over-fitted, or outliers",
                        self.r2
                    ));
                }
            }
        }
        if let Some(v) = self.validity.filter(|v| *v <= 0.25) {
            warnings
                .push(format!("model validity {v:.3} is not above 0.25: lack of fit (p < 0.05)"));
        }
        if let Some(r) = self.reproducibility.filter(|r| *r <= 0.5) {
            warnings.push(format!("reproducibility {r:.3} is not above 0.5: replicates scatter"));
        }
        if self.condition_number >= 8.0 {
            warnings.push(format!(
                "condition number {:.1} is not below 8: the plan separates the terms poorly",
                self.condition_number
            ));
        }
        warnings
    }
}

impl Fit {
    /// Share of the variation explained: 1 - SS_residual / SS_total.
    ///
    /// Corrected for the mean if the model has an intercept, uncorrected if it has none.
    pub fn r2(&self) -> f64 {
        let anova = self.anova();
        if anova.residual.ss < 0.5 * anova.total.ss {
            1.0 - anova.residual.ss / anova.total.ss
        } else {
            anova.regression.ss / anova.total.ss
        }
    }

    /// R2 corrected for the number of terms: 1 - MS_residual / MS_total.
    pub fn r2_adjusted(&self) -> f64 {
        let total = self.anova().total;
        1.0 - self.residual_variance() / (total.ss / total.df as f64)
    }

    /// Prediction sum of squares: squared errors of predicting each run from the others.
    ///
    /// Each is weighted with the run's weight. None if a run alone carries a term.
    pub fn press(&self) -> Option<f64> {
        let d = &self.diagnostics;
        d.deleted.iter().zip(&d.weight).map(|(e, w)| e.map(|e| w * e * e)).sum()
    }

    /// Share of the variation predicted, 1 - PRESS / SS_total; none if a run alone carries a term.
    ///
    /// Zero for a model that predicts no better than the mean of all runs; may be negative.
    pub fn q2(&self) -> Option<f64> {
        self.press().map(|press| 1.0 - press / self.anova().total.ss)
    }

    /// Model validity, 1 + 0.57647 log10 p of the lack-of-fit test; below 0.25 means p < 0.05.
    ///
    /// None without replicates, or where they agree exactly.
    pub fn model_validity(&self) -> Option<f64> {
        let p = self.anova().lack_of_fit?.p?;
        Some(1.0 + VALIDITY_SLOPE * p.max(f64::MIN_POSITIVE).log10())
    }

    /// Reproducibility, 1 - MS_pure_error / MS_total; none without replicates.
    pub fn reproducibility(&self) -> Option<f64> {
        let pure = self.anova().lack_of_fit?.pure_error.mean_square()?;
        let total = self.anova().total;
        Some(1.0 - pure / (total.ss / total.df as f64))
    }

    /// The figures above, gathered.
    pub fn summary(&self) -> Summary {
        Summary {
            r2: self.r2(),
            r2_adjusted: self.r2_adjusted(),
            q2: self.q2(),
            rmse: self.rmse(),
            df: self.df(),
            validity: self.model_validity(),
            reproducibility: self.reproducibility(),
            condition_number: self.condition_number(),
        }
    }

    /// Leverage of each run: the share of its own prediction that it determines, 0 to 1.
    ///
    /// The diagonal of the hat matrix, summing to the number of terms, for ordinary and weighted
    /// fits. With a full covariance S, 1 - P_ii / (S^-1)_ii of the projector P that the deleted
    /// residuals use, which then need not sum to it.
    pub fn leverage(&self) -> &[f64] {
        &self.diagnostics.leverage
    }

    /// Each run less its prediction by the others, response units; none for a run of leverage 1.
    pub fn deleted_residuals(&self) -> &[Option<f64>] {
        &self.diagnostics.deleted
    }

    /// Residuals over their standard deviation, the residual variance from all runs.
    ///
    /// None for a run of leverage 1 and in an exact fit.
    pub fn studentised_residuals(&self) -> &[Option<f64>] {
        &self.diagnostics.internal
    }

    /// Residuals over their standard deviation, the residual variance from the *other* runs.
    ///
    /// They follow Student's t with one degree of freedom less than the residual; beyond +-4 is
    /// the usual limit of an outlier. None for a run of leverage 1, with a single residual degree
    /// of freedom, and in an exact fit.
    pub fn studentised_deleted_residuals(&self) -> &[Option<f64>] {
        &self.diagnostics.external
    }

    /// Cook's distance of each run: how far the coefficients move without it.
    ///
    /// None for a run of leverage 1 and in an exact fit.
    pub fn cooks_distance(&self) -> &[Option<f64>] {
        &self.diagnostics.cook
    }
}
