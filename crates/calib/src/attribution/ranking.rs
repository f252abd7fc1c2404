//! Which effect explains the data: every candidate fitted and judged, then pairs.
//!
//! A candidate is named if the model with it passes the absolute gate, if its improvement is
//! more than the best of the catalogue reaches by chance, and if speeds left out agree. Those
//! that explain the data as well within a stated likelihood ratio join its class whether or not
//! their own improvement is significant, whatever layer they act on.

use super::data::Data;
use super::evidence::IGNORANCE;
use super::gate::{Case, Screen};
use super::held_out::{Compared, predict};
use super::linear::{dot, orthonormal, without};
use super::model::Model;
use super::pairs::{are_named, fit_pairs};
use super::solver::{Settled, optima};
use super::{Layer, Verdict};
use crate::covariance::square;
use crate::{CalibError, chi_square_p};

/// Least number of speeds at which leaving one out says something of speeds.
const LEAST_SPEEDS: usize = 3;

/// Frictions, as parts of their ranges, from which a model with one effect is fitted as well.
const OTHER_FRICTIONS: [f64; 3] = [0.15, 0.45, 0.75];

/// Deviance of what was measured besides the observations, less that from the base, above which an effect is contradicted:
/// it makes that a thousand times less likely.
const CONTRADICTED: f64 = 13.8;

/// Least number of speeds at which both ends can be left out.
const LEAST_FOR_ENDS: usize = 5;

/// Whether a strength at this part of its range stands at an end of it, within 2 %. Of a reading or of a
/// camera what stands there is no name ([`Ranked::objections`](super::Ranked)).
pub fn at_the_end(part: f64) -> bool {
    !(0.02..=0.98).contains(&part)
}

/// Whether a fit left a parameter, as a part of its range, between the ends.
fn can_move(part: f64) -> bool {
    part > 1e-6 && part < 1.0 - 1e-6
}

/// Fall of chi-square beyond the end of a friction's range from which a model is refused: where the truth lies at that end it is
/// larger in one of 44 cases.
const PULL: f64 = 4.0;

/// Training data of each fold, and the same followed by its test data.
pub(super) struct Folds {
    pub(super) kind: &'static str,
    pub(super) folds: Vec<(Data, Data)>,
}

impl Folds {
    /// One speed left out; both ends left out; the set that is never fitted.
    pub(super) fn all(case: &Case<'_, '_>) -> Vec<Self> {
        let o = &case.observations;
        let speeds = o.speeds_rpm();
        let most = case.base.len() + 1;
        let split = |aside: &dyn Fn(f64) -> bool| {
            let train = o.filter(|x| !aside(x.omega_rpm));
            let test = o.filter(|x| aside(x.omega_rpm));
            (train.items.len() > most && !test.items.is_empty())
                .then(|| (case.prepare(&train), case.prepare(&train.followed_by(&test))))
        };
        let mut sets = Vec::new();
        if speeds.len() >= LEAST_SPEEDS {
            let folds = speeds.iter().filter_map(|s| split(&|x| x == *s)).collect();
            sets.push(Self { kind: "leave one speed out", folds });
        }
        if speeds.len() >= LEAST_FOR_ENDS {
            let ends = (speeds[0], speeds[speeds.len() - 1]);
            let folds = split(&|x| x == ends.0 || x == ends.1).into_iter().collect();
            sets.push(Self { kind: "both ends", folds });
        }
        if let Some(given) = case.attribution.held_out.as_ref().filter(|g| !g.items.is_empty()) {
            let folds = vec![(case.prepare(o), case.prepare(&o.followed_by(given)))];
            sets.push(Self { kind: "given set", folds });
        }
        sets.retain(|s| !s.folds.is_empty());
        sets
    }

