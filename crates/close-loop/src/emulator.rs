//! What simulations say: a surface for each response at each simulated operating point, with its uncertainty.
//!
//! The surfaces are those of [`crate::process`]; between the simulated speeds of a load a cubic spline goes on. What
//! runs scatter beyond their frames is counted once more for the measured drum, which is one filling too.

use std::ops::Range;

use calib::{CalibError, OperatingPoint, Predicted, Simulator};

use crate::anchors::{Anchor, Off, Whole, off};
use crate::ignorance::{BESIDE, alongside};
use crate::process::{Local, Process, Scatter, witnesses};
use crate::scale::Scale;
use crate::speeds::weights;
use crate::unrest::Unrest;

/// How near a point runs tell how runs scatter there, units: a standard deviation.
const NEAR: f64 = 0.5;
/// The same where too few lie as near.
const WIDE: f64 = 1.0;
/// Witnesses that are enough.
const ENOUGH: f64 = 12.0;

/// One coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Path of the parameter.
    pub path: String,
    /// Its coordinate.
    pub scale: Scale,
    /// Change of the coordinate that counts as one.
    pub unit: f64,
    /// How fast responses bend over a unit: 1 is what surfaces expect, less is for what acts evenly. It stretches the
    /// coordinate of the surface, not the distances between points.
    pub roughness: f64,
}

/// What one run showed.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Values of all axes.
    pub at: Vec<f64>,
    /// Responses at each knot.
    pub mean: Vec<[f64; 4]>,
    /// Their covariance from the frames.
    pub covariance: Vec<[[f64; 4]; 4]>,
    /// Variance of one frame, at each knot.
    pub variance: Vec<[f64; 4]>,
    /// By how much more solid its fillings held than is expected of the rig, load by load, as a part of that.
    pub excess: Vec<f64>,
}

/// What is particular to one load of the drum: its fillings are others, and so is what more volume does.
#[derive(Debug, Clone)]
struct OfLoad {
    /// Its knots among all.
    at: Range<usize>,
    /// Their speeds, rpm.
    speeds_rpm: Vec<f64>,
    process: Process,
    /// Standard deviation of the volume of a measured filling, as a part of it.
    volume_sd: f64,
    /// Fillings that the measured means are averages over.
    fillings: f64,
}

/// A model of the simulator, made of its runs.
#[derive(Debug, Clone)]
pub struct Emulator {
    axes: Vec<Axis>,
    origin: Vec<f64>,
    knots: Vec<OperatingPoint>,
    /// Factor of the covariance of what is not known at the knots, in units of what the surface says.
    alongside: Vec<Vec<f64>>,
    /// Runs that tell how runs scatter about the point of use.
    witnesses: f64,
    loads: Vec<OfLoad>,
    /// Variance of one frame about the point of use, by knot.
    variance: Vec<[f64; 4]>,
    /// Uncertain knowns that were simulated: change of (knot, response) for one standard deviation.
    modes: Vec<Vec<[f64; 4]>>,
    /// By how much it is off from a whole rig that it stands in for.
    anchors: Vec<Anchor>,
    /// How far single frames scatter.
    unrest: Option<Box<Unrest>>,
}

impl Emulator {
    /// Fit a model to runs at `knots`, in order; coordinates count from `origin` (a value for each axis).
    ///
    /// # Errors
    /// [`CalibError::TooFewRuns`] with fewer than two runs, [`CalibError::Covariance`] if the
    /// regression has no solution.
    pub fn fit(
        axes: Vec<Axis>,
        origin: Vec<f64>,
        knots: Vec<OperatingPoint>,
        samples: &[Sample],
    ) -> Result<Self, CalibError> {
        Self::about(axes, origin, knots, samples, None)
    }

