//! What comes closest to the data where nothing explains them.

use calib::attribution::{Finding, Fit, Verdict, at_the_end};
use serde::Serialize;

use crate::catalogue::Effect;
use crate::confirm::figures;

/// An effect at its best strength.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nearest {
    /// Path.
    pub name: String,
    /// Strength.
    pub value: f64,
    /// Whether that is as far as it is looked for: it may be stronger.
    pub at_end: bool,
}

/// The effect, or the two, whose model comes closest to the data.
///
/// It is no name: its model does not explain the data, or is not sure enough to be told from others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Closest {
    /// One effect or two.
    pub effects: Vec<Nearest>,
    /// Free parameters with them: path and value.
    pub at: Vec<(String, f64)>,
    /// Chi-square at the fitted speeds, by what is known of the effects.
    pub chi2: f64,
    /// Its degrees of freedom.
    pub dof: usize,
    /// Its probability.
    pub p: f64,
}

impl Closest {
    /// Of what was fitted, singly or in pairs, the best deviance; none where nothing is missing, or something is named.
    pub(crate) fn of(finding: &Finding, effects: &[Effect]) -> Option<Self> {
        if finding.verdict != Verdict::Unknown {
            return None;
        }
        let single = finding.ranked.iter().filter(|r| r.improvement > 0.0);
        let single = single.map(|r| (&r.fit, vec![(&r.name, r.strength.value)]));
        let pairs = finding.pairs.iter().map(|p| {
            (&p.fit, p.names.iter().zip(&p.strengths).map(|(n, s)| (n, s.value)).collect())
        });
        let all: Vec<(&Fit, Vec<(&String, f64)>)> = single.chain(pairs).collect();
        let (fit, with) = all.into_iter().min_by(|a, b| a.0.deviance.total_cmp(&b.0.deviance))?;
        let nearest = |(name, value): (&String, f64)| {
            let own = effects.iter().find(|e| e.path == *name);
            let at_end = own.is_some_and(|e| e.ends_at(value));
            Nearest { name: name.clone(), value, at_end }
        };
        let free = fit.theta.len() - with.len();
        let at = fit.parameters.iter().cloned().zip(fit.theta.iter().copied()).take(free).collect();
        let effects = with.into_iter().map(nearest).collect();
        Some(Self { effects, at, chi2: fit.chi2, dof: fit.dof, p: fit.p })
    }

    /// The same in words.
    pub fn words(&self) -> String {
        let named = self.effects.iter().map(|e| {
            let end = if e.at_end { " (as far as it is looked for)" } else { "" };
            format!("{} = {}{end}", e.name, figures(e.value))
        });
        let at = self.at.iter().map(|(path, value)| format!("{path} = {}", figures(*value)));
        format!(
            "{}, at {}: chi-square {:.1} with {} degrees of freedom, p = {:.1e}",
            named.collect::<Vec<_>>().join(" and "),
            at.collect::<Vec<_>>().join(", "),
            self.chi2,
            self.dof,
            self.p
        )
    }

    /// Whether one of them may be stronger than it is looked for.
    pub fn ends(&self) -> bool {
        self.effects.iter().any(|e| e.at_end)
    }
}

impl Effect {
    /// Whether a strength stands at an end of its range other than "absent".
    fn ends_at(&self, value: f64) -> bool {
        let [low, high, own, null] =
            [self.range.0, self.range.1, value, self.null].map(|v| self.scale.forth(v));
        let part = |v: f64| (v - low) / (high - low);
        at_the_end(part(own)) && (part(own) - part(null)).abs() > 0.02
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::Scale;

    #[test]
    fn an_end_of_a_range_is_none_where_the_effect_is_absent() {
        let cohesion = Effect { range: (0.0, 1e4), ..Effect::bare("cohesion.energy_density_j_m3") };
        let at = |v: f64| cohesion.ends_at(v);
        assert_eq!([0.0, 100.0, 5e3, 9.9e3, 1e4].map(at), [false, false, false, true, true]);
        let scale = Scale::Log;
        let stiffness = Effect { null: 1.0, range: (0.1, 10.0), scale, ..Effect::bare("a.b") };
        assert_eq!(
            [0.1, 0.104, 1.0, 10.0].map(|v| stiffness.ends_at(v)),
            [true, true, false, true]
        );
    }

    #[test]
    fn what_comes_closest_is_told_in_words() {
        let nearest = |name: &str, value, at_end| Nearest { name: name.to_owned(), value, at_end };
        let closest = Closest {
            effects: vec![
                nearest("cohesion.energy_density_j_m3", 10_074.0, true),
                nearest("fill.scale", 1.184, false),
            ],
            at: vec![("friction.pp".to_owned(), 0.2525)],
            chi2: 55.19,
            dof: 29,
            p: 0.00236,
        };
        assert!(closest.ends());
        assert_eq!(
            closest.words(),
            "cohesion.energy_density_j_m3 = 10074 (as far as it is looked for) and fill.scale = 1.18, at friction.pp = 0.253: chi-square 55.2 with 29 degrees of freedom, p = 2.4e-3"
        );
    }
}
