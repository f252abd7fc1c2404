//! Ends of a smoothed curve that bend too much for the penalty of the rest.
//!
//! The penalty on bending is chosen for the whole curve. A steep surface with a strong S-shape levels off over the last tenth of
//! the radius; the penalty holds it straight there, the outermost points look like outliers, and the curve is continued to the wall
//! one or two pixels beside them. Where the curve turns strongly towards an end, and the points there agree better with a looser
//! curve than chance explains, the end is loosened. Elsewhere a looser end would only follow the grains.

use super::{Rows, Spline, Stiffness, fill_residuals, fit};

/// Pieces at either end over which the penalty is less, and over which the two curves are compared.
const REACH: usize = 3;
/// Penalty at the very end of a loosened curve, fraction of that elsewhere.
const LOOSE: f64 = 0.01;
/// Turn of the curve within its last pieces from which, and up to which, a looser end is taken, radians (20 and 35 deg).
const TURN: (f64, f64) = (0.349, 0.611);
/// Gain in misfit, in units of the scatter squared and of independent points, at which a looser end is taken in full.
const GAIN: f64 = 2.0;
/// Scatters from which a residual counts linearly in the misfit.
const KNEE: f64 = 2.0;
/// Share of points that every half piece at the end must hold.
const HELD: f64 = 0.25;
/// Steps of reweighting, the first half with weights that never vanish, so that the outermost points get a say.
const ROUNDS: usize = 8;

/// A fit under way: points, spline, weights and what is left over.
#[derive(Clone)]
pub(super) struct Task<'a> {
    pub(super) rows: &'a Rows,
    pub(super) y: &'a [f64],
    pub(super) accepted: &'a [bool],
    pub(super) spline: Spline,
    pub(super) weights: Vec<f64>,
    pub(super) residuals: Vec<f64>,
    pub(super) scatter: f64,
}

impl Task<'_> {
    /// Fits with the present weights, then weighs the residuals anew: by biweights, or, `soft`, by Huber's weights.
    pub(super) fn step(&mut self, stiffness: Stiffness, soft: bool) -> Option<()> {
        let size = self.spline.coefficients.len();
        self.spline.coefficients = fit(self.rows, self.y, &self.weights, size, stiffness)?;
        self.weigh(soft);
        Some(())
    }

    fn weigh(&mut self, soft: bool) {
        self.scatter =
            fill_residuals(self.rows, self.y, &self.spline, &self.weights, &mut self.residuals);
        let cut = 4.685 * self.scatter.max(1e-3 * self.spline.piece).max(1e-9);
        let huber = 1.345 / 4.685;
        for ((w, r), &a) in self.weights.iter_mut().zip(&self.residuals).zip(self.accepted) {
            let t = (r / cut).abs();
            *w = match (a, soft) {
                (false, _) => 0.0,
                (true, true) => (huber / t.max(1e-12)).min(1.0),
                (true, false) if t < 1.0 => (1.0 - t * t).powi(2),
                (true, false) => 0.0,
            };
        }
    }

    /// Misfit of the accepted points of a zone in units of `scatter` squared, linear for large residuals.
    fn misfit(&self, zone: &std::ops::Range<usize>, scatter: f64) -> f64 {
        self.residuals[zone.clone()]
            .iter()
            .zip(&self.accepted[zone.clone()])
            .filter(|(_, a)| **a)
            .map(|(r, _)| {
                let t = r.abs() / scatter;
                if t < KNEE { t * t } else { (2.0 * t - KNEE) * KNEE }
            })
            .sum()
    }

    /// Points over which residuals are alike: the integrated autocorrelation.
    fn alike(&self) -> f64 {
        let held: Vec<f64> = self
            .residuals
            .iter()
            .zip(&self.weights)
            .filter(|(_, w)| **w > 0.0)
            .map(|(r, _)| *r)
            .collect();
        let rho = crate::statistics::autocorrelation(&held, 60.min(held.len() / 4));
        1.0 + 2.0 * rho.iter().skip(1).take_while(|r| **r > 0.0).sum::<f64>()
    }

    /// Indices of the points in the last pieces at one side; `None` where parts of them are empty.
    fn zone(&self, right: bool) -> Option<std::ops::Range<usize>> {
        let pieces = self.spline.coefficients.len() - 3;
        let zone = if right {
            self.rows.partition_point(|r| r.0 < pieces - REACH)..self.rows.len()
        } else {
            0..self.rows.partition_point(|r| r.0 < REACH)
        };
        let parts = 2 * REACH;
        let held = |j: usize| {
            let (a, b) = (zone.len() * j / parts, zone.len() * (j + 1) / parts);
            let part = &self.accepted[zone.start + a..zone.start + b];
            let count = part.iter().filter(|a| **a).count() as f64;
            count > 0.0 && count >= HELD * part.len() as f64
        };
        (0..parts).all(held).then_some(zone)
    }

    /// Largest change of the curve's direction between an end and any place in its last pieces, radians.
    fn turn(&self, right: bool) -> f64 {
        let (from, to) = self.spline.range();
        let direction = |d: f64| {
            let at = d * self.spline.piece;
            self.spline.slope(if right { to - at } else { from + at }).atan()
        };
        let end = direction(0.0);
        (1..=4 * REACH).map(|k| (direction(0.25 * k as f64) - end).abs()).fold(0.0, f64::max)
    }
}

/// Loosens the ends that ask for it; returns what a looser curve would add in full at either end.
pub(super) fn loosen(task: &mut Task<'_>, lambda: f64) -> Option<[Spline; 2]> {
    let size = task.spline.coefficients.len();
    let mut turns = [0, 1].map(|_| Spline { coefficients: vec![0.0; size], ..task.spline.clone() });
    if size < 3 + 2 * REACH + 1 {
        return Some(turns);
    }
    let base = task.clone();
    let scatter = base.scatter.max(1e-9);
    let alike = base.alike();
    for (side, turn) in turns.iter_mut().enumerate() {
        let bend = (base.turn(side == 1) - TURN.0) / (TURN.1 - TURN.0);
        let Some(zone) = base.zone(side == 1) else { continue };
        let mut trial = base.clone();
        for k in zone.clone() {
            trial.weights[k] = f64::from(u8::from(base.accepted[k]));
        }
        let mut ends = [1.0; 2];
        ends[side] = LOOSE;
        for round in 0..ROUNDS {
            trial.step(Stiffness { lambda, ends }, 2 * round < ROUNDS)?;
        }
        let gain = (base.misfit(&zone, scatter) - trial.misfit(&zone, scatter)) / alike;
        let share = bend.clamp(0.0, 1.0) * (gain / GAIN).clamp(0.0, 1.0);
        for (k, d) in turn.coefficients.iter_mut().enumerate() {
            *d = trial.spline.coefficients[k] - base.spline.coefficients[k];
            task.spline.coefficients[k] += share * *d;
        }
    }
    task.weigh(false);
    Some(turns)
}

/// Factor on the penalty on the second difference number `k` of `count`.
pub(super) fn looseness(ends: [f64; 2], k: usize, count: usize) -> f64 {
    let at = |d: usize, f: f64| f.powf((1.0 - d as f64 / REACH as f64).max(0.0));
    at(k, ends[0]) * at(count - 1 - k, ends[1])
}
