//! Johnson, Kendall and Roberts: adhesion of soft elastic spheres, with neck and pull-off.
//!
//! `delta = a^2/R* - sqrt(2 pi w a/E*)`, `F = 4 E* a^3/(3 R*) - 2 sqrt(2 pi w E* a^3)`,
//! plus an optional dashpot `alpha sqrt(2 m* E* a) delta'`
//!
//! - `F` repulsion, N; `delta` overlap, m (negative while a neck stands); `a` contact radius, m
//! - `w` work of adhesion, J/m^2 (`w = gamma_i + gamma_j - gamma_ij`, so `2 gamma` for equal
//!   solids of surface energy `gamma`); `E*` Pa; `R*` m; `m*` kg
//! - `alpha` damping factor, that of Hertz
//!
//! Under force control the bodies part at the **pull-off force `1.5 pi w R*`**; under displacement
//! control, which is what a DEM contact has, the neck stands past it and tears at
//! `delta_tear = -(3/4) c (c R*/4)^(1/3)`, `c = sqrt(2 pi w/E*)`, with 5/9 of that force.
//! Contact forms at `delta = 0`, where the force jumps to -8/9 of the pull-off force. The
//! energy between forming and tearing is lost, and is booked when the contact forms: the stored
//! energy counts from the torn state, so that nothing is left over when the neck breaks.
//!
//! Validity: large, soft, strongly adhesive bodies (Tabor's number above about 5).
//! References: K. L. Johnson, K. Kendall, A. D. Roberts, *Proc. R. Soc. A* 324 (1971) 301-313,
//! doi:10.1098/rspa.1971.0141; load of the Coulomb limit `F + 2 F_pulloff`: C. Thornton,
//! *J. Phys. D* 24 (1991) 1942-1946, doi:10.1088/0022-3727/24/11/007.
//! Departures: formation at zero overlap instead of a jump across a gap. `stiffness` is `2 E* a`
//! (Hertz's at the same circle), since the true slope is infinite at the tear. Restitution is the
//! input without adhesion only: adhesion takes its energy in addition.

use glam::DVec3;

use super::hertz::damping_factor;
use super::restitution::AttractiveTail;
use crate::contact::error::{LawError, positive};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{Memory, NormalLaw, NormalResponse};

/// Parameters of [`Jkr`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct JkrSpec {
    /// Effective Young's modulus, Pa.
    pub e_star: f64,
    /// Work of adhesion, J/m^2.
    pub work_of_adhesion: f64,
    /// Coefficient of restitution in the absence of adhesion, above 0 and at most 1.
    pub restitution: f64,
}

/// JKR law of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jkr {
    /// Effective Young's modulus, Pa.
    pub e_star: f64,
    /// Work of adhesion, J/m^2.
    pub work_of_adhesion: f64,
    /// Damping factor `alpha`.
    pub damping: f64,
}

impl TryFrom<JkrSpec> for Jkr {
    type Error = LawError;
    fn try_from(spec: JkrSpec) -> Result<Self, LawError> {
        Ok(Self {
            e_star: positive("Jkr", "e_star", spec.e_star)?,
            work_of_adhesion: positive("Jkr", "work_of_adhesion", spec.work_of_adhesion)?,
            damping: damping_factor(spec.restitution, AttractiveTail::Kept)?,
        })
    }
}

/// Whether the bodies have touched and not parted since.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Bond {
    /// Whether a neck stands.
    pub formed: bool,
}

impl Memory for Bond {
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

impl Jkr {
    /// Pull-off force `1.5 pi w R*`, N: what it takes to part the bodies by a steady pull.
    pub fn pull_off_force(&self, r_star: f64) -> f64 {
        1.5 * std::f64::consts::PI * self.work_of_adhesion * r_star
    }

    /// Contact radius under the steady force `force` (N, repulsion positive), m:
    /// `a^3 = 3 R*/(4 E*) (F + 2 P + 2 sqrt(P (F + P)))`, `P` the pull-off force. `None` past it.
    pub fn radius_under(&self, force: f64, r_star: f64) -> Option<f64> {
        let p = self.pull_off_force(r_star);
        if force < -p {
            return None;
        }
        let sum = force + 2.0 * p + 2.0 * (p * (force + p)).sqrt();
        Some((0.75 * r_star / self.e_star * sum).cbrt())
    }

