//! Pendular liquid bridge between two spheres, which forms on touching and breaks at a gap.
//!
//! `F = 2 pi R gamma cos(theta)/(1 + 1.05 x + 2.5 x^2)`, `x = h sqrt(R/V)`, `R = 2 R*`
//!
//! breaks at `h_r = (1 + theta/2) V^(1/3)`
//!
//! - `F` attraction, N; `h` gap, m (0 while the bodies overlap); `h_r` rupture distance, m
//! - `V` volume of the bridge, m^3; `gamma` surface tension, N/m; `theta` contact angle, rad
//! - `R` radius of equal spheres; for unequal ones Derjaguin's mean `2 R*`, m
//!
//! Hysteresis: no force before the first touch; then the bridge stands out to `h_r`. The energy
//! that this costs is booked as lost when the bridge forms, so that none is left over at rupture.
//! Validity: small bridges (`V` below about 0.001 `R^3`), contact angle below 50 degrees, no
//! gravity, no viscosity, a constant volume.
//! References: C. D. Willett, M. J. Adams, S. A. Johnson, J. P. K. Seville, *Langmuir* 16 (2000)
//! 9396-9405, doi:10.1021/la000657y (their simple closed form; with half the gap in `x` its numbers
//! are 2.1 and 10, as YADE writes it; MercuryDPM writes it as here); rupture: G. Lian, C. Thornton,
//! M. J. Adams, *J. Colloid Interface Sci.* 161 (1993) 138-147, doi:10.1006/jcis.1993.1452.

use glam::DVec3;

use super::{NonContactForce, NonContactResponse, Separation};
use crate::contact::error::{LawError, positive};
use crate::contact::kinematics::PairGeometry;
use crate::contact::law::Memory;

/// Parameters of [`CapillaryBridge`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct CapillaryBridgeSpec {
    /// Surface tension of the liquid, N/m.
    pub surface_tension: f64,
    /// Contact angle, degrees, 0 to 50.
    pub contact_angle_deg: f64,
    /// Volume of one bridge, m^3.
    pub volume: f64,
}

/// Liquid bridge of one pair of materials.
///
/// ```
/// use dem_core::noncontact::{CapillaryBridge, CapillaryBridgeSpec};
/// // water between 2 mm spheres: a bridge of a nanolitre breaks at 0.1 mm
/// let bridge: CapillaryBridge = CapillaryBridgeSpec {
///     surface_tension: 0.072, contact_angle_deg: 0.0, volume: 1e-12,
/// }.try_into()?;
/// assert!((bridge.rupture_gap() - 1e-4).abs() < 1e-18);
/// # Ok::<(), dem_core::contact::error::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapillaryBridge {
    /// Surface tension times the cosine of the contact angle, N/m.
    pub wetting_tension: f64,
    /// Contact angle, rad.
    pub contact_angle: f64,
    /// Volume of one bridge, m^3.
    pub volume: f64,
}

impl TryFrom<CapillaryBridgeSpec> for CapillaryBridge {
    type Error = LawError;
    fn try_from(spec: CapillaryBridgeSpec) -> Result<Self, LawError> {
        const LAW: &str = "CapillaryBridge";
        let tension = positive(LAW, "surface_tension", spec.surface_tension)?;
        if !(0.0..=50.0).contains(&spec.contact_angle_deg) {
            return Err(LawError::OutOfRange {
                law: LAW,
                parameter: "contact_angle_deg",
                value: spec.contact_angle_deg,
                expected: "an angle of 0 to 50 degrees, where the formula holds",
            });
        }
        let contact_angle = spec.contact_angle_deg.to_radians();
        Ok(Self {
            wetting_tension: tension * contact_angle.cos(),
            contact_angle,
            volume: positive(LAW, "volume", spec.volume)?,
        })
    }
}

/// Whether a bridge stands.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BridgeMemory {
    /// The bodies have touched and the bridge has not broken since.
    pub formed: bool,
}

impl Memory for BridgeMemory {
    const SLOTS: usize = 1;
    #[inline]
    fn store(&self, slots: &mut [f64]) {
        slots[0] = f64::from(u8::from(self.formed));
    }
    #[inline]
    fn load(slots: &[f64]) -> Self {
        Self { formed: slots[0] != 0.0 }
    }
    #[inline]
    fn transport(&mut self, _: DVec3, _: f64) {}
}

impl CapillaryBridge {
    /// Gap at which the bridge breaks, m.
    pub fn rupture_gap(&self) -> f64 {
        (1.0 + 0.5 * self.contact_angle) * self.volume.cbrt()
    }

    /// Work to pull the bodies from touch to rupture, J: lost once a cycle.
    pub fn rupture_energy(&self, r_star: f64) -> f64 {
        self.work(2.0 * r_star, self.rupture_gap())
    }