    /// The same, for use about a point: how runs scatter there is told by those about it, since a bed that
    /// surges at a low friction is quiet at a higher one.
    pub(crate) fn about(
        axes: Vec<Axis>,
        origin: Vec<f64>,
        knots: Vec<OperatingPoint>,
        samples: &[Sample],
        point: Option<&[f64]>,
    ) -> Result<Self, CalibError> {
        let coded = coded(&axes, &origin, samples)?;
        let weight = point.map_or_else(|| vec![1.0; samples.len()], |p| about(&axes, samples, p));
        let point = point.map_or_else(|| vec![0.0; axes.len()], |p| code(&axes, &origin, p));
        let all: f64 = weight.iter().sum();
        let average = |of: &dyn Fn(&Sample) -> f64| {
            samples.iter().zip(&weight).map(|(s, w)| w * of(s)).sum::<f64>() / all
        };
        let frames = |k: usize| {
            let of = |r: usize, c: usize| average(&|s| s.covariance[k][r][c]);
            std::array::from_fn(|r| std::array::from_fn(|c| of(r, c)))
        };
        let variance = (0..knots.len())
            .map(|k| std::array::from_fn(|r| average(&|s| s.variance[k][r])))
            .collect();
        let witnesses = witnesses(&weight);
        let mut loads = Vec::new();
        for (l, own) in knots.chunk_by(|a, b| a.load == b.load).enumerate() {
            let first = loads.last().map_or(0, |o: &OfLoad| o.at.end);
            let at = first..first + own.len();
            let (mean, excess) = of_load(samples, (l, &at));
            let frames = at.clone().map(frames).collect();
            let alongside = alongside(own)?;
            let runs = (coded.clone(), excess);
            let process = Process::fit(runs, &point, &mean, frames, &alongside, &weight)?;
            let speeds_rpm = own.iter().map(|p| p.omega_rpm).collect();
            loads.push(OfLoad { at, speeds_rpm, process, volume_sd: 0.0, fillings: 1.0 });
        }
        let alongside = alongside(&knots)?;
        let (modes, anchors) = (Vec::new(), Vec::new());
        Ok(Self {
            axes,
            origin,
            knots,
            alongside,
            witnesses,
            loads,
            variance,
            modes,
            anchors,
            unrest: None,
        })
    }

    /// The same for other runs at this model's knots, which scatter as those of this one do.
    pub(crate) fn of_others(
        &self,
        axes: Vec<Axis>,
        origin: Vec<f64>,
        samples: &[Sample],
    ) -> Result<Self, CalibError> {
        let coded = coded(&axes, &origin, samples)?;
        let mut loads = self.loads.clone();
        for (l, own) in loads.iter_mut().enumerate() {
            let (mean, excess) = of_load(samples, (l, &own.at));
            own.process = own.process.of_others((coded.clone(), excess), &mean)?;
        }
        let others = |u: &Unrest| u.of_others(axes.clone(), origin.clone(), samples);
        let unrest = self.unrest.as_deref().map(others).transpose()?.map(Box::new);
        Ok(Self {
            unrest,
            axes,
            origin,
            knots: self.knots.clone(),
            alongside: self.alongside.clone(),
            witnesses: self.witnesses,
            loads,
            variance: self.variance.clone(),
            modes: Vec::new(),
            anchors: Vec::new(),
        })
    }

    /// Shift the model of a stand-in by what it is off from runs of the whole rig: of those without effects, and with no others than
    /// its own.
    #[must_use]
    pub(crate) fn anchored(mut self, wholes: &[Whole]) -> Self {
        // Free parameters come first, then effects.
        let place = |w: &Whole| {
            let free = w.sample.at.len().checked_sub(w.names.len())?;
            let mut at = self.origin.clone();
            at.get_mut(..free)?.copy_from_slice(&w.sample.at[..free]);
            for (name, strength) in w.names.iter().zip(&w.sample.at[free..]) {
                let axis = self.axes.iter().skip(free).position(|a| a.path == *name)?;
                at[free + axis] = *strength;
            }
            Some(at)
        };
        let anchors =
            wholes.iter().filter_map(|w| Some(self.anchor(&place(w)?, &w.sample))).collect();
        self.anchors = anchors;
        self
    }

