//! Backward elimination that keeps the hierarchy of terms.
//!
//! One term leaves at a time: the one with the largest p among those that *may* leave, if that p
//! exceeds alpha. A term may leave only when no term that contains it is left (see
//! [`Term::divides`]): a main effect stays while its square or an interaction with it is in the
//! model, whatever its own p. The rule is one-sided: the higher term protects the lower, never
//! the other way round. The intercept stays. `exp(-x/m0)` and `x` do not contain each other, so
//! either may leave a saturating basis; their products with other factors protect both parts.

use crate::error::DoeError;
use crate::fit::{Fit, fit};
use crate::model::Model;
use crate::prediction::check_probability;
use crate::quality::Summary;
use crate::term::Term;
use crate::weighting::Weighting;

/// One term removed.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EliminationStep {
    /// Printed name of the term that left.
    pub removed: String,
    /// Its p before it left.
    pub p: f64,
    /// Terms with a larger p that stayed for the hierarchy or because they were to be kept.
    pub protected: Vec<(String, f64)>,
    /// The fit after it left.
    pub summary: Summary,
}

/// What elimination did and what it ended with.
#[derive(Debug, Clone)]
pub struct Elimination {
    /// Summary of the fit with all terms.
    pub start: Summary,
    /// The removals, first to last.
    pub steps: Vec<EliminationStep>,
    /// Terms left whose p exceeds alpha: protected by the hierarchy or kept by request.
    pub protected: Vec<(String, f64)>,
    /// The fit of the terms that are left.
    pub fit: Fit,
}

/// Removes terms one by one until each that may leave has p at most `alpha`.
///
/// `keep` lists terms that stay whatever their p; terms that the model lacks are ignored.
///
/// ```
/// use doe::{Factor, Model, ModelTerms, Weighting, eliminate};
/// let f = [Factor::uncoded("a")?, Factor::uncoded("b")?];
/// let model = Model::new(&f, &ModelTerms::interaction(&f))?;
/// let points = [[-1., -1.], [1., -1.], [-1., 1.], [1., 1.], [0., 0.], [0., 0.], [0.5, 0.]];
/// let y = [1.1, 4.9, 0.9, 5.1, 3.0, 2.9, 4.1];
/// let reduced = eliminate(&model, &points, &y, Weighting::Ordinary, 0.05, &[])?;
/// assert_eq!(reduced.fit.model().term_names(), ["1", "a"]);
/// # Ok::<(), doe::DoeError>(())
/// ```
///
/// # Errors
/// [`DoeError::Probability`] unless `0 < alpha < 1`, and those of [`fit`].
pub fn eliminate<P: AsRef<[f64]>>(
    model: &Model,
    points: &[P],
    y: &[f64],
    weighting: Weighting<'_>,
    alpha: f64,
    keep: &[Term],
) -> Result<Elimination, DoeError> {
    check_probability("alpha", alpha)?;
    let mut current = fit(model, points, y, weighting)?;
    let start = current.summary();
    let mut steps = Vec::new();
    loop {
        let p = current.p_values();
        let names = current.model().term_names();
        let may_leave = |i: &usize| may_leave(current.model().terms(), *i, keep);
        let weakest = (0..p.len()).filter(may_leave).max_by(|a, b| p[*a].total_cmp(&p[*b]));
        let above = |limit: f64| -> Vec<(String, f64)> {
            (0..p.len())
                .filter(|i| !current.model().terms()[*i].is_intercept())
                .filter(|i| p[*i] > limit && !may_leave(i))
                .map(|i| (names[i].clone(), p[i]))
                .collect()
        };
        match weakest {
            Some(index) if p[index] > alpha => {
                let protected = above(p[index]);
                let (removed, p) = (names[index].clone(), p[index]);
                let smaller = current.model().without(index)?;
                current = fit(&smaller, points, y, weighting)?;
                steps.push(EliminationStep { removed, p, protected, summary: current.summary() });
            }
            _ => {
                let protected = above(alpha);
                return Ok(Elimination { start, steps, protected, fit: current });
            }
        }
    }
}

fn may_leave(terms: &[Term], index: usize, keep: &[Term]) -> bool {
    let term = &terms[index];
    let contained = terms.iter().any(|other| term.divides(other) && !other.is_same(term));
    terms.len() > 1
        && !term.is_intercept()
        && !contained
        && !keep.iter().any(|kept| kept.is_same(term))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Factor, ModelTerms};

    /// Runs whose response holds only a*b: its weak parents must stay.
    fn data() -> (Model, Vec<[f64; 3]>, Vec<f64>) {
        let f = ["a", "b", "c"].map(|n| Factor::uncoded(n).unwrap());
        let model = Model::new(&f, &ModelTerms::quadratic(&f)).unwrap();
        let mut points = vec![];
        for a in [-1.0, 0.0, 1.0] {
            for b in [-1.0, 0.0, 1.0] {
                points.extend([-1.0, 0.0, 1.0].map(|c| [a, b, c]));
            }
        }
        // A fixed scatter without pattern in the factors.
        let noise = |i: usize| ((i * 7919 + 104_729) % 1000) as f64 / 5000.0 - 0.1;
        let y = points.iter().enumerate().map(|(i, x)| 5.0 + x[0] * x[1] + noise(i)).collect();
        (model, points, y)
    }

    #[test]
    fn an_interaction_keeps_its_main_effects() {
        let (model, points, y) = data();
        let done = eliminate(&model, &points, &y, Weighting::Ordinary, 0.01, &[]).unwrap();
        assert_eq!(done.fit.model().term_names(), ["1", "a", "b", "a*b"]);
        assert!(done.protected.iter().all(|(name, p)| ["a", "b"].contains(&&**name) && *p > 0.01));
        assert_eq!(done.steps.len(), 6);
    }

    #[test]
    fn no_step_ever_breaks_the_hierarchy() {
        let (model, points, y) = data();
        let done = eliminate(&model, &points, &y, Weighting::Ordinary, 1.0e-6, &[]).unwrap();
        let mut left = model.terms().to_vec();
        for step in &done.steps {
            let at = left.iter().position(|t| t.to_string() == step.removed).unwrap();
            let removed = left.remove(at);
            assert!(left.iter().all(|t| !removed.divides(t)), "{removed} left before its child");
            assert!(step.p > 1.0e-6);
        }
    }

    #[test]
    fn terms_to_be_kept_are_kept() {
        let (model, points, y) = data();
        let keep = [Term::power("c", 2)];
        let done = eliminate(&model, &points, &y, Weighting::Ordinary, 0.01, &keep).unwrap();
        assert_eq!(done.fit.model().term_names(), ["1", "a", "b", "c", "a*b", "c^2"]);
    }
}
