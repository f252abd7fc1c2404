//! Grey gradient by the Sobel masks.

use crate::frame::Plane;

/// Horizontal and vertical derivative, grey levels per pixel; the outermost rows and columns are zero.
///
/// One eighth of the Sobel sums, so that a ramp of slope one gives one; `skimage.filters.sobel_h` and `_v`
/// differ by a factor of two and their border.
#[must_use]
pub fn sobel(plane: &Plane) -> (Plane, Plane) {
    let (w, h) = (plane.width, plane.height);
    let mut gx = Plane::filled(w, h, 0.0);
    let mut gy = Plane::filled(w, h, 0.0);
    if w < 3 || h < 3 {
        return (gx, gy);
    }
    for y in 1..h - 1 {
        let (a, b, c) = (plane.row(y - 1), plane.row(y), plane.row(y + 1));
        for x in 1..w - 1 {
            let left = a[x - 1] + 2.0 * b[x - 1] + c[x - 1];
            let right = a[x + 1] + 2.0 * b[x + 1] + c[x + 1];
            let up = a[x - 1] + 2.0 * a[x] + a[x + 1];
            let down = c[x - 1] + 2.0 * c[x] + c[x + 1];
            gx.data[y * w + x] = 0.125 * (right - left);
            gy.data[y * w + x] = 0.125 * (down - up);
        }
    }
    (gx, gy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_has_its_slope() {
        let data = (0..25).map(|k| 3.0 * (k % 5) as f32 - 2.0 * (k / 5) as f32).collect();
        let (gx, gy) = sobel(&Plane { width: 5, height: 5, data });
        assert_eq!((gx.at(2, 2), gy.at(2, 2)), (3.0, -2.0));
    }
}
