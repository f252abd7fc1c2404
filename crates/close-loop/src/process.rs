//! Gaussian-process regression of many outputs over the same runs.
//!
//! An output is a quadratic in coded coordinates whose coefficients have normal priors wide against what
//! drums show, plus a smooth remainder (Rasmussen and Williams, Gaussian
//! Processes for Machine Learning, 2006, sections 2.2 and 2.7). So the surface follows runs wherever they
//! are, near the calibrated point and far from it, and says how little it knows between them. The amplitude
//! of the remainder and the scatter of fillings are chosen for each response by the marginal likelihood.
//!
//! A run differs from the next by more than its frames scatter: another filling of the drum has a little
//! more or less volume at all its speeds (560 beads of 12 % spread move the centre of area by 0.6 % of R), which is
//! known and taken out ([`Volume`]), and lies otherwise. So a run's noise is that of its frames and a shift of each
//! response which its speeds share. Where a bed swings
//! more slowly than a run looks at it, its frames show too little: by which factor, speed by speed, is told by
//! how runs left out miss the surface through all others ([`Scatter`]).

use calib::CalibError;
use faer::linalg::solvers::Solve as _;
use faer::{Mat, Side};

use crate::fillings::Shifts;
use crate::ignorance::BESIDE;
use crate::volume::{Told, Volume};

/// Prior standard deviation of the constant about the mean of the runs, deg or percent of R.
const CONSTANT: f64 = 15.0;
/// Of a slope, for one coded unit.
const SLOPE: f64 = 6.0;
/// Of a curvature.
const CURVATURE: f64 = 2.0;
/// Of a product of two coordinates.
const PRODUCT: f64 = 1.5;
/// Of what more solid in the drum does, for twice as much: one per cent moves the centre of area by half a per cent of R.
const VOLUME: f64 = 60.0;
/// Of how that changes over a coded unit.
const VOLUME_CHANGES: f64 = 20.0;
/// Excess of volume below which fillings are alike.
const SAME: f64 = 1e-6;
/// Lengths of the remainder that are tried, coded units.
const LENGTHS: [f64; 3] = [0.8, 1.2, 1.8];
/// Length that is expected, with the standard deviation of its logarithm.
const LENGTH: (f64, f64) = (1.2, 0.5);
/// Amplitudes of the remainder that are tried, deg or percent of R.
const AMPLITUDES: [f64; 5] = [0.3, 0.6, 1.2, 2.5, 5.0];
/// Amplitude that is expected, with the standard deviation of its logarithm.
const AMPLITUDE: (f64, f64) = (1.2, 0.7);
/// Standard deviations of a filling's shift that are tried, deg or percent of R.
const SHIFTS: [f64; 6] = [0.05, 0.1, 0.2, 0.4, 0.8, 1.6];
/// Shift that is expected, with the standard deviation of its logarithm.
const SHIFT: (f64, f64) = (0.3, 1.0);
/// Least number of runs that tell how they scatter.
const LEAST_RUNS: f64 = 8.0;
/// Shift that few runs which show less are drawn towards, deg or percent of R: what fillings of one volume were seen to have.
const USUAL: f64 = 0.15;
/// Least variance of a mean over what its frames show.
const LEAST_SWINGS: f64 = 0.5;
/// Part of a correlation of shifts that many runs are sure of.
const SURE: f64 = 0.9;
/// Number of runs that are sure of half of that.
pub(crate) const HALF_SURE: f64 = 6.0;
/// Shifts that have nothing to do with each other.
const ALONE: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
/// Least variance of a mean, (0.01 deg)^2.
const FLOOR: f64 = 1e-4;

/// Shift of the four responses at one speed, with its covariance.
pub(crate) type Shift = ([f64; 4], [[f64; 4]; 4]);

/// What is known of the responses at a point.
#[derive(Debug, Clone, Default)]
pub(crate) struct Local {
    /// By knot, with the covariance that the frames of runs leave.
    pub(crate) at: Vec<Shift>,
    /// Standard deviation of what the surface does not know, by knot, which goes together ([`crate::ignorance`]).
    pub(crate) unknown: Vec<[f64; 4]>,
    /// Further standard deviation of each response, shared by all knots: shifts of the fillings that
    /// were simulated.
    pub(crate) shared: Vec<[f64; 4]>,
    /// One more standard deviation, common to knots and responses in this proportion: what a stand-in may be off by. Empty
    /// for none.
    pub(crate) unsure: Vec<[f64; 4]>,
    /// Change for twice the volume, by knot.
    pub(crate) of_volume: Vec<[f64; 4]>,
    /// How fillings shift there, load by load.
    pub(crate) fillings: Vec<Shifts>,
}

