//! Grey levels that part the bed from the background: Otsu's, and the local mean.

use super::wiener::{Border, box_sums};
use crate::frame::Plane;

/// Otsu's level: samples above it are the bright class (N. Otsu, IEEE Trans. SMC 9 (1979) 62).
///
/// The level is the one that maximises the variance between the classes, the lowest of equals, as
/// `skimage.filters.threshold_otsu` on 8-bit samples. `None` when fewer than two levels are present.
#[must_use]
pub fn otsu(histogram: &[u64; 256]) -> Option<u8> {
    let total: u64 = histogram.iter().sum();
    let moment: f64 = histogram.iter().enumerate().map(|(v, &n)| v as f64 * n as f64).sum();
    let (mut below, mut below_moment) = (0u64, 0.0);
    let mut best: Option<(f64, u8)> = None;
    for (v, &n) in histogram.iter().enumerate().take(255) {
        below += n;
        below_moment += v as f64 * n as f64;
        let above = total - below;
        if below == 0 || above == 0 {
            continue;
        }
        let gap = below_moment / below as f64 - (moment - below_moment) / above as f64;
        let between = below as f64 * above as f64 * gap * gap;
        if best.is_none_or(|(b, _)| between > b) {
            best = Some((between, v as u8));
        }
    }
    best.map(|(_, v)| v)
}

/// The mean over a window of `size` pixels a side around every pixel, border mirrored.
///
/// As a threshold this is `skimage.filters.threshold_local(method="mean", mode="reflect")` without offset.
#[must_use]
pub fn local_mean(plane: &Plane, size: usize) -> Plane {
    let size = (size.max(1) | 1).min((plane.width.min(plane.height).max(1) - 1) | 1);
    let area = (size * size) as f64;
    let sums = box_sums(&plane.data, plane.width, plane.height, size, size, Border::Reflect);
    Plane {
        width: plane.width,
        height: plane.height,
        data: sums.into_iter().map(|s| (s / area) as f32).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::stretch::histogram;

    #[test]
    fn two_peaks_are_parted_between_them() {
        let h = histogram([20u8; 50].into_iter().chain([22; 30]).chain([200; 40]));
        assert_eq!(otsu(&h), Some(22));
        assert_eq!(otsu(&histogram([9u8; 4])), None);
    }
}