    /// Gap at which the neck tears, m.
    pub fn tear_gap(&self, r_star: f64) -> f64 {
        let c = self.c();
        0.75 * c * tear_root(c, r_star)
    }

    /// Contact radius at the overlap `delta` (m) of a standing contact, m.
    pub fn contact_radius(&self, delta: f64, r_star: f64) -> f64 {
        let c = self.c();
        let s = root_of_radius(c * r_star, tear_root(c, r_star), delta * r_star);
        s * s
    }

    /// Energy lost between forming and tearing the contact, J.
    pub fn hysteresis(&self, r_star: f64) -> f64 {
        let c = self.c();
        let torn = self.energy(c, tear_root(c, r_star), r_star);
        torn - self.energy(c, (c * r_star).cbrt(), r_star)
    }

    #[inline]
    fn c(&self) -> f64 {
        (std::f64::consts::TAU * self.work_of_adhesion / self.e_star).sqrt()
    }

    /// Energy `integral F d delta` from `a = 0` at `s = sqrt(a)`, J.
    #[inline]
    fn energy(&self, c: f64, s: f64, r_star: f64) -> f64 {
        let s4 = s * s * s * s;
        let x = s * s * s / r_star;
        self.e_star * s4 * (8.0 / 15.0 * x * x - 4.0 / 3.0 * c * x + 0.5 * c * c)
    }
}

/// `sqrt(a)` at the tear, from `4 s^3/R* = c`.
#[inline]
fn tear_root(c: f64, r_star: f64) -> f64 {
    CBRT_OF_QUARTER * (c * r_star).cbrt()
}

/// `(1/4)^(1/3)`.
const CBRT_OF_QUARTER: f64 = 0.629_960_524_947_436_6;

/// `s = sqrt(a)` of the stable branch, from `s^4 - q3 s = p4` with `q3 = c R*`, `p4 = R* delta`; `floor`
/// is its value at the tear.
///
/// Newton from above: the polynomial is convex there, so the iteration falls monotonically on the
/// larger root, quadratically but for the tear itself, where the two roots meet.
#[inline]
fn root_of_radius(q3: f64, floor: f64, p4: f64) -> f64 {
    let q = floor / CBRT_OF_QUARTER;
    // One Newton step from the limit without load (q), or from that without adhesion (p).
    let mut s = if p4 > q3 * q {
        let p = p4.sqrt().sqrt();
        p + q3 * p / (4.0 * p * p * p - q3)
    } else {
        q + p4 / (3.0 * q3).max(f64::MIN_POSITIVE)
    };
    for _ in 0..60 {
        let s3 = s * s * s;
        let slope = 4.0 * s3 - q3;
        if slope <= 0.0 {
            return floor;
        }
        let step = (s3 * s - q3 * s - p4) / slope;
        s -= step;
        if step <= 1e-15 * s {
            break;
        }
    }
    s.max(floor)
}

impl NormalLaw for Jkr {
    type Memory = Bond;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        memory: &mut Bond,
    ) -> NormalResponse {
        let (delta, r_star) = (motion.overlap, pair.r_star);
        let c = self.c();
        let torn = tear_root(c, r_star);
        let open = if memory.formed { delta < -0.75 * c * torn } else { delta < 0.0 };
        if open {
            *memory = Bond::default();
            return NormalResponse::default();
        }
        let s = root_of_radius(c * r_star, torn, delta * r_star);
        let s3 = s * s * s;
        let a = s * s;
        let stiffness = 2.0 * self.e_star * a;
        let elastic = self.e_star * (4.0 / 3.0 * s3 * s3 / r_star - 2.0 * c * s3);
        let viscous = self.damping * (pair.m_star * stiffness).sqrt() * motion.overlap_rate;
        let mut lost = viscous * motion.overlap_rate;
        if !memory.formed {
            memory.formed = true;
            lost += self.hysteresis(r_star) / motion.dt;
        }
        let force = elastic + viscous;
        NormalResponse {
            force,
            friction_load: (force + 2.0 * self.pull_off_force(r_star)).max(0.0),
            stiffness,
            contact_radius: a,
            elastic_energy: self.energy(c, s, r_star) - self.energy(c, torn, r_star),
            dissipated_power: lost,
        }
    }

    fn reach(&self, pair: &PairGeometry) -> f64 {
        self.tear_gap(pair.r_star)
    }
}

#[cfg(test)]
#[path = "jkr_tests.rs"]
mod tests;