/// How one run differs from the next of the same drum.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scatter {
    /// Standard deviation of a filling's shift of each response, shared by all speeds.
    pub(crate) shift: [f64; 4],
    /// Correlation of the shifts of two responses: a bed that lies higher has its centre of area higher and both
    /// angles lower.
    pub(crate) together: [[f64; 4]; 4],
    /// Variance of a mean over what its frames show, by knot: more than 1 where a bed swings slowly, less where it swings to
    /// and fro from frame to frame, which a number of independent frames that is at most that of all frames does not count.
    pub(crate) swings: Vec<f64>,
    /// Covariance of a run's means without the shift, by knot: that of its frames times the former.
    pub(crate) frames: Vec<[[f64; 4]; 4]>,
}

/// All outputs over the same runs.
#[derive(Debug, Clone)]
pub(crate) struct Process {
    /// Coded coordinates of the runs.
    coded: Vec<Vec<f64>>,
    /// Standard deviations of the shifts of their fillings.
    shifts: Vec<[f64; 4]>,
    /// What more volume does; the outputs are those of the volume expected.
    volume: Volume,
    amplitude: [f64; 4],
    length: f64,
    pub(crate) scatter: Scatter,
    /// By knot and response.
    outputs: Vec<[Output; 4]>,
    /// Inverse of the runs' covariance times what they showed, by knot and run: the four responses of a run side by side,
    /// as means are asked for more than anything else.
    alpha: Vec<Vec<[f64; 4]>>,
}

#[derive(Debug, Clone)]
struct Output {
    middle: f64,
    inverse: Mat<f64>,
}

impl Output {
    /// The inverse times a vector, column by column, which processors do several rows at a time.
    fn weights(&self, of: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; of.len()];
        for (j, x) in of.iter().enumerate() {
            let column = self.inverse.col_as_slice(j);
            all.iter_mut().zip(column).for_each(|(sum, c)| *sum += c * x);
        }
        all
    }
}

impl Process {
    /// Regression on runs at coded coordinates, each with the excess of its volume, whose outputs are `mean` (by run and
    /// knot), with the covariance of their frames by knot; `alongside` is the factor of the correlation of knots
    /// ([`crate::ignorance`]). What more volume does is told about `point`; how runs scatter, by all of them, each with its
    /// weight.
    pub(crate) fn fit(
        (coded, excess): (Vec<Vec<f64>>, Vec<f64>),
        point: &[f64],
        mean: &[&[[f64; 4]]],
        frames: Vec<[[f64; 4]; 4]>,
        alongside: &[Vec<f64>],
        weight: &[f64],
    ) -> Result<Self, CalibError> {
        let mut volume = Volume::none(frames.len());
        if excess.iter().any(|e| e.abs() > SAME) {
            let open = Self::with(coded.clone(), mean, frames.clone(), None, Some(&excess))?;
            volume = open.volume_of_runs(&excess, point);
        }
        let mean = volume.level(&coded, &excess, mean);
        let rows: Vec<&[[f64; 4]]> = mean.iter().map(|m| &m[..]).collect();
        let first = Self::with(coded, &rows, frames, None, None)?;
        if witnesses(weight) < LEAST_RUNS {
            return Ok(Self { volume, ..first });
        }
        let scatter = first.scatter_of_runs(alongside, weight);
        let shifts = vec![scatter.shift; weight.len()];
        Self::with_scatter(first.coded, &rows, (scatter, &shifts), volume)
    }

    /// Regression on outputs of the volume expected, where it is known how runs scatter and what more volume does.
    fn with_scatter(
        coded: Vec<Vec<f64>>,
        level: &[&[[f64; 4]]],
        (scatter, shifts): (Scatter, &[[f64; 4]]),
        volume: Volume,
    ) -> Result<Self, CalibError> {
        let process = Self::with(coded, level, scatter.frames.clone(), Some(shifts), None)?;
        Ok(Self { scatter, volume, ..process })
    }

