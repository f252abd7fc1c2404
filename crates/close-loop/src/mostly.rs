//! What is missing for the most part, where nothing fits.
//!
//! An effect may take away all but a twentieth of chi-square and still leave more than scatter does: it is the right one, and
//! something small is beside it, or means scatter more widely than is counted. "Something that is not in the catalogue" would be the
//! worst answer then. It is named if it leaves less than [`LEAVES`] of chi-square, if nothing else speaks against it, if two effects
//! together do fit, and if it is one of the two in every pair that does: so it is missing whatever the other is. Fresh runs must
//! bear out that it leaves no more. (In sealed drums whose effect was taken out of the catalogue the best one left six to forty
//! per cent, and pairs that fitted had no member in common that did.)

use calib::attribution::{Finding, PairFit, Ranked, Verdict};

use crate::catalogue::Effect;
use crate::confirm;
use crate::driver::{CloseLoop, LAST_ROUND, State, Told};
use crate::error::CloseLoopError;
use crate::outcome::{Outcome, StrengthOf};

/// Part of chi-square that an effect leaves, up to which it is most of what is missing.
const LEAVES: f64 = 0.1;

/// Whether so little is left of chi-square.
pub(crate) fn is_little(left: f64, of: f64) -> bool {
    left <= LEAVES * of
}

/// The effect that is named by itself though it does not fit; `None` if what is named does, or nothing is.
pub(crate) fn named(finding: &Finding, level: f64) -> Option<&Ranked> {
    let Verdict::Effect(name) = &finding.verdict else { return None };
    finding.ranked.iter().find(|r| r.name == *name && !(r.p_absolute > level))
}

/// Pairs that fit.
pub(crate) fn fitting(finding: &Finding, level: f64) -> impl Iterator<Item = &PairFit> {
    finding.pairs.iter().filter(move |p| p.fit.p > level)
}

/// What is missing for the most part.
fn most(finding: &Finding, level: f64) -> Option<&Ranked> {
    let best = finding.ranked.iter().min_by(|a, b| a.fit.chi2.total_cmp(&b.fit.chi2))?;
    // Its only objection is that it does not fit.
    let only = !(best.p_absolute > level) && best.objections.len() == 1;
    let most = is_little(best.fit.chi2, finding.base.chi2) && best.p_family <= level;
    let mut pairs = fitting(finding, level).peekable();
    let fits = pairs.peek().is_some();
    let shared = pairs.all(|p| p.names.contains(&best.name));
    (only && most && fits && shared).then_some(best)
}

/// What is left, and what may be beside it, in words.
pub(crate) fn beside(finding: &Finding, level: f64) -> String {
    let Some(own) = named(finding, level) else { return String::new() };
    let (fit, base) = (&own.fit, finding.base.chi2);
    let others: Vec<&str> = fitting(finding, level)
        .filter_map(|p| p.names.iter().find(|n| **n != own.name))
        .map(|n| &n[..])
        .collect();
    format!(
        " It takes away {:.0} % of chi-square; what is left, {:.1} with {} degrees of freedom (p = {:.1e}), is more than is known to scatter. With {} beside it the data are met{}.",
        100.0 * (1.0 - fit.chi2 / base),
        fit.chi2,
        fit.dof,
        own.p_absolute,
        others.join(" or "),
        if others.len() > 1 { "; which of them, they do not tell" } else { "" }
    )
}

/// Widen the interval of a strength whose model leaves more than scatter: as if all errors were larger by what brings chi-square
/// to its degrees of freedom.
pub(crate) fn widen(
    strengths: &mut [StrengthOf],
    effects: &[Effect],
    finding: &Finding,
    level: f64,
) {
    let Some(own) = named(finding, level) else { return };
    let by = (own.fit.chi2 / own.fit.dof.max(1) as f64).sqrt().max(1.0);
    for s in strengths {
        let Some(effect) = effects.iter().find(|e| e.path == s.name) else { continue };
        let forth = |x: f64| effect.scale.forth(x);
        let (low, high) = (forth(effect.range.0), forth(effect.range.1));
        let at = forth(s.value);
        let away = |end: f64| {
            let far = at + by * (forth(end) - at);
            effect.scale.back(far.clamp(low.min(high), high.max(low)))
        };
        (s.lo, s.hi) = (away(s.lo), away(s.hi));
    }
}

