//! Measured responses at a speed between two measured ones.

use crate::{Observation, Observations};

impl Observations {
    /// The observations at one speed; between two measured speeds each response is interpolated
    /// linearly, its variance with the squared weights, and taken as one measurement.
    ///
    /// `None` outside the measured range.
    #[must_use]
    pub fn at_speed(&self, omega_rpm: f64) -> Option<Self> {
        let speeds = self.speeds_rpm();
        if speeds.iter().any(|s| (s - omega_rpm).abs() < 1e-9) {
            return Some(self.filter(|o| (o.omega_rpm - omega_rpm).abs() < 1e-9));
        }
        let above = speeds.partition_point(|s| *s < omega_rpm);
        if above == 0 || above == speeds.len() {
            return None;
        }
        let (low, high) = (speeds[above - 1], speeds[above]);
        let t = (omega_rpm - low) / (high - low);
        let (before, after) =
            (self.filter(|o| o.omega_rpm == low), self.filter(|o| o.omega_rpm == high));
        let mut items = Vec::new();
        for a in &before.items {
            let Some(b) = after.items.iter().find(|b| b.response == a.response) else { continue };
            let variance = ((1.0 - t) * a.sd).powi(2) + (t * b.sd).powi(2);
            items.push(Observation {
                load: a.load,
                omega_rpm,
                response: a.response,
                mean: (1.0 - t) * a.mean + t * b.mean,
                sd: variance.sqrt(),
            });
        }
        if items.is_empty() {
            return None;
        }
        Self::new(items, before.n_eff[0], self.correlation).ok()
    }
}
