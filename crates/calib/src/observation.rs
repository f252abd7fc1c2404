//! Measured responses with their covariance.

use rig_schema::{MeasuredTable, Response};

use crate::{CalibError, OperatingPoint};

/// How the four responses of one frame vary together, where a table does not say.
///
/// A bed that swings by a small angle about the drum's axis moves all four: both angles up, the
/// centre of area sideways up and downwards down. How much of the scatter is swinging is not
/// printed, so it is an assumption, and results are given under more than one.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum FrameCorrelation {
    /// The responses scatter independently.
    Independent,
    /// Half of the variance is common swinging: correlation 0.5 (centre of area down: -0.5).
    #[default]
    Swinging,
    /// Nearly all is common: correlation 0.9.
    Rigid,
}

impl FrameCorrelation {
    /// All assumptions that are compared.
    pub const ALL: [Self; 3] = [Self::Independent, Self::Swinging, Self::Rigid];

    /// Correlation between two responses of a frame.
    pub fn between(self, a: Response, b: Response) -> f64 {
        if a == b {
            return 1.0;
        }
        let size = match self {
            Self::Independent => 0.0,
            Self::Swinging => 0.5,
            Self::Rigid => 0.9,
        };
        let down = |r: Response| if r == Response::CenY { -1.0 } else { 1.0 };
        size * down(a) * down(b)
    }

    /// Name for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Swinging => "swinging (0.5)",
            Self::Rigid => "rigid (0.9)",
        }
    }
}

/// One measured response at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Which load of the drum, 0 for the rig's own.
    pub load: usize,
    /// Speed, rpm.
    pub omega_rpm: f64,
    /// Which response.
    pub response: Response,
    /// Mean over the frames, deg or percent of R.
    pub mean: f64,
    /// Standard deviation over the frames, same unit.
    pub sd: f64,
}

impl Observation {
    /// Where it was measured.
    pub fn at(&self) -> OperatingPoint {
        OperatingPoint { load: self.load, omega_rpm: self.omega_rpm }
    }

    /// Operating points of observations, each once, in order, and for each observation its element of a prediction at them
    /// ([`crate::Predicted`]).
    pub fn places(items: &[Self]) -> (Vec<OperatingPoint>, Vec<usize>) {
        let points = OperatingPoint::distinct(items.iter().map(Self::at));
        let place = |o: &Self| 4 * points.partition_point(|p| *p < o.at()) + o.response.index();
        let places = items.iter().map(place).collect();
        (points, places)
    }
}

/// All measured responses that are matched, with the covariance of their means.
#[derive(Debug, Clone, PartialEq)]
pub struct Observations {
    /// In the order of load, speed, response.
    pub items: Vec<Observation>,
    /// Independent frames in a mean, for each item.
    pub n_eff: Vec<f64>,
    /// How the responses of one frame vary together.
    pub correlation: FrameCorrelation,
    /// Covariances over the frames that the table gives: (item, item, value).
    given: Vec<(usize, usize, f64)>,
}

impl Observations {
    /// Observations of a table within a range of speeds.
    ///
    /// A missing standard deviation is taken as the median of its response's others. `n_eff` is
    /// the number of independent frames where the table does not give it.
    ///
    /// Returns the observations and the speeds left out because they lie outside the range.
    ///
    /// # Errors
    /// [`CalibError::NoObservations`], [`CalibError::NoScatter`], [`CalibError::NotPositive`].
    pub fn from_table(
        table: &MeasuredTable,
        range_rpm: (f64, f64),
        n_eff: f64,
        correlation: FrameCorrelation,
    ) -> Result<(Self, Vec<f64>), CalibError> {
        if !(n_eff > 0.0 && n_eff.is_finite()) {
            return Err(CalibError::NotPositive { what: "n_eff", value: n_eff });
        }
        let mut typical = [None; 4];
        for r in Response::ALL {
            let mut sds: Vec<f64> = table
                .rows
                .iter()
                .filter_map(|row| row.cells[r.index()]?.sd)
                .filter(|sd| *sd > 0.0)
                .collect();
            sds.sort_by(f64::total_cmp);
            typical[r.index()] = sds.get(sds.len() / 2).copied();
        }
        let mut all = Self { items: Vec::new(), n_eff: Vec::new(), correlation, given: Vec::new() };
        let mut left_out = Vec::new();
        for row in &table.rows {
            if !(range_rpm.0..=range_rpm.1).contains(&row.omega_rpm) {
                left_out.push(row.omega_rpm);
                continue;
            }
            let mut at = [None; 4];
            for r in Response::ALL {
                let Some(cell) = row.cells[r.index()] else { continue };
                let sd = cell.sd.filter(|sd| *sd > 0.0).or(typical[r.index()]);
                let sd = sd.ok_or(CalibError::NoScatter { response: r.column() })?;
                at[r.index()] = Some(all.items.len());
                all.items.push(Observation {
                    load: 0,
                    omega_rpm: row.omega_rpm,
                    response: r,
                    mean: cell.mean,
                    sd,
                });
                all.n_eff.push(row.n_eff.unwrap_or(n_eff));
            }
            for i in 0..4 {
                for j in i + 1..4 {
                    if let (Some(value), Some(a), Some(b)) = (row.covariance[i][j], at[i], at[j]) {
                        all.given.push((a, b, value));
                    }
                }
            }
        }
        if all.items.is_empty() {
            return Err(CalibError::NoObservations { low: range_rpm.0, high: range_rpm.1 });
        }
        Ok((all, left_out))
    }