impl CloseLoop<'_> {
    /// The answer, or where that is "unknown" what is missing for the most part. (Not where a stand-in had to save the cost of the rig
    /// itself: its fresh runs are for what fits.)
    pub(crate) fn or_most(
        &self,
        state: &mut State<'_>,
        outcome: Outcome,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Outcome, CloseLoopError> {
        let level = self.settings.attribution.level;
        if outcome.verdict != "unknown" || state.setup.cast.fresh.is_some() || !state.has_time(1) {
            return Ok(outcome);
        }
        let Some(name) = most(&outcome.finding, level).map(|r| r.name.clone()) else {
            return Ok(outcome);
        };
        let finding = Finding { verdict: Verdict::Effect(name), ..outcome.finding.clone() };
        let (most, _) = confirm::outcome(self, state, finding, LAST_ROUND, watch)?;
        Ok(if most.confirmed == Some(true) { most } else { outcome })
    }
}

#[cfg(test)]
mod tests {
    use calib::attribution::Settings;
    use campaign::{Laboratory, Sampling};

    use super::*;
    use crate::fixture::{FRICTIONS, nothing_known, run};

    const COHESION: &str = "cohesion.energy_density_j_m3";
    const LEVEL: f64 = 0.01;

    /// What is found where cohesion makes the whole line 6 deg steeper and moves the centre by 2 % of the radius, and `more` is
    /// added to the height of the centre, each measured to 0.3.
    fn found(more: f64) -> (Finding, Vec<Effect>) {
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
        let only = format!(
            "[catalogue]\nonly = [\"{COHESION}\", \"measure.bias_mid_deg\", \"measure.offset_y_pct\"]"
        );
        let row = format!("40,0.3,34,0.3,12,0.3,{},0.3,20", 15.0 + more);
        let mut state = nothing_known(&lab, &only, &row);
        let run = |friction: f64, strengths: &[f64], by: f64| {
            let lin = 34.0 + 6.0 * (friction / 0.5).ln();
            run(friction, strengths, [lin + by, lin, 10.0 + by / 3.0, 15.0])
        };
        state.base = FRICTIONS.iter().map(|f| run(*f, &[], 0.0)).collect();
        state.theta = vec![0.5];
        let strengths = [2000.0, 4000.0, 6000.0, 8000.0];
        let own = strengths.map(|s| run(0.5, &[s], s / 1000.0));
        state.effects.insert(COHESION.to_owned(), own.to_vec());
        for (path, r) in [("measure.bias_mid_deg", 1), ("measure.offset_y_pct", 3)] {
            state.curves.insert(path.to_owned(), crate::curve::Change::Shift(r));
        }
        let settings = Settings { bootstrap: 199, stability_bootstrap: 0, ..Settings::default() };
        (state.attribute(&settings).unwrap(), state.setup.catalogue.effects.clone())
    }

    #[test]
    fn what_leaves_a_little_is_what_is_missing_for_the_most_part() {
        let (finding, effects) = found(1.2);
        let best = most(&finding, LEVEL).unwrap();
        assert_eq!(best.name, COHESION);
        assert!(best.p_absolute < LEVEL, "{}", best.p_absolute);
        let named_so = Finding { verdict: Verdict::Effect(COHESION.to_owned()), ..finding };
        let own = named(&named_so, LEVEL).unwrap();
        let (value, lo, hi) =
            (own.strength.value, own.strength.lo.unwrap(), own.strength.hi.unwrap());
        let mut strengths = [StrengthOf {
            name: COHESION.to_owned(),
            meaning: String::new(),
            null: 0.0,
            value,
            lo,
            hi,
        }];
        widen(&mut strengths, &effects, &named_so, LEVEL);
        let by = (own.fit.chi2 / own.fit.dof as f64).sqrt();
        assert!(by > 1.3 && (strengths[0].hi - value) / (hi - value) / by > 0.999, "{strengths:?}");
        let words = beside(&named_so, LEVEL);
        assert!(words.contains("With measure.offset_y_pct beside it"), "{words}");
    }

    #[test]
    fn what_fits_or_leaves_too_much_is_not() {
        let (fits, _) = found(0.0);
        assert!(most(&fits, LEVEL).is_none());
        let named_so = Finding { verdict: Verdict::Effect(COHESION.to_owned()), ..fits };
        assert!(named(&named_so, LEVEL).is_none() && beside(&named_so, LEVEL).is_empty());
        // Half as much again is missing beside it.
        let (too_much, _) = found(9.0);
        assert!(most(&too_much, LEVEL).is_none());
    }

    #[test]
    fn a_tenth_is_little_and_more_is_not() {
        assert!(is_little(99.0, 1000.0) && !is_little(101.0, 1000.0));
        assert!(!is_little(f64::NAN, 1000.0));
    }
}
