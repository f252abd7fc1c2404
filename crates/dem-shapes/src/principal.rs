//! Principal axes of a symmetric tensor.

use glam::{DMat3, DQuat, DVec3};

/// Products of inertia below this share of the largest moment count as zero: they are the error of
/// a quadrature, and would turn the axes of a symmetric body at will.
const NEGLIGIBLE: f64 = 1e-9;

/// Moments and the rotation from the principal frame to the frame of `tensor`.
///
/// The axes keep as near to the given ones as they can: a body built about its own axes keeps them.
pub(crate) fn principal_axes(tensor: &DMat3) -> (DVec3, DQuat) {
    let mut a = tensor.to_cols_array_2d();
    let largest = a.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
    if off_diagonal(&a) <= NEGLIGIBLE * largest {
        return (DVec3::new(a[0][0], a[1][1], a[2][2]), DQuat::IDENTITY);
    }
    // Cyclic Jacobi: columns of `v` become the axes. A symmetric 3x3 needs at most eight sweeps.
    let mut v = DMat3::IDENTITY.to_cols_array_2d();
    for _ in 0..12 {
        if off_diagonal(&a) <= f64::EPSILON * 1e-2 * largest {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut v, p, q);
        }
    }
    let moments = [a[0][0], a[1][1], a[2][2]];
    let axes = v.map(DVec3::from_array);
    nearest_to_given(moments, axes)
}

fn off_diagonal(a: &[[f64; 3]; 3]) -> f64 {
    a[0][1].abs().max(a[0][2].abs()).max(a[1][2].abs())
}

/// One Jacobi rotation that clears `a[p][q]`; row `k` of `v` holds axis `k`.
fn rotate(a: &mut [[f64; 3]; 3], v: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for row in a.iter_mut() {
        let (kp, kq) = (row[p], row[q]);
        row[p] = c * kp - s * kq;
        row[q] = s * kp + c * kq;
    }
    for k in 0..3 {
        let (pk, qk) = (a[p][k], a[q][k]);
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
        let (vp, vq) = (v[p][k], v[q][k]);
        v[p][k] = c * vp - s * vq;
        v[q][k] = s * vp + c * vq;
    }
}

/// Orders and turns the axes so that they are a right-handed frame nearest to the unit axes.
fn nearest_to_given(moments: [f64; 3], axes: [DVec3; 3]) -> (DVec3, DQuat) {
    const ORDERS: [[usize; 3]; 6] =
        [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let mut best = (f64::NEG_INFINITY, DVec3::ZERO, DMat3::IDENTITY);
    for order in ORDERS {
        let [x, y, z] = order.map(|k| axes[k]);
        for (sx, sy) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let (x, y) = (sx * x, sy * y);
            let z = if x.cross(y).dot(z) < 0.0 { -z } else { z };
            // The trace grows as the angle of the rotation falls.
            let trace = x.x + y.y + z.z;
            if trace > best.0 {
                let m = DVec3::from_array(order.map(|k| moments[k]));
                best = (trace, m, DMat3::from_cols(x, y, z));
            }
        }
    }
    (best.1, DQuat::from_mat3(&best.2).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_tensor_gives_its_moments_and_the_turn_back() {
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.2, 0.5);
        let r = DMat3::from_quat(turn);
        let moments = DVec3::new(2.0, 3.0, 4.5);
        let (got, axes) = principal_axes(&(r * DMat3::from_diagonal(moments) * r.transpose()));
        // The turn is less than 45 degrees about every axis, so nearest means the same order.
        assert!((got - moments).length() < 1e-14);
        assert!(axes.angle_between(turn) < 1e-7);
    }

    #[test]
    fn the_axes_rebuild_the_tensor_for_any_turn() {
        let moments = DVec3::new(1.0, 1.0, 1.7);
        for k in 0..50 {
            let k = f64::from(k);
            let turn = DQuat::from_euler(glam::EulerRot::ZYX, 0.7 * k, 1.3 * k, 2.1 * k);
            let r = DMat3::from_quat(turn);
            let tensor = r * DMat3::from_diagonal(moments) * r.transpose();
            let (got, axes) = principal_axes(&tensor);
            let p = DMat3::from_quat(axes);
            let back = p * DMat3::from_diagonal(got) * p.transpose();
            // Rounding of two matrix products.
            assert!(back.abs_diff_eq(tensor, 1e-13));
            assert!((p.determinant() - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn noise_does_not_turn_a_symmetric_body() {
        let noisy = DMat3::from_cols(
            DVec3::new(1.0, 1e-11, 0.0),
            DVec3::new(1e-11, 1.0, 0.0),
            DVec3::new(0.0, 0.0, 2.0),
        );
        assert_eq!(principal_axes(&noisy).1, DQuat::IDENTITY);
    }
}
