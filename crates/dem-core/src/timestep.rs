//! Limits of the time step.
//!
//! An explicit scheme must resolve the shortest contact. Three measures are in use:
//!
//! - Rayleigh time `T_R = pi R sqrt(rho/G)/(0.1631 nu + 0.8766)`: a surface wave around a sphere
//! - Hertz's collision time `T_H = 2.868 (m*^2/(R* E*^2 v))^(1/5)`
//! - the linear contact's half period `T_L = pi/sqrt(k/m* - b^2)`, `b = c/(2 m*)`
//!
//! - `R` radius, m; `rho` density, kg/m^3; `G` shear modulus, Pa; `nu` Poisson's ratio
//! - `m*` effective mass, kg; `R*` effective radius, m; `E*` effective modulus, Pa
//! - `v` speed of impact, m/s; `k` stiffness, N/m; `c` damping, N s/m
//!
//! Usual fractions: 0.2 `T_R` in dense beds; `T_H`/20 for a restitution within 1 %.
//! References: Y. Li, Y. Xu, C. Thornton, *Powder Technology* 160 (2005) 219-228,
//! doi:10.1016/j.powtec.2005.09.002 (Rayleigh); Hertz in closed form.

use crate::contact::elasticity::Elasticity;
use crate::contact::normal::hertz::ElasticImpact;

/// Rayleigh time of a sphere, s.
///
/// ```
/// use dem_core::contact::elasticity::Elasticity;
/// use dem_core::timestep::rayleigh_time;
/// // a 6 mm glass bead
/// let glass = Elasticity::new(60e9, 0.25)?;
/// assert!((rayleigh_time(3e-3, 2500.0, &glass) - 3.3e-6).abs() < 1e-7);
/// # Ok::<(), dem_core::contact::error::LawError>(())
/// ```
pub fn rayleigh_time(radius: f64, density: f64, elasticity: &Elasticity) -> f64 {
    let nu = elasticity.poisson_ratio;
    std::f64::consts::PI * radius * (density / elasticity.shear_modulus()).sqrt()
        / (0.1631 * nu + 0.8766)
}

/// Duration of an elastic Hertz collision at the relative speed `speed` (m/s), s.
pub fn hertz_time(e_star: f64, r_star: f64, m_star: f64, speed: f64) -> f64 {
    ElasticImpact::new(e_star, r_star, m_star, speed).duration
}

/// Half period of a linear contact with `damping` (N s/m), s; infinite if it is overdamped.
pub fn linear_time(stiffness: f64, m_star: f64, damping: f64) -> f64 {
    let b = 0.5 * damping / m_star;
    let square = stiffness / m_star - b * b;
    if square > 0.0 { std::f64::consts::PI / square.sqrt() } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hertz_time_has_the_textbook_factor() {
        let (e, r, m, v) = (1e9f64, 0.01f64, 0.02f64, 0.3f64);
        let textbook = 2.868 * (m * m / (r * e * e * v)).powf(0.2);
        // the factor is quoted to four digits
        assert!((hertz_time(e, r, m, v) / textbook - 1.0).abs() < 2e-4);
    }

    #[test]
    fn linear_time_is_half_a_period_and_endless_beyond_critical_damping() {
        assert!((linear_time(1e4, 0.01, 0.0) - std::f64::consts::PI * 1e-3).abs() < 1e-15);
        assert_eq!(linear_time(1.0, 1.0, 2.1), f64::INFINITY);
    }
}