    /// Predictions of all folds by the base and by `model`, fitted near the fits given.
    pub(super) fn compare(
        &self,
        base: (&Model<'_>, &Settled),
        model: (&Model<'_>, &Settled),
    ) -> Result<Compared, CalibError> {
        let mut compared = Compared { folds: self.folds.len(), ..Compared::default() };
        for (train, all) in &self.folds {
            let start = [base.1.point.unit.clone()];
            compared.before.extend(predict(base.0, train, all, &start)?.points);
            let mut starts = vec![model.1.point.unit.clone()];
            starts.push(model.0.unit(&model.0.absent(&base.1.theta)));
            let after = predict(model.0, train, all, &starts)?;
            compared.after.extend(after.points);
            compared.chi2 += after.chi2;
        }
        Ok(compared)
    }
}

/// One model judged.
pub(super) struct Judged<'s> {
    /// Candidates: one or two.
    pub(super) of: Vec<usize>,
    pub(super) model: Model<'s>,
    pub(super) fit: Settled,
    /// Squared strengths in units of their prior standard deviations.
    pub(super) penalty: f64,
    /// Deviance of what was measured besides the observations, less that from the base.
    pub(super) aside: f64,
    pub(super) p_absolute: f64,
    pub(super) p_single: f64,
    pub(super) p_family: f64,
    pub(super) gain: Option<f64>,
    /// Squared error at both ends left out, in squared standard deviations of the prediction.
    pub(super) at_ends: Option<f64>,
    pub(super) worsens: Vec<&'static str>,
    pub(super) objections: Vec<String>,
    /// Whether it can be in a class: objections to its significance aside.
    pub(super) explains: bool,
    pub(super) eligible: bool,
}

impl Judged<'_> {
    /// Deviance of the fit, of what was measured besides, and what its strengths cost by their priors.
    pub(super) fn deviance(&self) -> f64 {
        self.fit.deviance() + self.aside + self.penalty
    }

    /// By how much more it deviates than `other`; what is less known of it than of that counts for little, so that nothing
    /// leaves a class for want of runs.
    fn behind(&self, other: &Judged<'_>) -> f64 {
        let all = self.deviance() - other.deviance();
        let ignorance = self.fit.weight.log_det - other.fit.weight.log_det;
        all - (1.0 - IGNORANCE) * ignorance.max(0.0)
    }

    /// Whether it is an effect of reading or of the camera at an end of its range. That range is what
    /// photographs would show, so what stands there would go on beyond: it stands for something else.
    fn reads_wrong(&self, case: &Case<'_, '_>) -> bool {
        let reading = |k: &usize| {
            let layer = case.attribution.candidates[*k].layer;
            matches!(layer, Layer::Camera | Layer::Measurement)
        };
        let unit = self.fit.point.unit[self.model.frictions()];
        self.of.first().is_some_and(reading) && at_the_end(unit)
    }

    /// The friction that would go on beyond an end of its range if it could, and chi-square fall by more than [`PULL`].
    ///
    /// By the derivatives at that end: `(c r)^2 / c' c'` for residuals r and the part c' of the derivative c along it that no
    /// parameter within its range can make up for.
    fn pulled_out(&self) -> Option<&str> {
        let point = &self.fit.point;
        let both = point.columns.iter().zip(&point.unit);
        let free = orthonormal(both.filter(|(_, u)| can_move(**u)).map(|(c, _)| c));
        let pulled = |k: &usize| {
            let (unit, column) = (point.unit[*k], &point.columns[*k]);
            let along = dot(column, &self.fit.white) * if unit < 0.5 { -1.0 } else { 1.0 };
            let own = square(&without(column, &free));
            !can_move(unit) && along > 0.0 && along * along > PULL * own
        };
        let found = (0..self.model.frictions()).find(pulled)?;
        self.model.parameters.get(found).map(String::as_str)
    }

    /// Whether no strength is absent, and neither a strength nor a friction at an end of its range.
    pub(super) fn inside(&self) -> bool {
        self.fit.point.unit.iter().all(|u| can_move(*u))
    }

