//! What simulations say: a surface for each response at each simulated operating point, with its uncertainty.
//!
//! The surfaces are those of [`crate::process`]; between the simulated speeds of a load a cubic spline goes on. What
//! runs scatter beyond their frames is counted once more for the measured drum, which is one filling too.

use calib::{CalibError, OperatingPoint};

use crate::anchors::{Anchor, Off, Whole, off};
use crate::fillings::{self, Restless, Shifts};
use crate::ignorance::alongside;
use crate::process::{Local, Process, Scatter, witnesses};
use crate::unrest::Unrest;

mod axis;
mod load;
mod spread;

pub use axis::Axis;
pub(crate) use axis::distance_squared;
use axis::{code, place};
use load::{OfLoad, check_knots, check_runs, of_load};

/// How near a point runs tell how runs scatter there, units: a standard deviation.
const NEAR: f64 = 0.5;
/// The same where too few lie as near.
const WIDE: f64 = 1.0;
/// Witnesses that are enough.
const ENOUGH: f64 = 12.0;

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
    /// Where fillings differ by more than about the point of use.
    restless: Vec<Restless>,
}

impl Emulator {
    /// Fit a model to runs at `knots`, in order; coordinates count from `origin` (a value for each axis).
    ///
    /// # Errors
    /// [`CalibError::TooFewRuns`] with fewer than two runs, [`CalibError::Covariance`] if the
    /// regression has no solution, [`CalibError::Knot`] and [`CalibError::Lengths`] for knots out of order and runs that do not
    /// fit them.
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
        check_knots(&knots)?;
        check_runs(&knots, samples)?;
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
            restless: Vec::new(),
        })
    }

    /// The same for other runs at this model's knots, which scatter as those of this one do, unless their fillings are seen to
    /// differ by more ([`crate::fillings`]).
    pub(crate) fn of_others(
        &self,
        axes: Vec<Axis>,
        origin: Vec<f64>,
        samples: &[Sample],
    ) -> Result<Self, CalibError> {
        let coded = coded(&axes, &origin, samples)?;
        check_runs(&self.knots, samples)?;
        let restless = self.restless(&axes, &origin, samples);
        let mut loads = Vec::new();
        for (l, own) in self.loads.iter().enumerate() {
            let (mean, excess) = of_load(samples, (l, &own.at));
            let scatter = &own.process.scatter;
            let shift = |s: &Sample| fillings::at(scatter, &restless, l, &place(&axes, &s.at)).sd;
            let shifts: Vec<[f64; 4]> = samples.iter().map(shift).collect();
            let process = own.process.of_others((coded.clone(), excess), &mean, &shifts)?;
            let (at, speeds_rpm) = (own.at.clone(), own.speeds_rpm.clone());
            loads.push(OfLoad { at, speeds_rpm, process, ..*own });
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
            restless,
        })
    }

    /// Where drums of other runs that differ by nothing but their fillings differ by more than those of this model. Its own, which
    /// lack what the others have, tell that already.
    fn restless(&self, axes: &[Axis], origin: &[f64], samples: &[Sample]) -> Vec<Restless> {
        let free = self.axes.len();
        let lacks = |s: &Sample| s.at.get(free..) == origin.get(free..);
        let own: Vec<Sample> = samples.iter().filter(|s| !lacks(s)).cloned().collect();
        let mut all = Vec::new();
        for at in fillings::refilled(&own) {
            let same: Vec<&Sample> = own.iter().filter(|s| s.at == at).collect();
            if let Some(of_load) = self.unlike(&same) {
                all.push(Restless::new((place(axes, &at), free), of_load));
            }
        }
        all
    }

    /// How fillings with a load shift at a point.
    pub(crate) fn shifts_at(&self, load: usize, at: &[f64]) -> Shifts {
        let scatter = &self.loads[load].process.scatter;
        fillings::at(scatter, &self.restless, load, &place(&self.axes, at))
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
        local.fillings = (0..self.loads.len()).map(|l| self.shifts_at(l, at)).collect();
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
        let shifts: Vec<Shifts> = (0..self.loads.len()).map(|l| self.shifts_at(l, at)).collect();
        let mut sum = 0.0;
        for (k, (_, covariance)) in local.at.iter().enumerate() {
            let (scatter, place) = self.scatter_at(k);
            let fillings = self.loads[self.knots[k].load].fillings;
            for (r, row) in covariance.iter().enumerate() {
                let shift = shifts[self.knots[k].load].sd[r];
                let run = scatter.frames[place][r][r] + shift.powi(2);
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
}

/// Coordinates of runs.
fn coded(axes: &[Axis], origin: &[f64], samples: &[Sample]) -> Result<Vec<Vec<f64>>, CalibError> {
    if samples.len() < 2 {
        return Err(CalibError::TooFewRuns { runs: samples.len(), terms: 1, needed: 2 });
    }
    Ok(samples.iter().map(|s| code(axes, origin, &s.at)).collect())
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

#[cfg(test)]
mod tests;