    /// Work from touch to the gap `h` (m), J: the integral of the force in closed form.
    fn work(&self, radius: f64, h: f64) -> f64 {
        // integral dx/(1 + 1.05 x + 2.5 x^2) = (2/d) atan((5 x + 1.05)/d), d^2 = 10 - 1.05^2
        const D: f64 = 2.982_867_747_654_931;
        let unit = (self.volume / radius).sqrt();
        let at = |x: f64| 2.0 / D * ((5.0 * x + 1.05) / D).atan();
        std::f64::consts::TAU * radius * self.wetting_tension * unit * (at(h / unit) - at(0.0))
    }
}

impl NonContactForce for CapillaryBridge {
    type Memory = BridgeMemory;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        separation: &Separation,
        memory: &mut BridgeMemory,
    ) -> NonContactResponse {
        let rupture = self.rupture_gap();
        let forms = !memory.formed && separation.gap <= 0.0;
        memory.formed = (memory.formed || forms) && separation.gap <= rupture;
        if !memory.formed {
            return NonContactResponse::default();
        }
        let radius = 2.0 * pair.r_star;
        let h = separation.gap.max(0.0);
        let x = h * (radius / self.volume).sqrt();
        let attraction =
            std::f64::consts::TAU * radius * self.wetting_tension / (1.0 + 1.05 * x + 2.5 * x * x);
        let whole = self.work(radius, rupture);
        NonContactResponse {
            attraction,
            // The force goes on below touch, so the energy falls on with the overlap.
            energy: self.work(radius, h) - whole + attraction * (separation.gap - h),
            lost_energy: if forms { whole } else { 0.0 },
        }
    }

    fn range(&self, _: &PairGeometry) -> f64 {
        self.rupture_gap()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAIR: PairGeometry =
        PairGeometry { r_star: 5e-4, m_star: 1e-6, radius_i: 1e-3, radius_j: 1e-3 };

    fn law() -> CapillaryBridge {
        CapillaryBridgeSpec { surface_tension: 0.072, contact_angle_deg: 20.0, volume: 1e-12 }
            .try_into()
            .unwrap()
    }

    fn at(gap: f64, memory: &mut BridgeMemory) -> NonContactResponse {
        let separation = Separation {
            normal_i_to_j: DVec3::X,
            gap,
            distance: 2e-3 + gap,
            charge_i: 0.0,
            charge_j: 0.0,
        };
        law().respond(&PAIR, &separation, memory)
    }

    #[test]
    fn the_bridge_forms_on_touch_stands_to_rupture_and_is_gone_after() {
        let mut m = BridgeMemory::default();
        assert_eq!(at(1e-6, &mut m), NonContactResponse::default());
        let touch = at(0.0, &mut m);
        let want = std::f64::consts::TAU * 1e-3 * 0.072 * 20f64.to_radians().cos();
        assert!((touch.attraction / want - 1.0).abs() < 1e-12);
        assert!(at(0.99 * law().rupture_gap(), &mut m).attraction > 0.0);
        assert_eq!(at(1.01 * law().rupture_gap(), &mut m), NonContactResponse::default());
        assert_eq!(at(1e-6, &mut m), NonContactResponse::default());
    }

    #[test]
    fn the_force_falls_as_in_the_other_notation_of_the_same_formula() {
        // Half the gap over sqrt(V/R), with 2.1 and 10 (Willett et al. 2000, as YADE has it).
        let touch = at(0.0, &mut BridgeMemory::default()).attraction;
        let mut standing = BridgeMemory { formed: true };
        for gap in [1e-6, 2e-5, 9e-5] {
            let plus = 0.5 * gap / (1e-12f64 / 1e-3).sqrt();
            let want = 1.0 / (1.0 + 2.1 * plus + 10.0 * plus * plus);
            assert!((at(gap, &mut standing).attraction / touch / want - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_force_is_the_slope_of_the_energy_and_forming_pays_for_the_well() {
        let mut m = BridgeMemory { formed: true };
        for gap in [-1e-6, 1e-6, 3e-5, 8e-5] {
            let h = 1e-9;
            let slope = (at(gap + h, &mut m).energy - at(gap - h, &mut m).energy) / (2.0 * h);
            assert!((slope / at(gap, &mut m).attraction - 1.0).abs() < 1e-6, "{gap}");
        }
        let touch = at(0.0, &mut BridgeMemory::default());
        assert!((touch.energy + touch.lost_energy).abs() < 1e-12 * touch.lost_energy);
        assert!((touch.lost_energy / law().rupture_energy(PAIR.r_star) - 1.0).abs() < 1e-12);
        assert!(at(law().rupture_gap(), &mut m).energy.abs() < 1e-12 * touch.lost_energy);
    }
}
