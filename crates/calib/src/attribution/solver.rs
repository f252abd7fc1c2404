//! Bounded Levenberg-Marquardt on whitened residuals.
//!
//! The covariance is held within a search; [`settle`] repeats the search at the covariance of
//! its own result until that stays. Parameters run from 0 to 1 over their ranges, so that one
//! step length and one tolerance serve all. A fit of a draw of the bootstrap starts from points
//! whose derivatives are known and mostly ends after one step.

use super::data::{Data, Weight};
use super::linear::bounded_step;
use super::model::Model;
use crate::CalibError;
use crate::covariance::square;

/// Step of the numerical derivative, part of a range.
const STEP: f64 = 1e-4;

/// Change of chi-square below which a search for reporting ends.
pub(super) const FINE: f64 = 1e-9;

/// Change of chi-square below which a search within the bootstrap ends: a fiftieth of the
/// scatter of chi-square with one degree of freedom.
pub(super) const COARSE: f64 = 0.03;

/// Distance in some coordinate, part of its range, beyond which two ends of searches are two optima.
const DISTINCT: f64 = 0.1;

/// Searches at renewed covariances.
const SETTLINGS: usize = 6;

/// A model at a point with its whitened derivatives.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub(super) unit: Vec<f64>,
    pub(super) mean: Vec<f64>,
    /// Whitened derivative of the mean along each unit parameter.
    pub(super) columns: Vec<Vec<f64>>,
}

/// Result of a search.
#[derive(Debug, Clone)]
pub(super) struct Solved {
    pub(super) unit: Vec<f64>,
    pub(super) white: Vec<f64>,
    pub(super) chi2: f64,
}

/// A model with data and a covariance that is held.
#[derive(Clone, Copy)]
pub(super) struct Search<'a, 's> {
    pub(super) model: &'a Model<'s>,
    pub(super) data: &'a Data,
    pub(super) weight: &'a Weight,
}

impl Search<'_, '_> {
    pub(super) fn mean(&self, unit: &[f64]) -> Result<Vec<f64>, CalibError> {
        let mean = self.model.expected(&self.model.theta(unit), &self.data.points)?;
        Ok(self.data.pick(&mean))
    }

    /// The model at a point with its derivatives, which are taken towards the inside.
    pub(super) fn point(&self, unit: &[f64], mean: Vec<f64>) -> Result<Point, CalibError> {
        let mut columns = Vec::with_capacity(unit.len());
        for k in 0..unit.len() {
            let step = if unit[k] + STEP > 1.0 { -STEP } else { STEP };
            let mut moved = unit.to_vec();
            moved[k] += step;
            let there = self.mean(&moved)?;
            let slope: Vec<f64> = there.iter().zip(&mean).map(|(a, b)| (a - b) / step).collect();
            columns.push(self.weight.whiten(&slope));
        }
        Ok(Point { unit: unit.to_vec(), mean, columns })
    }

    pub(super) fn point_at(&self, unit: &[f64]) -> Result<Point, CalibError> {
        self.point(unit, self.mean(unit)?)
    }

    fn white(&self, y: &[f64], mean: &[f64]) -> Vec<f64> {
        let residual: Vec<f64> = y.iter().zip(mean).map(|(a, b)| a - b).collect();
        self.weight.whiten(&residual)
    }

    /// Search from a point, with one parameter held there if so asked.
    pub(super) fn descend(
        &self,
        y: &[f64],
        start: &Point,
        held: Option<usize>,
        tolerance: f64,
    ) -> Result<Solved, CalibError> {
        let mut at = start.clone();
        let mut white = self.white(y, &at.mean);
        let mut chi2 = square(&white);
        let mut lambda = 0.0;
        for _ in 0..60 {
            let unit = bounded_step(&at.columns, &white, &at.unit, held, lambda);
            let moved = unit.iter().zip(&at.unit).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let foreseen = predicted(&at, &white, &unit);
            if moved < 1e-10 || chi2 - foreseen < 0.1 * tolerance {
                break;
            }
            let mean = self.mean(&unit)?;
            let there = self.white(y, &mean);
            let value = square(&there);
            if value < chi2 {
                let gained = chi2 - value;
                let close = (value - foreseen).abs() < tolerance;
                (white, chi2) = (there, value);
                if gained < tolerance || (close && tolerance >= COARSE) {
                    at.unit = unit;
                    break;
                }
                at = self.point(&unit, mean)?;
                lambda *= 0.1;
                if lambda < 1e-6 {
                    lambda = 0.0;
                }
            } else {
                lambda = if lambda == 0.0 { 1e-2 } else { lambda * 10.0 };
                if lambda > 1e8 {
                    break;
                }
            }
        }
        Ok(Solved { unit: at.unit, white, chi2 })
    }

