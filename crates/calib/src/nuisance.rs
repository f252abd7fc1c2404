//! Uncertain knowns that shift responses, with normal priors.

use rig_schema::Response;

/// How a nuisance enters the responses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// Added to one response at every speed.
    Shift(Response),
    /// Divides both coordinates of the centre of area (an error of the ring radius); linearised
    /// about 1 with the measured values.
    Scale,
}

/// One nuisance.
#[derive(Debug, Clone, PartialEq)]
pub struct Nuisance {
    /// Path.
    pub name: String,
    /// How it enters.
    pub effect: Effect,
    /// Prior mean.
    pub mean: f64,
    /// Prior standard deviation.
    pub sd: f64,
}

/// What the data say of a nuisance at the best fit.
#[derive(Debug, Clone, PartialEq)]
pub struct NuisanceEstimate {
    /// Path.
    pub name: String,
    /// Posterior mean, free parameters held at their best values.
    pub value: f64,
    /// Posterior standard deviation, free parameters held at their best values.
    pub sd: f64,
    /// Distance from the prior mean in prior standard deviations: above 2, the prior is strained.
    pub pull: f64,
}

impl Nuisance {
    /// Paths whose effect on responses is known without a simulation.
    pub const PATHS: [&str; 5] = [
        "measure.bias_lin_deg",
        "measure.bias_mid_deg",
        "measure.offset_x_pct",
        "measure.offset_y_pct",
        "measure.scale",
    ];

    /// A nuisance of the namespace, if its effect on responses is known without a simulation.
    ///
    /// ```
    /// use calib::{Effect, Nuisance};
    /// let shift = Nuisance::from_path("measure.offset_y_pct", 0.0, 3.0).expect("is linear");
    /// assert_eq!(shift.effect, Effect::Shift(rig_schema::Response::CenY));
    /// assert!(Nuisance::from_path("rolling.pp", 0.0, 0.01).is_none());
    /// ```
    pub fn from_path(path: &str, mean: f64, sd: f64) -> Option<Self> {
        let effect = match path {
            "measure.bias_lin_deg" => Effect::Shift(Response::AorLin),
            "measure.bias_mid_deg" => Effect::Shift(Response::AorMid),
            "measure.offset_x_pct" => Effect::Shift(Response::CenX),
            "measure.offset_y_pct" => Effect::Shift(Response::CenY),
            "measure.scale" => Effect::Scale,
            _ => return None,
        };
        Some(Self { name: path.to_owned(), effect, mean, sd })
    }

    /// Change of a response for a unit change of the nuisance, at the measured value `measured`.
    pub fn slope(&self, response: Response, measured: f64) -> f64 {
        match self.effect {
            Effect::Shift(r) => f64::from(u8::from(r == response)),
            Effect::Scale => match response {
                Response::CenX | Response::CenY => -measured,
                Response::AorLin | Response::AorMid => 0.0,
            },
        }
    }

    /// Offset at which the slope acts: a shift's value itself, a scale's departure from 1.
    pub fn departure(&self, value: f64) -> f64 {
        match self.effect {
            Effect::Shift(_) => value,
            Effect::Scale => value - 1.0,
        }
    }
}