    /// Held-out errors against the base: the gain at one speed left out (else of the given set). A set of
    /// three speeds or more is judged of itself; fewer, given beside speeds left out, only together with
    /// them: the noise of one alone would refuse every third true effect that is weak.
    pub(super) fn judge_held_out(
        &mut self,
        case: &Case<'_, '_>,
        base: &Settled,
        folds: &[Folds],
    ) -> Result<(), CalibError> {
        let mut all = Compared::default();
        for set in folds {
            let compared = set.compare((&case.base, base), (&self.model, &self.fit))?;
            if set.kind == "both ends" {
                self.at_ends = compared.surprise();
                let n = compared.after.len();
                let p = self.at_ends.map_or(1.0, |a| chi_square_p(a * n as f64, n));
                if !(p > case.attribution.settings.level) {
                    self.objections.push(format!("does not carry over to both ends (p {p:.1e})"));
                    self.explains = false;
                }
                continue;
            }
            self.gain = self.gain.or(compared.gain());
            let of_itself = compared.speeds() >= LEAST_SPEEDS;
            all.join(compared.clone());
            let judged = if of_itself { &compared } else { &all };
            if judged.gain().is_some_and(|g| !(g > 0.0)) {
                self.objections.push(format!("no better at held-out speeds ({})", set.kind));
                self.explains = false;
            }
            for r in judged.worsened() {
                if !self.worsens.contains(&r.column()) {
                    self.worsens.push(r.column());
                }
            }
        }
        if !self.worsens.is_empty() {
            self.objections.push(format!(
                "worsens {} at held-out speeds by more than one standard deviation",
                self.worsens.join(", ")
            ));
            self.explains = false;
        }
        Ok(())
    }
}

/// Everything that was judged, best deviance first.
pub(super) struct Decision<'s> {
    pub(super) singles: Vec<Judged<'s>>,
    pub(super) pairs: Vec<Judged<'s>>,
    pub(super) folds: Vec<Folds>,
    pub(super) verdict: Verdict,
}

/// Fit and judge the candidates; pairs too if `with_pairs` or if no single one will do.
pub(super) fn decide<'s>(
    case: &Case<'_, 's>,
    screen: &Screen,
    with_pairs: bool,
) -> Result<Decision<'s>, CalibError> {
    let settings = &case.attribution.settings;
    let level = settings.level;
    let folds = Folds::all(case);
    let base = &screen.base;
    let mut singles = Vec::new();
    for (k, model) in case.singles.iter().enumerate() {
        let mut judged = fit(case, model, &[k], base)?;
        let better = base.deviance() - (judged.deviance() - judged.aside);
        (judged.p_single, judged.p_family) = screen.p_values(k, better);
        if !(judged.p_absolute > level) {
            judged.objections.push(format!("does not fit (p {:.2e})", judged.p_absolute));
            judged.explains = false;
        }
        if judged.aside > CONTRADICTED {
            let why =
                "what was measured besides the responses is as without it, and not as with it";
            judged.objections.push(why.to_owned());
            judged.explains = false;
        }
        if judged.reads_wrong(case) {
            let why = "only at the end of its range, where photographs would show it";
            judged.objections.push(why.to_owned());
            judged.explains = false;
        }
        if let Some(friction) = judged.pulled_out() {
            let why = format!("would have {friction} beyond the range that is given for it");
            judged.objections.push(why);
            judged.explains = false;
        }
        judged.judge_held_out(case, base, &folds)?;
        let significant = judged.p_family <= level;
        if !significant {
            let p = judged.p_family;
            judged.objections.push(format!("its improvement may be chance (p {p:.3})"));
        }
        judged.eligible = judged.explains && significant;
        singles.push(judged);
    }
    sort(&mut singles);
    let name = |k: usize| case.attribution.candidates[k].name.clone();
    let few = (settings.few_members, settings.few_ratio);
    let class = class_of(&singles, settings.class_ratio, few, |a, b| a.behind(b));
    let mut pairs = Vec::new();
    let verdict = if screen.gate.passes {
        Verdict::None
    } else if class.len() == 1 {
        Verdict::Effect(name(singles[class[0]].of[0]))
    } else if class.len() > 1 {
        Verdict::Class(class.iter().map(|i| name(singles[*i].of[0])).collect())
    } else {
        pairs = fit_pairs(case, base, &singles, &folds)?;
        // There are so many that some fit for want of runs: these are charged for it.
        let charged = |a: &Judged<'_>, b: &Judged<'_>| a.deviance() - b.deviance();
        let class = class_of(&pairs, settings.class_ratio, (0, 1.0), charged);
        let members: Vec<&[usize]> = class.iter().map(|i| &pairs[*i].of[..]).collect();
        if are_named(&members, settings.most_pairs) {
            let both = |i: &usize| [name(pairs[*i].of[0]), name(pairs[*i].of[1])];
            Verdict::Pairs(class.iter().map(both).collect())
        } else {
            Verdict::Unknown
        }
    };
    if with_pairs && pairs.is_empty() {
        pairs = fit_pairs(case, base, &singles, &folds)?;
    }
    Ok(Decision { singles, pairs, folds, verdict })
}

