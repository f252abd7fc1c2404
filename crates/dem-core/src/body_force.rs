//! Forces on whole bodies: gravity, which may turn, and drag.

use glam::{DQuat, DVec3};

use crate::error::{Error, direction, finite, not_negative};

/// Gravity; its direction may turn, as seen from a drum that stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Gravity {
    /// Acceleration at time zero, m/s2.
    pub acceleration: DVec3,
    /// Axis (any length) about which it turns, if it does.
    pub axis: DVec3,
    /// Rate of the turn, rad/s.
    pub rate: f64,
}

impl Default for Gravity {
    /// No gravity.
    fn default() -> Self {
        Self::steady(DVec3::ZERO)
    }
}

impl Gravity {
    /// Gravity that stays as it is.
    pub fn steady(acceleration: DVec3) -> Self {
        Self { acceleration, axis: DVec3::Z, rate: 0.0 }
    }

    /// Acceleration at `time`, m/s2.
    ///
    /// ```
    /// # use dem_core::body_force::Gravity;
    /// # use glam::DVec3;
    /// let g = Gravity { acceleration: DVec3::NEG_Y * 9.81, axis: DVec3::Z, rate: 1.0 };
    /// let quarter = g.at(std::f64::consts::FRAC_PI_2);
    /// assert!((quarter - DVec3::X * 9.81).length() < 1e-12);
    /// ```
    pub fn at(&self, time: f64) -> DVec3 {
        if self.rate == 0.0 {
            return self.acceleration;
        }
        DQuat::from_axis_angle(self.axis.normalize(), self.rate * time) * self.acceleration
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        finite("gravity (m/s2)", self.acceleration)?;
        direction("axis of gravity's turn", self.axis)?;
        if self.rate.is_finite() {
            Ok(())
        } else {
            Err(Error::Parameter {
                name: "rate of gravity's turn (rad/s)",
                value: self.rate,
                expected: "a finite number",
            })
        }
    }
}

/// Drag of a medium at rest on each body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Drag {
    /// `F = -m rate v`: every body slows down alike; for settling a packing.
    Uniform {
        /// Rate of decay, 1/s.
        rate: f64,
    },
    /// Stokes: `F = -6 pi eta R v`, valid for Reynolds numbers below about 1.
    Stokes {
        /// Viscosity of the medium, Pa s.
        viscosity: f64,
    },
    /// Newton: `F = -c rho pi R^2 |v| v / 2`.
    Newton {
        /// Density of the medium, kg/m3.
        density: f64,
        /// Drag coefficient (0.44 for a sphere at Reynolds numbers from 1e3 to 2e5).
        coefficient: f64,
    },
}

impl Drag {
    /// Force on a body of `mass` (kg) and (bounding) `radius` (m) at `velocity` (m/s), N.
    ///
    /// ```
    /// # use dem_core::body_force::Drag;
    /// # use glam::DVec3;
    /// // A 6 mm bead at 1 m/s in air: about 7.5 uN, a 400th of its weight.
    /// let air = Drag::Newton { density: 1.2, coefficient: 0.44 };
    /// let force = air.force(2.827e-4, 3e-3, DVec3::X);
    /// assert!((force.x + 7.46e-6).abs() < 1e-8);
    /// ```
    #[inline]
    pub fn force(&self, mass: f64, radius: f64, velocity: DVec3) -> DVec3 {
        use std::f64::consts::PI;
        match *self {
            Self::Uniform { rate } => velocity * (-mass * rate),
            Self::Stokes { viscosity } => velocity * (-6.0 * PI * viscosity * radius),
            Self::Newton { density, coefficient } => {
                let area = PI * radius * radius;
                velocity * (-0.5 * coefficient * density * area * velocity.length())
            }
        }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        match *self {
            Self::Uniform { rate } => not_negative("drag rate (1/s)", rate)?,
            Self::Stokes { viscosity } => not_negative("viscosity (Pa s)", viscosity)?,
            Self::Newton { density, coefficient } => {
                not_negative("density of the medium (kg/m3)", density)?;
                not_negative("drag coefficient", coefficient)?
            }
        };
        Ok(())
    }
}
