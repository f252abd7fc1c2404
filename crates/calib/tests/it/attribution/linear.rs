//! A straight line over speed beside a constant: everything has a closed form.

use calib::attribution::{Attribution, Candidate, Layer, Settings, Verdict};
use calib::{
    CalibError, FrameCorrelation, FreeParameter, Observation, Observations, OperatingPoint,
    Predicted, Problem, Simulator, chi_square_p,
};
use rig_schema::Response;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

pub(crate) const SPEEDS: [f64; 7] = [3.0, 5.0, 8.0, 12.0, 17.0, 21.0, 25.0];
const ANGLE: [f64; 7] = [29.1, 29.6, 30.0, 30.2, 30.9, 30.4, 31.3];

/// Standard deviation of every angle.
pub(crate) const SD: f64 = 0.5;

/// Angle = level + slope (omega - 10), the slope a function of the strength; none: no slope.
pub(crate) struct Line(pub(crate) Option<fn(f64) -> f64>);

impl Simulator for Line {
    fn parameters(&self) -> Vec<String> {
        let names = ["level", "slope"].into_iter().take(1 + usize::from(self.0.is_some()));
        names.map(str::to_owned).collect()
    }
    fn speed_range_rpm(&self) -> (f64, f64) {
        (1.0, 30.0)
    }
    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        let slope = self.0.map_or(0.0, |slope| slope(theta[1]));
        let each = at.iter().map(|p| theta[0] + slope * (p.omega_rpm - 10.0));
        let mean = each.flat_map(|angle| [angle; 4]).collect();
        Ok(Predicted { mean, covariance: vec![0.0; 16 * at.len() * at.len()] })
    }
}

/// Whether angles at speeds lie on a constant between 20 and 40 deg, or on a line.
pub(crate) fn question<'s>(
    (base, line): (&'s Line, &'s Line),
    angles: impl Iterator<Item = (f64, f64)>,
    (range, strength_sd): ((f64, f64), Option<f64>),
    settings: Settings,
) -> Attribution<'s> {
    let items = angles.map(|(omega_rpm, mean)| Observation {
        load: 0,
        omega_rpm,
        response: Response::AorLin,
        mean,
        sd: SD,
    });
    let observations = Observations::new(items.collect(), 1.0, FrameCorrelation::Independent);
    Attribution {
        base: Problem {
            observations: observations.expect("is well formed"),
            simulator: base,
            free: vec![FreeParameter { name: "level".to_owned(), range: (20.0, 40.0) }],
            nuisances: Vec::new(),
        },
        candidates: vec![Candidate {
            name: "slope".to_owned(),
            simulator: line,
            null: 0.0,
            range,
            layer: Layer::Physics,
            prior: 1.0,
            strength_sd,
            exposed_by: "more speeds".to_owned(),
            meaning: "a slope".to_owned(),
        }],
        pair_models: Vec::new(),
        code_covariance: None,
        held_out: None,
        experiments: Vec::new(),
        settings,
    }
}

/// Sums of squares and of products of speeds and angles about their means.
fn sums() -> [f64; 3] {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (x, y) = (mean(&SPEEDS), mean(&ANGLE));
    let both = || SPEEDS.iter().zip(ANGLE).map(|(s, a)| (s - x, a - y));
    [
        both().map(|(s, _)| s * s).sum(),
        both().map(|(s, a)| s * a).sum(),
        both().map(|(_, a)| a * a).sum(),
    ]
}

/// The same line, with an error of each angle that grows by so many of its standard deviations for one of the strength
/// above `from`.
struct Vague {
    from: f64,
    growth: f64,
}

impl Vague {
    /// Variance over that of a measured angle.
    fn unknown(&self, slope: f64) -> f64 {
        (self.growth * (slope - self.from).max(0.0)).powi(2)
    }
}

impl Simulator for Vague {
    fn parameters(&self) -> Vec<String> {
        Line(Some(|slope| slope)).parameters()
    }
    fn speed_range_rpm(&self) -> (f64, f64) {
        (1.0, 30.0)
    }
    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        let mut predicted = Line(Some(|slope| slope)).predict(theta, at)?;
        let step = predicted.mean.len() + 1;
        let own = self.unknown(theta[1]) * SD * SD;
        predicted.covariance.iter_mut().step_by(step).for_each(|v| *v = own);
        Ok(predicted)
    }
}

/// A constant that knows that there is a slope, but nothing of it: a standard deviation of 3 deg a rpm.
struct Unsure;

