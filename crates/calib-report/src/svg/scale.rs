//! Scales from data to pixels and the ticks that people like to read.

use crate::number::{fixed, significant};

/// How data are spaced along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Spacing {
    #[default]
    Linear,
    /// Decadic logarithm; values at or below zero have no place.
    Log10,
}

/// A tick: where it stands (data units) and what it says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) at: f64,
    pub(crate) label: String,
}

/// A map from data to pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    spacing: Spacing,
    lo: f64,
    hi: f64,
    px_lo: f64,
    px_hi: f64,
}

impl Scale {
    /// A scale that puts `lo` at `px_lo` and `hi` at `px_hi`.
    pub(crate) fn new(spacing: Spacing, (lo, hi): (f64, f64), (px_lo, px_hi): (f64, f64)) -> Self {
        let (lo, hi) = (transform(spacing, lo), transform(spacing, hi));
        let usable = lo.is_finite() && hi.is_finite() && hi > lo;
        let (lo, hi) = if usable { (lo, hi) } else { (0.0, 1.0) };
        Self { spacing, lo, hi, px_lo, px_hi }
    }

    /// The pixel of a value, or none where it has no place; far values are held near the picture.
    pub(crate) fn px(&self, value: f64) -> Option<f64> {
        let t = (transform(self.spacing, value) - self.lo) / (self.hi - self.lo);
        t.is_finite().then(|| self.px_lo + t.clamp(-20.0, 21.0) * (self.px_hi - self.px_lo))
    }

    /// Whether a value lies on the axis, its ends included.
    pub(crate) fn contains(&self, value: f64) -> bool {
        let t = (transform(self.spacing, value) - self.lo) / (self.hi - self.lo);
        (-1e-9..=1.0 + 1e-9).contains(&t)
    }
}

fn transform(spacing: Spacing, value: f64) -> f64 {
    match spacing {
        Spacing::Linear => value,
        Spacing::Log10 if value > 0.0 => value.log10(),
        Spacing::Log10 => f64::NAN,
    }
}

/// Ticks of a range: at most about `count`, at multiples of 1, 2 or 5 times a power of ten.
pub(crate) fn ticks(spacing: Spacing, (lo, hi): (f64, f64), count: usize) -> Vec<Tick> {
    match spacing {
        Spacing::Linear => linear_ticks(lo, hi, count),
        Spacing::Log10 => log_ticks(lo, hi, count),
    }
}

/// The distance of ticks: 1, 2 or 5 times a power of ten, giving at most `count` intervals.
pub(crate) fn nice_step(lo: f64, hi: f64, count: usize) -> f64 {
    let raw = (hi - lo) / count.max(1) as f64;
    let power = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= raw * 0.999);
    step.unwrap_or(10.0 * power)
}

/// The multiples of [`nice_step`] within a range; none where the range is empty or not finite.
pub(crate) fn nice_values(lo: f64, hi: f64, count: usize) -> Vec<f64> {
    if !(lo.is_finite() && hi.is_finite() && hi > lo) {
        return Vec::new();
    }
    let step = nice_step(lo, hi, count);
    let first = (lo / step - 1e-9).ceil() as i64;
    let last = (hi / step + 1e-9).floor() as i64;
    // A range far from zero and shorter than the spacing of f64 there would never end.
    if last.saturating_sub(first) > 1000 {
        return Vec::new();
    }
    (first..=last).map(|i| i as f64 * step).collect()
}

/// Decimals with which multiples of a step are told apart.
pub(crate) fn decimals_of_step(step: f64) -> usize {
    (-(step.log10() + 1e-9).floor()).clamp(0.0, 12.0) as usize
}

fn linear_ticks(lo: f64, hi: f64, count: usize) -> Vec<Tick> {
    let step = nice_step(lo, hi, count);
    let decimals = decimals_of_step(step);
    let extreme = lo.abs().max(hi.abs()) >= 1e6 || step < 1e-4;
    nice_values(lo, hi, count)
        .into_iter()
        .map(|at| {
            let label = if extreme {
                let digits = (at.abs().max(step) / step).log10().floor() as usize + 1;
                significant(at, digits.clamp(1, 8))
            } else {
                fixed(at, decimals)
            };
            Tick { at, label }
        })
        .collect()
}

fn log_ticks(lo: f64, hi: f64, count: usize) -> Vec<Tick> {
    if !(lo > 0.0 && hi > lo && hi.is_finite()) {
        return Vec::new();
    }
    let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
    let stride = ((last - first) as usize).div_ceil(count.max(1)).max(1);
    let mantissas: &[f64] = if last - first <= 2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let mut out = Vec::new();
    for power in (first..=last).step_by(stride) {
        for m in mantissas {
            let at = m * 10f64.powi(power);
            if at >= lo * (1.0 - 1e-9) && at <= hi * (1.0 + 1e-9) {
                let plain = first >= -3 && last <= 5;
                let label = if plain {
                    fixed(at, usize::try_from(-power).unwrap_or(0))
                } else if *m == 1.0 {
                    format!("10^{{{}}}", fixed(f64::from(power), 0))
                } else {
                    significant(at, 1)
                };
                out.push(Tick { at, label });
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(lo: f64, hi: f64, count: usize) -> Vec<String> {
        ticks(Spacing::Linear, (lo, hi), count).into_iter().map(|t| t.label).collect()
    }

    #[test]
    fn ticks_are_round_and_within_the_range() {
        assert_eq!(labels(0.1, 0.9, 4), ["0.2", "0.4", "0.6", "0.8"]);
        assert_eq!(labels(-4.2, 4.2, 5), ["−4", "−2", "0", "2", "4"]);
        assert_eq!(labels(19.7, 31.0, 5), ["20", "25", "30"]);
    }

    #[test]
    fn log_ticks_are_decades_when_there_are_many() {
        let ticks = ticks(Spacing::Log10, (1e-6, 1e2), 10);
        assert_eq!(ticks.len(), 9);
        assert_eq!(ticks[0].label, "10^{−6}");
        assert_eq!(ticks[8].label, "10^{2}");
    }

    #[test]
    fn a_range_below_the_spacing_of_numbers_ends() {
        assert!(nice_values(1e17, 1e17 + 16.0, 5).len() <= 1000);
        assert!(nice_values(f64::NAN, 1.0, 5).is_empty());
        assert!(nice_values(1.0, 1.0, 5).is_empty());
    }

    #[test]
    fn degenerate_scale_still_maps() {
        let scale = Scale::new(Spacing::Log10, (-1.0, 0.0), (0.0, 100.0));
        assert_eq!(scale.px(-1.0), None);
        assert!(scale.px(5.0).is_some());
    }
}
