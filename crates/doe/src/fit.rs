//! Least squares of a response on a model, and what follows from the coefficients.

use crate::anova::{Anova, FTest, SumOfSquares};
use crate::distribution::{f_upper, t_quantile_two_sided, t_two_sided};
use crate::double_double::Double;
use crate::error::DoeError;
use crate::lack_of_fit::split_by_replicates;
use crate::least_squares::{Factored, condition_number, dot, norm};
use crate::model::Model;
use crate::prediction::{Prediction, check_probability};
use crate::refinement::{Solution, solve_refined};
use crate::run_diagnostics::RunDiagnostics;
use crate::weighting::{Weighting, Whitener, check_length};

/// A model fitted to runs.
///
/// In a weighted or generalised fit, sums of squares are of whitened residuals, and the
/// variances that the weights or the covariance state are scaled by [`Fit::residual_variance`].
#[derive(Debug, Clone)]
pub struct Fit {
    pub(crate) model: Model,
    pub(crate) points: Vec<Vec<f64>>,
    pub(crate) y: Vec<f64>,
    pub(crate) whitener: Whitener,
    /// Columns of the whitened design matrix.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Whitened column of ones, if the model has an intercept.
    pub(crate) ones: Option<Vec<f64>>,
    coefficients: Vec<f64>,
    r_inverse: Vec<Vec<f64>>,
    residuals: Vec<f64>,
    anova: Anova,
    condition_number: f64,
    pub(crate) diagnostics: RunDiagnostics,
}

/// One line of a table of coefficients.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CoefficientRow {
    /// Printed name of the term.
    pub term: String,
    /// Estimated coefficient.
    pub estimate: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Estimate over standard error; infinite in an exact fit.
    pub t: f64,
    /// Probability of so large a |t| where the coefficient is zero.
    pub p: f64,
    /// Lower end of the t interval.
    pub low: f64,
    /// Upper end of the t interval.
    pub high: f64,
}

/// Fits a model by least squares: ordinary, weighted or generalised.
///
/// `points` holds one row a run, the natural values of the model's factors in their order; `y`
/// the response of each run. Solved by QR with a rank test, never by normal equations.
///
/// ```
/// use doe::{Factor, Model, ModelTerms, Weighting, fit};
/// // Stopping distance of a car, m, by speed, m/s: v^2 / (2 mu g) with mu = 0.7 gives 0.0728 v^2.
/// let v = Factor::uncoded("v")?;
/// let model = Model::new(&[v.clone()], &ModelTerms::quadratic(&[v]))?;
/// let points = [[5.0], [10.0], [15.0], [20.0], [25.0]];
/// let y: Vec<f64> = points.iter().map(|p| p[0] * p[0] / (2.0 * 0.7 * 9.81)).collect();
/// let fitted = fit(&model, &points, &y, Weighting::Ordinary)?;
/// assert!((fitted.coefficients()[2] - 0.0728).abs() < 1e-4);
/// # Ok::<(), doe::DoeError>(())
/// ```
///
/// # Errors
/// Lengths that do not match, values that are not finite, fewer runs than terms plus one,
/// [`DoeError::Aliased`] terms, weights that are not positive, a covariance that is not
/// symmetric and positive definite, a response that does not vary.
pub fn fit<P: AsRef<[f64]>>(
    model: &Model,
    points: &[P],
    y: &[f64],
    weighting: Weighting<'_>,
) -> Result<Fit, DoeError> {
    let points: Vec<Vec<f64>> = points.iter().map(|p| p.as_ref().to_vec()).collect();
    check_data(model, &points, y)?;
    let whitener = Whitener::new(weighting, y.len())?;
    let names = model.term_names();
    let mut precise = design_columns(model, &points)?;
    let condition_number = condition_number(&leading(&precise))?;
    precise.iter_mut().for_each(|column| whitener.whiten_precisely(column));
    let columns = leading(&precise);
    let factored = Factored::new(&columns, &names)?;

    let mut precise_y: Vec<Double> = y.iter().map(|&y| Double::from(y)).collect();
    whitener.whiten_precisely(&mut precise_y);
    let whitened_y: Vec<f64> = precise_y.iter().map(|y| y.hi).collect();
    let ones = model.intercept().map(|i| columns[i].clone());
    let centred = centre(&whitened_y, ones.as_deref());
    if norm(&centred) <= 16.0 * f64::EPSILON * norm(&whitened_y) {
        return Err(DoeError::ConstantResponse { value: y[0] });
    }
    let Solution { coefficients, residuals: whitened_residuals } =
        solve_refined(&factored, &precise, &precise_y);
    let mut residuals = whitened_residuals.clone();
    whitener.unwhiten(&mut residuals);

    let anova = {
        let explained: Vec<f64> =
            centred.iter().zip(&whitened_residuals).map(|(y, e)| y - e).collect();
        let means = usize::from(ones.is_some());
        let (n, p) = (y.len(), columns.len());
        let regression = SumOfSquares { ss: dot(&explained, &explained), df: p - means };
        let residual =
            SumOfSquares { ss: dot(&whitened_residuals, &whitened_residuals), df: n - p };
        let total = SumOfSquares { ss: dot(&centred, &centred), df: n - means };
        let f = regression.mean_square().map(|ms| ms / (residual.ss / residual.df as f64));
        let p = f.map(|f| f_upper(f, regression.df as f64, residual.df as f64));
        let lack_of_fit = split_by_replicates(model, &points, y, &whitener, residual)?;
        Anova { regression, residual, total, f, p, lack_of_fit }
    };
    let diagnostics =
        RunDiagnostics::new(&factored, &whitener, &whitened_residuals, &residuals, anova.residual);
    Ok(Fit {
        model: model.clone(),
        points,
        y: y.to_vec(),
        whitener,
        r_inverse: factored.r_inverse(),
        columns,
        ones,
        coefficients,
        residuals,
        anova,
        condition_number,
        diagnostics,
    })
}