    /// The same for other runs, to which volume does the same and which scatter as those of this one do, but for the shifts of
    /// their fillings, whose standard deviations are given run by run.
    pub(crate) fn of_others(
        &self,
        (coded, excess): (Vec<Vec<f64>>, Vec<f64>),
        mean: &[&[[f64; 4]]],
        shifts: &[[f64; 4]],
    ) -> Result<Self, CalibError> {
        let mean = self.volume.level(&coded, &excess, mean);
        let rows: Vec<&[[f64; 4]]> = mean.iter().map(|m| &m[..]).collect();
        Self::with_scatter(coded, &rows, (self.scatter.clone(), shifts), self.volume.clone())
    }

    /// What more volume does about a point, by runs whose volumes were left in their outputs.
    fn volume_of_runs(&self, excess: &[f64], point: &[f64]) -> Volume {
        let to: Vec<f64> =
            self.coded.iter().zip(excess).map(|(c, e)| e * of_volume(c, point)).collect();
        let told = |k: usize, r: usize| {
            let o = &self.outputs[k][r];
            let known: f64 = to.iter().zip(o.weights(&to)).map(|(t, w)| t * w).sum();
            let slope = self.alpha[k].iter().zip(&to).map(|(a, t)| a[r] * t).sum();
            Told { slope, variance: (of_volume(point, point) - known).max(0.0) }
        };
        let all: Vec<[Told; 4]> =
            (0..self.outputs.len()).map(|k| std::array::from_fn(|r| told(k, r))).collect();
        let knots = self.outputs.len() as f64;
        let gradient = |d: usize| {
            let own = |alpha: &Vec<[f64; 4]>, r: usize| {
                let each = alpha.iter().zip(excess).zip(&self.coded);
                each.map(|((a, e), c)| VOLUME_CHANGES.powi(2) * a[r] * e * c[d]).sum::<f64>()
            };
            std::array::from_fn(|r| self.alpha.iter().map(|a| own(a, r)).sum::<f64>() / knots)
        };
        let gradient = (0..point.len()).map(gradient).collect();
        Volume::of_runs(point.to_vec(), &all, gradient)
    }

