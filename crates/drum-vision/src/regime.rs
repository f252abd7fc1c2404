//! A guess at the regime of motion from scatter, shape and Froude number.
//!
//! After the thesis (section 4.3): whole and middle angle alike mean rolling or slumping, clearly different ones
//! cascading; a large scatter over the frames means slumping or surging. The Froude number `w^2 R / g` bounds
//! the regimes (H. Henein et al., Metall. Trans. B 14 (1983) 191; J. Mellmann, Powder Technol. 118 (2001) 251,
//! Table 1: slumping 1e-5..1e-3, rolling 1e-4..1e-2, cascading 1e-3..1e-1, cataracting 0.1..1, centrifuging above 1).

/// Standard gravity, m/s2.
const GRAVITY_M_S2: f64 = 9.80665;

/// Regime of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Regime {
    /// The bed rests at a low angle and slides on the wall.
    Sliding,
    /// The bed swings as a whole: it adheres, then slides back.
    Surging,
    /// Avalanches one after another: the angle scatters about a flat surface.
    Slumping,
    /// Steady flow, flat surface.
    Rolling,
    /// Steady flow, S-shaped surface.
    Cascading,
    /// Particles fly: Froude number above 0.1.
    Cataracting,
    /// Particles stick to the wall: Froude number above 1.
    Centrifuging,
}

/// Froude number `w^2 R / g` of a drum.
///
/// ```
/// // 17 rpm in a drum of 125 mm radius.
/// assert!((drum_vision::regime::froude(17.0, 0.125) - 0.0404).abs() < 1e-4);
/// ```
#[must_use]
pub fn froude(speed_rpm: f64, drum_radius_m: f64) -> f64 {
    let omega = speed_rpm * std::f64::consts::TAU / 60.0;
    omega * omega * drum_radius_m / GRAVITY_M_S2
}

/// What the guess rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signs {
    /// Mean angle over the whole surface, degrees.
    pub aor_lin_deg: f64,
    /// Its standard deviation over the frames; `None` for a single frame.
    pub aor_lin_sd: Option<f64>,
    /// Mean S-shape, degrees.
    pub s_shape_deg: f64,
    /// Apparent fill.
    pub fill: f64,
    /// Froude number, where speed and radius are known.
    pub froude: Option<f64>,
}

/// Scatter from which the bed does not move steadily, degrees: the thesis's steady beds stay below 0.8, its slumping and
/// surging ones reach 1 to 5.
const UNSTEADY_SD_DEG: f64 = 1.0;
/// S-shape from which a surface counts as curved, degrees.
const CURVED_DEG: f64 = 2.0;
/// Below this angle no free surface of solid particles flows: the bed slides.
const SLIDING_DEG: f64 = 15.0;

/// Guesses the regime.
#[must_use]
pub fn guess(signs: &Signs) -> Regime {
    if let Some(fr) = signs.froude {
        if fr > 1.0 {
            return Regime::Centrifuging;
        }
        if fr > 0.1 && signs.fill > 0.2 {
            return Regime::Cataracting;
        }
    }
    let unsteady = signs.aor_lin_sd.is_some_and(|sd| sd > UNSTEADY_SD_DEG);
    let curved = signs.s_shape_deg.abs() > CURVED_DEG;
    match (unsteady, curved) {
        _ if signs.aor_lin_deg < SLIDING_DEG && !unsteady => Regime::Sliding,
        // Avalanches change the slope of a flat surface; a bed that swings as a whole does so by more.
        (true, _) if signs.aor_lin_sd.is_some_and(|sd| sd > 3.0) => Regime::Surging,
        (true, _) => Regime::Slumping,
        (false, true) => Regime::Cascading,
        (false, false) => Regime::Rolling,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_sign_leads_to_its_regime() {
        let base = Signs {
            aor_lin_deg: 30.0,
            aor_lin_sd: Some(0.3),
            s_shape_deg: 0.5,
            fill: 0.35,
            froude: Some(5e-3),
        };
        assert_eq!(guess(&base), Regime::Rolling);
        assert_eq!(guess(&Signs { s_shape_deg: 4.0, ..base }), Regime::Cascading);
        assert_eq!(guess(&Signs { aor_lin_sd: Some(1.8), ..base }), Regime::Slumping);
        assert_eq!(guess(&Signs { aor_lin_sd: Some(4.0), ..base }), Regime::Surging);
        assert_eq!(guess(&Signs { aor_lin_deg: 9.0, ..base }), Regime::Sliding);
        assert_eq!(guess(&Signs { froude: Some(0.3), ..base }), Regime::Cataracting);
        assert_eq!(guess(&Signs { froude: Some(1.2), ..base }), Regime::Centrifuging);
    }
}