    /// The whole rig less what this model says.
    fn anchor(&self, at: &[f64], whole: &Sample) -> Anchor {
        let z = code(&self.axes, &self.origin, at);
        let stand_in = self.known(&z);
        let knots = || stand_in.at.iter().enumerate();
        let of_volume = &stand_in.of_volume;
        let mean = knots()
            .map(|(k, (own, _))| {
                let more = |r: usize| whole.excess[self.knots[k].load] * of_volume[k][r];
                std::array::from_fn(|r| whole.mean[k][r] - more(r) - own[r])
            })
            .collect();
        let with = |of: &[[f64; 4]; 4], factor: f64, own: [f64; 4]| {
            std::array::from_fn(|r| {
                std::array::from_fn(|s| factor * of[r][s] + if r == s { own[r] } else { 0.0 })
            })
        };
        let both = |a: [f64; 4], b: [f64; 4]| std::array::from_fn(|r| a[r].powi(2) + b[r].powi(2));
        let noise = knots()
            .map(|(k, _)| {
                let (scatter, own) = self.scatter_at(k);
                with(&whole.covariance[k], scatter.swings[own], scatter.shift.map(|s| s * s))
            })
            .collect();
        let unknown = knots()
            .map(|(k, (_, own))| {
                let missed = stand_in.unknown[k].map(|u| self.missed(k) * u);
                with(own, 1.0, both(stand_in.shared[k], missed))
            })
            .collect();
        Anchor { at: place(&self.axes, at), mean, noise, unknown }
    }

    /// What is added at a point.
    pub(crate) fn off(&self, at: &[f64]) -> Off {
        off(&self.anchors, &place(&self.axes, at))
    }

    /// Degrees of freedom with which is known how runs scatter: of each run a shift that its speeds share, in angle and in
    /// height. (Fifteen drums that lack nothing: chi-square 18 with a standard deviation of 10, where 19 degrees of freedom and
    /// errors that are known leave 6.) Every load is another filling.
    pub(crate) fn errors_dof(&self) -> f64 {
        2.0 * self.witnesses * self.loads.len() as f64
    }

    /// Covariance of one run from its frames and what swings more slowly than they show, by knot.
    pub fn frames(&self) -> impl Iterator<Item = &[[f64; 4]; 4]> {
        self.loads.iter().flat_map(|own| &own.process.scatter.frames)
    }

    /// How runs of the load of a knot scatter, and which of its knots it is.
    fn scatter_at(&self, knot: usize) -> (&Scatter, usize) {
        let own = &self.loads[self.knots[knot].load];
        (&own.process.scatter, knot - own.at.start)
    }

    /// Add uncertain knowns that were simulated: for each, the change of every (knot, response)
    /// for one standard deviation of its prior.
    #[must_use]
    pub fn with_modes(mut self, modes: Vec<Vec<[f64; 4]>>) -> Self {
        self.modes = modes;
        self
    }

    /// For measured fillings whose volumes are known to these standard deviations, load by load, as a part of it.
    #[must_use]
    pub fn with_volume_sd(mut self, relative_sd: &[f64]) -> Self {
        self.loads.iter_mut().zip(relative_sd).for_each(|(own, sd)| own.volume_sd = *sd);
        self
    }

    /// For measured means that are averages over so many fillings, load by load, of which each lies otherwise. (The same
    /// particles have the same volume each time, so what is not known of that stays.)
    #[must_use]
    pub fn with_fillings(mut self, fillings: &[u32]) -> Self {
        let each = self.loads.iter_mut().zip(fillings);
        each.for_each(|(own, n)| own.fillings = f64::from((*n).max(1)));
        self
    }

    /// With a model of how far single frames scatter.
    #[must_use]
    pub(crate) fn with_unrest(mut self, unrest: Unrest) -> Self {
        self.unrest = Some(Box::new(unrest));
        self
    }

