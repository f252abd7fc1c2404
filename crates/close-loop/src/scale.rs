//! In which coordinate a parameter acts about linearly.

/// Coordinate of a parameter.
///
/// ```
/// use close_loop::Scale;
/// // The angle of a bed goes with the logarithm of sliding friction and the root of rolling.
/// assert_eq!(Scale::of("friction.pp", 0.1), Scale::Log);
/// assert!((Scale::Root.forth(0.04) - 0.2).abs() < 1e-15);
/// // A wall of friction 0.27 instead of 0.9 is a quarter of the way to a wall without any.
/// let s = Scale::Saturating;
/// let part = (s.forth(0.27) - s.forth(0.9)) / (s.forth(0.0) - s.forth(0.9));
/// assert!((part - 0.251).abs() < 1e-3);
/// assert_eq!(Scale::of("friction.mantle", 0.1), s);
/// assert!((s.back(s.forth(0.5)) - 0.5).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The value itself.
    Linear,
    /// Its natural logarithm.
    Log,
    /// Its square root.
    Root,
    /// `-exp(-x / 0.2)`: a wall whose friction suffices to carry the bed does no more with twice as much.
    Saturating,
}

/// Friction of walls over which their effect falls to 1/e.
const SATURATION: f64 = 0.2;

impl Scale {
    /// The coordinate of a path whose lowest value is `low`.
    pub fn of(path: &str, low: f64) -> Self {
        match path.split_once('.').map(|(group, _)| group) {
            Some("friction") if path.ends_with("mantle") || path.ends_with("end_plate") => {
                Self::Saturating
            }
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
            Self::Saturating => -(-x / SATURATION).exp(),
        }
    }

    /// Coordinate to value.
    pub fn back(self, t: f64) -> f64 {
        match self {
            Self::Linear => t,
            Self::Log => t.exp(),
            Self::Root => t.max(0.0).powi(2),
            Self::Saturating => -SATURATION * t.min(-1e-12).abs().ln(),
        }
    }

    /// Value half-way between two, by the coordinate.
    pub fn half_way(self, a: f64, b: f64) -> f64 {
        self.back(0.5 * (self.forth(a) + self.forth(b)))
    }

    /// Change of the coordinate over which a response bends noticeably.
    pub fn unit(self, range: (f64, f64)) -> f64 {
        let whole = self.forth(range.1) - self.forth(range.0);
        match self {
            // A factor of 1.42.
            Self::Log => 0.35f64.min(0.5 * whole),
            Self::Root => 0.1f64.min(0.5 * whole),
            Self::Linear | Self::Saturating => 0.25 * whole,
        }
    }
}
