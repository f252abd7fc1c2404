//! Closed solution of an impact under the linear spring-dashpot law.
//!
//! `m x'' + c x' + k x = 0`, `x(0) = 0`, `x'(0) = v0`
//!
//! - `x` overlap, m; `m` effective mass, kg; `k` stiffness, N/m; `c` damping coefficient, N s/m
//! - `b = c/(2m)`, `w0 = sqrt(k/m)`, `w = sqrt(w0^2 - b^2)`, `W = sqrt(b^2 - w0^2)`, all 1/s
//!
//! Overlap `v0/w e^(-bt) sin wt` (damped), `v0 t e^(-bt)` (critical), `v0/W e^(-bt) sinh Wt`
//! (overdamped); force `F = k x + c x'`. The contact ends at overlap 0 with the tail kept:
//! `pi/w`, never when overdamped; with the tail cut where the force vanishes:
//! `2 atan(w/b)/w`, `2/b`, `ln((b + W)/(b - W))/W`.
//!
//! References: T. Schwager, T. Poeschel, *Granular Matter* 9 (2007) 465-469,
//! doi:10.1007/s10035-007-0065-z; thesis appendix 7.1.
//! Departures from the thesis, whose eq. 49-56 are misprinted: `w` contains `b^2`; the restitution
//! carries a minus sign (52); the angle of (53) is `atan(2 b w/(w^2 - b^2)) = 2 atan(b/w)`, one
//! branch for all `b < w0`, with a third for `b > w0`; the force is repulsive and uses `b`.

use super::restitution::{AttractiveTail, restitution_of};
use crate::contact::error::{LawError, non_negative, positive};

/// An impact under the linear spring-dashpot law.
///
/// ```
/// use dem_core::contact::normal::{AttractiveTail, LinearImpact};
/// let hit = LinearImpact::new(1e4, 0.0, 0.01, 1.0, AttractiveTail::Cut)?;
/// // elastic: half a period, pi sqrt(m/k)
/// assert!((hit.duration() - std::f64::consts::PI * 1e-3).abs() < 1e-15);
/// assert!((hit.peak_force() - 10.0).abs() < 1e-12); // v sqrt(k m)
/// # Ok::<(), dem_core::contact::error::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearImpact {
    /// Stiffness `k`, N/m.
    pub stiffness: f64,
    /// Damping coefficient `c`, N s/m.
    pub damping: f64,
    /// Effective mass `m`, kg.
    pub m_star: f64,
    /// Speed of approach `v0`, m/s.
    pub speed: f64,
    /// Whether the attractive tail is kept.
    pub tail: AttractiveTail,
}

impl LinearImpact {
    /// Checked impact.
    ///
    /// # Errors
    /// A stiffness, mass or speed that is not positive; a negative damping.
    pub fn new(
        stiffness: f64,
        damping: f64,
        m_star: f64,
        speed: f64,
        tail: AttractiveTail,
    ) -> Result<Self, LawError> {
        const LAW: &str = "LinearImpact";
        Ok(Self {
            stiffness: positive(LAW, "stiffness", stiffness)?,
            damping: non_negative(LAW, "damping", damping)?,
            m_star: positive(LAW, "m_star", m_star)?,
            speed: positive(LAW, "speed", speed)?,
            tail,
        })
    }

    /// Damping ratio `zeta = b/w0` (thesis eq. 51).
    pub fn damping_ratio(&self) -> f64 {
        0.5 * self.damping / (self.stiffness * self.m_star).sqrt()
    }

    fn b(&self) -> f64 {
        0.5 * self.damping / self.m_star
    }

    /// `(sqrt(|w0^2 - b^2|), sign of w0^2 - b^2)`; sign 0 at critical damping.
    fn frequency(&self) -> (f64, f64) {
        let b = self.b();
        let w0 = (self.stiffness / self.m_star).sqrt();
        let square = (w0 - b) * (w0 + b);
        if square.abs() <= 1e-14 * w0 * w0 {
            (0.0, 0.0)
        } else {
            (square.abs().sqrt(), square.signum())
        }
    }

    /// Duration of the contact, s; infinite for an overdamped contact with the tail kept.
    pub fn duration(&self) -> f64 {
        let b = self.b();
        let (w, sign) = self.frequency();
        match (self.tail, sign) {
            (AttractiveTail::Kept, s) if s > 0.0 => std::f64::consts::PI / w,
            (AttractiveTail::Kept, _) => f64::INFINITY,
            (AttractiveTail::Cut, s) if s > 0.0 => 2.0 * w.atan2(b) / w,
            (AttractiveTail::Cut, s) if s < 0.0 => 2.0 * (w / b).atanh() / w,
            (AttractiveTail::Cut, _) => 2.0 / b,
        }
    }

    /// Coefficient of restitution.
    pub fn restitution(&self) -> f64 {
        restitution_of(self.damping_ratio(), self.tail)
    }