    /// How the runs scatter about what the others say of them: shifts that the speeds of a run share, from
    /// the products of its misses at different speeds; what is left beyond the frames, speed by speed.
    fn scatter_of_runs(&self, alongside: &[Vec<f64>], weight: &[f64]) -> Scatter {
        let frames = &self.scatter.frames;
        let (n, knots) = (self.coded.len(), self.outputs.len());
        // Miss of run i if it is left out, and the variance of that (Rasmussen and Williams, section 5.4.2).
        let missed = |k: usize, r: usize, i: usize| {
            let own = self.outputs[k][r].inverse[(i, i)];
            (self.alpha[k][i][r] / own, 1.0 / own)
        };
        let all: f64 = weight.iter().sum();
        let mean = |of: &dyn Fn(usize) -> f64| (0..n).map(|i| weight[i] * of(i)).sum::<f64>() / all;
        // How much of the scatter of one run those that it is predicted from add, and what the surface does not know there.
        let others = |k: usize, r: usize, i: usize| -> f64 {
            let inverse = &self.outputs[k][r].inverse;
            (0..n).filter(|j| *j != i).map(|j| (inverse[(i, j)] / inverse[(i, i)]).powi(2)).sum()
        };
        let rows = |of: &dyn Fn(usize, usize, usize) -> f64| -> Vec<[Vec<f64>; 4]> {
            let row = |k: usize, r: usize| (0..n).map(|i| of(k, r, i)).collect();
            (0..knots).map(|k| std::array::from_fn(|r| row(k, r))).collect()
        };
        let of_others = rows(&others);
        let unknown = rows(&|k, r, i| {
            let noise = frames[k][r][r].max(FLOOR) + self.scatter.shift[r].powi(2);
            (missed(k, r, i).1 - noise * (1.0 + of_others[k][r][i])).max(0.0).sqrt()
        });
        // Product of the misses of two responses at unlike speeds, less what the surface does not know at both; with
        // one speed there is nothing to tell shifts by.
        let product = |r: usize, s: usize| {
            let (mut sum, mut count) = (0.0, 0.0f64);
            // A speed at which runs scatter widely says little of what all speeds share.
            let wide = |k: usize, r: usize| mean(&|i| missed(k, r, i).0.powi(2)).max(FLOOR);
            for k in 0..knots {
                for l in (0..knots).filter(|l| *l != k) {
                    let trust = 1.0 / (wide(k, r) * wide(l, s));
                    let both: f64 =
                        alongside[k].iter().zip(&alongside[l]).map(|(a, b)| a * b).sum();
                    sum += trust
                        * mean(&|i| {
                            let ignorance =
                                BESIDE[r][s] * both * unknown[k][r][i] * unknown[l][s][i];
                            missed(k, r, i).0 * missed(l, s, i).0 - ignorance
                        });
                    count +=
                        trust * mean(&|i| 1.0 + (of_others[k][r][i] * of_others[l][s][i]).sqrt());
                }
            }
            (count > 0.0).then(|| sum / count)
        };
        let runs = witnesses(weight);
        let shift: [f64; 4] = std::array::from_fn(|r| {
            // The likelihood was asked on a coarse grid.
            let asked = self.scatter.shift[r];
            // Few runs that happen to lie close do not show that fillings of one volume are alike.
            let least =
                |p: f64| (runs * p.max(0.0) + HALF_SURE * USUAL * USUAL) / (runs + HALF_SURE);
            let drawn = |p: f64| p.max(least(p.min(USUAL * USUAL)));
            let seen = product(r, r);
            seen.map_or(asked, |p| drawn(p).sqrt().clamp(SHIFTS[0].min(asked), 2.0 * asked))
        });
        let together = correlation(SURE * runs / (runs + HALF_SURE), shift, product);
        let swings: Vec<f64> = (0..knots)
            .map(|k| {
                let (mut sum, mut weights) = (0.0, f64::MIN_POSITIVE);
                for r in 0..4 {
                    let frame = frames[k][r][r].max(FLOOR);
                    let noise = frame + self.scatter.shift[r].powi(2);
                    let seen = mean(&|i| {
                        let (miss, variance) = missed(k, r, i);
                        miss * miss - (variance - noise)
                    });
                    let shift = shift[r] * shift[r];
                    let weight = (frame / (frame + shift)).powi(2);
                    sum += weight * (seen - shift) / frame;
                    weights += weight;
                }
                // Few runs that happen to lie far or close do not show that their frames say too little or too much.
                let seen = (runs * (sum / weights).max(0.0) + HALF_SURE) / (runs + HALF_SURE);
                seen.max(LEAST_SWINGS)
            })
            .collect();
        let of_means = |(f, s): (&[[f64; 4]; 4], &f64)| f.map(|row| row.map(|v| v * s));
        let frames = frames.iter().zip(&swings).map(of_means).collect();
        Scatter { shift, together, swings, frames }
    }

