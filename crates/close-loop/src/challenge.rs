//! What fresh runs teach: answers that they refute, and effects that only their models dismiss.

use calib::attribution::Finding;

use crate::confirm::Learned;
use crate::driver::{Stage, State, Told, is_simulated};
use crate::error::CloseLoopError;
use crate::runs::{rig_with, sample};

/// How often the effects that come closest are simulated at their best points before it is said that
/// none of them fits: runs dismiss an effect, not the model of it.
pub(crate) const CHALLENGES: usize = 2;

/// Effects that are simulated then.
pub(crate) const CHALLENGED: usize = 2;

impl State<'_> {
    /// Simulate the effects that come closest at their best points; whether there were any.
    pub(crate) fn challenge(
        &mut self,
        finding: &Finding,
        round: usize,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<bool, CloseLoopError> {
        let best = finding.ranked.iter().map(|r| r.improvement).fold(0.0, f64::max);
        let effects = self.setup.catalogue.effects.clone();
        let mut rigs = Vec::new();
        let mut places = Vec::new();
        let close = finding.ranked.iter().filter(|r| r.improvement > 0.5 * best && best > 0.0);
        let simulated = close.filter_map(|r| {
            let effect = effects.iter().find(|e| e.path == r.name)?;
            (is_simulated(effect) && self.effects.contains_key(&r.name)).then_some((effect, r))
        });
        for (effect, r) in simulated.take(CHALLENGED) {
            let Some((strength, theta)) = r.fit.theta.split_last() else { continue };
            for k in 0..self.effort.confirm {
                let filling = self.runs.filling(Stage::Refine, 1000 * round + k);
                let (rig, axes) = (&self.setup.rig, &self.setup.axes);
                let with = rig_with(rig, axes, theta, (effect, *strength), filling)?;
                rigs.push((format!("{} = {strength:.4}", effect.path), with));
                places.push((effect.path.clone(), r.fit.theta.clone()));
            }
        }
        let runs = self.runs.all(Stage::Refine, &rigs, watch)?;
        let mut any = false;
        for ((path, at), run) in places.into_iter().zip(&runs) {
            if let Some(run) = run {
                any = true;
                self.learn(vec![(path, at.clone(), vec![sample(at, run)])]);
            }
        }
        Ok(any)
    }

    /// Whether an effect's model is made of simulations.
    pub(crate) fn can_learn(&self, (path, ..): &Learned) -> bool {
        self.effects.contains_key(path)
    }

    /// Take fresh runs into the models of their effects, which stand about them from now on.
    pub(crate) fn learn(&mut self, learned: Vec<Learned>) {
        for (path, at, samples) in learned {
            if let Some(known) = self.effects.get_mut(&path) {
                known.extend(samples);
                self.centres.insert(path, at);
            }
        }
    }
}
