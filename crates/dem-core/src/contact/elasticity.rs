//! Elastic constants of one material and of a pair.
//!
//! Symbols: `E` Young's modulus, Pa; `nu` Poisson's ratio; `G = E / (2 (1 + nu))`, Pa.
//!
//! - thesis eq. 13: `1/E* = (1 - nu_i^2)/E_i + (1 - nu_j^2)/E_j`
//! - thesis eq. 22 (with the star that the text dropped): `1/G* = (2 - nu_i)/G_i + (2 - nu_j)/G_j`
//!
//! Reference: K. L. Johnson, *Contact Mechanics*, 1985, ch. 4 and 7.

use super::error::{LawError, positive};

/// Elastic constants of one isotropic material.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Elasticity {
    /// Young's modulus, Pa.
    pub young_modulus: f64,
    /// Poisson's ratio, -1 (exclusive) to 0.5.
    pub poisson_ratio: f64,
}

impl Elasticity {
    /// Checked constants.
    ///
    /// # Errors
    /// A modulus that is not positive, a ratio outside (-1, 0.5].
    pub fn new(young_modulus: f64, poisson_ratio: f64) -> Result<Self, LawError> {
        positive("Elasticity", "young_modulus", young_modulus)?;
        if !(poisson_ratio > -1.0 && poisson_ratio <= 0.5) {
            return Err(LawError::OutOfRange {
                law: "Elasticity",
                parameter: "poisson_ratio",
                value: poisson_ratio,
                expected: "a number above -1 and at most 0.5",
            });
        }
        Ok(Self { young_modulus, poisson_ratio })
    }

    /// Shear modulus `G = E / (2 (1 + nu))`, Pa.
    pub fn shear_modulus(&self) -> f64 {
        self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }
}

/// Elastic constants that two bodies in contact share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticPair {
    /// Effective Young's modulus `E*`, Pa.
    pub e_star: f64,
    /// Effective shear modulus of tangential contact `G*`, Pa.
    pub g_star: f64,
    /// Shear moduli in series, `1/(1/G_i + 1/G_j)`, Pa: what a twisted contact feels.
    pub g_series: f64,
}

impl ElasticPair {
    /// Two deformable bodies.
    ///
    /// ```
    /// use dem_core::contact::elasticity::{ElasticPair, Elasticity};
    /// let glass = Elasticity::new(48e9, 0.20)?;
    /// let pair = ElasticPair::new(&glass, &glass);
    /// assert!((pair.e_star - 25e9).abs() < 1.0); // 48 / (2 (1 - .04)) GPa
    /// # Ok::<(), dem_core::contact::error::LawError>(())
    /// ```
    pub fn new(i: &Elasticity, j: &Elasticity) -> Self {
        let compliance = |m: &Elasticity| (1.0 - m.poisson_ratio.powi(2)) / m.young_modulus;
        let shear = |m: &Elasticity| (2.0 - m.poisson_ratio) / m.shear_modulus();
        Self {
            e_star: 1.0 / (compliance(i) + compliance(j)),
            g_star: 1.0 / (shear(i) + shear(j)),
            g_series: 1.0 / (1.0 / i.shear_modulus() + 1.0 / j.shear_modulus()),
        }
    }

    /// A deformable body on a rigid one: `E* = E/(1 - nu^2)`, `G* = G/(2 - nu)`.
    pub fn on_rigid(i: &Elasticity) -> Self {
        Self {
            e_star: i.young_modulus / (1.0 - i.poisson_ratio.powi(2)),
            g_star: i.shear_modulus() / (2.0 - i.poisson_ratio),
            g_series: i.shear_modulus(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_spheres_have_g_star_of_g_over_twice_two_minus_nu() {
        let m = Elasticity::new(70e9, 0.33).unwrap();
        let pair = ElasticPair::new(&m, &m);
        let want = m.shear_modulus() / (2.0 * (2.0 - 0.33));
        assert!((pair.g_star / want - 1.0).abs() < 1e-15);
        assert!((pair.g_series / (0.5 * m.shear_modulus()) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_poisson_ratio_above_one_half_is_refused() {
        assert!(matches!(Elasticity::new(1e9, 0.51), Err(LawError::OutOfRange { .. })));
        assert!(matches!(Elasticity::new(f64::NAN, 0.3), Err(LawError::NotPositive { .. })));
        assert!(Elasticity::new(1e9, f64::NAN).is_err());
    }
}
