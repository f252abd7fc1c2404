//! Van der Waals attraction of two spheres after Hamaker, cut off at contact.
//!
//! `F = A R*/(6 h^2)`, `U = -A R*/(6 h)`, `h` never less than `h_min`; zero beyond `h_max`
//!
//! - `F` attraction, N; `U` energy, J (shifted to 0 at `h_max`); `h` gap of the surfaces, m
//! - `A` Hamaker constant, J; `R*` effective radius, m
//! - `h_min` closest gap of two atoms' layers, m (0.165 nm for many solids); `h_max` range, m
//!
//! Below `h_min`, touching bodies included, the force stays what it is there.
//! Validity: `h` much smaller than `R*`, no retardation (below some 10 nm).
//! References: H. C. Hamaker, *Physica* 4 (1937) 1058-1072, doi:10.1016/S0031-8914(37)80203-7;
//! thesis section 3.3 (`E ~ -1/r^6` between molecules; the printed sign is that of a repulsion).
//! Departure: the leading term in `h/R*` of Hamaker's sum.

use super::{NonContactForce, NonContactResponse, Separation};
use crate::contact::error::{LawError, positive};
use crate::contact::kinematics::PairGeometry;

/// Parameters of [`VanDerWaals`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct VanDerWaalsSpec {
    /// Hamaker constant, J.
    pub hamaker_constant: f64,
    /// Gap below which the force grows no further, m.
    pub closest_gap: f64,
    /// Gap beyond which the force is neglected, m.
    pub range: f64,
}

/// Van der Waals attraction of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VanDerWaals {
    /// Hamaker constant, J.
    pub hamaker_constant: f64,
    /// Gap below which the force grows no further, m.
    pub closest_gap: f64,
    /// Gap beyond which the force is neglected, m.
    pub range: f64,
}

impl TryFrom<VanDerWaalsSpec> for VanDerWaals {
    type Error = LawError;
    fn try_from(spec: VanDerWaalsSpec) -> Result<Self, LawError> {
        const LAW: &str = "VanDerWaals";
        let law = Self {
            hamaker_constant: positive(LAW, "hamaker_constant", spec.hamaker_constant)?,
            closest_gap: positive(LAW, "closest_gap", spec.closest_gap)?,
            range: positive(LAW, "range", spec.range)?,
        };
        if law.range <= law.closest_gap {
            return Err(LawError::Contradiction {
                law: LAW,
                first: "range",
                first_value: law.range,
                second: "closest_gap",
                second_value: law.closest_gap,
                expected: "the range must exceed the closest gap",
            });
        }
        Ok(law)
    }
}

impl NonContactForce for VanDerWaals {
    type Memory = ();

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        separation: &Separation,
        (): &mut (),
    ) -> NonContactResponse {
        if separation.gap > self.range {
            return NonContactResponse::default();
        }
        let strength = self.hamaker_constant * pair.r_star / 6.0;
        let h = separation.gap.max(self.closest_gap);
        let attraction = strength / (h * h);
        let energy = strength / self.range - strength / h - attraction * (h - separation.gap);
        NonContactResponse { attraction, energy, lost_energy: 0.0 }
    }

    fn range(&self, _: &PairGeometry) -> f64 {
        self.range
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn at(gap: f64) -> NonContactResponse {
        let law: VanDerWaals =
            VanDerWaalsSpec { hamaker_constant: 6.5e-20, closest_gap: 1.65e-10, range: 1e-8 }
                .try_into()
                .unwrap();
        let pair = PairGeometry { r_star: 5e-7, m_star: 1e-15, radius_i: 1e-6, radius_j: 1e-6 };
        let separation = Separation {
            normal_i_to_j: DVec3::X,
            gap,
            distance: 2e-6 + gap,
            charge_i: 0.0,
            charge_j: 0.0,
        };
        law.respond(&pair, &separation, &mut ())
    }

    #[test]
    fn the_force_is_the_slope_of_the_energy_on_both_sides_of_contact() {
        for gap in [-1e-9, 1e-10, 1e-9, 5e-9] {
            let h = 1e-14;
            let slope = (at(gap + h).energy - at(gap - h).energy) / (2.0 * h);
            assert!((slope / at(gap).attraction - 1.0).abs() < 1e-5, "{gap}");
        }
    }

    #[test]
    fn two_micron_spheres_at_a_nanometre_attract_by_some_nanonewton() {
        let want = 6.5e-20 * 5e-7 / 6.0 / 1e-18;
        assert!((at(1e-9).attraction / want - 1.0).abs() < 1e-12);
        assert_eq!(at(-1e-9).attraction, at(1e-10).attraction);
        assert_eq!(at(1.1e-8), NonContactResponse::default());
        assert!(at(1e-8).energy.abs() < 1e-30);
    }

    #[test]
    fn a_range_within_the_closest_gap_is_refused() {
        let spec = VanDerWaalsSpec { hamaker_constant: 1e-20, closest_gap: 1e-9, range: 1e-10 };
        assert!(matches!(VanDerWaals::try_from(spec), Err(LawError::Contradiction { .. })));
    }
}
