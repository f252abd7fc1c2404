//! Restitution of a viscously damped contact against its damping ratio.
//!
//! A linear spring-dashpot `m x'' + c x' + k x = 0` has the damping ratio
//! `zeta = c / (2 sqrt(k m))`. With `rho = zeta / sqrt(|1 - zeta^2|)`:
//!
//! - attractive tail kept (the contact ends at overlap 0), `zeta < 1`: `e = exp(-pi rho)`;
//! - tail cut off (the contact ends where the force would turn attractive):
//!   `e = exp(-rho (pi - 2 atan rho))` for `zeta < 1`, `exp(-2)` at 1, and
//!   `e = ((zeta + s)/(zeta - s))^(-zeta/s)`, `s = sqrt(zeta^2 - 1)`, above.
//!
//! The same function holds for Hertz with `c ~ sqrt(m k)`: with `y = x^(5/4)` the trajectory in
//! the plane of overlap and velocity is that of the linear law, and so is the place where the
//! force vanishes (Antypov and Elliott for the tail kept; for the cut the force is the linear one
//! times `x^(1/4)`, so both vanish together). Hence one function serves both laws.
//!
//! References: T. Schwager, T. Poeschel, *Granular Matter* 9 (2007) 465-469,
//! doi:10.1007/s10035-007-0065-z (linear, cut); D. Antypov, J. A. Elliott, *EPL* 94 (2011) 50004,
//! doi:10.1209/0295-5075/94/50004 (Hertz, kept). Thesis eq. 16 and 52-54, corrected.

use crate::contact::error::{LawError, restitution};

/// What happens when damping makes the normal force attractive at the end of a rebound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum AttractiveTail {
    /// The force is left as it is: the damper pulls until the overlap is gone.
    Kept,
    /// The force is cut at zero: dry bodies do not pull.
    Cut,
}

/// Coefficient of restitution at the damping ratio `zeta` (0 and up).
///
/// With the tail kept an overdamped pair (`zeta >= 1`) never separates: 0.
///
/// ```
/// use dem_core::contact::normal::restitution::{AttractiveTail, restitution_of};
/// // thesis eq. 16 for e = 0.5, used with the tail cut off, gives 0.550
/// let beta = 2f64.ln() / (2f64.ln().powi(2) + std::f64::consts::PI.powi(2)).sqrt();
/// assert!((restitution_of(beta, AttractiveTail::Kept) - 0.5).abs() < 1e-15);
/// assert!((restitution_of(beta, AttractiveTail::Cut) - 0.550).abs() < 5e-4);
/// ```
pub fn restitution_of(zeta: f64, tail: AttractiveTail) -> f64 {
    use std::f64::consts::PI;
    if tail == AttractiveTail::Kept {
        if zeta >= 1.0 {
            return 0.0;
        }
        return (-PI * zeta / (1.0 - zeta * zeta).sqrt()).exp();
    }
    let s2 = (1.0 - zeta) * (1.0 + zeta);
    if s2.abs() < 1e-10 {
        // The first terms about critical damping: exp(-2 + (2/3) s2), error of order s2^2.
        return (-2.0 + 2.0 / 3.0 * s2).exp();
    }
    if s2 > 0.0 {
        // Full angle pi - 2 atan(rho) as 2 atan(1/rho): no cancellation near zeta = 1.
        let s = s2.sqrt();
        (-2.0 * zeta / s * (s / zeta).atan()).exp()
    } else {
        let s = (-s2).sqrt();
        // ln((zeta+s)/(zeta-s)) = 2 atanh(s/zeta) = 2 ln(zeta + s), as zeta^2 - s^2 = 1.
        (-2.0 * zeta / s * (zeta + s).ln()).exp()
    }
}

/// Damping ratio `zeta` that yields the coefficient of restitution `e`.
///
/// # Errors
/// `e` outside (0, 1]: without rebound the damping would be infinite.
///
/// ```
/// use dem_core::contact::normal::restitution::{AttractiveTail, damping_ratio};
/// // A tenth of the speed left: overdamped, yet separating, once the tail is cut.
/// assert!(damping_ratio(0.1, AttractiveTail::Cut)? > 1.0);
/// assert!((damping_ratio(0.1, AttractiveTail::Kept)? - 0.5912).abs() < 1e-4);
/// # Ok::<(), dem_core::contact::error::LawError>(())
/// ```
pub fn damping_ratio(e: f64, tail: AttractiveTail) -> Result<f64, LawError> {
    let e = restitution("damping_ratio", e)?;
    let ln = e.ln();
    let kept = -ln / (ln * ln + std::f64::consts::PI.powi(2)).sqrt();
    if tail == AttractiveTail::Kept || e == 1.0 {
        return Ok(kept);
    }
    // The cut always needs more damping than the tail kept; e falls strictly with zeta.
    let (mut low, mut high) = (kept, 1.0f64.max(2.0 * kept));
    while restitution_of(high, tail) > e {
        low = high;
        high *= 2.0;
    }
    // Bisection to the last bit: at most ~60 halvings, once per pair of materials.
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return Ok(middle);
        }
        if restitution_of(middle, tail) > e {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cut_tail_turns_a_tenth_into_a_quarter_and_a_half_into_055() {
        for (asked, found) in [(0.1, 0.253), (0.5, 0.550)] {
            let kept = damping_ratio(asked, AttractiveTail::Kept).unwrap();
            assert!((restitution_of(kept, AttractiveTail::Cut) - found).abs() < 1e-3);
        }
    }

    #[test]
    fn damping_ratio_inverts_restitution_for_both_tails() {
        for tail in [AttractiveTail::Kept, AttractiveTail::Cut] {
            for k in 1..=100 {
                let e = f64::from(k) / 100.0;
                let zeta = damping_ratio(e, tail).unwrap();
                // Near critical damping e is flat to about 1e-10 by the series: 1e-9 holds all.
                assert!((restitution_of(zeta, tail) - e).abs() < 1e-9, "{tail:?} {e}");
            }
        }
    }

    #[test]
    fn the_branches_meet_at_critical_damping() {
        let at = |z| restitution_of(z, AttractiveTail::Cut);
        assert!((at(1.0) - (-2f64).exp()).abs() < 1e-15);
        for d in [1e-4, 1e-6, 1e-8] {
            // slope of ln e over zeta at 1 is -4/3
            assert!((at(1.0 - d) - at(1.0) * (4.0 / 3.0 * d).exp()).abs() < 1e-8 + d * d);
            assert!((at(1.0 + d) - at(1.0) * (-4.0 / 3.0 * d).exp()).abs() < 1e-8 + d * d);
        }
    }

    #[test]
    fn a_restitution_of_zero_or_above_one_is_refused() {
        for e in [0.0, -0.1, 1.01, f64::NAN] {
            assert!(damping_ratio(e, AttractiveTail::Cut).is_err());
        }
    }
}
