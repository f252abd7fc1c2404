//! Tail probabilities and quantiles of Student's t and Fisher's F.
//!
//! The distributions are statrs's; its quantile of t is polished by Newton steps on the tail
//! probability, since the inverse beta function behind it stops at about 1e-9.

use statrs::distribution::{Continuous, ContinuousCDF, FisherSnedecor, StudentsT};

/// Probability that |t| of `df` degrees of freedom exceeds `|t|`; 0 for an infinite t.
pub(crate) fn t_two_sided(t: f64, df: f64) -> f64 {
    if t.is_infinite() {
        return 0.0;
    }
    (2.0 * student(df).sf(t.abs())).min(1.0)
}

/// The t that `|t|` stays below with probability `level`, 0 < level < 1.
pub(crate) fn t_quantile_two_sided(level: f64, df: f64) -> f64 {
    let (law, tail) = (student(df), 0.5 * (1.0 - level));
    let mut t = law.inverse_cdf(1.0 - tail);
    for _ in 0..4 {
        let step = (law.sf(t) - tail) / law.pdf(t);
        if !step.is_finite() {
            break;
        }
        t += step;
        if step.abs() <= 4.0 * f64::EPSILON * t.abs() {
            break;
        }
    }
    t
}

/// Probability that F of these degrees of freedom exceeds `f`; 0 for an infinite f.
pub(crate) fn f_upper(f: f64, df1: f64, df2: f64) -> f64 {
    if f.is_infinite() {
        return 0.0;
    }
    if f <= 0.0 {
        return 1.0;
    }
    FisherSnedecor::new(df1, df2).expect("degrees of freedom are positive").sf(f)
}

fn student(df: f64) -> StudentsT {
    StudentsT::new(0.0, 1.0, df).expect("degrees of freedom are positive")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn t_with_one_and_two_degrees_of_freedom_follows_its_closed_form() {
        // df 1: P(|T| > t) = 1 - 2 atan(t)/pi; df 2: 1 - t/sqrt(2 + t^2). 1e-13 is what the
        // incomplete beta function behind the law gives.
        for t in [0.1_f64, 1.0, 3.0, 12.706] {
            let cauchy = 1.0 - 2.0 * t.atan() / std::f64::consts::PI;
            assert!((t_two_sided(t, 1.0) - cauchy).abs() < 1.0e-13);
            let two = 1.0 - t / (2.0 + t * t).sqrt();
            assert!((t_two_sided(t, 2.0) - two).abs() < 1.0e-13);
        }
    }

    #[test]
    fn quantiles_of_t_follow_their_closed_form_to_twelve_digits() {
        for level in [0.5, 0.9, 0.95, 0.99] {
            let cauchy = (0.5 * std::f64::consts::PI * level).tan();
            assert!((t_quantile_two_sided(level, 1.0) / cauchy - 1.0).abs() < 1.0e-12);
            let two = level * (2.0 / (1.0 - level * level)).sqrt();
            assert!((t_quantile_two_sided(level, 2.0) / two - 1.0).abs() < 1.0e-12);
        }
    }

    #[test]
    fn f_with_one_numerator_degree_is_t_squared() {
        for df in [1.0, 5.0, 17.0] {
            for t in [0.3, 1.7, 6.0] {
                assert!((f_upper(t * t, 1.0, df) - t_two_sided(t, df)).abs() < 1.0e-13);
            }
        }
    }
}