    /// Change of the responses at the knots for twice the volume, as far as fillings tell that have a little more or less.
    pub fn of_volume(&self, at: &[f64]) -> Vec<[f64; 4]> {
        let z = code(&self.axes, &self.origin, at);
        self.loads.iter().flat_map(|own| own.process.of_volume(&z)).collect()
    }

    /// The same anywhere, from that at the knots.
    pub(crate) fn of_volume_at(&self, of_volume: &[[f64; 4]], at: OperatingPoint) -> [f64; 4] {
        std::array::from_fn(|r| self.linear(at, |k| of_volume[k][r]))
    }

    /// Standard deviation of the shift of each response, common to all speeds, from one filling of the drum
    /// with a load to the next.
    pub fn shift(&self, load: usize) -> [f64; 4] {
        self.loads[load].process.scatter.shift
    }

    /// Variance of a mean over what its frames show, anywhere; above 1 for slow swings of the bed.
    pub fn swings(&self, at: OperatingPoint) -> f64 {
        self.linear(at, |k| {
            let (scatter, own) = self.scatter_at(k);
            scatter.swings[own]
        })
    }

    /// Variance of one frame anywhere.
    pub(crate) fn variance_of_frame(&self, at: OperatingPoint) -> [f64; 4] {
        std::array::from_fn(|r| self.linear(at, |k| self.variance[k][r]))
    }

    /// Between the knots of a load along a line, constant beyond them.
    fn linear(&self, at: OperatingPoint, of: impl Fn(usize) -> f64) -> f64 {
        let (own, omega_rpm) = (&self.loads[at.load], at.omega_rpm);
        let knots = &own.speeds_rpm;
        let above = knots.partition_point(|k| *k < omega_rpm).min(knots.len() - 1);
        let below = above.saturating_sub(usize::from(knots[above] > omega_rpm));
        let apart = knots[above] - knots[below];
        let (a, b) = (of(own.at.start + below), of(own.at.start + above));
        if apart > 0.0 { a + (b - a) * (omega_rpm - knots[below]) / apart } else { a }
    }

    /// By how much runs scatter beyond their frames, as a factor on the variance, on average.
    pub fn inflation(&self) -> f64 {
        let ratio = |(k, f): (usize, &[[f64; 4]; 4])| -> f64 {
            let shift = self.scatter_at(k).0.shift;
            (0..4).map(|r| 0.25 * shift[r].powi(2) / f[r][r].max(f64::MIN_POSITIVE)).sum()
        };
        1.0 + self.frames().enumerate().map(ratio).sum::<f64>() / self.knots.len() as f64
    }

    /// The axes.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Operating points that were simulated.
    pub fn knots(&self) -> &[OperatingPoint] {
        &self.knots
    }

    /// Means at the knots.
    pub fn at_knots(&self, at: &[f64]) -> Vec<[f64; 4]> {
        let z = code(&self.axes, &self.origin, at);
        let mut all: Vec<[f64; 4]> =
            self.loads.iter().flat_map(|own| own.process.mean(&z)).collect();
        for (four, off) in all.iter_mut().zip(&self.off(at).shift) {
            four.iter_mut().zip(off.0).for_each(|(m, b)| *m += b);
        }
        all
    }

    /// What is known at the knots, without modes; of the whole rig where this is a stand-in.
    pub(crate) fn moments(&self, at: &[f64]) -> Local {
        let mut local = self.known(&code(&self.axes, &self.origin, at));
        let Off { shift, unsure } = self.off(at);
        for ((mean, covariance), off) in local.at.iter_mut().zip(&shift) {
            mean.iter_mut().zip(off.0).for_each(|(m, b)| *m += b);
            let each = covariance.iter_mut().flatten().zip(off.1.iter().flatten());
            each.for_each(|(c, b)| *c += b);
        }
        local.unsure = unsure;
        local
    }

