//! Froude number and regime of motion.

/// Forms of motion of a bed in a turning drum, by Froude number.
///
/// Mellmann's ranges overlap; the limits here are the upper ends of slumping, rolling, cascading
/// and cataracting. Slipping needs a smooth wall and is no matter of the Froude number.
/// Reference: J. Mellmann, *Powder Technology* 118 (2001) 251-270,
/// doi:10.1016/S0032-5910(00)00402-2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regime {
    /// Avalanches one by one (below 1e-4).
    Slumping,
    /// A steady flowing layer, a flat surface (below 1e-2).
    Rolling,
    /// A steady flowing layer, a bent surface (below 0.1).
    Cascading,
    /// Particles are thrown off (below 1).
    Cataracting,
    /// Particles stick to the mantle.
    Centrifuging,
}

impl Regime {
    /// The regime at a Froude number.
    ///
    /// ```
    /// use drum_rig::{Regime, froude};
    /// let fr = froude(17.0 * std::f64::consts::TAU / 60.0, 0.125);
    /// assert!((fr - 0.0404).abs() < 1e-4);
    /// assert_eq!(Regime::at(fr), Regime::Cascading);
    /// ```
    pub fn at(froude: f64) -> Self {
        match froude {
            f if f < 1e-4 => Self::Slumping,
            f if f < 1e-2 => Self::Rolling,
            f if f < 0.1 => Self::Cascading,
            f if f < 1.0 => Self::Cataracting,
            _ => Self::Centrifuging,
        }
    }
}

impl std::fmt::Display for Regime {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Slumping => "slumping",
            Self::Rolling => "rolling",
            Self::Cascading => "cascading",
            Self::Cataracting => "cataracting",
            Self::Centrifuging => "centrifuging",
        })
    }
}

/// Froude number `omega^2 R / g` of a drum of radius `radius_m` at `omega` rad/s.
pub fn froude(omega: f64, radius_m: f64) -> f64 {
    omega * omega * radius_m / crate::GRAVITY
}
