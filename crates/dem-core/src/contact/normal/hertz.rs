//! Hertz contact of two elastic spheres with viscous damping.
//!
//! `F = 4/3 E* sqrt(R*) delta^(3/2) + alpha sqrt(m* S) delta'`, `S = 2 E* sqrt(R* delta)`
//!
//! - `F` repulsion, N; `delta` overlap, m; `delta'` its rate, m/s (positive on approach)
//! - `E*` effective Young's modulus, Pa; `R*` effective radius, m; `m*` effective mass, kg
//! - `S = dF_el/d delta` normal stiffness, N/m
//! - `alpha = 2 sqrt(5/6) zeta`, with `zeta` the damping ratio that yields the asked restitution
//!
//! Validity: smooth convex bodies, contact circle much smaller than `R*`, elastic material;
//! restitution is then the same at every speed.
//! References: thesis eq. 10-17 (damping positive here because the rate is that of the overlap);
//! Y. Tsuji, T. Tanaka, T. Ishida, *Powder Technology* 71 (1992) 239-250,
//! doi:10.1016/0032-5910(92)88030-L; restitution by `restitution.rs`.
//! Departure: with `CUT_TAIL` the force never turns attractive, and the damping is raised so that
//! the rebound still has the asked restitution.

use super::restitution::{AttractiveTail, damping_ratio};
use crate::contact::error::{LawError, positive};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalLaw, NormalResponse};

/// `2 sqrt(5/6)`: damping factor of Hertz per damping ratio.
const DAMPING_PER_RATIO: f64 = 1.825_741_858_350_553_8;

/// Parameters of [`Hertz`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct HertzSpec {
    /// Effective Young's modulus, Pa.
    pub e_star: f64,
    /// Coefficient of normal restitution, above 0 and at most 1.
    pub restitution: f64,
}

/// Hertz's law of one pair of materials; `CUT_TAIL` cuts the attractive tail off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hertz<const CUT_TAIL: bool> {
    /// Effective Young's modulus, Pa.
    pub e_star: f64,
    /// Damping factor `alpha`: the dashpot is `alpha sqrt(m* S)`.
    pub damping: f64,
}

/// Hertz whose damper may pull at the end of a rebound.
pub type HertzTailKept = Hertz<false>;
/// Hertz that never pulls.
pub type HertzTailCut = Hertz<true>;

impl<const CUT_TAIL: bool> TryFrom<HertzSpec> for Hertz<CUT_TAIL> {
    type Error = LawError;
    fn try_from(spec: HertzSpec) -> Result<Self, LawError> {
        let e_star = positive("Hertz", "e_star", spec.e_star)?;
        let tail = if CUT_TAIL { AttractiveTail::Cut } else { AttractiveTail::Kept };
        Ok(Self { e_star, damping: damping_factor(spec.restitution, tail)? })
    }
}

impl<const CUT_TAIL: bool> NormalLaw for Hertz<CUT_TAIL> {
    type Memory = ();

    #[inline]
    fn respond(&self, pair: &PairGeometry, motion: &Kinematics, (): &mut ()) -> NormalResponse {
        let delta = motion.overlap.max(0.0);
        let a = (pair.r_star * delta).sqrt();
        let stiffness = 2.0 * self.e_star * a;
        let elastic = 2.0 / 3.0 * stiffness * delta;
        // sqrt(m* k) as a product of roots: that of m* a serves the shear dashpot as well.
        let root = (pair.m_star * a).sqrt() * (2.0 * self.e_star).sqrt();
        let viscous = self.damping * root * motion.overlap_rate;
        let mut force = elastic + viscous;
        if CUT_TAIL {
            force = force.max(0.0);
        }
        NormalResponse {
            force,
            friction_load: force.max(0.0),
            stiffness,
            contact_radius: a,
            elastic_energy: 0.4 * elastic * delta,
            dissipated_power: (force - elastic) * motion.overlap_rate,
        }
    }
}

/// Damping factor `alpha = 2 sqrt(5/6) zeta` that yields `restitution` under Hertz.
///
/// # Errors
/// A restitution outside (0, 1].
pub fn damping_factor(restitution: f64, tail: AttractiveTail) -> Result<f64, LawError> {
    Ok(DAMPING_PER_RATIO * damping_ratio(restitution, tail)?)
}

/// Closed form of an elastic impact under Hertz.
///
/// ```
/// use dem_core::contact::normal::hertz::ElasticImpact;
/// // Chung and Ooi, test 1: glass on glass, 10 mm, 10 m/s each
/// let m = 2800.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.01f64.powi(3);
/// let hit = ElasticImpact::new(25e9, 0.005, 0.5 * m, 20.0);
/// assert!((hit.peak_force / 10_697.0 - 1.0).abs() < 1e-3);
/// assert!((hit.peak_overlap / 274.1e-6 - 1.0).abs() < 1e-3);
/// assert!((hit.duration / 40.34e-6 - 1.0).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticImpact {
    /// Largest overlap, m: `(15 m* v^2 / (16 E* sqrt(R*)))^(2/5)`.
    pub peak_overlap: f64,
    /// Largest force, N: `4/3 E* sqrt(R*) peak_overlap^(3/2)`.
    pub peak_force: f64,
    /// Duration, s: `2.9432... peak_overlap / v`.
    pub duration: f64,
}