fn check_data(model: &Model, points: &[Vec<f64>], y: &[f64]) -> Result<(), DoeError> {
    if y.is_empty() {
        return Err(DoeError::Empty { what: "runs" });
    }
    check_length("points of the runs", y.len(), points.len())?;
    for (run, point) in points.iter().enumerate() {
        model.check_point(point).map_err(|error| match error {
            DoeError::Length { what, expected, got } => {
                DoeError::Length { what: format!("{what} (run {run})"), expected, got }
            }
            DoeError::NotFinite { what, value } => {
                DoeError::NotFinite { what: format!("{what} of run {run}"), value }
            }
            other => other,
        })?;
    }
    if let Some(run) = y.iter().position(|v| !v.is_finite()) {
        return Err(DoeError::NotFinite { what: format!("response of run {run}"), value: y[run] });
    }
    if y.len() <= model.terms().len() {
        return Err(DoeError::TooFewRuns { runs: y.len(), terms: model.terms().len() });
    }
    Ok(())
}

fn design_columns(model: &Model, points: &[Vec<f64>]) -> Result<Vec<Vec<Double>>, DoeError> {
    let mut columns = vec![Vec::with_capacity(points.len()); model.terms().len()];
    for (run, point) in points.iter().enumerate() {
        let row = model.precise_row(point);
        for ((column, value), term) in columns.iter_mut().zip(row).zip(model.terms()) {
            if !value.hi.is_finite() || !value.lo.is_finite() {
                let what = format!("term `{term}` of run {run}");
                return Err(DoeError::NotFinite { what, value: value.hi });
            }
            column.push(value);
        }
    }
    Ok(columns)
}

/// The columns rounded to working precision.
fn leading(columns: &[Vec<Double>]) -> Vec<Vec<f64>> {
    columns.iter().map(|column| column.iter().map(|v| v.hi).collect()).collect()
}

/// A whitened response less its weighted mean, if the model has an intercept.
pub(crate) fn centre(whitened: &[f64], ones: Option<&[f64]>) -> Vec<f64> {
    let mut centred = whitened.to_vec();
    if let Some(u) = ones {
        // Twice: the second pass removes what rounding of a large mean leaves.
        for _ in 0..2 {
            let mean = dot(u, &centred) / dot(u, u);
            centred.iter_mut().zip(u).for_each(|(y, u)| *y -= mean * u);
        }
    }
    centred
}

