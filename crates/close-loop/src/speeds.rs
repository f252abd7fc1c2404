//! Speeds that are simulated, and what lies between them.

/// Speeds to simulate for data at `measured` rpm: all, or `most` of them spread evenly.
pub(crate) fn knots(measured: &[f64], most: usize) -> Vec<f64> {
    let mut all = measured.to_vec();
    all.sort_by(f64::total_cmp);
    all.dedup();
    let most = most.max(2);
    if all.len() <= most {
        return all;
    }
    let last = (all.len() - 1) as f64;
    (0..most).map(|k| all[(last * k as f64 / (most - 1) as f64).round() as usize]).collect()
}

/// Weights of the values at `knots` in the natural cubic spline at `omega`; constant beyond the
/// ends.
pub(crate) fn weights(knots: &[f64], omega: f64) -> Vec<f64> {
    let n = knots.len();
    let mut w = vec![0.0; n];
    if n == 1 || omega <= knots[0] {
        w[0] = 1.0;
        return w;
    }
    if omega >= knots[n - 1] {
        w[n - 1] = 1.0;
        return w;
    }
    let i = knots.partition_point(|k| *k <= omega).clamp(1, n - 1);
    let h = knots[i] - knots[i - 1];
    let (a, b) = ((knots[i] - omega) / h, (omega - knots[i - 1]) / h);
    w[i - 1] += a;
    w[i] += b;
    if n > 2 {
        let (ca, cb) = ((a.powi(3) - a) * h * h / 6.0, (b.powi(3) - b) * h * h / 6.0);
        for (k, w) in w.iter_mut().enumerate() {
            let bend = second_derivatives(knots, k);
            *w += ca * bend[i - 1] + cb * bend[i];
        }
    }
    w
}

/// Second derivatives at the knots of the spline through 1 at knot `at` and 0 at all others.
fn second_derivatives(x: &[f64], at: usize) -> Vec<f64> {
    let n = x.len();
    let y = |k: usize| f64::from(u8::from(k == at));
    // Thomas' algorithm; the ends are free.
    let (mut c, mut d) = (vec![0.0; n], vec![0.0; n]);
    for i in 1..n - 1 {
        let (l, r) = (x[i] - x[i - 1], x[i + 1] - x[i]);
        let pivot = 2.0 * (l + r) - l * c[i - 1];
        c[i] = r / pivot;
        let slope = (y(i + 1) - y(i)) / r - (y(i) - y(i - 1)) / l;
        d[i] = (6.0 * slope - l * d[i - 1]) / pivot;
    }
    let mut m = vec![0.0; n];
    for i in (1..n - 1).rev() {
        m[i] = d[i] - c[i] * m[i + 1];
    }
    m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_add_up_and_keep_knots_and_lines() {
        let knots = [4.0, 7.0, 12.0, 20.0, 31.0];
        for omega in [4.0, 5.5, 7.0, 11.0, 19.9, 25.0, 31.0, 40.0] {
            let w = weights(&knots, omega);
            assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let line: f64 = w.iter().zip(knots).map(|(w, k)| w * k).sum();
            assert!((line - omega.min(31.0)).abs() < 1e-9, "{omega}: {line}");
        }
        assert_eq!(weights(&knots, 12.0)[2], 1.0);
    }

    #[test]
    fn a_smooth_curve_is_met_between_knots() {
        let knots: Vec<f64> = (0..6).map(|k| 4.0 + 8.0 * f64::from(k)).collect();
        // A bed that steepens with the square of speed, 28 to 34 degrees.
        let angle = |w: f64| 28.0 + 6.0 * (w / 44.0).powi(2);
        for omega in [6.0, 15.0, 23.0, 38.0, 42.0] {
            let w = weights(&knots, omega);
            let met: f64 = w.iter().zip(&knots).map(|(w, k)| w * angle(*k)).sum();
            assert!((met - angle(omega)).abs() < 0.04, "{omega}: {met} {}", angle(omega));
        }
    }

    #[test]
    fn knots_keep_both_ends() {
        let all: Vec<f64> = (2..26).map(|k| 2.0 * f64::from(k)).collect();
        let some = knots(&all, 5);
        assert_eq!((some.len(), some[0], some[4]), (5, 4.0, 50.0));
        assert_eq!(knots(&[3.0, 1.0, 3.0], 5), [1.0, 3.0]);
    }
}