    /// With the covariance of a run's means by knot; the shift of fillings is found if it is not given run by run, and what more
    /// volume does if volumes are in excess of the one expected.
    fn with(
        coded: Vec<Vec<f64>>,
        mean: &[&[[f64; 4]]],
        frames: Vec<[[f64; 4]; 4]>,
        given: Option<&[[f64; 4]]>,
        excess: Option<&[f64]>,
    ) -> Result<Self, CalibError> {
        let n = coded.len();
        let kernels = |length: f64| -> Vec<(f64, f64)> {
            (0..n * n)
                .map(|k| {
                    let (i, j) = (k / n, k % n);
                    let (q, s) = kernel(&coded[i], &coded[j], length);
                    let more = |e: &[f64]| e[i] * e[j] * of_volume(&coded[i], &coded[j]);
                    (q + excess.map_or(0.0, more), s)
                })
                .collect()
        };
        // The shift of a run's filling, or one that is tried for all.
        let of_run = |i: usize, r: usize, tried: f64| given.map_or(tried, |all| all[i][r]);
        let noise = |i: usize, (k, r): (usize, usize), tried: f64| {
            frames[k][r][r].max(FLOOR) + of_run(i, r, tried).powi(2)
        };
        let system = |kernels: &[(f64, f64)], amplitude: f64, tried: f64, of: (usize, usize)| {
            Mat::from_fn(n, n, |i, j| {
                let (q, s) = kernels[i * n + j];
                q + amplitude * amplitude * s + if i == j { noise(i, of, tried) } else { 0.0 }
            })
        };
        let output = |k: usize, r: usize| -> (f64, Mat<f64>) {
            let middle = mean.iter().map(|m| m[k][r]).sum::<f64>() / n as f64;
            (middle, Mat::from_fn(n, 1, |i, _| mean[i][k][r] - middle))
        };
        let outputs: Vec<[(f64, Mat<f64>); 4]> =
            (0..frames.len()).map(|k| std::array::from_fn(|r| output(k, r))).collect();
        let fault = || CalibError::Covariance { what: "runs of a surface", size: n };
        let log_likelihood = |of: &[(f64, f64)], amplitude: f64, shift: f64, r: usize| {
            let mut sum = log_prior(amplitude, AMPLITUDE) + log_prior(shift, SHIFT);
            for (k, four) in outputs.iter().enumerate() {
                let llt =
                    system(of, amplitude, shift, (k, r)).llt(Side::Lower).map_err(|_| fault())?;
                let (_, y) = &four[r];
                let alpha = llt.solve(y);
                let fit: f64 = (0..n).map(|i| y[(i, 0)] * alpha[(i, 0)]).sum();
                let log_det: f64 = (0..n).map(|i| llt.L()[(i, i)].ln()).sum();
                sum -= 0.5 * fit + log_det;
            }
            Ok::<f64, CalibError>(sum)
        };
        let mut best = (f64::NEG_INFINITY, LENGTH.0, [(AMPLITUDE.0, SHIFT.0); 4]);
        for length in LENGTHS {
            let of = kernels(length);
            let mut sum = log_prior(length, LENGTH);
            let mut chosen = [(AMPLITUDE.0, SHIFT.0); 4];
            for (r, own) in chosen.iter_mut().enumerate() {
                let mut most = f64::NEG_INFINITY;
                let only = given.map(|all| [all[0][r]]);
                for s in only.as_ref().map_or(&SHIFTS[..], |s| &s[..]) {
                    for amplitude in AMPLITUDES {
                        let l = log_likelihood(&of, amplitude, *s, r)?;
                        if l > most {
                            (most, *own) = (l, (amplitude, *s));
                        }
                    }
                }
                sum += most;
            }
            if sum > best.0 {
                best = (sum, length, chosen);
            }
        }
        let (likelihood, length, chosen) = best;
        if !likelihood.is_finite() {
            return Err(fault());
        }
        let (amplitude, shift) = (chosen.map(|c| c.0), chosen.map(|c| c.1));
        let of = kernels(length);
        let mut fitted = Vec::with_capacity(frames.len());
        let mut alpha = vec![vec![[0.0; 4]; n]; frames.len()];
        for (k, own) in outputs.iter().enumerate() {
            let mut four = Vec::with_capacity(4);
            for (r, a) in amplitude.iter().enumerate() {
                let llt =
                    system(&of, *a, shift[r], (k, r)).llt(Side::Lower).map_err(|_| fault())?;
                let (middle, y) = &own[r];
                let solved = llt.solve(y);
                alpha[k].iter_mut().enumerate().for_each(|(i, row)| row[r] = solved[(i, 0)]);
                let inverse = llt.solve(Mat::<f64>::identity(n, n));
                four.push(Output { middle: *middle, inverse });
            }
            fitted.push(four.try_into().map_err(|_| fault())?);
        }
        let swings = vec![1.0; frames.len()];
        let scatter = Scatter { shift, together: ALONE, swings, frames };
        let volume = Volume::none(scatter.swings.len());
        let shifts = given.map_or_else(|| vec![shift; n], <[_]>::to_vec);
        Ok(Self { coded, shifts, volume, amplitude, length, scatter, outputs: fitted, alpha })
    }

    /// Change of the means at a point for twice the volume, by knot.
    pub(crate) fn of_volume(&self, z: &[f64]) -> Vec<[f64; 4]> {
        self.volume.at(z)
    }

    /// Means at a point of a drum with the volume expected, by knot.
    pub(crate) fn mean(&self, z: &[f64]) -> Vec<[f64; 4]> {
        self.mean_from(&self.to(z))
    }

