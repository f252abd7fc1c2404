//! Models: an ordered list of terms over an ordered list of factors.

use crate::double_double::Double;
use crate::error::DoeError;
use crate::factor::{Factor, check_factors};
use crate::term::Term;

/// A linear model: which columns a design matrix has, and how a point becomes a row of it.
///
/// A point lists the factors' *natural* values, in the order of [`Model::factors`].
///
/// ```
/// use doe::{Factor, Model, Term};
/// let factors = [Factor::new("omega_rpm", 4.0, 30.0)?, Factor::new("mu_pp", 0.1, 0.9)?];
/// let terms = [Term::intercept(), Term::linear("omega_rpm"), Term::power("mu_pp", 2)];
/// let model = Model::new(&factors, &terms)?;
/// assert_eq!(model.row(&[30.0, 0.9]), [1.0, 1.0, 1.0]);
/// # Ok::<(), doe::DoeError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "ModelSpec", into = "ModelSpec"))]
pub struct Model {
    factors: Vec<Factor>,
    terms: Vec<Term>,
    columns: Vec<Column>,
}

/// A term with its factors' positions looked up.
#[derive(Debug, Clone, PartialEq)]
struct Column {
    powers: Vec<(usize, u32)>,
    saturations: Vec<(usize, f64)>,
}

impl Model {
    /// A model of these terms over these factors.
    ///
    /// # Errors
    /// An invalid or repeated factor, no factor or term, a term that names a factor that is
    /// not there or has no usable scale, or a term given twice.
    pub fn new(factors: &[Factor], terms: &[Term]) -> Result<Self, DoeError> {
        check_factors(factors)?;
        if terms.is_empty() {
            return Err(DoeError::Empty { what: "terms" });
        }
        let mut columns = Vec::with_capacity(terms.len());
        for (i, term) in terms.iter().enumerate() {
            if terms[..i].iter().any(|other| other.is_same(term)) {
                return Err(DoeError::DuplicateTerm { term: term.to_string() });
            }
            columns.push(Column::new(term, factors)?);
        }
        Ok(Self { factors: factors.to_vec(), terms: terms.to_vec(), columns })
    }

    /// The factors, in the order of a point's values.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// The terms, in the order of a row's values.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Printed names of the terms.
    pub fn term_names(&self) -> Vec<String> {
        self.terms.iter().map(ToString::to_string).collect()
    }

    /// Position of a term, however its factors are ordered.
    pub fn position(&self, term: &Term) -> Option<usize> {
        self.terms.iter().position(|t| t.is_same(term))
    }

    /// Positions of every term that involves a factor: main effect, powers, interactions and
    /// exponentials. With [`crate::Fit::f_test`] this tests whether the factor has any influence.
    pub fn positions_involving(&self, factor: &str) -> Vec<usize> {
        (0..self.terms.len()).filter(|&i| self.terms[i].involves(factor)).collect()
    }

    /// Position of the constant term, if the model has one.
    pub fn intercept(&self) -> Option<usize> {
        self.terms.iter().position(Term::is_intercept)
    }

    /// The model without one term.
    ///
    /// # Errors
    /// [`DoeError::TermIndex`] if there is no such term, [`DoeError::Empty`] if it is the last.
    pub fn without(&self, index: usize) -> Result<Self, DoeError> {
        if index >= self.terms.len() {
            return Err(DoeError::TermIndex { index, terms: self.terms.len() });
        }
        let mut terms = self.terms.clone();
        terms.remove(index);
        Self::new(&self.factors, &terms)
    }

    /// Row of the design matrix at a point of natural factor values.
    ///
    /// # Panics
    /// If the point has fewer values than the model has factors; [`Model::check_point`] tests.
    pub fn row(&self, x: &[f64]) -> Vec<f64> {
        let mut row = vec![0.0; self.terms.len()];
        self.row_into(x, &mut row);
        row
    }

    /// Writes the row of the design matrix at a point into a buffer, without allocating.
    ///
    /// # Panics
    /// If the point has fewer values than there are factors or the buffer fewer than terms.
    pub fn row_into(&self, x: &[f64], row: &mut [f64]) {
        for (value, column) in row[..self.columns.len()].iter_mut().zip(&self.columns) {
            *value = column.value(&self.factors, x);
        }
    }

    /// Row of the design matrix in twice the precision; exponentials carry one rounding.
    pub(crate) fn precise_row(&self, x: &[f64]) -> Vec<Double> {
        self.columns.iter().map(|column| column.precise_value(&self.factors, x)).collect()
    }

    /// Derivative of the row with respect to one factor, per natural unit of it.
    ///
    /// # Panics
    /// If the point has fewer values than there are factors, or there is no such factor.
    pub fn row_derivative(&self, x: &[f64], factor: usize) -> Vec<f64> {
        assert!(factor < self.factors.len(), "factor {factor} of {}", self.factors.len());
        self.columns.iter().map(|column| column.derivative(&self.factors, x, factor)).collect()
    }