    /// Overlap at time `t` (s) within the contact, m.
    pub fn overlap(&self, t: f64) -> f64 {
        let (w, sign) = self.frequency();
        let shape = if sign > 0.0 {
            (w * t).sin() / w
        } else if sign < 0.0 {
            (w * t).sinh() / w
        } else {
            t
        };
        self.speed * (-self.b() * t).exp() * shape
    }

    /// Rate of the overlap at time `t` (s), m/s.
    pub fn overlap_rate(&self, t: f64) -> f64 {
        let b = self.b();
        let (w, sign) = self.frequency();
        let shape = if sign > 0.0 {
            (w * t).cos() - b / w * (w * t).sin()
        } else if sign < 0.0 {
            (w * t).cosh() - b / w * (w * t).sinh()
        } else {
            1.0 - b * t
        };
        self.speed * (-b * t).exp() * shape
    }

    /// Repulsive force at time `t` (s), N (thesis eq. 55-56); 0 once the contact has ended.
    pub fn force(&self, t: f64) -> f64 {
        if t > self.duration() {
            return 0.0;
        }
        self.stiffness * self.overlap(t) + self.damping * self.overlap_rate(t)
    }

    /// Largest overlap, m.
    pub fn peak_overlap(&self) -> f64 {
        let b = self.b();
        let (w, sign) = self.frequency();
        let t = if sign > 0.0 {
            w.atan2(b) / w
        } else if sign < 0.0 {
            (w / b).atanh() / w
        } else {
            1.0 / b
        };
        self.overlap(t)
    }

    /// Largest repulsive force, N: inside the contact for `zeta < 1/2`, at first touch above.
    pub fn peak_force(&self) -> f64 {
        let b = self.b();
        let w0_2 = self.stiffness / self.m_star;
        let spare = w0_2 - 4.0 * b * b;
        if spare <= 0.0 {
            return self.damping * self.speed;
        }
        let (w, _) = self.frequency();
        // F' = 0: (w0^2 - 4 b^2) x' = 2 b w0^2 x with x'/x = w cot(wt) - b
        let t = w.atan2(b + 2.0 * b * w0_2 / spare) / w;
        self.force(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(zeta: f64, tail: AttractiveTail) -> LinearImpact {
        let (k, m) = (2e4, 0.03);
        LinearImpact::new(k, 2.0 * zeta * f64::sqrt(k * m), m, 1.7, tail).unwrap()
    }

    #[test]
    fn the_end_of_the_contact_is_where_its_condition_holds_on_every_branch() {
        for zeta in [0.0, 0.1, 0.5, 0.7, 0.8, 0.99, 1.0, 1.01, 2.0, 5.0] {
            let cut = at(zeta, AttractiveTail::Cut);
            let t = cut.duration();
            let scale = cut.peak_force();
            // the force vanishes within rounding
            assert!(cut.force(t).abs() < 1e-9 * scale, "zeta {zeta}");
            assert!(cut.force(0.5 * t) > 0.0);
            let e = -cut.overlap_rate(t) / cut.speed;
            assert!((e - cut.restitution()).abs() < 1e-9, "zeta {zeta}: {e}");
            if zeta < 1.0 {
                let kept = at(zeta, AttractiveTail::Kept);
                let t = kept.duration();
                assert!(kept.overlap(t).abs() < 1e-9 * kept.peak_overlap());
                let e = -kept.overlap_rate(t) / kept.speed;
                assert!((e - kept.restitution()).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_overlap_solves_the_equation_of_motion() {
        for zeta in [0.3, 1.0, 1.7] {
            let hit = at(zeta, AttractiveTail::Cut);
            let (t, h) = (0.4 * hit.duration(), 1e-7);
            let acceleration = (hit.overlap_rate(t + h) - hit.overlap_rate(t - h)) / (2.0 * h);
            // central difference, h well below the period: 1e-6 of the force
            assert!((hit.m_star * acceleration + hit.force(t)).abs() < 1e-6 * hit.peak_force());
        }
    }

    #[test]
    fn the_peaks_are_the_largest_sampled_values() {
        for zeta in [0.0, 0.2, 0.45, 0.6, 1.0, 1.5] {
            let hit = at(zeta, AttractiveTail::Cut);
            let n = 20_000;
            let times = (0..=n).map(|k| hit.duration() * f64::from(k) / f64::from(n));
            let (mut force, mut overlap) = (0f64, 0f64);
            for t in times {
                force = force.max(hit.force(t));
                overlap = overlap.max(hit.overlap(t));
            }
            // sampling misses the top by a relative (pi/n)^2/2
            assert!((force / hit.peak_force() - 1.0).abs() < 1e-6, "zeta {zeta}");
            assert!((overlap / hit.peak_overlap() - 1.0).abs() < 1e-6, "zeta {zeta}");
        }
    }

    #[test]
    fn the_printed_branch_of_the_duration_was_negative_and_ours_is_not() {
        assert!(at(0.8, AttractiveTail::Cut).duration() > 0.0);
        assert!(at(0.8, AttractiveTail::Cut).restitution() < 1.0);
    }
}
