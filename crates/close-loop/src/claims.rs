//! What would have been seen of a drum that seems to lack nothing, put to the test.
//!
//! A report that nothing is missing says how strong each effect would have to be to be seen: in a drum that calibrates to the
//! very point that these data calibrate to, which is another friction the stronger the effect is. Nobody has run such drums
//! when friction alone explains the data, and what effects do there is read off runs at the calibrated friction. So they are
//! run, and where one hides after all the next is stronger.

use calib::CalibError;
use calib::attribution::{Finding, Settings, Verdict};

use crate::driver::{Stage, State, Told, is_simulated};
use crate::error::CloseLoopError;
use crate::refine::{Asked, NEAR};

/// How often what would have been seen is asked again with the runs of the drums that it speaks of.
const ROUNDS: usize = 4;

/// A drum of which it is said that it would have been seen: an effect's path, the free parameters followed by the strength.
type Claim = (String, Vec<f64>);

impl State<'_> {
    /// Run the drums that would have been seen by a finding of nothing, with at most `most` runs, and ask again.
    pub(crate) fn prove(
        &mut self,
        mut finding: Finding,
        mut most: usize,
        settings: &Settings,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Finding, CloseLoopError> {
        for _ in 0..ROUNDS {
            if finding.verdict != Verdict::None || most == 0 {
                break;
            }
            let claims = claims(&finding);
            let before = self.runs.everyday;
            self.look(Stage::Prove, most, watch, |state, count| state.unproven(&claims, count))?;
            let made = self.runs.everyday - before;
            if made == 0 {
                break;
            }
            most = most.saturating_sub(made);
            finding = self.attribute(settings)?;
        }
        Ok(finding)
    }

    /// Of these drums some near which nobody has run any with their effect.
    fn unproven(&self, claims: &[Claim], count: usize) -> Result<Vec<Asked>, CalibError> {
        let base = self.base_model()?;
        let mut open = Vec::new();
        for (path, at) in claims {
            if open.len() == count {
                break;
            }
            let Some(effect) = self.effect(path).filter(|e| is_simulated(e)) else { continue };
            let own = self.seen(std::slice::from_ref(effect));
            let within = at.last().is_some_and(|s| (effect.range.0..=effect.range.1).contains(s));
            if own.is_empty() || !within {
                continue;
            }
            let model = self.effect_model(&base, effect, own)?;
            // However sure a surface is of a place: what is claimed of it is run there.
            let lost = self.lost(std::slice::from_ref(effect)).iter();
            let mut near = own.iter().map(|s| &s.at).chain(lost);
            let known = near.any(|run| model.apart(run, at) < NEAR);
            if !known {
                open.push(Asked { effects: vec![effect.clone()], at: self.on_grid(effect, at) });
            }
        }
        Ok(open)
    }
}

/// The weakest drums that would have been seen.
fn claims(finding: &Finding) -> Vec<Claim> {
    let one = |d: &calib::attribution::Detectable| {
        let strength = d.strength?;
        Some((d.name.clone(), d.at.iter().copied().chain([strength]).collect()))
    };
    finding.detectable.iter().filter_map(one).collect()
}

#[cfg(test)]
mod tests {
    use campaign::{Laboratory, Sampling};

    use super::*;
    use crate::fixture::{FRICTIONS, nothing_known, run};

    #[test]
    fn what_is_said_to_be_visible_is_run_where_it_would_hide() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
        let only = r#"[catalogue]
only = ["friction.kinetic_ratio", "speed.scale"]"#;
        let mut state = nothing_known(&lab, only, "34,0.3,34,0.3,10,0.1,15,0.1,20");
        // Nothing but the product of friction and kinetic ratio shows, a wrong speed moves the centre.
        let drum = |friction: f64, ratio: f64, across: f64| {
            let lin = 34.0 + 6.0 * (friction * ratio / 0.5).ln();
            [lin, lin, 10.0 + across, 15.0]
        };
        state.base = FRICTIONS.iter().map(|f| run(*f, &[], drum(*f, 1.0, 0.0))).collect();
        state.theta = vec![0.5];
        let [kinetic, speed] = ["friction.kinetic_ratio", "speed.scale"].map(str::to_owned);
        let probes = [0.6, 0.8].map(|k| run(0.5, &[k], drum(0.5, k, 0.0)));
        state.effects.insert(kinetic.clone(), probes.to_vec());
        let probes = [0.95, 1.05].map(|s| run(0.5, &[s], drum(0.5, 1.0, s - 1.0)));
        state.effects.insert(speed.clone(), probes.to_vec());
        let settings = Settings { bootstrap: 199, stability_bootstrap: 0, ..Settings::default() };
        let finding = state.attribute(&settings).unwrap();
        assert_eq!(finding.verdict, Verdict::None);
        // A kinetic friction hides to the end of its range; a speed that is off by a third would be seen, and nobody has run one.
        let claims = claims(&finding);
        assert_eq!(claims.len(), 2, "{claims:?}");
        assert!(claims.iter().all(|(path, at)| *path == speed && at.len() == 2), "{claims:?}");
        for left in [2, 1, 0] {
            let asked = state.unproven(&claims, 9).unwrap();
            assert_eq!(asked.len(), left, "{claims:?}");
            if let Some(Asked { at, .. }) = asked.first() {
                assert!((at[0] - 0.5).abs() < 0.05 && (at[1] - 1.0).abs() > 0.2, "{at:?}");
                let own = run(at[0], &at[1..], drum(at[0], 1.0, at[1] - 1.0));
                state.effects.entry(speed.clone()).or_default().push(own);
            }
        }
    }
}