    /// Best of searches from several starts; those after the first are followed only if their
    /// own straight line promises more than has been found.
    pub(super) fn best(
        &self,
        y: &[f64],
        starts: &[Point],
        tolerance: f64,
    ) -> Result<Option<Solved>, CalibError> {
        let mut best: Option<Solved> = None;
        for start in starts {
            if let Some(known) = best.as_ref().filter(|_| tolerance >= COARSE) {
                let white = self.white(y, &start.mean);
                let unit = bounded_step(&start.columns, &white, &start.unit, None, 0.0);
                if predicted(start, &white, &unit) > known.chi2 - 0.5 {
                    continue;
                }
            }
            let solved = self.descend(y, start, None, tolerance)?;
            if best.as_ref().is_none_or(|b| solved.chi2 < b.chi2) {
                best = Some(solved);
            }
        }
        Ok(best)
    }
}

/// Chi-square that the derivatives at `at` foresee for `unit`.
fn predicted(at: &Point, white: &[f64], unit: &[f64]) -> f64 {
    let mut rest = white.to_vec();
    for ((column, new), old) in at.columns.iter().zip(unit).zip(&at.unit) {
        for (r, c) in rest.iter_mut().zip(column) {
            *r -= c * (new - old);
        }
    }
    square(&rest)
}

/// A fit at the covariance of its own result.
#[derive(Debug, Clone)]
pub(super) struct Settled {
    pub(super) theta: Vec<f64>,
    pub(super) weight: Weight,
    pub(super) point: Point,
    pub(super) white: Vec<f64>,
    pub(super) chi2: f64,
}

impl Settled {
    pub(super) fn deviance(&self) -> f64 {
        self.chi2 + self.weight.log_det
    }
}

/// Fit from several starts (unit ranges); the best deviance wins.
pub(super) fn settle(
    model: &Model<'_>,
    data: &Data,
    starts: &[Vec<f64>],
) -> Result<Settled, CalibError> {
    let first = optima(model, data, starts)?.into_iter().next();
    first.ok_or(CalibError::Lengths { what: "starts of a fit", expected: 1, given: 0 })
}

/// Optima that searches from several starts (unit ranges) end in, best deviance first.
pub(super) fn optima(
    model: &Model<'_>,
    data: &Data,
    starts: &[Vec<f64>],
) -> Result<Vec<Settled>, CalibError> {
    let mut found: Vec<Settled> = Vec::new();
    for start in starts {
        let mut unit = start.clone();
        for round in 0..SETTLINGS {
            let (weight, solved) = renewed(model, data, &unit, None)?;
            let moved = apart(&solved.unit, &unit);
            unit = solved.unit;
            if (moved < 1e-5 && round > 0) || round + 1 == SETTLINGS {
                let point = Search { model, data, weight: &weight }.point_at(&unit)?;
                let settled = Settled {
                    theta: model.theta(&unit),
                    white: solved.white,
                    chi2: solved.chi2,
                    weight,
                    point,
                };
                let place = found.partition_point(|f| f.deviance() <= settled.deviance());
                found.insert(place, settled);
                break;
            }
        }
    }
    let mut distinct: Vec<Settled> = Vec::new();
    for one in found {
        if distinct.iter().all(|d| apart(&d.point.unit, &one.point.unit) > DISTINCT) {
            distinct.push(one);
        }
    }
    Ok(distinct)
}

/// Search from a point (unit ranges) at the covariance of that point, with one parameter held there if so asked.
pub(super) fn renewed(
    model: &Model<'_>,
    data: &Data,
    unit: &[f64],
    held: Option<usize>,
) -> Result<(Weight, Solved), CalibError> {
    let predicted = model.predict(&model.theta(unit), &data.points)?;
    let weight = data.weight(&predicted, None)?;
    let search = Search { model, data, weight: &weight };
    let start = search.point(unit, data.pick(&predicted.mean))?;
    let solved = search.descend(&data.y, &start, held, FINE)?;
    Ok((weight, solved))
}

/// Where a search with one parameter held ends, at the covariance of its own result.
#[derive(Debug, Clone)]
pub(super) struct Held {
    pub(super) theta: Vec<f64>,
    pub(super) chi2: f64,
    pub(super) deviance: f64,
}

/// Fit from a point (unit ranges) with one parameter held there.
pub(super) fn held(
    model: &Model<'_>,
    data: &Data,
    start: &[f64],
    axis: usize,
) -> Result<Held, CalibError> {
    let mut unit = start.to_vec();
    let (mut chi2, mut deviance) = (f64::INFINITY, f64::INFINITY);
    for round in 0..SETTLINGS {
        let (weight, solved) = renewed(model, data, &unit, Some(axis))?;
        let moved = apart(&solved.unit, &unit);
        (chi2, deviance) = (solved.chi2, solved.chi2 + weight.log_det);
        unit = solved.unit;
        if moved < 1e-5 && round > 0 {
            break;
        }
    }
    Ok(Held { theta: model.theta(&unit), chi2, deviance })
}

/// Largest difference of two points in any coordinate.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Starts spread over the frictions: the middle and the corners of the inner three fifths.
pub(super) fn spread(frictions: usize) -> Vec<Vec<f64>> {
    let mut starts = vec![vec![0.5; frictions]];
    for k in 0..1usize << frictions.min(4) {
        starts.push((0..frictions).map(|i| if k >> i & 1 == 0 { 0.2 } else { 0.8 }).collect());
    }
    starts
}