    /// Observations from items, all with the same number of independent frames.
    ///
    /// # Errors
    /// [`CalibError::NotPositive`] for a standard deviation or `n_eff` that is not above 0.
    pub fn new(
        items: Vec<Observation>,
        n_eff: f64,
        correlation: FrameCorrelation,
    ) -> Result<Self, CalibError> {
        let wrong = items.iter().map(|o| ("sd", o.sd)).chain([("n_eff", n_eff)]);
        for (what, value) in wrong {
            if !(value > 0.0 && value.is_finite()) {
                return Err(CalibError::NotPositive { what, value });
            }
        }
        let n_eff = vec![n_eff; items.len()];
        Ok(Self { items, n_eff, correlation, given: Vec::new() })
    }

    /// The same with another number of independent frames.
    #[must_use]
    pub fn with_n_eff(&self, n_eff: f64) -> Self {
        Self { n_eff: vec![n_eff; self.items.len()], ..self.clone() }
    }

    /// The same under another assumption on the correlation within a frame.
    #[must_use]
    pub fn with_correlation(&self, correlation: FrameCorrelation) -> Self {
        Self { correlation, ..self.clone() }
    }

    /// Only the items for which `keep` holds.
    #[must_use]
    pub fn filter(&self, keep: impl Fn(&Observation) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.items.len()).filter(|i| keep(&self.items[*i])).collect();
        let place = |i: usize| kept.iter().position(|k| *k == i);
        Self {
            items: kept.iter().map(|i| self.items[*i]).collect(),
            n_eff: kept.iter().map(|i| self.n_eff[*i]).collect(),
            correlation: self.correlation,
            given: self
                .given
                .iter()
                .filter_map(|(a, b, v)| Some((place(*a)?, place(*b)?, *v)))
                .collect(),
        }
    }

    /// These, then others, whose frames are not the same even at the same speed.
    #[must_use]
    pub fn followed_by(&self, others: &Self) -> Self {
        let first = self.items.len();
        let mut given = self.given.clone();
        given.extend(others.given.iter().map(|(a, b, v)| (first + a, first + b, *v)));
        for (a, one) in self.items.iter().enumerate() {
            for (b, other) in others.items.iter().enumerate() {
                if one.at() == other.at() {
                    given.push((a, first + b, 0.0));
                }
            }
        }
        Self {
            items: self.items.iter().chain(&others.items).copied().collect(),
            n_eff: self.n_eff.iter().chain(&others.n_eff).copied().collect(),
            correlation: self.correlation,
            given,
        }
    }

    /// The same, measured with another load of the drum.
    #[must_use]
    pub fn with_load(mut self, load: usize) -> Self {
        self.items.iter_mut().for_each(|o| o.load = load);
        self
    }

    /// Operating points, and for each item its element of a prediction at them ([`Observation::places`]).
    pub fn places(&self) -> (Vec<OperatingPoint>, Vec<usize>) {
        Observation::places(&self.items)
    }

    /// Speeds, each once, ascending.
    pub fn speeds_rpm(&self) -> Vec<f64> {
        let mut speeds: Vec<f64> = self.items.iter().map(|o| o.omega_rpm).collect();
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        speeds
    }

    /// Covariance of two means: zero between operating points, frame covariance over `n_eff` within one.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        let (a, b) = (&self.items[i], &self.items[j]);
        if a.at() != b.at() {
            return 0.0;
        }
        let given = self.given.iter().find(|(p, q, _)| (*p, *q) == (i, j) || (*p, *q) == (j, i));
        let frames = match given {
            Some((_, _, value)) => *value,
            None => self.correlation.between(a.response, b.response) * a.sd * b.sd,
        };
        frames / (self.n_eff[i] * self.n_eff[j]).sqrt()
    }
}
