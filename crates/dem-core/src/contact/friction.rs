//! Coulomb limit with static and kinetic friction, kinetic friction depending on sliding speed.
//!
//! While a contact sticks, `|T| <= mu_s N`. Once it slides as a whole,
//! `|T| = mu(v) N` with `mu(v) = mu_k + (mu_s - mu_k) exp(-v / v_c)`
//! until the spring asks for less than that; then it sticks again.
//!
//! - `T` tangential force, N; `N` load of the limit, N (see `NormalResponse::friction_load`)
//! - `v` sliding speed, m/s; `v_c` speed over which static friction fades, m/s
//! - `mu_s`, `mu_k` static and kinetic coefficients, `mu_k <= mu_s`
//!
//! Validity: dry friction, contact area irrelevant. Thesis section 3.5.4 (eq. 28) and eq. 27.
//! Without `v_c` the coefficient drops to `mu_k` as soon as the contact slides.
//! `mu_k > mu_s` is refused: a contact that starts to slide would at once stick again.

use glam::DVec3;

use super::error::{LawError, non_negative, positive};

/// Parameters of [`Friction`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct FrictionSpec {
    /// Static coefficient of friction.
    pub mu_static: f64,
    /// Kinetic coefficient of friction; the static one where absent.
    #[cfg_attr(feature = "serde", serde(default))]
    pub mu_kinetic: Option<f64>,
    /// Speed over which static friction fades into kinetic, m/s; an immediate drop where absent.
    #[cfg_attr(feature = "serde", serde(default))]
    pub decay_speed: Option<f64>,
}

/// Coulomb friction of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Coefficient while the contact sticks.
    pub mu_static: f64,
    /// Coefficient at high sliding speed.
    pub mu_kinetic: f64,
    /// Speed over which static friction fades, m/s (0: an immediate drop).
    pub decay_speed: f64,
}

impl TryFrom<FrictionSpec> for Friction {
    type Error = LawError;
    fn try_from(spec: FrictionSpec) -> Result<Self, LawError> {
        let mu_static = non_negative("Friction", "mu_static", spec.mu_static)?;
        let mu_kinetic =
            non_negative("Friction", "mu_kinetic", spec.mu_kinetic.unwrap_or(mu_static))?;
        if mu_kinetic > mu_static {
            return Err(LawError::Contradiction {
                law: "Friction",
                first: "mu_kinetic",
                first_value: mu_kinetic,
                second: "mu_static",
                second_value: mu_static,
                expected: "kinetic friction cannot exceed static friction",
            });
        }
        let decay_speed = match spec.decay_speed {
            Some(v) => positive("Friction", "decay_speed", v)?,
            None => 0.0,
        };
        Ok(Self { mu_static, mu_kinetic, decay_speed })
    }
}

impl Friction {
    /// One coefficient for sticking and sliding.
    ///
    /// # Errors
    /// A coefficient that is negative or not finite.
    pub fn coulomb(mu: f64) -> Result<Self, LawError> {
        FrictionSpec { mu_static: mu, mu_kinetic: None, decay_speed: None }.try_into()
    }

    /// Coefficient of a contact that slides at `speed` (m/s).
    ///
    /// ```
    /// use dem_core::contact::friction::{Friction, FrictionSpec};
    /// let f: Friction = FrictionSpec {
    ///     mu_static: 0.6, mu_kinetic: Some(0.4), decay_speed: Some(0.1),
    /// }.try_into()?;
    /// assert_eq!(f.sliding_coefficient(0.0), 0.6);
    /// assert!((f.sliding_coefficient(0.1) - (0.4 + 0.2 / 1f64.exp())).abs() < 1e-15);
    /// # Ok::<(), dem_core::contact::error::LawError>(())
    /// ```
    #[inline]
    pub fn sliding_coefficient(&self, speed: f64) -> f64 {
        if self.decay_speed > 0.0 {
            self.mu_kinetic + (self.mu_static - self.mu_kinetic) * (-speed / self.decay_speed).exp()
        } else {
            self.mu_kinetic
        }
    }

    /// `trial` force held to the Coulomb limit under `load` (N, not negative), and whether the
    /// contact slides now.
    #[inline]
    pub fn limit(
        &self,
        trial: DVec3,
        load: f64,
        was_sliding: bool,
        slip_velocity: DVec3,
    ) -> (DVec3, bool) {
        let size2 = trial.length_squared();
        // One coefficient: the common case, and no exponential.
        let one = self.mu_static == self.mu_kinetic;
        let threshold = if was_sliding && !one {
            self.sliding_coefficient(slip_velocity.length()) * load
        } else {
            self.mu_static * load
        };
        if size2 <= threshold * threshold {
            return (trial, false);
        }
        let bound = if one || was_sliding {
            threshold
        } else {
            self.sliding_coefficient(slip_velocity.length()) * load
        };
        (trial * (bound / size2.sqrt()), true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stick_slip() -> Friction {
        FrictionSpec { mu_static: 0.6, mu_kinetic: Some(0.4), decay_speed: Some(0.1) }
            .try_into()
            .unwrap()
    }

    #[test]
    fn sticking_holds_up_to_static_friction_then_drops_to_the_coefficient_of_the_speed() {
        let f = stick_slip();
        let (t, slides) = f.limit(DVec3::X * 5.9, 10.0, false, DVec3::X);
        assert_eq!((t, slides), (DVec3::X * 5.9, false));
        let (t, slides) = f.limit(DVec3::X * 6.1, 10.0, false, DVec3::X);
        // exp(-10) of the fading part is left at ten decay speeds.
        let want = 10.0 * (0.4 + 0.2 * (-10f64).exp());
        assert!(slides && (t.x - want).abs() < 1e-12);
    }

    #[test]
    fn a_sliding_contact_sticks_again_below_kinetic_not_static_friction() {
        let f = stick_slip();
        let v = DVec3::X * 5.0;
        assert!(f.limit(DVec3::X * 4.5, 10.0, true, v).1);
        assert!(!f.limit(DVec3::X * 3.9, 10.0, true, v).1);
    }

    #[test]
    fn an_unloaded_contact_bears_no_shear_and_no_nan() {
        let f = Friction::coulomb(0.5).unwrap();
        assert_eq!(f.limit(DVec3::X, 0.0, false, DVec3::ZERO).0, DVec3::ZERO);
        assert_eq!(f.limit(DVec3::ZERO, 0.0, false, DVec3::ZERO).0, DVec3::ZERO);
    }

    #[test]
    fn kinetic_friction_above_static_is_refused() {
        let spec = FrictionSpec { mu_static: 0.3, mu_kinetic: Some(0.4), decay_speed: None };
        assert!(matches!(Friction::try_from(spec), Err(LawError::Contradiction { .. })));
    }
}
