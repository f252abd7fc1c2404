//! The usual sets of terms, named.

use crate::error::DoeError;
use crate::factor::Factor;
use crate::term::Term;

/// Builds the usual sets of terms over a list of factors.
///
/// ```
/// use doe::{Factor, ModelTerms};
/// let f = [Factor::new("speed", 4.0, 30.0)?, Factor::new("friction", 0.1, 0.9)?];
/// let names: Vec<String> = ModelTerms::quadratic(&f).iter().map(ToString::to_string).collect();
/// assert_eq!(names, ["1", "speed", "friction", "speed*friction", "speed^2", "friction^2"]);
/// # Ok::<(), doe::DoeError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct ModelTerms;

impl ModelTerms {
    /// The intercept and each factor: 1 + k terms.
    pub fn linear(factors: &[Factor]) -> Vec<Term> {
        let mut terms = vec![Term::intercept()];
        terms.extend(factors.iter().map(|f| Term::linear(&f.name)));
        terms
    }

    /// Linear terms and every product of two factors: 1 + k + k(k-1)/2 terms.
    pub fn interaction(factors: &[Factor]) -> Vec<Term> {
        let mut terms = Self::linear(factors);
        for (i, a) in factors.iter().enumerate() {
            terms.extend(factors[i + 1..].iter().map(|b| Term::interaction(&a.name, &b.name)));
        }
        terms
    }

    /// Interaction terms and every square: (k+1)(k+2)/2 terms, the full second order.
    pub fn quadratic(factors: &[Factor]) -> Vec<Term> {
        let mut terms = Self::interaction(factors);
        terms.extend(factors.iter().map(|f| Term::power(&f.name, 2)));
        terms
    }

    /// Every monomial up to total degree 3: (k+1)(k+2)(k+3)/6 terms.
    ///
    /// A pure cube needs four levels of its factor; on three levels the fit refuses it as an
    /// alias of the linear term.
    pub fn cubic(factors: &[Factor]) -> Vec<Term> {
        let mut terms = Self::quadratic(factors);
        for i in 0..factors.len() {
            for j in i..factors.len() {
                for k in j..factors.len() {
                    let [a, b, c] = [i, j, k].map(|n| Term::linear(&factors[n].name));
                    terms.push(a.times(&b).times(&c));
                }
            }
        }
        terms
    }

    /// The quadratic terms with the square of one factor replaced by `exp(-x/m0)`.
    ///
    /// In that factor the basis is 1, x, exp(-x/m0); it keeps its interactions with the other
    /// factors, which keep their squares. As many terms as the quadratic model, so that the two
    /// compare on equal footing.
    ///
    /// # Errors
    /// [`DoeError::UnknownFactor`] if the saturating factor is not in the list,
    /// [`DoeError::SaturationScale`] if `m0` is zero or not finite.
    pub fn saturating(factors: &[Factor], factor: &str, m0: f64) -> Result<Vec<Term>, DoeError> {
        let saturating = Term::saturating(factor, m0);
        if !factors.iter().any(|f| f.name == factor) {
            return Err(DoeError::UnknownFactor {
                term: saturating.to_string(),
                factor: factor.to_string(),
                known: factors.iter().map(|f| f.name.clone()).collect(),
            });
        }
        if !m0.is_finite() || m0 == 0.0 {
            return Err(DoeError::SaturationScale { term: saturating.to_string(), scale: m0 });
        }
        let square = Term::power(factor, 2);
        let terms = Self::quadratic(factors).into_iter();
        Ok(terms.map(|t| if t.is_same(&square) { saturating.clone() } else { t }).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_of_terms_follow_the_binomial_coefficients() {
        for k in 1..=6usize {
            let f: Vec<Factor> =
                (0..k).map(|i| Factor::uncoded(format!("x{i}")).unwrap()).collect();
            assert_eq!(ModelTerms::linear(&f).len(), k + 1);
            assert_eq!(ModelTerms::interaction(&f).len(), 1 + k + k * (k - 1) / 2);
            assert_eq!(ModelTerms::quadratic(&f).len(), (k + 1) * (k + 2) / 2);
            assert_eq!(ModelTerms::cubic(&f).len(), (k + 1) * (k + 2) * (k + 3) / 6);
            let saturating = ModelTerms::saturating(&f, "x0", 0.2).unwrap();
            assert_eq!(saturating.len(), (k + 1) * (k + 2) / 2);
            assert!(saturating.iter().any(|t| t.to_string() == "exp(-x0/0.2)"));
            assert!(!saturating.iter().any(|t| t.to_string() == "x0^2"));
        }
    }
}
