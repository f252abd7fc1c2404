//! Strengths of a confirmed answer, read once more when its fresh runs have been learnt from.

use std::collections::BTreeMap;

use calib::attribution::{Settings, Strength, Verdict};

use crate::compare;
use crate::confirm::{Learned, sentence};
use crate::driver::State;
use crate::error::CloseLoopError;
use crate::outcome::Outcome;

impl State<'_> {
    /// Fresh runs stand at the very point that was found and were seen by no fit, so nothing says more of the
    /// strengths. The verdict stays what they confirmed.
    pub(crate) fn read_anew(
        &mut self,
        outcome: &mut Outcome,
        fresh: Vec<Learned>,
        settings: &Settings,
    ) -> Result<(), CloseLoopError> {
        let alone = matches!(outcome.finding.verdict, Verdict::Effect(_) | Verdict::Class(_));
        if outcome.confirmed != Some(true) || !alone {
            return Ok(());
        }
        self.learn(fresh);
        let again = self.attribute(settings)?;
        let read: BTreeMap<&String, Strength> =
            again.ranked.iter().map(|r| (&r.name, r.strength)).collect();
        let ranked = &mut outcome.finding.ranked;
        for row in ranked.iter_mut().filter(|r| outcome.members.contains(&r.name)) {
            row.strength = read.get(&row.name).copied().unwrap_or(row.strength);
        }
        let effects = &self.setup.catalogue.effects;
        outcome.strengths = compare::strengths(effects, &outcome.finding, &outcome.members);
        outcome.sentence = sentence(&outcome.finding, outcome.verdict, &outcome.strengths, false);
        Ok(())
    }
}
