//! Response surfaces over a table of runs, as a simulator.
//!
//! Four regressions on the same runs and terms. Their error has two parts: the uncertainty of the
//! coefficients, `x_a' (X'X)^-1 x_b`, and the misfit of the surface, which the residual variance
//! estimates. The misfit at neighbouring speeds is not independent; it is taken to be correlated
//! by `exp(-(a - b)^2 / (2 l^2))` with `l` a quarter of the range of speeds, half the spacing of
//! three levels. Between responses both parts follow the correlation of the residuals.

use doe::{Factor, Fit, Model, ModelTerms, Weighting, fit};
use rig_schema::{Response, SimulatedTable};

use crate::{CalibError, OperatingPoint, Predicted, Simulator};

/// Terms of the surfaces.
#[derive(Debug, Clone, PartialEq)]
pub enum Basis {
    /// Full quadratic in speed and parameters.
    Quadratic,
    /// `exp(-x/m0)` instead of the square of one parameter.
    Saturating {
        /// Path of the parameter.
        parameter: String,
        /// Value over which the response saturates, in the parameter's unit.
        m0: f64,
    },
}

/// Four response surfaces over speed and parameters.
#[derive(Debug, Clone)]
pub struct Surrogate {
    parameters: Vec<String>,
    speed_range: (f64, f64),
    fits: Vec<Fit>,
    correlation: [[f64; 4]; 4],
    misfit_length: f64,
    /// Values of parameters that predictions do not take, in the order of `parameters`.
    held: Vec<Option<f64>>,
}

impl Surrogate {
    /// Fit the surfaces to a table; `columns` gives the table's column of each parameter, in the
    /// order that predictions take.
    ///
    /// # Errors
    /// [`CalibError::TooFewRuns`], [`CalibError::Regression`], [`CalibError::Design`].
    pub fn from_table(
        table: &SimulatedTable,
        columns: &[(&str, &str)],
        basis: &Basis,
    ) -> Result<Self, CalibError> {
        let place = |column: &str| table.factors.iter().position(|f| f == column);
        let at: Vec<usize> = columns.iter().filter_map(|(column, _)| place(column)).collect();
        if at.len() != columns.len() {
            return Err(CalibError::Parameters { expected: columns.len(), given: at.len() });
        }
        let mut points = Vec::new();
        let mut values: [Vec<f64>; 4] = Default::default();
        for row in &table.rows {
            let Some(cells) = row.cells.iter().copied().collect::<Option<Vec<_>>>() else {
                continue;
            };
            let mut x = vec![row.omega_rpm];
            x.extend(at.iter().map(|i| row.factors[*i]));
            points.push(x);
            for (v, cell) in values.iter_mut().zip(cells) {
                v.push(cell.mean);
            }
        }
        let paths: Vec<&str> = columns.iter().map(|(_, path)| *path).collect();
        Self::from_points(&paths, &points, &values, basis)
    }

    /// Fit the surfaces to points `(omega_rpm, parameters...)` and the four responses there.
    ///
    /// # Errors
    /// As [`Surrogate::from_table`].
    pub fn from_points(
        parameters: &[&str],
        points: &[Vec<f64>],
        values: &[Vec<f64>; 4],
        basis: &Basis,
    ) -> Result<Self, CalibError> {
        let names: Vec<&str> =
            std::iter::once("omega_rpm").chain(parameters.iter().copied()).collect();
        let mut factors = Vec::new();
        for (k, name) in names.iter().enumerate() {
            let column = points.iter().map(|x| x[k]);
            let (low, high) = column.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
            factors.push(Factor::new(*name, low, high)?);
        }
        let terms = match basis {
            Basis::Quadratic => ModelTerms::quadratic(&factors),
            Basis::Saturating { parameter, m0 } => {
                ModelTerms::saturating(&factors, parameter, *m0)?
            }
        };
        let needed = terms.len() + 2;
        if points.len() < needed {
            return Err(CalibError::TooFewRuns { runs: points.len(), terms: terms.len(), needed });
        }
        let speed_range = (factors[0].low, factors[0].high);
        let model = Model::new(&factors, &terms)?;
        let mut fits = Vec::with_capacity(4);
        for r in Response::ALL {
            let fitted = fit(&model, points, &values[r.index()], Weighting::Ordinary)
                .map_err(|source| CalibError::Regression { response: r.column(), source })?;
            fits.push(fitted);
        }
        let correlation = residual_correlation(&fits);
        Ok(Self {
            parameters: parameters.iter().map(|p| (*p).to_owned()).collect(),
            speed_range,
            fits,
            correlation,
            misfit_length: (speed_range.1 - speed_range.0) / 4.0,
            held: vec![None; parameters.len()],
        })
    }

