//! Coulomb force of two charges, and of a charge and its image in a plane wall.
//!
//! - charges: `F = -q_i q_j/(4 pi eps D^2)`, `U = q_i q_j/(4 pi eps D)`
//! - image: `F = kappa q^2/(16 pi eps H^2)`, `U = -kappa q^2/(16 pi eps H)`,
//!   `kappa = (eps_w - eps_m)/(eps_w + eps_m)` (1 for a conductor)
//!
//! - `F` attraction, N; `U` energy, J; `q` charges, C; `D` distance of the centres, m
//! - `H` distance of the centre from the wall, m; `eps = eps_0 eps_r` permittivity, F/m;
//!   `eps_w`, `eps_m` relative permittivities of wall and medium
//!
//! Validity: charge spread evenly over each sphere (or in its centre), charges of their own only;
//! the polarisation of a sphere by its neighbour is neglected. Both are cut off at a gap `range`,
//! where the energy is shifted to 0; the force there is what the cut neglects.
//! Reference: J. D. Jackson, *Classical Electrodynamics*, ch. 2 and 4; thesis section 3.3.
//! Departure: the image of one plane wall; images of images between two walls are left out.

use super::{NonContactForce, NonContactResponse, Separation};
use crate::contact::error::{LawError, positive};
use crate::contact::kinematics::PairGeometry;

/// Permittivity of vacuum, F/m (CODATA 2018).
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_812_8e-12;

/// Parameters of [`Coulomb`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct CoulombSpec {
    /// Relative permittivity of the medium (1 for air).
    pub relative_permittivity: f64,
    /// Gap beyond which the force is neglected, m.
    pub range: f64,
}

/// Coulomb force of two charged bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    /// Relative permittivity of the medium.
    pub relative_permittivity: f64,
    /// Gap beyond which the force is neglected, m.
    pub range: f64,
}

impl TryFrom<CoulombSpec> for Coulomb {
    type Error = LawError;
    fn try_from(spec: CoulombSpec) -> Result<Self, LawError> {
        Ok(Self {
            relative_permittivity: positive(
                "Coulomb",
                "relative_permittivity",
                spec.relative_permittivity,
            )?,
            range: positive("Coulomb", "range", spec.range)?,
        })
    }
}

impl NonContactForce for Coulomb {
    type Memory = ();

    #[inline]
    fn respond(&self, _: &PairGeometry, s: &Separation, (): &mut ()) -> NonContactResponse {
        if s.gap > self.range {
            return NonContactResponse::default();
        }
        let four_pi_eps =
            4.0 * std::f64::consts::PI * VACUUM_PERMITTIVITY * self.relative_permittivity;
        let strength = s.charge_i * s.charge_j / four_pi_eps;
        let farthest = s.distance - s.gap + self.range;
        NonContactResponse {
            attraction: -strength / (s.distance * s.distance),
            energy: strength / s.distance - strength / farthest,
            lost_energy: 0.0,
        }
    }

    fn range(&self, _: &PairGeometry) -> f64 {
        self.range
    }
}

/// Parameters of [`ImageCharge`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ImageChargeSpec {
    /// Relative permittivity of the medium (1 for air).
    pub relative_permittivity: f64,
    /// Relative permittivity of the wall; a conductor where absent.
    #[cfg_attr(feature = "serde", serde(default))]
    pub wall_permittivity: Option<f64>,
    /// Gap beyond which the force is neglected, m.
    pub range: f64,
}

/// Attraction of a charge by its image in a plane wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageCharge {
    /// Relative permittivity of the medium.
    pub relative_permittivity: f64,
    /// Strength `kappa` of the image: 1 for a conductor, 0 for a wall like the medium.
    pub image: f64,
    /// Gap beyond which the force is neglected, m.
    pub range: f64,
}

