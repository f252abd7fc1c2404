//! Median and spread of a few repeats.

use serde::Serialize;

/// Median, least and largest of some repeats.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub(crate) struct Spread {
    pub(crate) median: f64,
    pub(crate) least: f64,
    pub(crate) most: f64,
}

impl Spread {
    /// Of some values; none gives NaN.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        let at = |k: usize| sorted.get(k).copied().unwrap_or(f64::NAN);
        let median =
            if n % 2 == 1 { at(n / 2) } else { 0.5 * (at(n / 2) + at((n / 2).wrapping_sub(1))) };
        Self { median, least: at(0), most: at(n.wrapping_sub(1)) }
    }

    /// Half the range.
    pub(crate) fn half_range(&self) -> f64 {
        0.5 * (self.most - self.least)
    }
}

/// Exponent `p` of `y ~ x^p` by least squares in logarithms.
pub(crate) fn exponent(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mx, my) =
        points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x.ln() / n, b + y.ln() / n));
    let (sxy, sxx) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| {
        (a + (x.ln() - mx) * (y.ln() - my), b + (x.ln() - mx).powi(2))
    });
    sxy / sxx
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_even_and_odd_counts() {
        assert_eq!(Spread::of([3.0, 1.0, 2.0]), Spread { median: 2.0, least: 1.0, most: 3.0 });
        assert_eq!(Spread::of([4.0, 1.0, 2.0, 3.0]).median, 2.5);
        assert!(Spread::of([]).median.is_nan());
    }

    #[test]
    fn a_power_law_gives_its_exponent() {
        let points = [1e3, 1e4, 3e5].map(|x: f64| (x, 7.0 * x.powf(1.05)));
        assert!((exponent(&points) - 1.05).abs() < 1e-12);
    }
}
