//! Terms of a response surface: products of powers of coded factors, with or without a
//! saturating factor.
//!
//! ```text
//! term(x) = prod_j c_j(x_j)^{k_j}  *  prod_i exp(-x_i / m_i)
//! ```
//!
//! `c_j` is the coded value of factor j, `x_i` the *natural* value of factor i and `m_i` a
//! scale in the unit of that factor. The saturating factor describes a response that levels
//! off, as an angle of repose does with growing friction; a square would turn back down.

use std::fmt;

/// A factor raised to a whole power, in coded units.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Power {
    /// Name of the factor.
    pub factor: String,
    /// Exponent, at least 1.
    pub exponent: u32,
}

/// The factor `exp(-x/scale)` of a term, `x` in natural units.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Saturation {
    /// Name of the factor.
    pub factor: String,
    /// Scale m0, in the factor's natural unit.
    pub scale: f64,
}

/// One column of a design matrix, written over named factors.
///
/// ```
/// use doe::Term;
/// assert_eq!(Term::linear("mu_pp").times(&Term::linear("omega_rpm")).to_string(), "mu_pp*omega_rpm");
/// assert_eq!(Term::power("mu_pp", 2).to_string(), "mu_pp^2");
/// assert_eq!(Term::saturating("mu_pp", 0.2).to_string(), "exp(-mu_pp/0.2)");
/// assert_eq!(Term::intercept().to_string(), "1");
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Term {
    /// The powers of the monomial, each factor at most once.
    pub powers: Vec<Power>,
    /// The saturating factors; usually none or one.
    #[cfg_attr(feature = "serde", serde(default))]
    pub saturations: Vec<Saturation>,
}

impl Term {
    /// The constant term.
    pub fn intercept() -> Self {
        Self::default()
    }

    /// A factor by itself.
    pub fn linear(factor: impl Into<String>) -> Self {
        Self::power(factor, 1)
    }

    /// A power of one factor; exponent 0 gives the intercept.
    pub fn power(factor: impl Into<String>, exponent: u32) -> Self {
        let factor = factor.into();
        let powers = if exponent == 0 { vec![] } else { vec![Power { factor, exponent }] };
        Self { powers, saturations: vec![] }
    }

    /// A product of two factors, each to the first power.
    pub fn interaction(a: impl Into<String>, b: impl Into<String>) -> Self {
        Self::linear(a).times(&Self::linear(b))
    }

    /// A product of powers of factors.
    pub fn monomial<S: AsRef<str>>(powers: &[(S, u32)]) -> Self {
        powers.iter().fold(Self::intercept(), |term, (factor, exponent)| {
            term.times(&Self::power(factor.as_ref(), *exponent))
        })
    }

    /// `exp(-x/scale)` of a factor in natural units.
    pub fn saturating(factor: impl Into<String>, scale: f64) -> Self {
        Self { powers: vec![], saturations: vec![Saturation { factor: factor.into(), scale }] }
    }

    /// The product of two terms: exponents of the same factor add up.
    pub fn times(&self, other: &Self) -> Self {
        let mut product = self.clone();
        for power in &other.powers {
            match product.powers.iter_mut().find(|p| p.factor == power.factor) {
                Some(p) => p.exponent += power.exponent,
                None => product.powers.push(power.clone()),
            }
        }
        product.saturations.extend(other.saturations.iter().cloned());
        product
    }

    /// Whether this is the constant term.
    pub fn is_intercept(&self) -> bool {
        self.powers.iter().all(|p| p.exponent == 0) && self.saturations.is_empty()
    }

    /// Sum of the exponents; each saturating factor counts as one.
    pub fn order(&self) -> u32 {
        self.powers.iter().map(|p| p.exponent).sum::<u32>() + self.saturations.len() as u32
    }

    /// Exponent of a factor in the monomial; 0 where it is absent.
    pub fn exponent(&self, factor: &str) -> u32 {
        self.powers.iter().filter(|p| p.factor == factor).map(|p| p.exponent).sum()
    }

    /// Whether a factor appears in the term, as a power or inside an exponential.
    pub fn involves(&self, factor: &str) -> bool {
        self.exponent(factor) > 0 || self.saturations.iter().any(|s| s.factor == factor)
    }

    /// Whether both terms are the same function, in whatever order they are written.
    pub fn is_same(&self, other: &Self) -> bool {
        self.divides(other) && other.divides(self)
    }

    /// Whether the other term is this one times something, or this one itself.
    ///
    /// This is the order of the hierarchy: a main effect divides its square and every
    /// interaction that it takes part in; the intercept divides everything.
    pub fn divides(&self, other: &Self) -> bool {
        let powers =
            self.powers.iter().all(|p| other.exponent(&p.factor) >= self.exponent(&p.factor));
        let count =
            |term: &Self, s: &Saturation| term.saturations.iter().filter(|t| *t == s).count();
        powers && self.saturations.iter().all(|s| count(other, s) >= count(self, s))
    }
}

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_intercept() {
            return write!(f, "1");
        }
        let mut separator = "";
        for power in self.powers.iter().filter(|p| p.exponent > 0) {
            write!(f, "{separator}{}", power.factor)?;
            if power.exponent > 1 {
                write!(f, "^{}", power.exponent)?;
            }
            separator = "*";
        }
        for s in &self.saturations {
            write!(f, "{separator}exp(-{}/{})", s.factor, s.scale)?;
            separator = "*";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_main_effect_divides_what_is_built_on_it_and_nothing_else() {
        let a = Term::linear("a");
        assert!(a.divides(&Term::power("a", 2)));
        assert!(a.divides(&Term::interaction("b", "a")));
        assert!(a.divides(&a.times(&Term::saturating("b", 0.2))));
        assert!(!a.divides(&Term::power("b", 3)));
        assert!(!Term::saturating("b", 0.2).divides(&Term::saturating("b", 0.3)));
        assert!(Term::intercept().divides(&a));
    }

    #[test]
    fn the_order_of_writing_does_not_matter() {
        assert!(Term::interaction("a", "b").is_same(&Term::interaction("b", "a")));
        assert!(!Term::interaction("a", "b").is_same(&Term::power("a", 2)));
        assert!(Term::monomial(&[("a", 1), ("a", 1)]).is_same(&Term::power("a", 2)));
    }
}
