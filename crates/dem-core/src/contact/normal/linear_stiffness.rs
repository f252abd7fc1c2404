//! Linear stiffness that stands in for Hertz at one speed of impact.
//!
//! With Hertz's elastic impact at speed `v`: peak overlap `d`, peak force `F`, duration `t`
//!
//! - peak overlap (and so peak energy): `k = m* v^2 / d^2 = 16/15 E* sqrt(R* d)`
//! - peak force: `k = F^2 / (m* v^2)`, which is 25/16 of the first
//! - duration: `k = m* (pi/t)^2`, which is `(pi/2.9433)^2` of the first
//!
//! - `k` N/m; `m*` kg; `v` m/s; `d` m; `F` N; `t` s; `E*` Pa; `R*` m
//!
//! Validity: one representative speed; peak overlap, force and duration cannot all be matched.
//! Reference: H. A. Navarro, M. P. de Souza Braun, *Powder Technology* 246 (2013) 707-722,
//! doi:10.1016/j.powtec.2013.05.049 (thesis section 3.5.1). Departure: the elastic closed forms
//! are used; damping changes them by its own factor.

use super::hertz::ElasticImpact;
use crate::contact::error::{LawError, positive};

/// What the linear contact shares with Hertz's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum HertzMatch {
    /// Largest overlap, and with it the largest stored energy.
    PeakOverlap,
    /// Largest force.
    PeakForce,
    /// Duration of the contact.
    Duration,
}

/// Linear stiffness (N/m) equivalent to Hertz with `e_star` (Pa), `r_star` (m), `m_star` (kg) at
/// the impact speed `speed` (m/s).
///
/// # Errors
/// An argument that is not positive.
///
/// ```
/// use dem_core::contact::normal::{HertzMatch, linear_stiffness};
/// // 6 mm glass beads at 0.5 m/s: some 10^6 N/m
/// let k = linear_stiffness(25e9, 1.5e-3, 1.4e-4, 0.5, HertzMatch::PeakOverlap)?;
/// assert!(k > 1e6 && k < 4e6, "{k}");
/// # Ok::<(), dem_core::contact::error::LawError>(())
/// ```
pub fn linear_stiffness(
    e_star: f64,
    r_star: f64,
    m_star: f64,
    speed: f64,
    of: HertzMatch,
) -> Result<f64, LawError> {
    const LAW: &str = "linear_stiffness";
    positive(LAW, "e_star", e_star)?;
    positive(LAW, "r_star", r_star)?;
    positive(LAW, "m_star", m_star)?;
    positive(LAW, "speed", speed)?;
    let hertz = ElasticImpact::new(e_star, r_star, m_star, speed);
    Ok(match of {
        HertzMatch::PeakOverlap => m_star * (speed / hertz.peak_overlap).powi(2),
        HertzMatch::PeakForce => (hertz.peak_force / speed).powi(2) / m_star,
        HertzMatch::Duration => m_star * (std::f64::consts::PI / hertz.duration).powi(2),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_matches_stand_in_their_fixed_ratios() {
        let k = |of| linear_stiffness(1e9, 0.01, 0.02, 0.7, of).unwrap();
        let base = k(HertzMatch::PeakOverlap);
        let d = ElasticImpact::new(1e9, 0.01, 0.02, 0.7).peak_overlap;
        assert!((base / (16.0 / 15.0 * 1e9 * (0.01 * d).sqrt()) - 1.0).abs() < 1e-12);
        assert!((k(HertzMatch::PeakForce) / base - 25.0 / 16.0).abs() < 1e-12);
        let ratio = (std::f64::consts::PI / 2.943_275_184).powi(2);
        assert!((k(HertzMatch::Duration) / base - ratio).abs() < 1e-8);
    }
}
