//! In which coordinate a parameter acts about linearly.

/// Coordinate of a parameter.
///
/// ```
/// use close_loop::Scale;
/// // The angle of a bed goes with the logarithm of sliding friction and the root of rolling.
/// assert_eq!(Scale::of("friction.pp", 0.1), Scale::Log);
/// assert!((Scale::Root.forth(0.04) - 0.2).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The value itself.
    Linear,
    /// Its natural logarithm.
    Log,
    /// Its square root.
    Root,
}

impl Scale {
    /// The coordinate of a path whose lowest value is `low`.
    pub fn of(path: &str, low: f64) -> Self {
        match path.split_once('.').map(|(group, _)| group) {
            Some("rolling") if low >= 0.0 => Self::Root,
            Some("friction" | "stiffness") if low > 0.0 => Self::Log,
            _ => Self::Linear,
        }
    }

    /// Value to coordinate.
    pub fn forth(self, x: f64) -> f64 {
        match self {
            Self::Linear => x,
            Self::Log => x.max(f64::MIN_POSITIVE).ln(),
            Self::Root => x.max(0.0).sqrt(),
        }
    }

    /// Coordinate to value.
    pub fn back(self, t: f64) -> f64 {
        match self {
            Self::Linear => t,
            Self::Log => t.exp(),
            Self::Root => t.max(0.0).powi(2),
        }
    }

    /// Change of the coordinate over which a response bends noticeably.
    pub fn unit(self, range: (f64, f64)) -> f64 {
        let whole = self.forth(range.1) - self.forth(range.0);
        match self {
            // A factor of 1.42.
            Self::Log => 0.35f64.min(0.5 * whole),
            Self::Root => 0.1f64.min(0.5 * whole),
            Self::Linear => 0.25 * whole,
        }
    }
}
