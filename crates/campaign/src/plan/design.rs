//! The points of a plan: which values the factors take in each run.

use doe::Factor;
use doe::design::{LatinHypercube, full_factorial, latin_hypercube};
use rig_schema::{DesignKind, Plan, PlanFactor};

use crate::CampaignError;

/// The path by which rotation speed is a factor.
pub const SPEED: &str = "run.speed_rpm";

/// The factors of a plan, sorted by path, and their values in each run.
///
/// A full factorial takes every combination of levels, the first factor changing fastest, then the
/// centre (the middle between the lowest and the highest level) as often as asked. A Latin
/// hypercube takes its seed from the rig.
///
/// # Errors
/// [`CampaignError::Design`] for plans that are too large or too small.
pub fn points(plan: &Plan) -> Result<(Vec<PlanFactor>, Vec<Vec<f64>>), CampaignError> {
    let mut factors = plan.factors.clone();
    factors.sort_by(|a, b| a.path.cmp(&b.path));
    let ends = |f: &PlanFactor| {
        let (low, high) = (f.levels.first().copied(), f.levels.last().copied());
        Factor::new(&f.path, low.unwrap_or(f64::NAN), high.unwrap_or(f64::NAN))
    };
    let ranges: Vec<Factor> = factors.iter().map(ends).collect::<Result<_, _>>()?;
    let rows = match plan.design {
        DesignKind::LatinHypercube { runs } => {
            let how = LatinHypercube::new(runs as usize, plan.rig.run.seed);
            latin_hypercube(&ranges, &how)?.points
        }
        DesignKind::FullFactorial { centre_points } => {
            // Levels need not be evenly spaced: the design is made of their numbers.
            let numbers: Vec<Factor> = factors
                .iter()
                .map(|f| Factor::new(&f.path, 0.0, (f.levels.len() as f64) - 1.0))
                .collect::<Result<_, _>>()?;
            let counts: Vec<usize> = factors.iter().map(|f| f.levels.len()).collect();
            let level =
                |(number, f): (&f64, &PlanFactor)| f.levels.get(number.round() as usize).copied();
            let mut rows: Vec<Vec<f64>> = full_factorial(&numbers, &counts)?
                .points
                .iter()
                .map(|p| p.iter().zip(&factors).filter_map(level).collect())
                .collect();
            // The centre of the ranges, as the design of experiments counts it.
            let centre = full_factorial(&ranges, &vec![2; ranges.len()])?
                .with_centre_points(centre_points as usize)
                .points;
            rows.extend(centre.into_iter().skip(1 << ranges.len()));
            rows
        }
    };
    Ok((factors, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(factors: &str, design: &str) -> Plan {
        let text = format!(
            r#"
name = "beads"
design.{design}
drum = {{ radius_m = 0.02, length_m = 0.02, mantle = "glass", end_plates = "glass" }}
particles = {{ material = "glass", shape = {{ sphere = {{ diameter_m = 0.004 }} }} }}
fill.count = 90
run = {{ speeds_rpm = [60.0], seed = 3 }}
[factors]
{factors}
[materials]
glass = {{ density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e6 }}
"#
        );
        Plan::parse("plan.toml", &text).unwrap()
    }

    #[test]
    fn a_factorial_takes_the_levels_as_they_are_and_its_centres_last() {
        let plan = plan(
            "run.speed_rpm = [4.0, 17.0, 30.0]\nfriction.pp = [0.1, 0.2, 0.9]",
            "full_factorial = { centre_points = 2 }",
        );
        let (factors, rows) = points(&plan).unwrap();
        let paths: Vec<&str> = factors.iter().map(|f| f.path.as_str()).collect();
        assert_eq!(paths, ["friction.pp", SPEED], "sorted by path");
        assert_eq!(rows.len(), 9 + 2);
        assert_eq!(rows[..4], [[0.1, 4.0], [0.2, 4.0], [0.9, 4.0], [0.1, 17.0]]);
        assert_eq!(rows[9..], [[0.5, 17.0], [0.5, 17.0]]);
    }

    #[test]
    fn a_hypercube_takes_the_rigs_seed() {
        let text = "friction.pp = [0.1, 0.9]\nfriction.mantle = [0.2, 0.8]";
        let mut plan = plan(text, "latin_hypercube = { runs = 8 }");
        let (_, rows) = points(&plan).unwrap();
        assert_eq!(rows.len(), 8);
        assert_eq!(rows, points(&plan).unwrap().1);
        plan.rig.run.seed = 4;
        assert_ne!(rows, points(&plan).unwrap().1);
        // One run in each eighth of each range.
        for factor in 0..2 {
            let (low, width) = [(0.2, 0.6), (0.1, 0.8)][factor];
            let mut slices: Vec<u32> =
                rows.iter().map(|r| ((r[factor] - low) / width * 8.0) as u32).collect();
            slices.sort_unstable();
            assert_eq!(slices, [0, 1, 2, 3, 4, 5, 6, 7]);
        }
    }
}
