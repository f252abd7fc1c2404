//! Members of a class that fresh runs contradicted at the place where they fitted best.

use calib::attribution::{Settings, Verdict};

use crate::compare;
use crate::confirm::{Learned, sentence};
use crate::driver::State;
use crate::error::CloseLoopError;
use crate::outcome::Outcome;

/// The answer with those members back that explain the data elsewhere: fresh runs contradict a place of an effect, not
/// the effect. Each is heard once more, its runs `learnt`.
pub(crate) fn heard(
    state: &mut State<'_>,
    mut outcome: Outcome,
    learnt: &[Learned],
    settings: &Settings,
) -> Result<Outcome, CloseLoopError> {
    let gone = gone(&outcome.finding.verdict, &outcome.members, learnt);
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
fn gone(verdict: &Verdict, named: &[String], learnt: &[Learned]) -> Vec<String> {
    let Verdict::Class(all) = verdict else { return Vec::new() };
    let ran = |name: &String| {
        learnt.iter().any(|(names, runs)| names[..] == [name.clone()] && !runs.is_empty())
    };
    all.iter().filter(|name| !named.contains(name) && ran(name)).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emulator::Sample;

    #[test]
    fn only_members_whose_drums_ran_are_heard_again() {
        let run = Sample {
            at: vec![0.5, 1.2],
            mean: vec![[30.0, 31.0, 10.0, 15.0]; 2],
            covariance: vec![[[0.1; 4]; 4]; 2],
            variance: vec![[1.0; 4]; 2],
            excess: 0.0,
        };
        let [a, b, c] = ["size.scale", "vibration.amplitude_m", "drag.coefficient_s"]
            .map(|n: &str| n.to_owned());
        let class = Verdict::Class(vec![a.clone(), b.clone(), c.clone()]);
        // The first is named, the second contradicted, the third could not be simulated.
        let learnt = [
            (vec![a.clone()], vec![run.clone()]),
            (vec![b.clone()], vec![run]),
            (vec![c], Vec::new()),
        ];
        assert_eq!(gone(&class, std::slice::from_ref(&a), &learnt), [b.clone()]);
        assert!(gone(&class, &[a.clone(), b], &learnt).is_empty());
        assert!(gone(&Verdict::Effect(a.clone()), &[], &learnt).is_empty());
    }
}