impl ElasticImpact {
    /// Impact at the relative speed `speed` (m/s) of bodies with `e_star` (Pa), `r_star` (m),
    /// `m_star` (kg).
    pub fn new(e_star: f64, r_star: f64, m_star: f64, speed: f64) -> Self {
        let peak_overlap =
            (15.0 * m_star * speed * speed / (16.0 * e_star * r_star.sqrt())).powf(0.4);
        Self {
            peak_overlap,
            peak_force: 4.0 / 3.0 * e_star * r_star.sqrt() * peak_overlap.powf(1.5),
            duration: DURATION_FACTOR * peak_overlap / speed,
        }
    }
}

/// `2 integral_0^1 dx / sqrt(1 - x^(5/2)) = (4/5) sqrt(pi) Gamma(2/5)/Gamma(9/10)`.
const DURATION_FACTOR: f64 = 2.943_275_184_324_704_7;

/// Overlap at which the elastic force bears `load` (N), m.
///
/// Closed form of the inverse law: `(3 F / (4 E* sqrt(R*)))^(2/3)`.
pub fn overlap_under(load: f64, e_star: f64, r_star: f64) -> f64 {
    (0.75 * load / (e_star * r_star.sqrt())).cbrt().powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn motion(overlap: f64, rate: f64) -> Kinematics {
        Kinematics {
            normal_i_to_j: DVec3::X,
            overlap,
            overlap_rate: rate,
            slip_velocity: DVec3::ZERO,
            spin_i: DVec3::ZERO,
            spin_j: DVec3::ZERO,
            lever_i: 1.0,
            lever_j: 1.0,
            dt: 1e-6,
        }
    }

    const PAIR: PairGeometry =
        PairGeometry { r_star: 0.005, m_star: 0.01, radius_i: 0.01, radius_j: 0.01 };

    #[test]
    fn the_force_is_the_slope_of_the_energy_and_the_stiffness_that_of_the_force() {
        let law = Hertz::<true> { e_star: 1e9, damping: 0.0 };
        let (d, h) = (1e-5, 1e-10);
        let at = |x| law.respond(&PAIR, &motion(x, 0.0), &mut ());
        let (low, high) = (at(d - h), at(d + h));
        // central differences: relative error of order (h/d)^2 plus rounding eps d/h
        let slope = (high.elastic_energy - low.elastic_energy) / (2.0 * h);
        assert!((slope / at(d).force - 1.0).abs() < 1e-8);
        let slope = (high.force - low.force) / (2.0 * h);
        assert!((slope / at(d).stiffness - 1.0).abs() < 1e-8);
    }

    #[test]
    fn the_duration_factor_is_the_integral_of_the_trajectory() {
        // x = 1 - u^2 removes the root at the end; midpoint rule, error of order 1/n^2
        let n = 200_000;
        let h = 1.0 / f64::from(n);
        let sum: f64 = (0..n)
            .map(|k| {
                let u = (f64::from(k) + 0.5) * h;
                2.0 * u / (1.0 - (1.0 - u * u).powf(2.5)).sqrt()
            })
            .sum();
        assert!((2.0 * sum * h - DURATION_FACTOR).abs() < 1e-9);
        assert!((DAMPING_PER_RATIO - 2.0 * (5.0f64 / 6.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn the_cut_tail_never_pulls_and_the_kept_one_does() {
        let kept: HertzTailKept = HertzSpec { e_star: 1e9, restitution: 0.5 }.try_into().unwrap();
        let cut: HertzTailCut = HertzSpec { e_star: 1e9, restitution: 0.5 }.try_into().unwrap();
        let leaving = motion(1e-7, -1.0);
        assert!(kept.respond(&PAIR, &leaving, &mut ()).force < 0.0);
        let r = cut.respond(&PAIR, &leaving, &mut ());
        assert_eq!(r.force, 0.0);
        assert!(r.dissipated_power > 0.0);
    }

    #[test]
    fn a_gap_gives_no_force_and_no_nan() {
        let cut: HertzTailCut = HertzSpec { e_star: 1e9, restitution: 0.5 }.try_into().unwrap();
        assert_eq!(cut.respond(&PAIR, &motion(-1e-6, 1.0), &mut ()), NormalResponse::default());
    }

    #[test]
    fn the_overlap_under_a_load_inverts_the_force() {
        let law = Hertz::<true> { e_star: 1e9, damping: 0.0 };
        let delta = overlap_under(3.0, 1e9, PAIR.r_star);
        assert!((law.respond(&PAIR, &motion(delta, 0.0), &mut ()).force - 3.0).abs() < 1e-12);
    }
}
