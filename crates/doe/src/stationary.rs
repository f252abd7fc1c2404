//! Where a second-order surface has no slope, and how it curves there.
//!
//! In coded units y = b0 + b'c + c'Bc; the slope vanishes at c = -B^-1 b / 2, and the eigenvalues
//! of B tell a maximum (all negative) from a minimum, a saddle, or a ridge (one near zero).

use faer::{Mat, Side};

use crate::error::DoeError;
use crate::fit::Fit;
use crate::model::Model;
use crate::term::Term;

/// Smallest curvature that is not flat, relative to the largest.
const FLAT: f64 = 1.0e-10;

/// Shape of the surface around its stationary point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StationaryKind {
    /// Falls in every direction.
    Maximum,
    /// Rises in every direction.
    Minimum,
    /// Rises in some, falls in others.
    Saddle,
    /// Flat in at least one direction: no single stationary point.
    Ridge,
}

/// Canonical analysis of a second-order surface.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StationaryPoint {
    /// Coded values of the varied factors; none on a ridge. May lie far outside -1..1.
    pub coded: Option<Vec<f64>>,
    /// The same in natural units.
    pub natural: Option<Vec<f64>>,
    /// Curvatures along the principal directions, ascending, per squared coded unit.
    pub eigenvalues: Vec<f64>,
    /// The principal directions, coded, one for each eigenvalue.
    pub directions: Vec<Vec<f64>>,
    /// Shape.
    pub kind: StationaryKind,
}

impl Fit {
    /// Canonical analysis over some factors, the others held at the values that `at` gives.
    ///
    /// `at` is a full point in natural units; its values of the varied factors are not used.
    ///
    /// # Errors
    /// [`DoeError::UnknownFactor`]; [`DoeError::UnsuitableTerm`] if a term is of higher than
    /// second order in the varied factors or saturates in one; those of a wrong point.
    pub fn stationary_point(
        &self,
        varied: &[&str],
        at: &[f64],
    ) -> Result<StationaryPoint, DoeError> {
        let model = self.model();
        model.check_point(at)?;
        let factors = model.factors();
        let mut positions = Vec::with_capacity(varied.len());
        for name in varied {
            let position = factors.iter().position(|f| f.name == *name);
            positions.push(position.ok_or_else(|| DoeError::UnknownFactor {
                term: "stationary point".to_string(),
                factor: (*name).to_string(),
                known: factors.iter().map(|f| f.name.clone()).collect(),
            })?);
        }
        if varied.is_empty() {
            return Err(DoeError::Empty { what: "factors" });
        }
        let k = varied.len();
        let mut slope = vec![0.0; k];
        let mut curvature = Mat::<f64>::zeros(k, k);
        for (term, b) in model.terms().iter().zip(self.coefficients()) {
            let involved = involved_factors(term, varied)?;
            let value = b * held_value(model, term, varied, at)?;
            match involved[..] {
                [] => {}
                [i] => slope[i] += value,
                [i, j] => {
                    curvature[(i, j)] += 0.5 * value;
                    curvature[(j, i)] += 0.5 * value;
                }
                _ => {
                    return Err(DoeError::UnsuitableTerm {
                        term: term.to_string(),
                        reason: "it is of higher than second order in the varied factors",
                    });
                }
            }
        }
        let eigen = curvature
            .self_adjoint_eigen(Side::Lower)
            .map_err(|_| DoeError::NoConvergence { what: "eigenvalue decomposition" })?;
        let eigenvalues: Vec<f64> = (0..k).map(|i| eigen.S()[i]).collect();
        let directions: Vec<Vec<f64>> =
            (0..k).map(|i| (0..k).map(|j| eigen.U()[(j, i)]).collect()).collect();
        let kind = kind_of(&eigenvalues);
        let coded = (kind != StationaryKind::Ridge).then(|| {
            let mut c = vec![0.0; k];
            for (value, direction) in eigenvalues.iter().zip(&directions) {
                let along: f64 = direction.iter().zip(&slope).map(|(d, s)| d * s).sum();
                c.iter_mut().zip(direction).for_each(|(c, d)| *c -= 0.5 * along / value * d);
            }
            c
        });
        let natural = coded
            .as_ref()
            .map(|c| c.iter().zip(&positions).map(|(c, &j)| factors[j].decode(*c)).collect());
        Ok(StationaryPoint { coded, natural, eigenvalues, directions, kind })
    }
}

/// Positions in `varied` of the varied factors of a term, repeated by their exponents.
fn involved_factors(term: &Term, varied: &[&str]) -> Result<Vec<usize>, DoeError> {
    if term.saturations.iter().any(|s| varied.contains(&s.factor.as_str())) {
        return Err(DoeError::UnsuitableTerm {
            term: term.to_string(),
            reason: "it saturates in a varied factor",
        });
    }
    let repeated = |(i, name): (usize, &&str)| std::iter::repeat_n(i, term.exponent(name) as usize);
    Ok(varied.iter().enumerate().flat_map(repeated).collect())
}

/// The part of a term in the factors that are held, at their values.
fn held_value(model: &Model, term: &Term, varied: &[&str], at: &[f64]) -> Result<f64, DoeError> {
    let mut held = term.clone();
    held.powers.retain(|p| !varied.contains(&p.factor.as_str()));
    Ok(Model::new(model.factors(), &[held])?.row(at)[0])
}

fn kind_of(eigenvalues: &[f64]) -> StationaryKind {
    let largest = eigenvalues.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if eigenvalues.iter().any(|v| v.abs() <= FLAT * largest) {
        return StationaryKind::Ridge;
    }
    match eigenvalues.iter().filter(|v| **v > 0.0).count() {
        0 => StationaryKind::Maximum,
        n if n == eigenvalues.len() => StationaryKind::Minimum,
        _ => StationaryKind::Saddle,
    }
}