    /// The same at coded coordinates, of what was run.
    fn known(&self, z: &[f64]) -> Local {
        let mut all = Local::default();
        for own in &self.loads {
            let of_load = own.process.moments(z);
            all.at.extend(of_load.at);
            all.unknown.extend(of_load.unknown);
            all.shared.extend(of_load.shared);
            all.of_volume.extend(of_load.of_volume);
        }
        all
    }

    /// Variance at a point over that of the measured means, on average, which is that of one run for each filling that was
    /// measured: of one filling 1 where one run was made, more where nothing is known.
    pub(crate) fn doubt(&self, at: &[f64]) -> f64 {
        let local = self.known(&code(&self.axes, &self.origin, at));
        let mut sum = 0.0;
        for (k, (_, covariance)) in local.at.iter().enumerate() {
            let (scatter, place) = self.scatter_at(k);
            let fillings = self.loads[self.knots[k].load].fillings;
            for (r, row) in covariance.iter().enumerate() {
                let run = scatter.frames[place][r][r] + scatter.shift[r].powi(2);
                let unknown = self.missed(k) * local.unknown[k][r];
                let own = row[r] + local.shared[k][r].powi(2) + unknown.powi(2);
                sum += fillings * 0.25 * own / run.max(f64::MIN_POSITIVE);
            }
        }
        sum / self.knots.len() as f64
    }

    /// What the surface misses at a knot over what it says that it does not know.
    fn missed(&self, knot: usize) -> f64 {
        self.alongside[knot].iter().map(|f| f * f).sum::<f64>().sqrt()
    }

