//! Which physical effect the model lacks.
//!
//! A calibrated base model either meets the data within their errors, or something is missing.
//! [`Attribution::attribute`] decides that first (the [`Gate`]), then asks which effect of a
//! catalogue, fitted together with the frictions, explains the data, which others explain them as
//! well (a class), and whether speeds that were not fitted agree.

mod candidate;
mod data;
mod evidence;
mod finding;
mod gate;
mod held_out;
mod linear;
mod model;
mod next;
mod pairs;
mod ranking;
mod report;
mod signature;
mod solver;
mod stability;

pub use candidate::{Candidate, CodeCovariance, Experiment, Layer, PairModel, Settings};
pub use finding::{
    CollinearClass, Detectable, Evidence, Finding, Fit, Gate, HeldOut, HeldOutResponse,
    NextExperiment, Overturn, PairFit, PairPlace, Ranked, ResidualPoint, StabilityRow, Strength,
    Trial, Verdict,
};

pub use ranking::at_the_end;

use crate::{CalibError, Observations, Problem};

/// Everything that an attribution needs.
pub struct Attribution<'s> {
    /// Base model with its observations, free parameters and nuisances.
    pub base: Problem<'s>,
    /// The catalogue.
    pub candidates: Vec<Candidate<'s>>,
    /// Pairs that were simulated together. The signatures of all others add.
    pub pair_models: Vec<PairModel<'s>>,
    /// Systematic difference between codes, where the truth came from another code.
    pub code_covariance: Option<CodeCovariance>,
    /// Data that are never fitted, of the same configuration.
    pub held_out: Option<Observations>,
    /// Experiments that could be made next.
    pub experiments: Vec<Experiment<'s>>,
    /// Levels, priors, sizes.
    pub settings: Settings,
}

impl Attribution<'_> {
    /// Decide whether an effect is missing, and which.
    ///
    /// # Errors
    /// [`CalibError`] if the problem is not well posed (fewer observations than parameters), a
    /// candidate's parameters are not the base's followed by one, or a simulator fails.
    pub fn attribute(&self) -> Result<Finding, CalibError> {
        self.check()?;
        report::finding(self)
    }

    /// Best fit of the base, and for each candidate in the order given every optimum that was found, best
    /// first, without any test: for choosing what to simulate next. Their deviance holds what strengths
    /// cost by their priors.
    ///
    /// # Errors
    /// As [`Attribution::attribute`].
    pub fn fits(&self) -> Result<(Fit, Vec<Vec<Fit>>), CalibError> {
        self.check()?;
        report::fits(self)
    }

    /// Candidate `k`, by the order given, at parameters of one's own (frictions, then the strength): how well
    /// it explains the data there, nothing fitted. To see where along a valley of such fits little is known.
    ///
    /// # Errors
    /// As [`Attribution::attribute`].
    pub fn trials(&self, k: usize, thetas: &[Vec<f64>]) -> Result<Vec<Trial>, CalibError> {
        self.check()?;
        report::trials(self, k, thetas)
    }

    /// Best fit of the base, and pairs, given by names in the order of the candidates, at their best fit and with the first
    /// friction held at these parts of its range, without any test: to see where along a valley of such fits little is known.
    /// The pair of the best deviance comes first, of each pair its best fit.
    ///
    /// # Errors
    /// As [`Attribution::attribute`].
    pub fn pair_places(
        &self,
        among: &[[String; 2]],
        parts: &[f64],
    ) -> Result<(Fit, Vec<PairPlace>), CalibError> {
        self.check()?;
        report::pair_places(self, among, parts)
    }

    /// Only the verdict, by a bootstrap that stops early where nothing is missing: for studies
    /// of power.
    ///
    /// # Errors
    /// As [`Attribution::attribute`].
    pub fn verdict(&self) -> Result<Verdict, CalibError> {
        self.check()?;
        let observations = &self.base.observations;
        let case = gate::Case::new(self, observations, data::Variation::default(), true)?;
        stability::verdict(&case, self.settings.bootstrap)
    }

    fn check(&self) -> Result<(), CalibError> {
        let s = &self.settings;
        let setting = |name, value, expected| Err(CalibError::Setting { name, value, expected });
        if !(s.level > 0.0 && s.level < 0.5) {
            return setting("level", s.level, "above 0 and below 0.5");
        }
        // The smallest p of B draws is 1 / (B + 1); a level below it could never be reached.
        for (name, draws) in
            [("bootstrap", s.bootstrap), ("stability_bootstrap", s.stability_bootstrap)]
        {
            let off = name == "stability_bootstrap" && draws == 0;
            if !off && (draws as f64 + 1.0) * s.level < 1.0 {
                return setting(
                    name,
                    draws as f64,
                    "at least 1 / level draws (199 for 0.01 is little)",
                );
            }
        }
        for (name, value) in [
            ("prior_none", s.prior_none),
            ("prior_unknown", s.prior_unknown),
            ("prior_pairs", s.prior_pairs),
        ] {
            if !(value > 0.0 && value < 1.0) {
                return setting(name, value, "above 0 and below 1");
            }
        }
        let mass = s.prior_none + s.prior_unknown + s.prior_pairs;
        if !(mass < 1.0) {
            return setting("prior_none + prior_unknown + prior_pairs", mass, "below 1");
        }
        for (name, ratio) in [("class_ratio", s.class_ratio), ("few_ratio", s.few_ratio)] {
            if !(ratio >= 1.0 && ratio.is_finite()) {
                return setting(name, ratio, "1 or more");
            }
        }
        if !(s.class_cosine > 0.0 && s.class_cosine <= 1.0) {
            return setting("class_cosine", s.class_cosine, "above 0, at most 1");
        }
        if !(s.power > 0.0 && s.power < 1.0) {
            return setting("power", s.power, "above 0 and below 1");
        }
        for (i, c) in self.candidates.iter().enumerate() {
            if self.candidates[..i].iter().any(|d| d.name == c.name) {
                let fault = "stands twice in the catalogue; expected once".to_owned();
                return Err(CalibError::Candidate { name: c.name.clone(), fault });
            }
        }
        Ok(())
    }
}