pub(super) fn sort(judged: &mut [Judged<'_>]) {
    judged.sort_by(|a, b| a.deviance().total_cmp(&b.deviance()));
}

/// The best that is eligible, and those that explain the data as well: within the ratio of it by how far they are
/// `behind`, and of these no more than hold all but one part in `ratio` of the likelihood together. As long as these are
/// fewer than `few.0` those within the ratio `few.1` count as well.
fn class_of(
    judged: &[Judged<'_>],
    ratio: f64,
    few: (usize, f64),
    behind: impl Fn(&Judged<'_>, &Judged<'_>) -> f64,
) -> Vec<usize> {
    let Some(winner) = judged.iter().position(|j| j.eligible) else { return Vec::new() };
    let mut all: Vec<usize> = (0..judged.len()).filter(|i| judged[*i].explains).collect();
    all.sort_by_key(|i| (*i != winner, *i));
    let likelihood = |i: &usize| (-0.5 * behind(&judged[*i], &judged[winner])).exp();
    let likelihoods: Vec<f64> = all.iter().map(likelihood).collect();
    members(&likelihoods, ratio, few).into_iter().map(|k| all[k]).collect()
}

/// Places of a class's members, likelihoods of all in order.
fn members(likelihoods: &[f64], ratio: f64, few: (usize, f64)) -> Vec<usize> {
    let within =
        |ratio: f64| (0..likelihoods.len()).filter(move |k| likelihoods[*k] * ratio >= 1.0);
    let close: Vec<f64> = within(ratio).map(|k| likelihoods[k]).collect();
    let mut class: Vec<usize> = within(ratio).take(holding(&close, ratio)).collect();
    for other in within(few.1) {
        if class.len() < few.0 && !class.contains(&other) {
            class.push(other);
        }
    }
    class
}

/// How many, in the order given, hold all but one part in `ratio` of the sum.
fn holding(likelihoods: &[f64], ratio: f64) -> usize {
    let wanted = (1.0 - 1.0 / ratio) * likelihoods.iter().sum::<f64>();
    let mut held = 0.0;
    let enough = likelihoods.iter().position(|l| {
        held += l;
        held >= wanted
    });
    enough.map_or(likelihoods.len(), |k| k + 1)
}

/// Best fit of a model of the candidates `of`, not judged yet.
pub(super) fn fit<'s>(
    case: &Case<'_, 's>,
    model: &Model<'s>,
    of: &[usize],
    base: &Settled,
) -> Result<Judged<'s>, CalibError> {
    let first = fits(case, model, of, base)?.into_iter().next();
    first.ok_or(CalibError::Lengths { what: "starts of a fit", expected: 1, given: 0 })
}