    /// Distance of two points, units.
    pub(crate) fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        distance_squared(&place(&self.axes, a), &place(&self.axes, b)).sqrt()
    }

    /// Weights of the knots at a point: those of its load.
    fn spline(&self, point: &OperatingPoint) -> Vec<f64> {
        let own = &self.loads[point.load];
        let mut all = vec![0.0; self.knots.len()];
        all[own.at.clone()].copy_from_slice(&weights(&own.speeds_rpm, point.omega_rpm));
        all
    }

    /// Means anywhere from those at the knots.
    pub(crate) fn between(&self, points: &[OperatingPoint], at: &[[f64; 4]]) -> Vec<f64> {
        let mut mean = Vec::with_capacity(4 * points.len());
        for point in points {
            // Nothing is between there.
            if let Some(k) = self.knots.iter().position(|knot| knot == point) {
                mean.extend(at[k]);
                continue;
            }
            let w = self.spline(point);
            mean.extend((0..4).map(|r| w.iter().zip(at).map(|(w, v)| w * v[r]).sum::<f64>()));
        }
        mean
    }

    /// Predictions anywhere from what is known at the knots.
    pub(crate) fn spread(&self, points: &[OperatingPoint], local: &Local) -> Predicted {
        let spline: Vec<Vec<f64>> = points.iter().map(|p| self.spline(p)).collect();
        let n = 4 * points.len();
        let means: Vec<[f64; 4]> = local.at.iter().map(|a| a.0).collect();
        let mean = self.between(points, &means);
        // What moves all speeds together: knowns, and fillings, of which the measured drum with a load is one.
        let value = |w: &[f64], mode: &[[f64; 4]], r: usize| -> f64 {
            w.iter().zip(mode).map(|(w, m)| w * m[r]).sum()
        };
        let load = |k: usize| &self.loads[self.knots[k].load];
        let of_means = |own: &OfLoad| own.process.scatter.shift.map(|s| s / own.fillings.sqrt());
        let shift: Vec<[f64; 4]> = (0..self.knots.len()).map(|k| of_means(load(k))).collect();
        // How much solid the measured filling holds is known to a part.
        let of_volume = |(k, g): (usize, &[f64; 4])| g.map(|g| load(k).volume_sd * g);
        let volume: Vec<[f64; 4]> = local.of_volume.iter().enumerate().map(of_volume).collect();
        let unsure = Some(&local.unsure).filter(|u| !u.is_empty());
        let modes: Vec<&Vec<[f64; 4]>> = self.modes.iter().chain(unsure).collect();
        // What the surface does not know, at each speed in independent parts.
        let parts = |w: &Vec<f64>| -> Vec<[f64; 4]> {
            let mut parts = vec![[0.0; 4]; self.knots.len()];
            for ((w, own), row) in w.iter().zip(&local.unknown).zip(&self.alongside) {
                for (part, factor) in parts.iter_mut().zip(row) {
                    part.iter_mut().zip(own).for_each(|(p, u)| *p += w * factor * u);
                }
            }
            parts
        };
        let unknown: Vec<Vec<[f64; 4]>> = spline.iter().map(parts).collect();
        let mut covariance = vec![0.0; n * n];
        for (a, pa) in points.iter().enumerate() {
            for (b, pb) in points.iter().enumerate().take(a + 1) {
                // Fillings of two loads have nothing to do with each other.
                let same = (pa.load == pb.load).then(|| &self.loads[pa.load].process.scatter);
                let mut block = [[0.0; 4]; 4];
                for (k, (_, own)) in local.at.iter().enumerate() {
                    let w = spline[a][k] * spline[b][k];
                    if w != 0.0 {
                        for (to, of) in block.iter_mut().flatten().zip(own.iter().flatten()) {
                            *to += w * of;
                        }
                    }
                }
                for (r, row) in block.iter_mut().enumerate() {
                    for (s, c) in row.iter_mut().enumerate() {
                        let both: f64 =
                            unknown[a].iter().zip(&unknown[b]).map(|(p, q)| p[r] * q[s]).sum();
                        *c += BESIDE[r][s] * both;
                    }
                    for own in [&local.shared, &shift] {
                        let Some(scatter) = same else { break };
                        for (s, c) in row.iter_mut().enumerate() {
                            let both = value(&spline[a], own, r) * value(&spline[b], own, s);
                            *c += scatter.together[r][s] * both;
                        }
                    }
                    for mode in modes.iter().copied().chain(same.map(|_| &volume)) {
                        for (s, c) in row.iter_mut().enumerate() {
                            *c += value(&spline[a], mode, r) * value(&spline[b], mode, s);
                        }
                    }
                }
                for r in 0..4 {
                    for s in 0..4 {
                        covariance[(4 * a + r) * n + 4 * b + s] = block[r][s];
                        covariance[(4 * b + s) * n + 4 * a + r] = block[r][s];
                    }
                }
            }
        }
        Predicted { mean, covariance }
    }
}

impl Emulator {
    pub(crate) fn check(&self, theta: &[f64], points: &[OperatingPoint]) -> Result<(), CalibError> {
        if theta.len() != self.axes.len() {
            return Err(CalibError::Parameters { expected: self.axes.len(), given: theta.len() });
        }
        match points.iter().find(|p| p.load >= self.loads.len()) {
            Some(other) => Err(CalibError::Load { at: *other }),
            None => Ok(()),
        }
    }
}

impl Simulator for Emulator {
    fn parameters(&self) -> Vec<String> {
        self.axes.iter().map(|a| a.path.clone()).collect()
    }

    fn speed_range_rpm(&self) -> (f64, f64) {
        let speeds = self.knots.iter().map(|k| k.omega_rpm);
        speeds.fold((f64::INFINITY, 0.0), |(low, high), s| (s.min(low), s.max(high)))
    }

    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        self.check(theta, at)?;
        Ok(self.spread(at, &self.moments(theta)))
    }

    fn aside(&self, theta: &[f64]) -> Result<Option<f64>, CalibError> {
        self.unrest.as_ref().map(|u| u.deviance(theta)).transpose()
    }

    fn expected(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Vec<f64>, CalibError> {
        self.check(theta, at)?;
        Ok(self.between(at, &self.at_knots(theta)))
    }
}

