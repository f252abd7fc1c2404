//! How far effects are looked for, where the case says so.

use std::collections::BTreeMap;

use super::{Catalogue, Effect};
use crate::error::CloseLoopError;
use crate::scale::Scale;

impl Catalogue {
    /// Look for effects as far as a case says: path, lowest and highest strength.
    ///
    /// Strengths that are simulated first and lie beyond an end come to lie at it, or half-way to it.
    ///
    /// # Errors
    /// [`CloseLoopError::Range`] where the path is no effect of the catalogue, or the range does not hold the rig's own value.
    pub fn over(mut self, ranges: &BTreeMap<String, (f64, f64)>) -> Result<Self, CloseLoopError> {
        for (path, range) in ranges {
            let wrong = |why: String| CloseLoopError::Range {
                path: path.clone(),
                low: range.0,
                high: range.1,
                why,
            };
            let Some(effect) = self.effects.iter_mut().find(|e| e.path == *path) else {
                let why = self.left_out.iter().find(|(p, _)| p == path).map(|(_, why)| why);
                let why = why.map_or_else(
                    || "it is no effect of the catalogue".to_owned(),
                    |why| format!("the effect is left out, since {why}"),
                );
                return Err(wrong(why));
            };
            effect.look_over(*range).map_err(wrong)?;
        }
        Ok(self)
    }
}

impl Effect {
    fn look_over(&mut self, (low, high): (f64, f64)) -> Result<(), String> {
        let null = self.null;
        if !(low <= null && null <= high && low < high) {
            return Err(format!("expected a range about the rig's own value, {null}"));
        }
        if low <= 0.0 && self.scale == Scale::Log {
            return Err("expected a range above 0, since it acts by factors".to_owned());
        }
        self.range = (low, high);
        let off = |x: f64| (self.scale.forth(x) - self.scale.forth(null)).abs();
        let [mut weaker, mut stronger] = self.probes.map(|p| p.clamp(low, high));
        // The rig's own value tells nothing of the effect, one strength twice little.
        if stronger == null {
            stronger = if off(high) >= off(low) { high } else { low };
        }
        if weaker == null || weaker == stronger {
            weaker = self.scale.half_way(null, stronger);
        }
        self.probes = [weaker, stronger];
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over(
        (null, probes, scale): (f64, [f64; 2], Scale),
        range: (f64, f64),
    ) -> Result<Effect, CloseLoopError> {
        let effect = Effect { null, probes, scale, ..Effect::bare("cohesion.energy_density_j_m3") };
        let all = Catalogue {
            effects: vec![effect],
            left_out: vec![("friction.end_plate".to_owned(), "the ends are periodic".to_owned())],
        };
        let asked = BTreeMap::from([("cohesion.energy_density_j_m3".to_owned(), range)]);
        Ok(all.over(&asked)?.effects.remove(0))
    }

    #[test]
    fn an_effect_is_looked_for_as_far_as_the_case_says() {
        let cohesion = (0.0, [1000.0, 2700.0], Scale::Linear);
        let wide = over(cohesion, (0.0, 20_000.0)).expect("holds 0");
        assert_eq!((wide.range, wide.probes), ((0.0, 20_000.0), cohesion.1));
        let narrow = over(cohesion, (0.0, 800.0)).expect("holds 0");
        assert_eq!((narrow.range, narrow.probes), ((0.0, 800.0), [400.0, 800.0]));
        // A speed to either side, of which one is known not to be.
        let speed = (1.0, [0.8, 1.25], Scale::Linear);
        assert_eq!(over(speed, (1.0, 1.5)).expect("holds 1").probes, [1.125, 1.25]);
        assert_eq!(over(speed, (0.5, 1.0)).expect("holds 1").probes, [0.8, 0.5]);
        let stiffness = (1.0, [0.3, 3.0], Scale::Log);
        let soft = over(stiffness, (0.25, 1.0)).expect("holds 1").probes;
        assert!((soft[0] - 0.3).abs() < 1e-12 && (soft[1] - 0.25).abs() < 1e-12, "{soft:?}");
    }

    #[test]
    fn ranges_without_the_rigs_own_value_and_of_no_effect_are_refused() {
        let message = |of, range| over(of, range).err().map(|e| e.to_string()).unwrap_or_default();
        let off = message((0.0, [1e3, 2e3], Scale::Linear), (500.0, 2000.0));
        assert!(off.contains("the rig's own value, 0"), "{off}");
        let zero = message((1.0, [0.3, 3.0], Scale::Log), (0.0, 3.0));
        assert!(zero.contains("above 0"), "{zero}");
        let left = vec![("friction.end_plate".to_owned(), "the ends are periodic".to_owned())];
        let none = Catalogue { effects: Vec::new(), left_out: left };
        for (path, why) in
            [("friction.end_plate", "since the ends are periodic"), ("a.b", "no effect")]
        {
            let asked = BTreeMap::from([(path.to_owned(), (0.0, 1.0))]);
            let error = none.clone().over(&asked).expect_err("is not there").to_string();
            assert!(error.contains(path) && error.contains(why), "{error}");
        }
    }
}
