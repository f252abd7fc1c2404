//! Models of effects, and the question which of them the data call for.

use calib::CalibError;
use calib::attribution::{Attribution, Candidate, CodeCovariance, Finding, PairModel, Settings};

use crate::catalogue::Effect;
use crate::coded::{Coded, Model, decode};
use crate::curve::Curve;
use crate::driver::State;
use crate::emulator::{Axis, Emulator, Sample};
use crate::error::CloseLoopError;

impl State<'_> {
    pub(crate) fn effect_axes(&self, effect: &Effect) -> Vec<Axis> {
        let mut axes = self.setup.axes.clone();
        let t = |x: f64| effect.scale.forth(x);
        let unit = (t(effect.probes[1]) - t(effect.null)).abs().max(f64::MIN_POSITIVE);
        let (path, roughness) = (effect.path.clone(), effect.roughness);
        axes.push(Axis { path, scale: effect.scale, unit, roughness });
        axes
    }

    pub(crate) fn effect_model(
        &self,
        base: &Emulator,
        effect: &Effect,
        samples: &[Sample],
    ) -> Result<Emulator, CalibError> {
        let mut all: Vec<Sample> = self
            .base
            .iter()
            .map(|s| {
                let mut at = s.at.clone();
                at.push(effect.null);
                Sample { at, ..s.clone() }
            })
            .collect();
        all.extend_from_slice(samples);
        let mut origin = self.middle();
        origin.push(effect.null);
        Ok(self.dress(base.of_others(self.effect_axes(effect), origin, &all)?))
    }

    /// Every effect of the catalogue whose model can be made.
    pub(crate) fn models(&self, base: &Emulator) -> Result<Vec<(&Effect, Coded)>, CalibError> {
        let mut models = Vec::new();
        for effect in &self.setup.catalogue.effects {
            let model = if let Some(change) = self.curves.get(&effect.path) {
                Model::Curve(Curve {
                    base: base.clone(),
                    name: effect.path.clone(),
                    null: effect.null,
                    change: change.clone(),
                })
            } else if let Some(samples) = self.effects.get(&effect.path) {
                Model::Runs(self.effect_model(base, effect, samples)?)
            } else {
                continue;
            };
            models.push((effect, Coded::new(&[effect], model)));
        }
        Ok(models)
    }

    /// The question which effect the data call for.
    pub(crate) fn question<'m>(
        &self,
        base: &'m Emulator,
        models: &'m [(&Effect, Coded)],
        pairs: &'m [([String; 2], Coded)],
        settings: &Settings,
    ) -> Attribution<'m> {
        let pair_models = pairs
            .iter()
            .map(|(names, model)| PairModel { names: names.clone(), simulator: model })
            .collect();
        let candidates = models
            .iter()
            .map(|(effect, model)| Candidate {
                name: effect.path.clone(),
                simulator: model,
                null: 0.0,
                range: model.range(effect.range),
                strength_sd: effect.strength_sd().map(|sd| model.change(sd)),
                layer: effect.layer,
                prior: effect.prior,
                exposed_by: effect.exposed_by.clone(),
                meaning: effect.meaning.clone(),
            })
            .collect();
        Attribution {
            base: self.problem(base),
            candidates,
            pair_models,
            code_covariance: self.codes().cloned(),
            held_out: self.setup.held_out.clone(),
            experiments: Vec::new(),
            settings: Settings {
                errors_dof: Some(base.errors_dof()),
                // Asked by itself.
                without_codes: false,
                ..settings.clone()
            },
        }
    }

    /// Ask which effect the data call for; where codes may differ, with and without that, and what explains the data
    /// better stands. The answer without is told beside it.
    pub(crate) fn attribute(&mut self, settings: &Settings) -> Result<Finding, CloseLoopError> {
        let base = self.base_model()?;
        let models = self.models(&base)?;
        let pairs = self.pair_models(&base)?;
        let ask = |codes: Option<&CodeCovariance>| {
            let mut question = self.question(&base, &models, &pairs, settings);
            question.code_covariance = codes.cloned();
            let mut finding = question.attribute()?;
            decode(&mut finding, &models);
            Ok::<Finding, CloseLoopError>(finding)
        };
        let alike = ask(None)?;
        let Some(codes) = &self.setup.codes else { return Ok(alike) };
        let without = Some(alike.verdict.clone());
        let differing = ask(Some(codes))?;
        let differ =
            !self.setup.codes_may_agree || best(&differing, settings) < best(&alike, settings);
        let finding = if differ { differing } else { alike };
        self.codes_differ = differ;
        Ok(Finding { verdict_without_code: without, ..finding })
    }

    /// By how much codes differ, where they are taken to.
    pub(crate) fn codes(&self) -> Option<&CodeCovariance> {
        self.setup.codes.as_ref().filter(|_| self.codes_differ)
    }
}

/// Deviance of what explains the data best, nothing or one effect, with what it costs by its prior mass.
fn best(finding: &Finding, settings: &Settings) -> f64 {
    let rest = 1.0 - settings.prior_none - settings.prior_unknown - settings.prior_pairs;
    let single = rest / finding.ranked.len().max(1) as f64;
    let cost = |mass: f64| -2.0 * mass.ln();
    finding
        .ranked
        .iter()
        .map(|r| r.fit.deviance + cost(single))
        .fold(finding.base.deviance + cost(settings.prior_none), f64::min)
}