impl Fit {
    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The points of the runs, natural units, as they were given.
    pub fn points(&self) -> &[Vec<f64>] {
        &self.points
    }

    /// The response of the runs, as it was given.
    pub fn response(&self) -> &[f64] {
        &self.y
    }

    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.y.len()
    }

    /// Coefficients, one a term.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Covariance of two coefficients.
    ///
    /// # Panics
    /// If an index is past the terms.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        self.residual_variance() * self.unscaled_covariance(i, j)
    }

    /// Covariance of two coefficients for a residual variance of one: an element of (X'WX)^-1.
    ///
    /// With weights or a covariance of *known* size this is the covariance itself.
    ///
    /// # Panics
    /// If an index is past the terms.
    pub fn unscaled_covariance(&self, i: usize, j: usize) -> f64 {
        dot(&self.r_inverse[i], &self.r_inverse[j])
    }

    /// Covariance of all coefficients, p x p, row-major.
    pub fn covariance_matrix(&self) -> Vec<f64> {
        let p = self.coefficients.len();
        (0..p * p).map(|k| self.covariance(k / p, k % p)).collect()
    }

    /// Standard errors of the coefficients.
    pub fn standard_errors(&self) -> Vec<f64> {
        let s = self.rmse();
        self.r_inverse.iter().map(|row| s * norm(row)).collect()
    }

    /// Rows of T with T T' = (X'WX)^-1.
    pub(crate) fn r_inverse(&self) -> &[Vec<f64>] {
        &self.r_inverse
    }

    /// t ratios of the coefficients; infinite in an exact fit, zero where a coefficient is.
    pub fn t_values(&self) -> Vec<f64> {
        let ratio = |(b, se): (&f64, f64)| if *b == 0.0 { 0.0 } else { b / se };
        self.coefficients.iter().zip(self.standard_errors()).map(ratio).collect()
    }

    /// Two-sided probabilities of the t ratios.
    pub fn p_values(&self) -> Vec<f64> {
        let df = self.df() as f64;
        self.t_values().into_iter().map(|t| t_two_sided(t, df)).collect()
    }

    /// Interval of one coefficient by Student's t, `level` as 0.95.
    ///
    /// # Errors
    /// [`DoeError::TermIndex`], or [`DoeError::Probability`] unless `0 < level < 1`.
    pub fn interval(&self, index: usize, level: f64) -> Result<(f64, f64), DoeError> {
        self.check_index(index)?;
        check_probability("level", level)?;
        let half = t_quantile_two_sided(level, self.df() as f64)
            * self.rmse()
            * norm(&self.r_inverse[index]);
        Ok((self.coefficients[index] - half, self.coefficients[index] + half))
    }

    /// The table of coefficients with t intervals.
    ///
    /// # Errors
    /// [`DoeError::Probability`] unless `0 < level < 1`.
    pub fn coefficient_table(&self, level: f64) -> Result<Vec<CoefficientRow>, DoeError> {
        let (errors, t, p) = (self.standard_errors(), self.t_values(), self.p_values());
        (0..self.coefficients.len())
            .map(|i| {
                let (low, high) = self.interval(i, level)?;
                Ok(CoefficientRow {
                    term: self.model.terms()[i].to_string(),
                    estimate: self.coefficients[i],
                    standard_error: errors[i],
                    t: t[i],
                    p: p[i],
                    low,
                    high,
                })
            })
            .collect()
    }

    /// Residual degrees of freedom: runs less terms.
    pub fn df(&self) -> usize {
        self.anova.residual.df
    }

    /// Residual variance: residual sum of squares over its degrees of freedom.
    pub fn residual_variance(&self) -> f64 {
        self.anova.residual.ss / self.anova.residual.df as f64
    }

    /// Residual standard deviation, with the degrees of freedom in the denominator.
    pub fn rmse(&self) -> f64 {
        self.residual_variance().sqrt()
    }

    /// Measured less fitted response, one a run.
    pub fn residuals(&self) -> &[f64] {
        &self.residuals
    }

    /// Fitted response, one a run.
    pub fn fitted(&self) -> Vec<f64> {
        self.y.iter().zip(&self.residuals).map(|(y, e)| y - e).collect()
    }

    /// The analysis of variance.
    pub fn anova(&self) -> &Anova {
        &self.anova
    }

    /// Ratio of the largest to the smallest singular value of the (unweighted) design matrix.
    ///
    /// Meant for coded factors: below about 8 for a sound response-surface plan.
    pub fn condition_number(&self) -> f64 {
        self.condition_number
    }

    /// Expected response at a point of natural factor values, with its variances.
    ///
    /// # Errors
    /// [`DoeError::Length`] or [`DoeError::NotFinite`].
    pub fn predict(&self, x: &[f64]) -> Result<Prediction, DoeError> {
        self.model.check_point(x)?;
        let row = self.model.row(x);
        let mean = dot(&row, &self.coefficients);
        let mut along = vec![0.0; row.len()];
        for (value, inverse) in row.iter().zip(&self.r_inverse) {
            along.iter_mut().zip(inverse).for_each(|(a, r)| *a += value * r);
        }
        let variance = self.residual_variance();
        let var_mean = variance * dot(&along, &along);
        Ok(Prediction { mean, var_mean, var_new: var_mean + variance, df: self.df() })
    }

    /// Expected response at a point, without tests or variances: for loops over many points.
    ///
    /// # Panics
    /// If the point has fewer values than the model has factors.
    pub fn mean(&self, x: &[f64]) -> f64 {
        dot(&self.model.row(x), &self.coefficients)
    }

    /// Slope of the expected response, per natural unit of each factor.
    ///
    /// # Errors
    /// [`DoeError::Length`] or [`DoeError::NotFinite`].
    pub fn gradient(&self, x: &[f64]) -> Result<Vec<f64>, DoeError> {
        self.model.check_point(x)?;
        let slope = |j| dot(&self.model.row_derivative(x, j), &self.coefficients);
        Ok((0..self.model.factors().len()).map(slope).collect())
    }

    /// Tests that the coefficients of a set of terms are all zero.
    ///
    /// The terms are moved to the end of the QR, where the squares of their coordinates are
    /// what they explain beyond the others: no difference of two sums is taken.
    ///
    /// # Errors
    /// [`DoeError::Empty`] without terms, [`DoeError::TermIndex`] past the terms.
    pub fn f_test(&self, terms: &[usize]) -> Result<FTest, DoeError> {
        for &index in terms {
            self.check_index(index)?;
        }
        let (tested, others): (Vec<usize>, Vec<usize>) =
            (0..self.columns.len()).partition(|i| terms.contains(i));
        if tested.is_empty() {
            return Err(DoeError::Empty { what: "terms" });
        }
        let order: Vec<usize> = others.iter().chain(&tested).copied().collect();
        let columns: Vec<Vec<f64>> = order.iter().map(|&i| self.columns[i].clone()).collect();
        let names = self.model.term_names();
        let names: Vec<String> = order.iter().map(|&i| names[i].clone()).collect();
        let factored = Factored::new(&columns, &names)?;
        let mut y = self.y.clone();
        self.whitener.whiten(&mut y);
        // The mean is in the span of the untested terms, unless the intercept is tested.
        if self.model.intercept().is_some_and(|i| !tested.contains(&i)) {
            y = centre(&y, self.ones.as_deref());
        }
        let (coordinates, _) = factored.project(&y);
        let gained = coordinates[others.len()..].iter().map(|z| z * z).sum::<f64>();
        let (df1, df2) = (tested.len(), self.df());
        let f = gained / df1 as f64 / self.residual_variance();
        Ok(FTest { f, df1, df2, p: f_upper(f, df1 as f64, df2 as f64) })
    }

    fn check_index(&self, index: usize) -> Result<(), DoeError> {
        let terms = self.coefficients.len();
        if index < terms { Ok(()) } else { Err(DoeError::TermIndex { index, terms }) }
    }
}
