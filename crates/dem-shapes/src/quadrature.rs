//! Gauss-Legendre quadrature in adaptive panels.
//!
//! An interval between two breakpoints is mapped by `x = a + h (1 - cos t)`, `t` in `[0, pi]`,
//! `h` half its width. An integrand that behaves like a power of the *root* of the distance from
//! either end, as areas and arcs of sections do where circles begin to touch, is smooth in `t`, so
//! that the rule converges exponentially. What is left (a singularity that no breakpoint
//! announces) is met by bisection of `t`.

use std::f64::consts::PI;

/// Points of a panel: even where the integrand is smooth only in part, 16 points and bisection are
/// within a factor of two of the best fixed order.
const POINTS: usize = 16;

/// Bisections of one interval after which a panel is taken as it is, if its error is below that
/// allowed for the whole: what is left in it is a jump, and its width is `2^-44` of the interval's.
const MAX_DEPTH: u32 = 44;

/// Panels of one interval: an integrand that asks for more is noise.
const MAX_PANELS: u32 = 100_000;

/// Depth from which a panel's allowance halves no more: only the few panels that close in on a
/// singularity get there.
const FULL_SHARE_DEPTH: u32 = 10;

/// Nodes and weights on `[-1, 1]`.
pub(crate) struct GaussLegendre {
    nodes: [f64; POINTS],
    weights: [f64; POINTS],
}

/// An integral that missed its tolerance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Missed {
    /// Where, in the variable of the integrand.
    pub(crate) at: f64,
    /// Estimated error over allowed error.
    pub(crate) excess: f64,
}

/// Integral and the estimate of its absolute error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Integral<const C: usize> {
    pub(crate) value: [f64; C],
    pub(crate) error: [f64; C],
}

impl<const C: usize> Integral<C> {
    pub(crate) const ZERO: Self = Self { value: [0.0; C], error: [0.0; C] };

    pub(crate) fn add(&mut self, other: &Self) {
        for k in 0..C {
            self.value[k] += other.value[k];
            self.error[k] += other.error[k];
        }
    }
}

impl GaussLegendre {
    /// The rule, its nodes found by Newton's method on the Legendre polynomial.
    pub(crate) fn new() -> Self {
        let n = POINTS as f64;
        let mut rule = Self { nodes: [0.0; POINTS], weights: [0.0; POINTS] };
        for i in 0..POINTS {
            let mut x = -(PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            // Newton converges quadratically from this start: six steps are more than it needs.
            for _ in 0..6 {
                let (mut p, mut previous) = (x, 1.0);
                for k in 2..=POINTS {
                    let k = k as f64;
                    (p, previous) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k, p);
                }
                slope = n * (x * p - previous) / (x * x - 1.0);
                x -= p / slope;
            }
            rule.nodes[i] = x;
            rule.weights[i] = 2.0 / ((1.0 - x * x) * slope * slope);
        }
        rule
    }

    /// Integral of `f` from `a` to `b`, each component to `allowed[k]` in absolute terms.
    pub(crate) fn integrate<const C: usize>(
        &self,
        a: f64,
        b: f64,
        allowed: &[f64; C],
        f: &mut impl FnMut(f64) -> [f64; C],
    ) -> Result<Integral<C>, Missed> {
        let half = 0.5 * (b - a);
        let mut g = |t: f64| {
            let (sin, cos) = (0.5 * t).sin_cos();
            // From the nearer end, so that the distance from it keeps its digits.
            let x =
                if t < 0.5 * PI { a + 2.0 * half * sin * sin } else { b - 2.0 * half * cos * cos };
            let mut y = f(x);
            let scale = half * 2.0 * sin * cos;
            y.iter_mut().for_each(|v| *v *= scale);
            y
        };
        let whole = self.panel(0.0, PI, &mut g);
        let mut sum = Integral::ZERO;
        self.refine(0.0, PI, &whole, allowed, 0, &mut 0, &mut g, &mut sum)
            .map_err(|m| Missed { at: a + half * (1.0 - m.at.cos()), ..m })?;
        Ok(sum)
    }

