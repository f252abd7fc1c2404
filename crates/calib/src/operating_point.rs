//! Where responses are measured and predicted.

use std::cmp::Ordering;
use std::fmt;

/// A speed at which the drum turns one of its loads.
///
/// Loads are counted from 0, which is the amount of particles that the rig itself holds; the same particles in other amounts
/// follow. Points are ordered by load, then by speed.
///
/// ```
/// use calib::OperatingPoint;
/// let (full, half) = (OperatingPoint::from(24.0), OperatingPoint { load: 1, omega_rpm: 10.0 });
/// assert!(full.load == 0 && full < half);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct OperatingPoint {
    /// Which load.
    pub load: usize,
    /// Speed, rpm.
    pub omega_rpm: f64,
}

impl OperatingPoint {
    /// Total order, by load, then by speed.
    #[must_use]
    pub fn total_cmp(&self, other: &Self) -> Ordering {
        self.load.cmp(&other.load).then(self.omega_rpm.total_cmp(&other.omega_rpm))
    }

    /// Each once, in order.
    #[must_use]
    pub fn distinct(all: impl IntoIterator<Item = Self>) -> Vec<Self> {
        let mut points: Vec<Self> = all.into_iter().collect();
        points.sort_by(Self::total_cmp);
        points.dedup();
        points
    }
}

impl fmt::Display for OperatingPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} rpm", self.omega_rpm)?;
        if self.load > 0 { write!(f, " with load {}", self.load + 1) } else { Ok(()) }
    }
}

impl From<f64> for OperatingPoint {
    /// The rig's own load at a speed, rpm.
    fn from(omega_rpm: f64) -> Self {
        Self { load: 0, omega_rpm }
    }
}
