//! Members of a class that fresh runs contradicted at the place where they fitted best.

use calib::attribution::{Settings, Verdict};

use crate::compare;
use crate::confirm::sentence;
use crate::driver::State;
use crate::error::CloseLoopError;
use crate::outcome::Outcome;

/// The answer with those members back that explain the data elsewhere: fresh runs contradict a place of an effect, not
/// the effect. Each is heard once more, its runs learnt by now.
pub(crate) fn heard(
    state: &mut State<'_>,
    mut outcome: Outcome,
    settings: &Settings,
) -> Result<Outcome, CloseLoopError> {
    let ran: Vec<&str> = outcome.models().filter_map(|side| side.effect.as_deref()).collect();
    let gone = gone(&outcome.finding.verdict, &outcome.members, &ran);
    if gone.is_empty() || outcome.confirmed != Some(true) {
        return Ok(outcome);
    }
    let finding = state.attribute(settings)?;
    let still = match &finding.verdict {
        Verdict::Effect(name) => std::slice::from_ref(name),
        Verdict::Class(names) => names,
        _ => &[],
    };
    let back: Vec<String> = gone.into_iter().filter(|n| still.contains(n)).collect();
    if back.is_empty() {
        return Ok(outcome);
    }
    outcome.assumed.push(format!(
        "Fresh runs contradict {} where the data seemed to ask for it; with these runs learnt it explains them elsewhere.",
        back.join(" and ")
    ));
    outcome.strengths.extend(compare::strengths(&state.setup.catalogue.effects, &finding, &back));
    outcome.members.extend(back);
    outcome.verdict = "class";
    outcome.sentence = sentence(&outcome.finding, outcome.verdict, &outcome.strengths, false);
    Ok(outcome)
}

/// Members of a class that are not among those that are named, though their drums ran.
fn gone(verdict: &Verdict, named: &[String], ran: &[&str]) -> Vec<String> {
    let Verdict::Class(all) = verdict else { return Vec::new() };
    let out = |name: &&String| !named.contains(name) && ran.contains(&name.as_str());
    all.iter().filter(out).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_members_whose_drums_ran_are_heard_again() {
        let all = ["size.scale", "vibration.amplitude_m", "drag.coefficient_s"].map(str::to_owned);
        let class = Verdict::Class(all.to_vec());
        // The first is named, the second contradicted, the third could not be simulated.
        let ran = ["size.scale", "vibration.amplitude_m"];
        assert_eq!(gone(&class, &all[..1], &ran), all[1..2]);
        assert!(gone(&class, &all[..2], &ran).is_empty());
        assert!(gone(&Verdict::Effect(all[0].clone()), &[], &ran).is_empty());
    }
}
