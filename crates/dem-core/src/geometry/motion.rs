//! Prescribed motion of a wall: translation, rotation about any axis, vibration.

use glam::{DQuat, DVec3};

use crate::error::{Error, direction, finite};

/// Steady rotation about an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rotation {
    /// A point on the axis, m.
    pub point: DVec3,
    /// Direction of the axis (any length); the rotation is right-handed about it.
    pub axis: DVec3,
    /// Angular speed, rad/s.
    pub rate: f64,
}

/// Harmonic vibration `amplitude (sin(2 pi f t + phase) - sin(phase))`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Vibration {
    /// Amplitude and direction, m.
    pub amplitude: DVec3,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Phase at the start, rad.
    pub phase_rad: f64,
}

/// How a wall moves; the default rests.
///
/// The parts add up: a rotation's axis is carried along by the translation and the vibration.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Motion {
    /// Steady velocity, m/s.
    pub velocity: DVec3,
    /// Rotation, if any.
    pub rotation: Option<Rotation>,
    /// Vibration, if any.
    pub vibration: Option<Vibration>,
}

/// Where a wall is, relative to where it was described.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pose {
    /// Turn about the origin.
    pub rotation: DQuat,
    /// Shift after the turn, m.
    pub translation: DVec3,
}

impl Default for Pose {
    fn default() -> Self {
        Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO }
    }
}

impl Pose {
    /// Image of a point that is fixed to the wall.
    #[inline]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    /// The point of the wall's own frame that now lies at `p`.
    #[inline]
    pub fn inverse_point(&self, p: DVec3) -> DVec3 {
        self.rotation.conjugate() * (p - self.translation)
    }

    pub(crate) fn then(&self, later: &Pose) -> Pose {
        Pose {
            rotation: (later.rotation * self.rotation).normalize(),
            translation: later.rotation * self.translation + later.translation,
        }
    }
}

/// Velocity field of a rigid body: `velocity + spin x (p - point)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RigidVelocity {
    /// Reference point, m.
    pub point: DVec3,
    /// Velocity there, m/s.
    pub velocity: DVec3,
    /// Angular velocity, rad/s.
    pub spin: DVec3,
}

impl RigidVelocity {
    /// Velocity of the body's material at `p`, m/s.
    #[inline]
    pub fn at(&self, p: DVec3) -> DVec3 {
        self.velocity + self.spin.cross(p - self.point)
    }
}

impl Motion {
    /// A rotation at `rate` rad/s about the axis through `point`.
    ///
    /// ```
    /// # use dem_core::geometry::Motion;
    /// # use glam::DVec3;
    /// // A drum of 250 mm at 17 rpm: its mantle runs at 0.2225 m/s.
    /// let drum = Motion::rotating(DVec3::ZERO, DVec3::Z, 17.0 * std::f64::consts::TAU / 60.0);
    /// let v = drum.velocity_at(0.0).at(DVec3::new(0.125, 0.0, 0.0));
    /// assert!((v.y - 0.22253).abs() < 1e-5);
    /// ```
    pub fn rotating(point: DVec3, axis: DVec3, rate: f64) -> Self {
        Self { rotation: Some(Rotation { point, axis, rate }), ..Self::default() }
    }

    /// A steady translation, m/s.
    pub fn translating(velocity: DVec3) -> Self {
        Self { velocity, ..Self::default() }
    }

    /// A harmonic vibration that starts from rest position with phase 0.
    pub fn vibrating(amplitude: DVec3, frequency_hz: f64) -> Self {
        Self {
            vibration: Some(Vibration { amplitude, frequency_hz, phase_rad: 0.0 }),
            ..Self::default()
        }
    }

    /// Check that every number is finite and the axis has a direction.
    ///
    /// # Errors
    /// [`Error::Vector`] or [`Error::Parameter`] that names the offending part.
    pub fn check(&self) -> Result<(), Error> {
        finite("motion velocity (m/s)", self.velocity)?;
        if let Some(r) = &self.rotation {
            finite("rotation point (m)", r.point)?;
            direction("rotation axis", r.axis)?;
            if !r.rate.is_finite() {
                return Err(Error::Parameter {
                    name: "rotation rate (rad/s)",
                    value: r.rate,
                    expected: "a finite number",
                });
            }
        }
        if let Some(v) = &self.vibration {
            finite("vibration amplitude (m)", v.amplitude)?;
            crate::error::not_negative("vibration frequency (Hz)", v.frequency_hz)?;
            if !v.phase_rad.is_finite() {
                return Err(Error::Parameter {
                    name: "vibration phase (rad)",
                    value: v.phase_rad,
                    expected: "a finite number",
                });
            }
        }
        Ok(())
    }

    fn shift(&self, t: f64) -> DVec3 {
        let mut d = self.velocity * t;
        if let Some(v) = &self.vibration {
            let w = std::f64::consts::TAU * v.frequency_hz;
            d += v.amplitude * ((w * t + v.phase_rad).sin() - v.phase_rad.sin());
        }
        d
    }

    /// Displacement of the wall `t` seconds after the motion began.
    pub fn pose_at(&self, t: f64) -> Pose {
        let shift = self.shift(t);
        match &self.rotation {
            None => Pose { rotation: DQuat::IDENTITY, translation: shift },
            Some(r) => {
                let q = DQuat::from_axis_angle(r.axis.normalize(), r.rate * t);
                Pose { rotation: q, translation: r.point - q * r.point + shift }
            }
        }
    }

    /// Velocity field of the wall `t` seconds after the motion began.
    pub fn velocity_at(&self, t: f64) -> RigidVelocity {
        let mut velocity = self.velocity;
        if let Some(v) = &self.vibration {
            let w = std::f64::consts::TAU * v.frequency_hz;
            velocity += v.amplitude * (w * (w * t + v.phase_rad).cos());
        }
        match &self.rotation {
            None => RigidVelocity { point: DVec3::ZERO, velocity, spin: DVec3::ZERO },
            Some(r) => RigidVelocity {
                point: r.point + self.shift(t),
                velocity,
                spin: r.axis.normalize() * r.rate,
            },
        }
    }
}

/// A motion under way: where the wall was when it began, and when that was.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotionState {
    /// The motion.
    pub motion: Motion,
    /// Pose at its beginning.
    pub base: Pose,
    /// Time of its beginning, s.
    pub since: f64,
}

impl MotionState {
    /// Pose at `time`.
    pub fn pose(&self, time: f64) -> Pose {
        self.base.then(&self.motion.pose_at(time - self.since))
    }

    /// Velocity field at `time`.
    pub fn velocity(&self, time: f64) -> RigidVelocity {
        self.motion.velocity_at(time - self.since)
    }

    /// Go on with another motion from `time`; the wall does not jump.
    pub fn change(&mut self, motion: Motion, time: f64) {
        self.base = self.pose(time);
        self.motion = motion;
        self.since = time;
    }
}
