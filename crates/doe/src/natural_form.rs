//! A fit rewritten in natural units.
//!
//! Coded columns are nearly orthogonal, natural powers are not: fit coded, print natural. Each
//! coded power is expanded by the binomial theorem,
//! `((x - c)/h)^k = sum_i binom(k, i) x^i (-c)^(k-i) / h^k`, and the covariance follows the same
//! linear map, so that the standard errors keep their digits.

use crate::error::DoeError;
use crate::factor::Factor;
use crate::fit::Fit;
use crate::least_squares::{dot, norm};
use crate::model::Model;
use crate::term::Term;

/// Coefficients of natural powers of the factors.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NaturalForm {
    /// The terms, over factors whose coding is the identity.
    pub model: Model,
    /// One coefficient a term.
    pub coefficients: Vec<f64>,
    /// Their standard errors.
    pub standard_errors: Vec<f64>,
}

impl NaturalForm {
    /// Expected response at a point of natural factor values.
    ///
    /// # Panics
    /// If the point has fewer values than there are factors.
    pub fn mean(&self, x: &[f64]) -> f64 {
        dot(&self.model.row(x), &self.coefficients)
    }
}

impl std::fmt::Display for NaturalForm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, (term, b)) in self.model.terms().iter().zip(&self.coefficients).enumerate() {
            let sign = match (i, *b < 0.0) {
                (0, false) => "",
                (0, true) => "-",
                (_, false) => " + ",
                (_, true) => " - ",
            };
            write!(f, "{sign}{:.6e}", b.abs())?;
            if !term.is_intercept() {
                write!(f, " {term}")?;
            }
        }
        Ok(())
    }
}

impl Fit {
    /// The fitted polynomial in natural units, saturating factors kept as they are.
    ///
    /// A term may appear that the coded model lacks: a square without its main effect has one in
    /// natural units.
    ///
    /// # Errors
    /// None that a fit's own model could cause; the signature is that of [`Model::new`].
    pub fn natural_form(&self) -> Result<NaturalForm, DoeError> {
        let mut terms: Vec<Term> = Vec::new();
        let mut map: Vec<Vec<f64>> = Vec::new();
        let width = self.model().terms().len();
        for (j, term) in self.model().terms().iter().enumerate() {
            for (natural, share) in expand(term, self.model().factors()) {
                let i = terms.iter().position(|t| t.is_same(&natural)).unwrap_or_else(|| {
                    terms.push(natural);
                    map.push(vec![0.0; width]);
                    terms.len() - 1
                });
                map[i][j] += share;
            }
        }
        let factors = self.model().factors();
        let uncoded: Result<Vec<Factor>, _> =
            factors.iter().map(|f| Factor::uncoded(&f.name)).collect();
        let s = self.rmse();
        let standard_error = |row: &Vec<f64>| {
            let mut along = vec![0.0; width];
            for (share, inverse) in row.iter().zip(self.r_inverse()) {
                along.iter_mut().zip(inverse).for_each(|(a, r)| *a += share * r);
            }
            s * norm(&along)
        };
        Ok(NaturalForm {
            model: Model::new(&uncoded?, &terms)?,
            coefficients: map.iter().map(|row| dot(row, self.coefficients())).collect(),
            standard_errors: map.iter().map(standard_error).collect(),
        })
    }
}

/// The natural terms of a coded one, with their coefficients; zero ones are left out.
fn expand(term: &Term, factors: &[Factor]) -> Vec<(Term, f64)> {
    let start = Term { powers: vec![], saturations: term.saturations.clone() };
    let mut sum = vec![(start, 1.0)];
    for power in &term.powers {
        let Some(factor) = factors.iter().find(|f| f.name == power.factor) else { continue };
        let (c, h) = (factor.centre(), factor.half_range());
        let mut next = Vec::new();
        let mut binomial = 1.0;
        for i in (0..=power.exponent).rev() {
            let share = binomial * (-c / h).powi((power.exponent - i) as i32) / h.powi(i as i32);
            if share != 0.0 {
                let x = Term::power(&power.factor, i);
                next.extend(sum.iter().map(|(t, b)| (t.times(&x), b * share)));
            }
            binomial *= f64::from(i) / f64::from(power.exponent - i + 1);
        }
        sum = next;
    }
    sum
}
