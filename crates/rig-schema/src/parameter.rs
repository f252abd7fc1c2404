//! Declaration of one thing that can vary.

use std::fmt;

/// Where a parameter acts; a camera or measuring parameter costs no new simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Layer {
    /// Changes the particles' motion.
    Physics,
    /// Changes the picture of a motion.
    Camera,
    /// Changes what is read from a picture.
    Measurement,
}

impl fmt::Display for Layer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Physics => "physics",
            Self::Camera => "camera",
            Self::Measurement => "measurement",
        })
    }
}

/// Physically possible sign of a parameter's departure from its nominal value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Sign {
    /// Can only lie above the nominal value (cohesion).
    Positive,
    /// Can only lie below the nominal value (kinetic over static friction).
    Negative,
    /// Can lie on either side (camera roll).
    Either,
}

/// One thing that can vary: its path and what is known of it beforehand.
///
/// ```
/// use rig_schema::{Layer, namespace};
/// let roll = namespace::find("camera.roll_deg").expect("is declared");
/// assert_eq!((roll.unit, roll.nominal, roll.layer), ("deg", Some(0.0), Layer::Camera));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Path: group and name, the key in every file.
    pub path: &'static str,
    /// Unit; `"1"` for a pure number.
    pub unit: &'static str,
    /// Value where a rig gives none; `None` if the rig must give it to have one.
    pub nominal: Option<f64>,
    /// Lowest and highest value that is accepted.
    pub range: (f64, f64),
    /// Physically possible sign of the departure from nominal.
    pub sign: Sign,
    /// Where it acts.
    pub layer: Layer,
    /// What it stands for, in one line.
    pub meaning: &'static str,
}

impl Parameter {
    /// Group: the part of the path before the dot.
    pub fn group(&self) -> &'static str {
        self.path.split_once('.').map_or(self.path, |(group, _)| group)
    }

    /// Name: the part of the path after the dot.
    pub fn name(&self) -> &'static str {
        self.path.split_once('.').map_or("", |(_, name)| name)
    }

    /// Whether `value` is finite and within the range.
    pub fn accepts(&self, value: f64) -> bool {
        value.is_finite() && (self.range.0..=self.range.1).contains(&value)
    }
}