    /// Kernels between a point and every run, for each response.
    fn to(&self, z: &[f64]) -> Vec<[f64; 4]> {
        let square = self.amplitude.map(|a| a.powi(2));
        let one = |c: &Vec<f64>| {
            let (q, s) = kernel(c, z, self.length);
            square.map(|a| q + a * s)
        };
        self.coded.iter().map(one).collect()
    }

    fn mean_from(&self, to: &[[f64; 4]]) -> Vec<[f64; 4]> {
        let mean = |(four, alpha): (&[Output; 4], &Vec<[f64; 4]>)| {
            let mut sum = [0.0; 4];
            for (k, a) in to.iter().zip(alpha) {
                (0..4).for_each(|r| sum[r] += k[r] * a[r]);
            }
            std::array::from_fn(|r| four[r].middle + sum[r])
        };
        self.outputs.iter().zip(&self.alpha).map(mean).collect()
    }

    /// Means at a point with their covariance, by knot: what the scatter of runs leaves, and what the surface does not
    /// know.
    pub(crate) fn moments(&self, z: &[f64]) -> Local {
        let to = self.to(z);
        let of_response: [Vec<f64>; 4] = std::array::from_fn(|r| to.iter().map(|k| k[r]).collect());
        let (own_q, own_s) = kernel(z, z, self.length);
        let mut local = Local { of_volume: self.of_volume(z), ..Local::default() };
        for ((four, frame), mean) in
            self.outputs.iter().zip(&self.scatter.frames).zip(self.mean_from(&to))
        {
            let mut shared = [0.0; 4];
            let mut unknown = [0.0; 4];
            let mut weights: [Vec<f64>; 4] = Default::default();
            let mut covariance = [[0.0; 4]; 4];
            for r in 0..4 {
                let a = self.amplitude[r].powi(2);
                let k = &of_response[r];
                weights[r] = four[r].weights(k);
                let known: f64 = k.iter().zip(&weights[r]).map(|(k, w)| k * w).sum();
                let all = (own_q + a * own_s - known).max(0.0);
                let square: f64 = weights[r].iter().map(|w| w * w).sum();
                let usual = self.scatter.shift[r].powi(2);
                let more = |(w, s): (&f64, &[f64; 4])| w * w * (s[r].powi(2) - usual);
                let more: f64 = weights[r].iter().zip(&self.shifts).map(more).sum();
                let of_fillings = (square * usual + more).min(all);
                shared[r] = of_fillings.sqrt();
                let of_frames = (square * frame[r][r]).min(all - of_fillings);
                covariance[r][r] = of_frames;
                unknown[r] = (all - of_fillings - of_frames).sqrt();
            }
            for r in 0..4 {
                for s in 0..r {
                    let both: f64 = weights[r].iter().zip(&weights[s]).map(|(a, b)| a * b).sum();
                    let common = both * frame[r][s];
                    let most = (covariance[r][r] * covariance[s][s]).sqrt();
                    covariance[r][s] = common.clamp(-most, most);
                    covariance[s][r] = covariance[r][s];
                }
            }
            local.at.push((mean, covariance));
            local.unknown.push(unknown);
            local.shared.push(shared);
        }
        local
    }
}

/// Number of runs that count alike and tell as much as runs with these weights.
pub(crate) fn witnesses(weight: &[f64]) -> f64 {
    let (sum, squares) =
        weight.iter().fold((0.0, 0.0), |(sum, squares), w| (sum + w, squares + w * w));
    sum * sum / squares
}

/// Correlations of shifts of these sizes from their products, drawn towards none as far as few runs ask for it.
fn correlation(
    sure: f64,
    shift: [f64; 4],
    product: impl Fn(usize, usize) -> Option<f64>,
) -> [[f64; 4]; 4] {
    let mut all = ALONE;
    for r in 0..4 {
        for s in 0..r {
            let seen = 0.5 * (product(r, s).unwrap_or(0.0) + product(s, r).unwrap_or(0.0));
            let value = (sure * seen / (shift[r] * shift[s])).clamp(-sure, sure);
            (all[r][s], all[s][r]) = (value, value);
        }
    }
    // Correlations that are estimated one by one need not go together.
    for _ in 0..60 {
        let rest = Mat::from_fn(4, 4, |r, s| all[r][s] - if r == s { 0.02 } else { 0.0 });
        if rest.llt(Side::Lower).is_ok() {
            return all;
        }
        for (r, row) in all.iter_mut().enumerate() {
            row.iter_mut().enumerate().filter(|(s, _)| *s != r).for_each(|(_, v)| *v *= 0.9);
        }
    }
    ALONE
}