    /// The same with one parameter held at a value: predictions take it no more.
    ///
    /// # Errors
    /// [`CalibError::Unknown`] if the surfaces do not depend on it.
    pub fn hold(mut self, parameter: &str, value: f64) -> Result<Self, CalibError> {
        let at = self.parameters.iter().position(|p| p == parameter);
        let at = at.ok_or_else(|| CalibError::Unknown {
            name: parameter.to_owned(),
            known: self.parameters.join(", "),
        })?;
        self.held[at] = Some(value);
        Ok(self)
    }

    /// Point of the regression: speed, then all parameters with the held ones filled in.
    fn point(&self, omega_rpm: f64, theta: &[f64]) -> Vec<f64> {
        let mut free = theta.iter();
        let values =
            self.held.iter().map(|h| h.or_else(|| free.next().copied()).unwrap_or(f64::NAN));
        std::iter::once(omega_rpm).chain(values).collect()
    }

    /// Terms of the regression at each speed; a table is of one load.
    fn rows(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Vec<Vec<f64>>, CalibError> {
        let expected = self.held.iter().filter(|h| h.is_none()).count();
        if theta.len() != expected {
            return Err(CalibError::Parameters { expected, given: theta.len() });
        }
        if let Some(other) = at.iter().find(|p| p.load > 0) {
            return Err(CalibError::Load { at: *other });
        }
        let model = self.fits[0].model();
        Ok(at.iter().map(|p| model.row(&self.point(p.omega_rpm, theta))).collect())
    }

    fn means(
        &self,
        rows: &[Vec<f64>],
        theta: &[f64],
        at: &[OperatingPoint],
    ) -> Result<Vec<f64>, CalibError> {
        let mut mean = Vec::with_capacity(4 * rows.len());
        for (row, at) in rows.iter().zip(at) {
            for fitted in &self.fits {
                let value: f64 = row.iter().zip(fitted.coefficients()).map(|(a, b)| a * b).sum();
                if !value.is_finite() {
                    return Err(CalibError::NotFinite { at: *at, theta: theta.to_vec() });
                }
                mean.push(value);
            }
        }
        Ok(mean)
    }

    /// The regression of one response.
    pub fn fit(&self, response: Response) -> &Fit {
        &self.fits[response.index()]
    }

    /// Correlation of the residuals between responses.
    pub fn residual_correlation(&self) -> &[[f64; 4]; 4] {
        &self.correlation
    }

    /// Expected value of one response, without its error.
    pub fn mean(&self, response: Response, omega_rpm: f64, theta: &[f64]) -> f64 {
        self.fit(response).mean(&self.point(omega_rpm, theta))
    }
}

fn residual_correlation(fits: &[Fit]) -> [[f64; 4]; 4] {
    let dot = |i: usize, j: usize| -> f64 {
        fits[i].residuals().iter().zip(fits[j].residuals()).map(|(a, b)| a * b).sum()
    };
    let mut correlation = [[0.0; 4]; 4];
    for (i, row) in correlation.iter_mut().enumerate() {
        for (j, c) in row.iter_mut().enumerate() {
            let scale = (dot(i, i) * dot(j, j)).sqrt();
            *c = if i == j || scale == 0.0 {
                f64::from(u8::from(i == j))
            } else {
                dot(i, j) / scale
            };
        }
    }
    correlation
}

impl Simulator for Surrogate {
    fn parameters(&self) -> Vec<String> {
        let free = self.parameters.iter().zip(&self.held).filter(|(_, held)| held.is_none());
        free.map(|(p, _)| p.clone()).collect()
    }

    fn speed_range_rpm(&self) -> (f64, f64) {
        self.speed_range
    }

    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        let rows = self.rows(theta, at)?;
        let mean = self.means(&rows, theta, at)?;
        let first = &self.fits[0];
        let scale: Vec<f64> = self.fits.iter().map(Fit::rmse).collect();
        let p = first.coefficients().len();
        let spread: Vec<Vec<f64>> = rows
            .iter()
            .map(|row| {
                (0..p)
                    .map(|i| (0..p).map(|j| first.unscaled_covariance(i, j) * row[j]).sum())
                    .collect()
            })
            .collect();
        let n = mean.len();
        let mut covariance = vec![0.0; n * n];
        for (a, row) in rows.iter().enumerate() {
            for b in 0..=a {
                let leverage: f64 = row.iter().zip(&spread[b]).map(|(x, y)| x * y).sum();
                let distance = (at[a].omega_rpm - at[b].omega_rpm) / self.misfit_length;
                let common = leverage + (-0.5 * distance * distance).exp();
                for r in 0..4 {
                    for s in 0..4 {
                        let value = common * self.correlation[r][s] * scale[r] * scale[s];
                        covariance[(4 * a + r) * n + 4 * b + s] = value;
                        covariance[(4 * b + s) * n + 4 * a + r] = value;
                    }
                }
            }
        }
        Ok(Predicted { mean, covariance })
    }

    fn expected(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Vec<f64>, CalibError> {
        self.means(&self.rows(theta, at)?, theta, at)
    }
}