/// Every optimum of such a model, best deviance first.
pub(super) fn fits<'s>(
    case: &Case<'_, 's>,
    model: &Model<'s>,
    of: &[usize],
    base: &Settled,
) -> Result<Vec<Judged<'s>>, CalibError> {
    let absent = model.unit(&model.absent(&base.theta));
    let frictions = &absent[..model.frictions()];
    let mut starts: Vec<Vec<f64>> = model
        .strength_starts()
        .into_iter()
        .map(|s| frictions.iter().copied().chain(s).collect())
        .collect();
    // Of added signatures only the best friction without them is tried: there are many pairs.
    if of.len() == 1 || model.is_whole() {
        // With a strong effect the best friction may lie far from that without it, beyond a worse optimum.
        for friction in OTHER_FRICTIONS {
            let elsewhere = |s: Vec<f64>| frictions.iter().map(|_| friction).chain(s).collect();
            starts.extend(model.strength_starts().into_iter().skip(1).map(elsewhere));
        }
    }
    let without = case.base.aside(&base.theta)?;
    let judged = |fit: Settled| {
        let penalty = penalty(case, of, &fit.theta[model.frictions()..]);
        let aside = aside(model, &fit.theta, without)?;
        let p_absolute = chi_square_p(fit.chi2, case.data.len().saturating_sub(model.len()));
        Ok(Judged {
            of: of.to_vec(),
            model: model.clone(),
            fit,
            penalty,
            aside,
            p_absolute,
            p_single: 1.0,
            p_family: 1.0,
            gain: None,
            at_ends: None,
            worsens: Vec::new(),
            objections: Vec::new(),
            explains: true,
            eligible: false,
        })
    };
    optima(model, &case.data, &starts)?.into_iter().map(judged).collect()
}

/// Deviance of what was measured besides the observations, less that from the base: 0 of signatures that are added.
pub(super) fn aside(
    model: &Model<'_>,
    theta: &[f64],
    without: Option<f64>,
) -> Result<f64, CalibError> {
    let own = model.aside(theta)?;
    Ok(own.zip(without).map_or(0.0, |(own, without)| own - without))
}

/// Squared strengths in units of their prior standard deviations.
pub(super) fn penalty(case: &Case<'_, '_>, of: &[usize], strengths: &[f64]) -> f64 {
    let one = |(k, s): (&usize, &f64)| {
        let candidate = &case.attribution.candidates[*k];
        candidate.strength_sd.map(|sd| ((s - candidate.null) / sd).powi(2))
    };
    of.iter().zip(strengths).filter_map(one).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_holds_nineteen_twentieths_of_its_likelihood() {
        assert_eq!(holding(&[1.0, 0.05], 20.0), 1);
        assert_eq!(holding(&[1.0, 0.06], 20.0), 2);
        assert_eq!(holding(&[1.0, 0.37, 0.08, 0.05], 20.0), 3);
        assert_eq!(holding(&[1.0; 4], 20.0), 4);
        assert_eq!(holding(&[], 20.0), 0);
    }

    #[test]
    fn a_class_of_few_takes_in_who_is_less_likely() {
        let likelihoods = [1.0, 0.03, 0.2, 0.01, 0.001];
        assert_eq!(members(&likelihoods, 20.0, (3, 20.0)), [0, 2]);
        assert_eq!(members(&likelihoods, 20.0, (3, 200.0)), [0, 2, 1]);
        assert_eq!(members(&likelihoods, 20.0, (5, 200.0)), [0, 2, 1, 3]);
        assert_eq!(members(&[1.0; 4], 20.0, (3, 200.0)), [0, 1, 2, 3]);
        assert_eq!(members(&likelihoods, 20.0, (0, 1.0)), [0, 2]);
        assert!(members(&[], 20.0, (3, 200.0)).is_empty());
    }
}