/// Prior covariance of what more volume does at two points.
fn of_volume(a: &[f64], b: &[f64]) -> f64 {
    let both: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
    VOLUME * VOLUME + VOLUME_CHANGES * VOLUME_CHANGES * both
}

/// The quadratic's part and the remainder's, whose amplitude is 1 here.
fn kernel(a: &[f64], b: &[f64], length: f64) -> (f64, f64) {
    let (mut slope, mut square, mut apart) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        let p = x * y;
        slope += p;
        square += p * p;
        apart += (x - y).powi(2);
    }
    let product = 0.5 * (slope * slope - square);
    let quadratic = CONSTANT.powi(2)
        + SLOPE.powi(2) * slope
        + CURVATURE.powi(2) * square
        + PRODUCT.powi(2) * product;
    (quadratic, (-0.5 * apart / length.powi(2)).exp())
}

fn log_prior(value: f64, (middle, sd): (f64, f64)) -> f64 {
    -0.5 * ((value / middle).ln() / sd).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ignorance::alongside;
    use calib::OperatingPoint;

    /// Angle of a bed against the logarithm of friction: rises, then levels off; an effect that acts
    /// beyond a threshold.
    fn surface(z: &[f64]) -> f64 {
        30.0 + 6.0 * (0.8 * z[0]).tanh() + 2.0 * (z[1] - 1.0).max(0.0) * (1.0 - 0.2 * z[0])
    }

    #[test]
    fn the_surface_is_right_near_the_runs_wherever_they_are_and_says_how_right() {
        let mut coded: Vec<Vec<f64>> =
            (0..14).map(|k| vec![-3.25 + 0.5 * f64::from(k), 0.0]).collect();
        coded.extend((0..4).map(|k| vec![0.0, 0.02 * f64::from(k)]));
        coded.extend([-1.0, 1.0].map(|v| vec![0.0, v]));
        // A refinement far from where the effect is absent.
        coded.extend(
            (0..9).map(|k| vec![1.5 + 0.35 * f64::from(k % 3), 3.3 + 0.35 * f64::from(k / 3)]),
        );
        let noise = |k: usize| 0.05 * (1.7 * k as f64).sin();
        let runs: Vec<[[f64; 4]; 1]> = coded
            .iter()
            .enumerate()
            .map(|(k, z)| [std::array::from_fn(|r| surface(z) + noise(4 * k + r))])
            .collect();
        let rows: Vec<&[[f64; 4]]> = runs.iter().map(|r| &r[..]).collect();
        let mut frame = [[0.0005; 4]; 4];
        (0..4).for_each(|r| frame[r][r] = 0.001);
        let process = Process::fit(
            (coded, vec![0.0; 29]),
            &[0.0; 2],
            &rows,
            vec![frame],
            &[vec![1.0]],
            &[1.0; 29],
        )
        .unwrap();
        // Absent, strong, and the frictions of either.
        for z in [[0.3, 0.0], [-1.4, 0.0], [1.9, 0.0], [1.7, 3.6], [2.1, 3.8]] {
            let local = process.moments(&z);
            let (mean, covariance) = local.at[0];
            let sd = (covariance[0][0] + local.shared[0][0].powi(2) + local.unknown[0][0].powi(2))
                .sqrt();
            assert!((mean[0] - surface(&z)).abs() < 0.15, "{z:?} {} {}", mean[0], surface(&z));
            assert!((mean[0] - surface(&z)).abs() < 3.0 * sd && sd < 0.2, "{z:?} {sd}");
        }
        // Between them nothing is known to a tenth of a degree, and it is said.
        assert!(process.moments(&[-2.0, 3.0]).unknown[0][0] > 0.5);
    }

    /// Numbers that look random, standard normal.
    fn normal(seed: &mut u64) -> f64 {
        let mut uniform = || {
            *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (*seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let (a, b) = (uniform().max(1e-12), uniform());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }

    /// How forty runs along a line scatter that share a shift of `shift` over four speeds, and whose means at the
    /// first speed vary by `swings` times what frames show, 0.09.
    fn scatter(shift: f64, swings: f64, mut seed: u64) -> Scatter {
        let coded: Vec<Vec<f64>> = (0..40).map(|k| vec![-1.0 + 0.05 * f64::from(k)]).collect();
        let runs: Vec<[[f64; 4]; 4]> = coded
            .iter()
            .map(|z| {
                let own: [f64; 4] = std::array::from_fn(|_| shift * normal(&mut seed));
                std::array::from_fn(|k| {
                    let sd = 0.3 * if k == 0 { swings.sqrt() } else { 1.0 };
                    own.map(|s| 30.0 + 3.0 * z[0] + s + sd * normal(&mut seed))
                })
            })
            .collect();
        let rows: Vec<&[[f64; 4]]> = runs.iter().map(|r| &r[..]).collect();
        let frame = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * 0.09));
        let alongside = alongside(&[15.0, 30.0, 45.0, 60.0].map(OperatingPoint::from)).unwrap();
        let runs = (coded, vec![0.0; 40]);
        Process::fit(runs, &[0.0], &rows, vec![frame; 4], &alongside, &[1.0; 40]).unwrap().scatter
    }

    #[test]
    fn a_shift_of_all_speeds_and_a_slow_swing_of_one_are_told_apart() {
        // Forty runs tell a variance to 22 %, four responses together to 11 %.
        let quiet = scatter(0.0, 1.0, 5);
        assert!(quiet.shift.iter().all(|s| *s < 0.2), "{quiet:?}");
        assert!(quiet.swings.iter().all(|s| *s < 1.4), "{quiet:?}");
        let shifted = scatter(0.6, 1.0, 6);
        assert!(shifted.shift.iter().all(|s| (0.4..0.8).contains(s)), "{shifted:?}");
        assert!(shifted.swings.iter().all(|s| *s < 1.6), "{shifted:?}");
        let swinging = scatter(0.0, 6.0, 7);
        assert!((4.0..8.0).contains(&swinging.swings[0]), "{swinging:?}");
        assert!(swinging.swings[1..].iter().all(|s| *s < 1.6), "{swinging:?}");
        assert!((swinging.frames[0][0][0] / 0.09 - swinging.swings[0]).abs() < 1e-9);
    }

    #[test]
    fn what_the_volume_of_fillings_does_is_no_scatter_where_it_is_known() {
        let mut seed = 11;
        let does = [25.0, 40.0, -8.0, -42.0];
        let coded: Vec<Vec<f64>> = (0..36).map(|k| vec![-1.0 + 0.055 * f64::from(k)]).collect();
        let excess: Vec<f64> = coded.iter().map(|_| 0.016 * normal(&mut seed)).collect();
        let mut one = |z: f64, e: f64| -> [[f64; 4]; 6] {
            let mut mean = || -> [f64; 4] {
                std::array::from_fn(|r| 30.0 + 3.0 * z + e * does[r] + 0.2 * normal(&mut seed))
            };
            std::array::from_fn(|_| mean())
        };
        let runs: Vec<[[f64; 4]; 6]> =
            coded.iter().zip(&excess).map(|(z, e)| one(z[0], *e)).collect();
        let rows: Vec<&[[f64; 4]]> = runs.iter().map(|r| &r[..]).collect();
        let frame = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * 0.04));
        let alongside =
            alongside(&[15.0, 25.0, 35.0, 45.0, 55.0, 70.0].map(OperatingPoint::from)).unwrap();
        let fit = |excess: Vec<f64>| {
            let runs = (coded.clone(), excess);
            Process::fit(runs, &[0.0], &rows, vec![frame; 6], &alongside, &[1.0; 36]).unwrap()
        };
        let known = fit(excess);
        // A slope of six speeds of 36 runs: 0.2 / (0.016 * 6 * 2.4) = 0.9, and half as much again for what the surface takes.
        for of_volume in known.of_volume(&[0.0]) {
            for r in 0..4 {
                assert!((of_volume[r] - does[r]).abs() < 6.0, "{of_volume:?}");
            }
        }
        let blind = fit(vec![0.0; 36]);
        // 0.016 of 42 is 0.67, of 40 0.64; none of it is left.
        for r in [1, 3] {
            assert!(blind.scatter.shift[r] > 0.45, "{:?}", blind.scatter);
            assert!(known.scatter.shift[r] < 0.15, "{:?}", known.scatter);
        }
    }
}