    /// Tests that a point has one finite value for each factor.
    ///
    /// # Errors
    /// [`DoeError::Length`] or [`DoeError::NotFinite`].
    pub fn check_point(&self, x: &[f64]) -> Result<(), DoeError> {
        if x.len() != self.factors.len() {
            return Err(DoeError::Length {
                what: "factor values of a point".to_string(),
                expected: self.factors.len(),
                got: x.len(),
            });
        }
        match x.iter().position(|v| !v.is_finite()) {
            Some(j) => Err(DoeError::NotFinite {
                what: format!("factor `{}`", self.factors[j].name),
                value: x[j],
            }),
            None => Ok(()),
        }
    }
}

impl Column {
    fn new(term: &Term, factors: &[Factor]) -> Result<Self, DoeError> {
        let find = |name: &str| {
            factors.iter().position(|f| f.name == name).ok_or_else(|| DoeError::UnknownFactor {
                term: term.to_string(),
                factor: name.to_string(),
                known: factors.iter().map(|f| f.name.clone()).collect(),
            })
        };
        let mut powers = Vec::new();
        for power in &term.powers {
            powers.push((find(&power.factor)?, power.exponent));
        }
        let mut saturations = Vec::new();
        for s in &term.saturations {
            if !s.scale.is_finite() || s.scale == 0.0 {
                return Err(DoeError::SaturationScale { term: term.to_string(), scale: s.scale });
            }
            saturations.push((find(&s.factor)?, s.scale));
        }
        Ok(Self { powers, saturations })
    }

    fn value(&self, factors: &[Factor], x: &[f64]) -> f64 {
        let monomial = self
            .powers
            .iter()
            .fold(1.0, |product, &(j, k)| product * whole_power(factors[j].code(x[j]), k));
        self.saturations.iter().fold(monomial, |product, &(j, m0)| product * (-x[j] / m0).exp())
    }

    fn precise_value(&self, factors: &[Factor], x: &[f64]) -> Double {
        let mut product = Double::from(1.0);
        for &(j, k) in &self.powers {
            let factor = &factors[j];
            let coded = Double::difference(x[j], factor.centre()) / factor.half_range();
            product = (0..k).fold(product, |product, _| product * coded);
        }
        self.saturations.iter().fold(product, |product, &(j, m0)| product * (-x[j] / m0).exp())
    }

    fn derivative(&self, factors: &[Factor], x: &[f64], wanted: usize) -> f64 {
        // Product rule over the factors of the term: d(c^k)/dx = k c^(k-1) / half range.
        let mut sum = 0.0;
        for (i, &(j, k)) in self.powers.iter().enumerate() {
            if j != wanted || k == 0 {
                continue;
            }
            let slope = f64::from(k) * whole_power(factors[j].code(x[j]), k - 1);
            let mut rest = self.clone();
            rest.powers.remove(i);
            sum += slope / factors[j].half_range() * rest.value(factors, x);
        }
        let rate: f64 =
            self.saturations.iter().filter(|(j, _)| *j == wanted).map(|(_, m0)| -1.0 / m0).sum();
        if rate == 0.0 { sum } else { sum + rate * self.value(factors, x) }
    }
}

/// Power by repeated multiplication: the same bits on every platform, unlike `powi`.
fn whole_power(base: f64, exponent: u32) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * base)
}

/// What a stored model holds: it is rebuilt, and so tested, on reading.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct ModelSpec {
    factors: Vec<Factor>,
    terms: Vec<Term>,
}

#[cfg(feature = "serde")]
impl TryFrom<ModelSpec> for Model {
    type Error = DoeError;
    fn try_from(spec: ModelSpec) -> Result<Self, DoeError> {
        Self::new(&spec.factors, &spec.terms)
    }
}

#[cfg(feature = "serde")]
impl From<Model> for ModelSpec {
    fn from(model: Model) -> Self {
        Self { factors: model.factors, terms: model.terms }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_factors() -> Vec<Factor> {
        vec![Factor::new("a", 1.0, 3.0).unwrap(), Factor::new("b", 0.1, 0.9).unwrap()]
    }

    #[test]
    fn derivatives_agree_with_central_differences() {
        let a = Term::linear("a");
        let terms = [
            Term::intercept(),
            Term::power("a", 3),
            Term::interaction("a", "b"),
            Term::saturating("b", 0.2),
            a.times(&Term::linear("b")).times(&Term::saturating("b", 0.3)),
        ];
        let model = Model::new(&two_factors(), &terms).unwrap();
        let (x, h) = ([2.3, 0.4], 1.0e-5);
        for j in 0..2 {
            let (mut above, mut below) = (x, x);
            above[j] += h;
            below[j] -= h;
            let (up, down) = (model.row(&above), model.row(&below));
            for (k, slope) in model.row_derivative(&x, j).into_iter().enumerate() {
                // Truncation h^2 f'''/6 with f''' up to 125 (the exponential of scale 0.2).
                assert!((slope - (up[k] - down[k]) / (2.0 * h)).abs() < 1.0e-8);
            }
        }
    }

    #[test]
    fn a_term_over_an_absent_factor_is_refused_with_the_known_names() {
        let error = Model::new(&two_factors(), &[Term::linear("c")]).unwrap_err();
        assert_eq!(error.to_string(), "term `c` names factor `c`, expected one of: a, b");
    }

    #[test]
    fn a_term_in_two_spellings_is_one_term() {
        let terms = [Term::interaction("a", "b"), Term::interaction("b", "a")];
        assert!(matches!(Model::new(&two_factors(), &terms), Err(DoeError::DuplicateTerm { .. })));
    }
}
