//! What each run does to the fit: leverage, deleted residuals, Cook's distance, PRESS.
//!
//! With P = S^-1 - S^-1 X (X' S^-1 X)^-1 X' S^-1, the error of predicting run i from all the
//! others (their correlation with it included) is d_i = (P y)_i / P_ii and has variance
//! sigma^2 / P_ii (Dubrule 1983, doi 10.1007/BF01032955). For independent runs of weight w,
//! P_ii = w_i (1 - h_ii) and d_i = e_i / (1 - h_ii) with the hat matrix's diagonal h_ii. Nothing
//! is refitted.

use crate::anova::SumOfSquares;
use crate::least_squares::{Factored, dot};
use crate::weighting::Whitener;

/// Least 1 - h of a run whose prediction by the others means anything: below it, the run alone
/// determines a coefficient.
const LEVERAGE_MARGIN: f64 = 1.0e-10;

/// Quantities of each run, in the order of the runs.
#[derive(Debug, Clone)]
pub(crate) struct RunDiagnostics {
    /// 1 - P_ii / (S^-1)_ii: the diagonal of the hat matrix for independent runs.
    pub(crate) leverage: Vec<f64>,
    /// Run less its prediction by the others, response units.
    pub(crate) deleted: Vec<Option<f64>>,
    /// (S^-1)_ii, the weight of an independent run.
    pub(crate) weight: Vec<f64>,
    pub(crate) internal: Vec<Option<f64>>,
    pub(crate) external: Vec<Option<f64>>,
    pub(crate) cook: Vec<Option<f64>>,
}

impl RunDiagnostics {
    pub(crate) fn new(
        factored: &Factored,
        whitener: &Whitener,
        whitened_residuals: &[f64],
        residuals: &[f64],
        residual: SumOfSquares,
    ) -> Self {
        let n = residuals.len();
        let mut this = Self {
            leverage: Vec::with_capacity(n),
            deleted: Vec::with_capacity(n),
            weight: Vec::with_capacity(n),
            internal: Vec::with_capacity(n),
            external: Vec::with_capacity(n),
            cook: Vec::with_capacity(n),
        };
        let mut p_y = whitened_residuals.to_vec();
        whitener.whiten_transposed(&mut p_y);
        let terms = factored.q.len() as f64;
        let variance = residual.ss / residual.df as f64;
        for run in 0..n {
            let (leverage, weight) = match whitener {
                Whitener::Identity => (hat(factored, run), 1.0),
                Whitener::RootWeights(root) => (hat(factored, run), root[run] * root[run]),
                Whitener::Lower(_) => {
                    let mut unit = vec![0.0; n];
                    unit[run] = 1.0;
                    whitener.whiten(&mut unit);
                    let weight = dot(&unit, &unit);
                    let spanned: f64 = factored.q.iter().map(|q| dot(q, &unit).powi(2)).sum();
                    (spanned / weight, weight)
                }
            };
            let rest = 1.0 - leverage;
            let precision = weight * rest;
            let deleted = (rest > LEVERAGE_MARGIN).then(|| p_y[run] / precision);
            // d_i^2 P_ii is the run's own share of the residual sum of squares.
            let share = deleted.map(|d| d * d * precision);
            this.leverage.push(leverage);
            this.weight.push(weight);
            this.deleted.push(deleted);
            this.internal.push(match deleted {
                Some(d) if variance > 0.0 => Some(d * (precision / variance).sqrt()),
                _ => None,
            });
            this.external.push(match (deleted, share) {
                (Some(d), Some(share)) if residual.df > 1 && share < residual.ss => {
                    let without = (residual.ss - share) / (residual.df - 1) as f64;
                    Some(d * (precision / without).sqrt())
                }
                _ => None,
            });
            this.cook.push(match share {
                Some(share) if variance > 0.0 => Some(share / variance * leverage / rest / terms),
                _ => None,
            });
        }
        this
    }
}

fn hat(factored: &Factored, run: usize) -> f64 {
    factored.q.iter().map(|q| q[run] * q[run]).sum()
}
