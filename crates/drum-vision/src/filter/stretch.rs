//! Contrast stretch that saturates a given fraction of the samples at either end.
//!
//! The limits are the smallest grey levels whose cumulated frequency reaches `f` and `1 - f` (NumPy's
//! `percentile(method="inverted_cdf")`), then mapped to 0 and 255; the rest is linear in between, as
//! `skimage.exposure.rescale_intensity` does. MATLAB's `imadjust` saturates 1 % a side by default.

/// The two grey levels between which the picture is stretched; `None` for an empty or flat histogram.
#[must_use]
pub fn stretch_limits(histogram: &[u64; 256], fraction: f64) -> Option<(u8, u8)> {
    let total: u64 = histogram.iter().sum();
    if total == 0 {
        return None;
    }
    let level = |p: f64| {
        let mut sum = 0u64;
        for (v, n) in histogram.iter().enumerate() {
            sum += n;
            if *n > 0 && sum as f64 >= p * total as f64 {
                return v as u8;
            }
        }
        255
    };
    let (low, high) = (level(fraction), level(1.0 - fraction));
    (high > low).then_some((low, high))
}

/// Maps a sample linearly so that `limits` become 0 and 255, clamped.
#[must_use]
#[inline]
pub fn stretched(value: f32, limits: (u8, u8)) -> f32 {
    let (low, high) = (f32::from(limits.0), f32::from(limits.1));
    ((value - low) * (255.0 / (high - low))).clamp(0.0, 255.0)
}

/// Counts of the 256 grey levels.
#[must_use]
pub fn histogram(samples: impl IntoIterator<Item = u8>) -> [u64; 256] {
    let mut counts = [0u64; 256];
    for s in samples {
        counts[usize::from(s)] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_percent_is_cut_at_either_end() {
        let h = histogram((0..200u8).chain(0..200u8));
        assert_eq!(stretch_limits(&h, 0.01), Some((1, 197)));
        assert_eq!(stretched(197.0, (1, 197)), 255.0);
        assert_eq!(stretch_limits(&histogram([7u8; 30]), 0.01), None);
    }
}