    fn panel<const C: usize>(
        &self,
        a: f64,
        b: f64,
        g: &mut impl FnMut(f64) -> [f64; C],
    ) -> [f64; C] {
        let (mid, half) = (0.5 * (a + b), 0.5 * (b - a));
        let mut sum = [0.0; C];
        for (node, weight) in self.nodes.iter().zip(&self.weights) {
            let y = g(mid + half * node);
            for k in 0..C {
                sum[k] += half * weight * y[k];
            }
        }
        sum
    }

    fn refine<const C: usize>(
        &self,
        a: f64,
        b: f64,
        whole: &[f64; C],
        allowed: &[f64; C],
        depth: u32,
        panels: &mut u32,
        g: &mut impl FnMut(f64) -> [f64; C],
        sum: &mut Integral<C>,
    ) -> Result<(), Missed> {
        let mid = 0.5 * (a + b);
        let left = self.panel(a, mid, g);
        let right = self.panel(mid, b, g);
        let mut halves = Integral::ZERO;
        let mut excess: f64 = 0.0;
        for k in 0..C {
            halves.value[k] = left[k] + right[k];
            halves.error[k] = (halves.value[k] - whole[k]).abs();
            let ratio = halves.error[k] / allowed[k];
            // `max` would pass over what is not a number.
            if ratio.is_nan() {
                return Err(Missed { at: mid, excess: ratio });
            }
            excess = excess.max(ratio);
        }
        if excess <= 1.0 {
            sum.add(&halves);
            return Ok(());
        }
        *panels += 1;
        if depth == MAX_DEPTH && excess <= f64::from(1_u32 << FULL_SHARE_DEPTH) {
            sum.add(&halves);
            return Ok(());
        }
        if depth == MAX_DEPTH || *panels == MAX_PANELS {
            return Err(Missed { at: mid, excess });
        }
        // The share of a half is the half of the share: the panels' errors add up to `allowed`.
        let share = if depth < FULL_SHARE_DEPTH { allowed.map(|v| 0.5 * v) } else { *allowed };
        self.refine(a, mid, &left, &share, depth + 1, panels, g, sum)?;
        self.refine(mid, b, &right, &share, depth + 1, panels, g, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_two_and_nodes_are_symmetric() {
        let rule = GaussLegendre::new();
        // Sixteen roundings of numbers below one.
        assert!((rule.weights.iter().sum::<f64>() - 2.0).abs() < 1e-14);
        for i in 0..POINTS {
            assert!((rule.nodes[i] + rule.nodes[POINTS - 1 - i]).abs() < 1e-15);
        }
    }

    #[test]
    fn half_powers_at_both_ends_are_integrated_to_rounding() {
        let rule = GaussLegendre::new();
        // Integral of sqrt(x (1 - x)) over [0, 1] is pi/8.
        let got = rule.integrate(0.0, 1.0, &[1e-14], &mut |x: f64| [(x * (1.0 - x)).sqrt()]);
        assert!((got.unwrap().value[0] - PI / 8.0).abs() < 1e-14);
    }

    #[test]
    fn a_kink_that_no_breakpoint_announces_is_met_by_bisection() {
        let rule = GaussLegendre::new();
        let at = 0.3_f64;
        let got = rule.integrate(0.0, 1.0, &[1e-11], &mut |x: f64| [(x - at).max(0.0).powf(1.5)]);
        let exact = 0.7_f64.powf(2.5) / 2.5;
        assert!((got.unwrap().value[0] - exact).abs() < 1e-11);
    }

    #[test]
    fn a_jump_is_closed_in_on_and_noise_is_refused() {
        let rule = GaussLegendre::new();
        let jump = |x: f64| [f64::from(u8::from(x > 0.3))];
        let got = rule.integrate(0.0, 1.0, &[1e-11], &mut { jump });
        assert!((got.unwrap().value[0] - 0.7).abs() < 1e-11);
        let mut state = 1_u64;
        let mut noise = |_: f64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            [(state >> 40) as f64]
        };
        assert!(rule.integrate(0.0, 1.0, &[1e-9], &mut noise).is_err());
    }

    #[test]
    fn an_integrand_that_is_no_number_is_refused() {
        let rule = GaussLegendre::new();
        assert!(rule.integrate(0.0, 1.0, &[1e-9], &mut |_| [f64::NAN]).is_err());
    }
}