impl Simulator for Unsure {
    fn parameters(&self) -> Vec<String> {
        Line(None).parameters()
    }
    fn speed_range_rpm(&self) -> (f64, f64) {
        (1.0, 30.0)
    }
    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        let mut predicted = Line(None).predict(theta, at)?;
        let n = predicted.mean.len();
        let of = |i: usize| 3.0 * (at[i / 4].omega_rpm - 10.0);
        (0..n * n).for_each(|k| predicted.covariance[k] = of(k / n) * of(k % n));
        Ok(predicted)
    }
}

#[test]
fn what_speeds_that_are_fitted_tell_of_an_error_is_used_at_those_left_out() {
    let (base, line) = (Line(None), Line(Some(|slope| slope)));
    let settings = Settings { stability_bootstrap: 0, ..Settings::default() };
    let angles = SPEEDS.into_iter().zip(ANGLE);
    let mut attribution = question((&base, &line), angles, ((-0.5, 0.5), None), settings);
    attribution.base.simulator = &Unsure;
    let f = attribution.attribute().expect("is well posed");
    let left_out = f.held_out.iter().find(|h| h.kind == "leave one speed out").expect("is there");
    // A straight line through the others misses a speed by its residual over one less its leverage.
    let [sxx, sxy, _] = sums();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / 7.0;
    let (x, y) = (mean(&SPEEDS), mean(&ANGLE));
    let miss = |(s, a): (f64, f64)| {
        let leverage = 1.0 / 7.0 + (s - x).powi(2) / sxx;
        (a - y - sxy / sxx * (s - x)) / (1.0 - leverage)
    };
    let squares: f64 = SPEEDS.into_iter().zip(ANGLE).map(|both| miss(both).powi(2)).sum();
    let expected = (squares / 7.0).sqrt();
    // The slope that is unknown is drawn towards none by (0.5 / 3)^2 of 400 rpm^2.
    let own = &left_out.responses[0];
    assert!((own.before - expected).abs() < 1e-3, "{} {expected}", own.before);
    assert!((own.after - expected).abs() < 1e-6, "{} {expected}", own.after);
}

#[test]
fn errors_whose_size_few_runs_tell_make_the_gate_a_variance_ratio() {
    let (base, line) = (Line(None), Line(Some(|slope| slope)));
    let dof = 8.0;
    let settings = Settings {
        bootstrap: 3999,
        stability_bootstrap: 0,
        errors_dof: Some(dof),
        ..Settings::default()
    };
    let angles = SPEEDS.into_iter().zip(ANGLE);
    let attribution = question((&base, &line), angles, ((-0.5, 0.5), None), settings);
    let gate = attribution.attribute().expect("is well posed").gate;
    // Chi-square over its six degrees of freedom is Fisher's F with six and eight.
    let fisher = FisherSnedecor::new(6.0, dof).expect("is well formed");
    let p = fisher.sf(gate.chi2 / 6.0);
    // Draws may stop early where nothing is seen.
    let draws = gate.draws as f64;
    let sd = (p * (1.0 - p) / draws).sqrt();
    assert!((gate.p_bootstrap - p).abs() < 3.0 * sd + 1.0 / draws, "{} {p}", gate.p_bootstrap);
    // A slope's improvement over what all that is left tells of the variance: one degree of freedom, and 5 and 8.
    let gained = {
        let [sxx, sxy, _] = sums();
        sxy * sxy / sxx / (SD * SD)
    };
    let rest = (dof + gate.chi2 - gained) / (dof + 5.0);
    let one = FisherSnedecor::new(1.0, dof + 5.0).expect("is well formed").sf(gained / rest);
    let sd = (one * (1.0 - one) / draws).sqrt();
    assert!((gate.p_focused - one).abs() < 3.0 * sd + 1.0 / draws, "{} {one}", gate.p_focused);
    // With errors that are known it would be less.
    assert!(gate.p_chi2 < 0.7 * p, "{} {p}", gate.p_chi2);
}

#[test]
fn an_interval_reaches_as_far_as_nothing_is_known() {
    let [sxx, sxy, syy] = sums();
    let (best, rest) = (sxy / sxx, (syy - sxy * sxy / sxx) / (SD * SD));
    let sd = SD / sxx.sqrt();
    // One standard deviation of the slope adds two fifths of an angle's.
    let vague = Vague { from: best, growth: 0.4 / sd };
    let base = Line(None);
    let settings = Settings { stability_bootstrap: 0, ..Settings::default() };
    let angles = SPEEDS.into_iter().zip(ANGLE);
    let mut attribution = question((&base, &base), angles, ((-0.5, 0.5), None), settings);
    attribution.candidates[0].simulator = &vague;
    let strength = attribution.attribute().expect("is well posed").ranked[0].strength;
    assert!((strength.value - best).abs() < 1e-7);
    // Below nothing is unknown: 1.96 standard deviations.
    let down = (best - strength.lo.expect("is inside")) / sd;
    assert!((down / 1.959964 - 1.0).abs() < 0.02, "{down}");
    // Above chi-square is divided by what is unknown, a tenth of whose logarithm counts for each of seven angles;
    // so it ends where algebra says, to a chord of half a standard deviation.
    let hi = strength.hi.expect("is inside");
    let all = 1.0 + vague.unknown(hi);
    let chi2 = (rest + ((hi - best) / sd).powi(2)) / all + 0.1 * 7.0 * all.ln();
    let inflation = (rest / 5.0).max(1.0);
    assert!((chi2 - rest - 3.841459 * inflation).abs() < 0.1, "{chi2} {rest}");
    assert!((hi - best) / sd > 3.0, "{}", (hi - best) / sd);
}