impl TryFrom<ImageChargeSpec> for ImageCharge {
    type Error = LawError;
    fn try_from(spec: ImageChargeSpec) -> Result<Self, LawError> {
        const LAW: &str = "ImageCharge";
        let medium = positive(LAW, "relative_permittivity", spec.relative_permittivity)?;
        let image = match spec.wall_permittivity {
            Some(w) => {
                let w = positive(LAW, "wall_permittivity", w)?;
                (w - medium) / (w + medium)
            }
            None => 1.0,
        };
        Ok(Self {
            relative_permittivity: medium,
            image,
            range: positive(LAW, "range", spec.range)?,
        })
    }
}

impl NonContactForce for ImageCharge {
    type Memory = ();

    #[inline]
    fn respond(&self, _: &PairGeometry, s: &Separation, (): &mut ()) -> NonContactResponse {
        if s.gap > self.range {
            return NonContactResponse::default();
        }
        let sixteen_pi_eps =
            16.0 * std::f64::consts::PI * VACUUM_PERMITTIVITY * self.relative_permittivity;
        let strength = self.image * s.charge_i * s.charge_i / sixteen_pi_eps;
        let farthest = s.distance - s.gap + self.range;
        NonContactResponse {
            attraction: strength / (s.distance * s.distance),
            energy: strength / farthest - strength / s.distance,
            lost_energy: 0.0,
        }
    }

    fn range(&self, _: &PairGeometry) -> f64 {
        self.range
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const PAIR: PairGeometry =
        PairGeometry { r_star: 5e-4, m_star: 1e-6, radius_i: 1e-3, radius_j: 1e-3 };

    fn apart(distance: f64, radii: f64, q_i: f64, q_j: f64) -> Separation {
        Separation {
            normal_i_to_j: DVec3::X,
            gap: distance - radii,
            distance,
            charge_i: q_i,
            charge_j: q_j,
        }
    }

    #[test]
    fn two_like_nanocoulombs_at_a_centimetre_repel_by_90_micronewton() {
        let law: Coulomb =
            CoulombSpec { relative_permittivity: 1.0, range: 1.0 }.try_into().unwrap();
        let at = |d: f64| law.respond(&PAIR, &apart(d, 2e-3, 1e-9, 1e-9), &mut ());
        // Coulomb's constant 8.98755e9
        assert!((at(0.01).attraction / -8.987_55e-5 - 1.0).abs() < 1e-5);
        let slope = (at(0.01 + 1e-7).energy - at(0.01 - 1e-7).energy) / 2e-7;
        assert!((slope / at(0.01).attraction - 1.0).abs() < 1e-6);
        let opposite = law.respond(&PAIR, &apart(0.01, 2e-3, 1e-9, -1e-9), &mut ());
        assert!(opposite.force_on_i(&apart(0.01, 2e-3, 0.0, 0.0)).x > 0.0);
    }

    #[test]
    fn the_image_in_a_conductor_is_an_opposite_charge_at_twice_the_distance() {
        let image: ImageCharge =
            ImageChargeSpec { relative_permittivity: 1.0, wall_permittivity: None, range: 1.0 }
                .try_into()
                .unwrap();
        let coulomb = Coulomb { relative_permittivity: 1.0, range: 1.0 };
        let wall = image.respond(&PAIR, &apart(0.01, 1e-3, 1e-9, 0.0), &mut ());
        let pair = coulomb.respond(&PAIR, &apart(0.02, 2e-3, 1e-9, -1e-9), &mut ());
        assert!((wall.attraction / pair.attraction - 1.0).abs() < 1e-12);
        let at = |d: f64| image.respond(&PAIR, &apart(d, 1e-3, 1e-9, 0.0), &mut ()).energy;
        let slope = (at(0.01 + 1e-7) - at(0.01 - 1e-7)) / 2e-7;
        assert!((slope / wall.attraction - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_wall_like_the_medium_has_no_image() {
        let image: ImageCharge = ImageChargeSpec {
            relative_permittivity: 2.0,
            wall_permittivity: Some(2.0),
            range: 1.0,
        }
        .try_into()
        .unwrap();
        assert_eq!(image.image, 0.0);
    }
}
