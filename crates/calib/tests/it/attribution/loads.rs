//! Two effects that do the same to one load of a drum and not to another.

use calib::attribution::{Attribution, Candidate, Layer, Settings, Verdict};
use calib::{
    CalibError, FrameCorrelation, FreeParameter, Observation, Observations, OperatingPoint,
    Predicted, Problem, Simulator,
};
use rig_schema::Response;

const SPEEDS: [f64; 7] = [4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0];
const SD: f64 = 0.5;

/// Angle = level + strength (omega - 16) / 10, with the other load times this; none: the level alone.
struct Bed(Option<f64>);

impl Simulator for Bed {
    fn parameters(&self) -> Vec<String> {
        let names = ["level", "strength"].into_iter().take(1 + usize::from(self.0.is_some()));
        names.map(str::to_owned).collect()
    }
    fn speed_range_rpm(&self) -> (f64, f64) {
        (1.0, 30.0)
    }
    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        let angle = |p: &OperatingPoint| {
            let strength = self.0.map_or(0.0, |other| theta[1] * [1.0, other][p.load]);
            theta[0] + strength * (p.omega_rpm - 16.0) / 10.0
        };
        let mean = at.iter().flat_map(|p| [angle(p); 4]).collect();
        Ok(Predicted { mean, covariance: vec![0.0; 16 * at.len() * at.len()] })
    }
}

/// What is missing if a drum with `loads` loads has the effect that acts on all of them alike, by two standard deviations a
/// decade of speed.
fn verdict(loads: usize) -> Verdict {
    let (base, alike, opposite) = (Bed(None), Bed(Some(1.0)), Bed(Some(-1.0)));
    let points =
        (0..loads).flat_map(|load| SPEEDS.map(|omega_rpm| OperatingPoint { load, omega_rpm }));
    let points: Vec<OperatingPoint> = points.collect();
    let truth = alike.predict(&[30.0, 2.0], &points).expect("is well formed").mean;
    let item = |(k, p): (usize, &OperatingPoint)| Observation {
        load: p.load,
        omega_rpm: p.omega_rpm,
        response: Response::AorLin,
        mean: truth[4 * k] + SD * if k % 2 == 0 { 0.6 } else { -0.6 },
        sd: SD,
    };
    let items = points.iter().enumerate().map(item).collect();
    let observations = Observations::new(items, 1.0, FrameCorrelation::Independent);
    let effects: [(&str, &dyn Simulator); 2] = [("alike", &alike), ("opposite", &opposite)];
    let candidate = |(name, simulator): (&str, _)| Candidate {
        name: name.to_owned(),
        simulator,
        null: 0.0,
        range: (-5.0, 5.0),
        layer: Layer::Physics,
        prior: 1.0,
        strength_sd: None,
        exposed_by: "another load".to_owned(),
        meaning: String::new(),
    };
    let asked = Attribution {
        base: Problem {
            observations: observations.expect("is well formed"),
            simulator: &base,
            free: vec![FreeParameter { name: "level".to_owned(), range: (20.0, 40.0) }],
            nuisances: Vec::new(),
        },
        candidates: effects.map(candidate).to_vec(),
        pair_models: Vec::new(),
        code_covariance: None,
        held_out: None,
        experiments: Vec::new(),
        settings: Settings { stability_bootstrap: 0, ..Settings::default() },
    };
    asked.attribute().expect("can be answered").verdict
}

#[test]
fn a_second_load_tells_apart_what_one_cannot() {
    let Verdict::Class(names) = verdict(1) else { panic!("told apart by one load") };
    assert_eq!(names.len(), 2);
    assert_eq!(verdict(2), Verdict::Effect("alike".to_owned()));
}

#[test]
fn points_are_those_of_their_load() {
    let table = "omega_rpm,aor_lin_deg,aor_lin_sd\n10,30,1\n20,31,1\n";
    let table = rig_schema::MeasuredTable::parse("m.csv", table).expect("is well formed");
    let of = |load| {
        let range = (0.0, 100.0);
        let all = Observations::from_table(&table, range, 4.0, FrameCorrelation::Independent);
        all.expect("is well formed").0.with_load(load)
    };
    let both = of(1).followed_by(&of(0));
    let (points, places) = both.places();
    assert_eq!(places, [8, 12, 0, 4]);
    assert_eq!(points.iter().map(ToString::to_string).collect::<Vec<_>>()[2], "10 rpm with load 2");
    // One speed, two beds: nothing of their scatter is common.
    assert_eq!((both.covariance(0, 2), both.covariance(0, 0)), (0.0, 0.25));
    assert_eq!(both.speeds_rpm(), [10.0, 20.0]);
}