/// A line beside which something else was measured, of this deviance.
struct Beside(Line, f64);

impl Simulator for Beside {
    fn parameters(&self) -> Vec<String> {
        self.0.parameters()
    }
    fn speed_range_rpm(&self) -> (f64, f64) {
        self.0.speed_range_rpm()
    }
    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        self.0.predict(theta, at)
    }
    fn aside(&self, _: &[f64]) -> Result<Option<f64>, CalibError> {
        Ok(Some(self.1))
    }
}

#[test]
fn what_is_measured_besides_ranks_effects_that_fit_alike_and_refutes_those_it_contradicts() {
    let line = |aside: f64| Beside(Line(Some(|slope| slope)), aside);
    let (base, first) = (Beside(Line(None), 10.0), line(7.0));
    let plain = Line(None);
    // Two equal lines; of the second something besides deviates by 5, 7, and 18 more, which is 15 more than without either.
    for (more, in_class, refuted) in [(5.0, true, false), (7.0, false, false), (18.0, false, true)]
    {
        let rival = line(7.0 + more);
        let settings = Settings { stability_bootstrap: 0, ..Settings::default() };
        let angles = SPEEDS.into_iter().zip(ANGLE);
        let mut all = question((&plain, &plain), angles, ((-0.5, 0.5), None), settings);
        all.base.simulator = &base;
        all.candidates[0].simulator = &first;
        let second =
            Candidate { name: "rival".to_owned(), simulator: &rival, ..all.candidates[0].clone() };
        all.candidates.push(second);
        let f = all.attribute().expect("is well posed");
        let [slope, other] = [&f.ranked[0], &f.ranked[1]];
        assert_eq!((&slope.name[..], &other.name[..]), ("slope", "rival"));
        assert_eq!((slope.aside, other.aside), (-3.0, more - 3.0));
        // Nothing of it enters fits and tests.
        assert_eq!((slope.fit.deviance, slope.p_family), (other.fit.deviance, other.p_family));
        assert!((slope.evidence / other.evidence / (0.5 * more).exp() - 1.0).abs() < 1e-9);
        assert_eq!(other.objections.iter().any(|o| o.contains("besides")), refuted);
        assert_eq!(matches!(&f.verdict, Verdict::Class(c) if c.len() == 2), in_class);
        assert_eq!(f.verdict == Verdict::Effect("slope".to_owned()), !in_class);
    }
}

#[test]
fn an_effect_that_asks_for_a_friction_beyond_its_range_is_not_named() {
    let (base, line) = (Line(None), Line(Some(|slope| slope)));
    let [sxx, sxy, _] = sums();
    let n = SPEEDS.len() as f64;
    let (x, y) = (SPEEDS.iter().sum::<f64>() / n, ANGLE.iter().sum::<f64>() / n);
    // The line's height at 10 rpm, and its standard deviation where the slope is free.
    let height = y + sxy / sxx * (10.0 - x);
    let sd = SD * (1.0 / n + (10.0 - x).powi(2) / sxx).sqrt();
    // Chi-square would fall by 3.9 and 4.1 without that end.
    for (fall, refused) in [(3.9_f64, false), (4.1, true)] {
        for side in [1.0, -1.0] {
            let settings = Settings { stability_bootstrap: 0, ..Settings::default() };
            let angles = SPEEDS.into_iter().zip(ANGLE);
            let mut all = question((&base, &line), angles, ((-0.5, 0.5), None), settings);
            let end = height - side * fall.sqrt() * sd;
            all.base.free[0].range = if side > 0.0 { (20.0, end) } else { (end, 40.0) };
            let f = all.attribute().expect("is well posed");
            assert!((f.ranked[0].fit.theta[0] - end).abs() < 1e-9);
            let beyond = f.ranked[0].objections.iter().any(|o| o.contains("level beyond"));
            assert_eq!(beyond, refused, "{fall} {side}: {:?}", f.ranked[0].objections);
        }
    }
}

