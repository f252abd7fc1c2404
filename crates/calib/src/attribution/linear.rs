//! Least squares of a few parameters within bounds.

use crate::covariance::square;

/// Cholesky factor of a small symmetric matrix, row-major; `None` if not positive definite.
pub(super) fn cholesky(a: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = a.len();
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            let rest = a[i][j] - known;
            if i == j {
                if !(rest > 0.0) {
                    return None;
                }
                l[i][i] = rest.sqrt();
            } else {
                l[i][j] = rest / l[j][j];
            }
        }
    }
    Some(l)
}

/// Solve `L L' x = b`.
pub(super) fn solve(l: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut x = b.to_vec();
    for i in 0..n {
        let known: f64 = (0..i).map(|k| l[i][k] * x[k]).sum();
        x[i] = (x[i] - known) / l[i][i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| l[k][i] * x[k]).sum();
        x[i] = (x[i] - known) / l[i][i];
    }
    x
}

/// `J' J` of columns.
pub(super) fn normal(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let row = |a: &Vec<f64>| columns.iter().map(|b| dot(a, b)).collect();
    columns.iter().map(row).collect()
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Orthonormal directions of vectors, one after the other; what the ones before span adds none.
pub(super) fn orthonormal<'v>(vectors: impl IntoIterator<Item = &'v Vec<f64>>) -> Vec<Vec<f64>> {
    let mut directions: Vec<Vec<f64>> = Vec::new();
    for v in vectors {
        let rest = without(v, &directions);
        let length = square(&rest).sqrt();
        if length > 1e-9 * square(v).sqrt() {
            directions.push(rest.iter().map(|x| x / length).collect());
        }
    }
    directions
}

/// What is left of a vector when its parts along orthonormal directions are taken out.
pub(super) fn without(v: &[f64], directions: &[Vec<f64>]) -> Vec<f64> {
    let mut rest = v.to_vec();
    for d in directions {
        let along = dot(&rest, d);
        rest.iter_mut().zip(d).for_each(|(r, x)| *r -= along * x);
    }
    rest
}

/// Covariance of parameters with a weak normal prior, from whitened columns: the inverse of
/// `J' J + ridge I`.
pub(super) fn covariance(columns: &[Vec<f64>], ridge: f64) -> Option<Vec<Vec<f64>>> {
    let mut a = normal(columns);
    for (i, row) in a.iter_mut().enumerate() {
        row[i] += ridge;
    }
    let l = cholesky(&a)?;
    let unit = |i: usize| (0..a.len()).map(|k| f64::from(u8::from(k == i))).collect::<Vec<_>>();
    Some((0..a.len()).map(|i| solve(&l, &unit(i))).collect())
}

/// Minimise `|r - J d|^2 + lambda sum_i (J'J)_ii d_i^2` with `0 <= u + d <= 1`; held parameters stay.
/// Returns the new `u`.
pub(super) fn bounded_step(
    columns: &[Vec<f64>],
    r: &[f64],
    u: &[f64],
    held: Option<usize>,
    lambda: f64,
) -> Vec<f64> {
    let p = columns.len();
    let a = normal(columns);
    let g: Vec<f64> = columns.iter().map(|c| dot(c, r)).collect();
    let mut fixed: Vec<Option<f64>> = (0..p).map(|i| (Some(i) == held).then_some(0.0)).collect();
    loop {
        let free: Vec<usize> = (0..p).filter(|i| fixed[*i].is_none()).collect();
        let mut d: Vec<f64> = fixed.iter().map(|f| f.unwrap_or(0.0)).collect();
        if !free.is_empty() {
            let small: Vec<Vec<f64>> = free
                .iter()
                .map(|i| {
                    let diagonal = |j: usize| {
                        // A parameter without any effect here stays where it is.
                        if *i == j { a[j][j] * (1.0 + lambda) + 1e-9 } else { a[*i][j] }
                    };
                    free.iter().map(|j| diagonal(*j)).collect()
                })
                .collect();
            let rhs: Vec<f64> = free
                .iter()
                .map(|i| g[*i] - (0..p).map(|j| a[*i][j] * fixed[j].unwrap_or(0.0)).sum::<f64>())
                .collect();
            let Some(l) = cholesky(&small) else { return u.to_vec() };
            for (i, x) in free.iter().zip(solve(&l, &rhs)) {
                d[*i] = x;
            }
        }
        let beyond = |i: usize| (-(u[i] + d[i])).max(u[i] + d[i] - 1.0);
        let worst = free.iter().copied().max_by(|i, j| beyond(*i).total_cmp(&beyond(*j)));
        match worst {
            Some(i) if beyond(i) > 0.0 => {
                fixed[i] = Some(if u[i] + d[i] < 0.0 { -u[i] } else { 1.0 - u[i] });
            }
            _ => return u.iter().zip(&d).map(|(u, d)| (u + d).clamp(0.0, 1.0)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bounded_step_is_least_squares_inside_and_conditional_at_a_bound() {
        // r = (1, 1); columns (1, 0) and (1, 1): free solution d = (0, 1).
        let columns = vec![vec![1.0, 0.0], vec![1.0, 1.0]];
        let free = bounded_step(&columns, &[0.5, 0.5], &[0.2, 0.2], None, 0.0);
        assert!((free[0] - 0.2).abs() < 1e-6 && (free[1] - 0.7).abs() < 1e-6, "{free:?}");
        // With the second capped at 1 (d = 0.8), the first takes what is left of row one: 0.2.
        let capped = bounded_step(&columns, &[1.0, 1.0], &[0.2, 0.2], None, 0.0);
        assert!((capped[1] - 1.0).abs() < 1e-12 && (capped[0] - 0.4).abs() < 1e-6, "{capped:?}");
        let held = bounded_step(&columns, &[0.5, 0.5], &[0.2, 0.2], Some(1), 0.0);
        assert!((held[0] - 0.7).abs() < 1e-6 && held[1] == 0.2, "{held:?}");
    }

    #[test]
    fn the_covariance_is_the_inverse_of_the_normal_matrix() {
        let c = covariance(&[vec![2.0, 0.0], vec![1.0, 1.0]], 0.0).expect("is regular");
        // J'J = [[4, 2], [2, 2]], inverse [[0.5, -0.5], [-0.5, 1]].
        assert!((c[0][0] - 0.5).abs() < 1e-12 && (c[0][1] + 0.5).abs() < 1e-12);
        assert!((c[1][1] - 1.0).abs() < 1e-12);
        assert!(covariance(&[vec![1.0], vec![1.0]], 0.0).is_none());
    }
}