/// Coordinates of runs.
fn coded(axes: &[Axis], origin: &[f64], samples: &[Sample]) -> Result<Vec<Vec<f64>>, CalibError> {
    if samples.len() < 2 {
        return Err(CalibError::TooFewRuns { runs: samples.len(), terms: 1, needed: 2 });
    }
    Ok(samples.iter().map(|s| code(axes, origin, &s.at)).collect())
}

/// Means of runs with one load, by its knots, and the excess of their volumes.
fn of_load<'s>(
    samples: &'s [Sample],
    (load, at): (usize, &Range<usize>),
) -> (Vec<&'s [[f64; 4]]>, Vec<f64>) {
    let mean = samples.iter().map(|s| &s.mean[at.clone()]).collect();
    (mean, samples.iter().map(|s| s.excess[load]).collect())
}

/// Weights of runs in what is told of a point: nearer than any others if enough of them lie there.
fn about(axes: &[Axis], samples: &[Sample], point: &[f64]) -> Vec<f64> {
    let point = place(axes, point);
    let apart = |s: &Sample| distance_squared(&place(axes, &s.at), &point);
    let within =
        |width: f64| samples.iter().map(|s| (-0.5 * apart(s) / (width * width)).exp()).collect();
    let near: Vec<f64> = within(NEAR);
    if witnesses(&near) < ENOUGH { within(WIDE) } else { near }
}

/// Squared distance of two points.
pub(crate) fn distance_squared(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// Coordinates in units, however rough the axes are.
fn place(axes: &[Axis], at: &[f64]) -> Vec<f64> {
    axes.iter().zip(at).map(|(a, x)| a.scale.forth(*x) / a.unit).collect()
}

/// Coordinates of the surfaces: units from the origin, longer where responses bend faster.
fn code(axes: &[Axis], origin: &[f64], at: &[f64]) -> Vec<f64> {
    axes.iter()
        .zip(origin)
        .zip(at)
        .map(|((a, o), x)| (a.scale.forth(*x) - a.scale.forth(*o)) / a.unit * a.roughness)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_over_four_fillings_shift_half_as_far() {
        let noise = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * 1e-4));
        // Ten drums of one friction: fillings differ by half a degree at both speeds alike.
        let run = |k: u32| {
            let mean = [20.0 + if k.is_multiple_of(2) { 0.5 } else { -0.5 }; 4];
            let (mean, covariance) = (vec![mean; 2], vec![noise; 2]);
            Sample {
                at: vec![0.4],
                mean,
                covariance,
                variance: vec![[1e-3; 4]; 2],
                excess: vec![0.0],
            }
        };
        let runs: Vec<Sample> = (0..10).map(run).collect();
        let axis =
            Axis { path: "friction.pp".to_owned(), scale: Scale::Log, unit: 0.35, roughness: 1.0 };
        let knots = [20.0, 40.0].map(OperatingPoint::from);
        let one = Emulator::fit(vec![axis], vec![0.4], knots.to_vec(), &runs).unwrap();
        let four = one.clone().with_fillings(&[4]);
        let shift = one.shift(0)[0];
        assert!((0.3..0.8).contains(&shift), "{shift}");
        let of = |m: &Emulator, i, j| m.predict(&[0.4], &knots).unwrap().covariance(i, j);
        for (i, j) in [(0, 0), (0, 4), (3, 3)] {
            // What is left is what ten simulated fillings do not know of their mean.
            let less = of(&one, i, j) - of(&four, i, j);
            let expected = 0.75 * one.shift(0)[i % 4].powi(2);
            assert!((less - expected).abs() < 1e-9, "{i} {j}: {less} {expected}");
        }
        // And what runs have to say is held against what was measured.
        assert!((four.doubt(&[0.4]) / one.doubt(&[0.4]) - 4.0).abs() < 1e-12);
        assert_eq!(one.with_fillings(&[0]).loads[0].fillings, 1.0);
    }
}