#[test]
fn what_is_known_less_does_not_leave_a_class_for_that() {
    let (base, line) = (Line(None), Line(Some(|slope| slope)));
    // The same line, of which each angle has three more standard deviations that nobody has simulated away; or a tenth.
    let [sxx, sxy, syy] = sums();
    let (best, rest) = (sxy / sxx, (syy - sxy * sxy / sxx) / (SD * SD));
    let vague = |sds: f64| Vague { from: best - 1.0, growth: sds };
    let (hardly, little) = (vague(3.0), vague(0.1));
    let ask = |rival: &Vague| {
        let settings = Settings { stability_bootstrap: 0, ..Settings::default() };
        let angles = SPEEDS.into_iter().zip(ANGLE);
        let mut all = question((&base, &line), angles, ((-0.5, 0.5), None), settings);
        let second =
            Candidate { name: "vague".to_owned(), simulator: rival, ..all.candidates[0].clone() };
        all.candidates.push(second);
        all.attribute().expect("is well posed")
    };
    for (rival, apart) in [(&hardly, true), (&little, false)] {
        let f = ask(rival);
        let both = Verdict::Class(vec!["slope".to_owned(), "vague".to_owned()]);
        let [first, second] = [0, 1].map(|k| f.ranked[k].fit.deviance);
        // Its variance goes up: chi-square is divided by it, its logarithm is charged; the fit may move a little.
        let all = 1.0 + rival.unknown(best);
        let expected = rest * (1.0 / all - 1.0) + 7.0 * all.ln();
        assert!((second - first - expected).abs() < 0.6, "{} {expected}", second - first);
        // By the whole of it, beyond the ratio of twenty: 6.0.
        assert_eq!(second - first > 6.0, apart);
        assert_eq!(f.verdict, both);
    }
}

#[test]
fn a_line_is_found_with_the_numbers_of_algebra() {
    let (base, line) = (Line(None), Line(Some(|slope| slope)));
    let settings = Settings { bootstrap: 1999, stability_bootstrap: 0, ..Settings::default() };
    let angles = SPEEDS.into_iter().zip(ANGLE);
    let attribution = question((&base, &line), angles, ((-0.5, 0.5), None), settings);
    let f = attribution.attribute().expect("is well posed");
    let [sxx, sxy, syy] = sums();
    let gained = sxy * sxy / sxx / (SD * SD);
    let r = &f.ranked[0];
    assert!((f.gate.chi2 - syy / (SD * SD)).abs() < 1e-7);
    assert!((r.strength.value - sxy / sxx).abs() < 1e-7);
    assert!((r.improvement - gained).abs() < 1e-6, "{} {gained}", r.improvement);
    assert!((f.base.sd[0].expect("is inside") - SD / 7_f64.sqrt()).abs() < 1e-6);
    // Interval +-1.96 sd; the profile is sampled at half sd, a chord of a parabola misses its
    // crossing by less than 2 % of it.
    let sd = SD / sxx.sqrt();
    let half = r.strength.hi.expect("is inside") - r.strength.value;
    assert!((half / (1.959964 * sd) - 1.0).abs() < 0.02, "{half}");
    // Bootstrap p against chi-square with one degree of freedom: 3 sd of 1999 draws.
    let p = chi_square_p(gained, 1);
    assert!(
        (r.p_single - p).abs() < 3.0 * (p / 2000.0).sqrt() + 1.0 / 2000.0,
        "{} {p}",
        r.p_single
    );
    assert_eq!(f.verdict, Verdict::Effect("slope".to_owned()));
    // Bayes factor: gain of the likelihood times posterior volume of the slope over its range.
    let exact = 0.5 * gained + 0.5 * std::f64::consts::TAU.ln() + sd.ln() - 1.0_f64.ln();
    let log =
        |name: &str| f.evidence.iter().find(|e| e.name == name).expect("is listed").log_likelihood;
    let found = log("slope") - log("none");
    // The trapezium over half sd and the bounded volume leave less than 0.02.
    assert!((found - exact).abs() < 0.02, "{found} {exact}");
    // Non-centrality of a slope s is s^2 sxx / sd^2: the detectable one needs the root of the
    // critical improvement plus the 90 % point of the normal.
    let up = f.detectable.iter().find(|d| d.towards > 0.0).expect("is listed");
    let down = f.detectable.iter().find(|d| d.towards < 0.0).expect("is listed");
    let s = up.strength.expect("is within the range");
    assert!((s + down.strength.expect("is within the range")).abs() < 1e-3);
    // Critical z between that of the level for one test and for two independent ones.
    let z = s / sd - 1.281552;
    assert!((2.4..2.9).contains(&z), "{z}");
}
