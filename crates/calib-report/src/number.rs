//! Numbers as text: fixed decimals, no negative zero, no NaN on the page.

/// A number with a fixed count of decimals and a true minus sign; "n/a" where it is not finite.
///
/// ```
/// use calib_report::number::fixed;
/// assert_eq!(fixed(-0.004, 2), "0.00");
/// assert_eq!(fixed(-3.14159, 2), "−3.14");
/// assert_eq!(fixed(f64::NAN, 2), "n/a");
/// ```
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "n/a".into();
    }
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| matches!(b, b'0' | b'.')) => digits.to_string(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// A number with a fixed count of decimals, or a dash where there is none.
pub fn fixed_or_dash(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "–".into(), |v| fixed(v, decimals))
}

/// A number with a count of significant digits, in powers of ten (`2.1·10^{−5}`) where it is very
/// small or large; `^{}` marks the exponent for [`crate::page`] and the pictures.
///
/// ```
/// use calib_report::number::significant;
/// assert_eq!(significant(26.714, 3), "26.7");
/// assert_eq!(significant(2.13e-5, 2), "2.1·10^{−5}");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "n/a".into();
    }
    if value == 0.0 {
        return "0".into();
    }
    let digits = digits.max(1);
    // Rounding may carry into the next decade (9.996 -> 10.0), so the exponent is read afterwards.
    let rounded = format!("{:.*e}", digits - 1, value.abs());
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        return fixed(value, decimals);
    }
    let sign = if value < 0.0 { "−" } else { "" };
    format!("{sign}{mantissa}·10^{{{}}}", fixed(f64::from(exponent), 0))
}

/// A probability as a reader expects it: `0.034`, `< 0.001`.
pub fn probability(p: f64) -> String {
    if !p.is_finite() {
        "n/a".into()
    } else if p < 0.001 {
        "< 0.001".into()
    } else {
        fixed(p, 3)
    }
}

/// The smallest and largest finite number of a sequence, if there is any.
///
/// Magnitudes above 1e100 are left out with the non-finite ones: no axis can show them.
pub(crate) fn extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values.into_iter().filter(|v| drawable(*v)).fold(None, |range, v| match range {
        None => Some((v, v)),
        Some((lo, hi)) => Some((lo.min(v), hi.max(v))),
    })
}

/// Whether a number can be given a place on an axis.
pub(crate) fn drawable(value: f64) -> bool {
    value.abs() < 1e100
}

/// A range widened on both sides by a fraction of its length, and a degenerate one to a visible
/// length.
pub(crate) fn padded((lo, hi): (f64, f64), fraction: f64) -> (f64, f64) {
    let length = hi - lo;
    if length > 1e-12 * (lo.abs() + hi.abs()) {
        (lo - fraction * length, hi + fraction * length)
    } else {
        let half = if lo == 0.0 { 1.0 } else { 0.1 * lo.abs() };
        (lo - half, hi + half)
    }
}
