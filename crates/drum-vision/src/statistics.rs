//! Means, scatter, autocorrelation and covariance of a series.

/// Median; reorders the values, `None` for an empty slice.
#[must_use]
pub(crate) fn median_in_place(values: &mut [f64]) -> Option<f64> {
    let n = values.len();
    if n == 0 {
        return None;
    }
    let (below, &mut mid, _) = values.select_nth_unstable_by(n / 2, f64::total_cmp);
    if n % 2 == 1 {
        return Some(mid);
    }
    let low = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Some(0.5 * (low + mid))
}

/// Median of a slice left as it is.
#[must_use]
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    median_in_place(&mut values.to_vec())
}

/// Quantile by linear interpolation between order statistics (`p` from 0 to 1); `None` for an empty slice.
#[must_use]
pub fn quantile(values: &[f64], p: f64) -> Option<f64> {
    let mut v = values.to_vec();
    v.sort_by(f64::total_cmp);
    let last = v.len().checked_sub(1)?;
    let at = p.clamp(0.0, 1.0) * last as f64;
    let k = (at as usize).min(last);
    let next = (k + 1).min(last);
    Some(v[k] + (at - k as f64) * (v[next] - v[k]))
}

/// Arithmetic mean, `None` for an empty slice.
#[must_use]
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Standard deviation with `n - 1`; `None` with fewer than two values.
#[must_use]
pub fn standard_deviation(values: &[f64]) -> Option<f64> {
    let m = mean(values)?;
    (values.len() > 1).then(|| {
        (values.iter().map(|v| (v - m).powi(2)).sum::<f64>() / (values.len() - 1) as f64).sqrt()
    })
}

/// Autocorrelation at lags 0 to `lags`, normalised by the variance (biased estimate, divisor `n`).
#[must_use]
pub fn autocorrelation(values: &[f64], lags: usize) -> Vec<f64> {
    let n = values.len();
    let m = mean(values).unwrap_or(0.0);
    let at = |k: usize| {
        (0..n.saturating_sub(k)).map(|i| (values[i] - m) * (values[i + k] - m)).sum::<f64>()
    };
    let zero = at(0);
    (0..=lags.min(n.saturating_sub(1)))
        .map(|k| if zero > 0.0 { at(k) / zero } else { f64::from(u8::from(k == 0)) })
        .collect()
}

/// Effective number of independent values in a series, between 1 and `n`.
///
/// `n / (1 + 2 sum rho_k)`, the sum taken over pairs of lags as long as their sum is positive and does
/// not grow (C. J. Geyer, Stat. Sci. 7 (1992) 473, initial monotone sequence). A constant series gives `n`.
///
/// ```
/// let alternating: Vec<f64> = (0..30).map(|k| f64::from(k % 2)).collect();
/// assert_eq!(drum_vision::statistics::effective_number(&alternating), 30.0);
/// ```
#[must_use]
pub fn effective_number(values: &[f64]) -> f64 {
    let n = values.len();
    if n < 4 {
        return n as f64;
    }
    let rho = autocorrelation(values, n - 1);
    let mut pairs = 0.0;
    let mut last = f64::INFINITY;
    for pair in rho.chunks_exact(2) {
        let sum = (pair[0] + pair[1]).min(last);
        if sum <= 0.0 {
            break;
        }
        pairs += sum;
        last = sum;
    }
    (n as f64 / (2.0 * pairs - 1.0).max(1.0)).clamp(1.0, n as f64)
}

/// Sample covariance of two series of equal length, divisor `n - 1`; `None` with fewer than two values.
#[must_use]
pub fn covariance(a: &[f64], b: &[f64]) -> Option<f64> {
    let (ma, mb) = (mean(a)?, mean(b)?);
    (a.len() == b.len() && a.len() > 1).then(|| {
        a.iter().zip(b).map(|(x, y)| (x - ma) * (y - mb)).sum::<f64>() / (a.len() - 1) as f64
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_persistent_series_counts_for_fewer_frames() {
        // First-order process with rho = 0.8: n_eff / n tends to (1 - rho) / (1 + rho) = 0.111.
        let mut state = 12345u64;
        let mut x = 0.0;
        let series: Vec<f64> = (0..4000)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                x = 0.8 * x + (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                x
            })
            .collect();
        let ratio = effective_number(&series) / 4000.0;
        // The estimate from 4000 values scatters by some 15 %.
        assert!((ratio - 0.111).abs() < 0.04, "{ratio}");
    }

    #[test]
    fn quantiles_interpolate() {
        assert_eq!(quantile(&[3.0, 1.0, 2.0, 4.0], 0.5), Some(2.5));
        assert_eq!(quantile(&[], 0.5), None);
    }
}
