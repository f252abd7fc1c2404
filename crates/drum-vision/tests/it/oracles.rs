//! Every operation against SciPy or scikit-image on the same input, frozen by `tests/oracles/oracles.py`.

use drum_vision::bed::columns::column_transitions;
use drum_vision::drum::circle_fit::{Circle, fit_circle};
use drum_vision::drum::hough::{Contrast, find_circles};
use drum_vision::filter::gradient::sobel;
use drum_vision::filter::median::{median_binary, median_u8};
use drum_vision::filter::stretch::{histogram, stretch_limits, stretched};
use drum_vision::filter::threshold::{local_mean, otsu};
use drum_vision::filter::wiener::{Border, wiener};
use drum_vision::frame::Plane;
use drum_vision::response::area_and_moment;
use serde_json::Value;

const W: usize = 40;
const H: usize = 32;

fn oracle() -> Value {
    serde_json::from_str(include_str!("../oracles/oracles.json")).unwrap()
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn picture(o: &Value) -> Vec<u8> {
    numbers(&o["picture"]).iter().map(|&v| v as u8).collect()
}

fn plane(samples: &[u8]) -> Plane {
    Plane { width: W, height: H, data: samples.iter().map(|&v| f32::from(v)).collect() }
}

#[track_caller]
fn close(ours: &[f32], theirs: &[f64], tolerance: f64) {
    assert_eq!(ours.len(), theirs.len());
    for (k, (a, b)) in ours.iter().zip(theirs).enumerate() {
        assert!((f64::from(*a) - b).abs() <= tolerance, "sample {k}: {a} against {b}");
    }
}

#[test]
fn median_equals_scipy_with_mirrored_borders() {
    let o = oracle();
    let img = picture(&o);
    for (x, y) in [(3, 3), (5, 5), (10, 10), (7, 4)] {
        let theirs = numbers(&o[format!("median_{x}x{y}")]);
        let ours = median_u8(&img, W, H, x, y);
        assert!(ours.iter().zip(&theirs).all(|(a, b)| f64::from(*a) == *b), "window {x} x {y}");
    }
    let mask: Vec<bool> = img.iter().map(|&v| v > 120).collect();
    let theirs = numbers(&o["binary_median_10"]);
    let ours = median_binary(&mask, W, H, 10);
    assert!(ours.iter().zip(&theirs).all(|(a, b)| *a == (*b == 1.0)));
}

#[test]
fn wiener_equals_scipy_signal_with_zero_borders() {
    let o = oracle();
    let p = plane(&picture(&o));
    // Ours rounds to single precision: 1e-5 of 255.
    close(&wiener(&p, 5, None, Border::Zero).data, &numbers(&o["wiener_5"]), 3e-3);
    close(&wiener(&p, 7, Some(300.0), Border::Zero).data, &numbers(&o["wiener_7_noise_300"]), 3e-3);
}

#[test]
fn otsu_and_stretch_equal_scikit_image() {
    let o = oracle();
    let img = picture(&o);
    let h = histogram(img.iter().copied());
    assert_eq!(u64::from(otsu(&h).unwrap()), o["otsu"].as_u64().unwrap());
    let limits = stretch_limits(&h, 0.01).unwrap();
    assert_eq!(vec![f64::from(limits.0), f64::from(limits.1)], numbers(&o["stretch_limits"]));
    let ours: Vec<f32> = img.iter().map(|&v| stretched(f32::from(v), limits)).collect();
    close(&ours, &numbers(&o["stretched"]), 1e-4);
}

#[test]
fn local_mean_gradient_and_luma_equal_scikit_image() {
    let o = oracle();
    let img = picture(&o);
    let p = plane(&img);
    close(&local_mean(&p, 9).data, &numbers(&o["local_mean_9"]), 1e-4);
    let (gx, gy) = sobel(&p);
    let inner = |g: &Plane| -> Vec<f32> {
        (1..H - 1)
            .flat_map(|y| g.row(y)[1..W - 1].iter().map(|v| 2.0 * v).collect::<Vec<_>>())
            .collect()
    };
    // scikit-image divides by four, we by eight.
    close(&inner(&gy), &numbers(&o["sobel_h"]), 1e-4);
    close(&inner(&gx), &numbers(&o["sobel_v"]), 1e-4);
    let mut rgb = Vec::new();
    for y in 0..H {
        for x in 0..W {
            let v = img[y * W + x];
            rgb.extend([v, 255 - v, img[y * W + (x + W - 3) % W]]);
        }
    }
    let frame = drum_vision::Frame::from_rgb(W, H, rgb).unwrap();
    // Weights of three digits against scikit-image's 0.299, 0.587, 0.114 in double precision.
    close(&frame.grey(frame.window()).data, &numbers(&o["luma"]), 1e-3);
}

#[test]
fn hough_circle_and_fit_agree_with_scikit_image() {
    let o = oracle();
    let (w, h) = (120, 100);
    let (cx, cy, r) = (57.3f64, 48.8f64, 33.4f64);
    let data = (0..w * h)
        .map(|k| {
            let d = ((k % w) as f64 - cx).hypot((k / w) as f64 - cy);
            (200.0 - 160.0 * (r + 0.5 - d).clamp(0.0, 1.0)) as f32
        })
        .collect();
    let p = Plane { width: w, height: h, data };
    let found = find_circles(&p, (20.0, 45.0), Contrast::DarkDisc, 0.3, 3);
    let theirs = numbers(&o["hough"]);
    // Theirs counts whole pixels; ours too for the centre: one pixel each.
    for (a, b) in [found[0].x, found[0].y, found[0].radius].iter().zip(&theirs) {
        assert!((a - b).abs() <= 1.0, "{found:?} against {theirs:?}");
    }
    assert!(found[0].support > 0.95);
    let points: Vec<(f64, f64)> =
        numbers(&o["edge_points"]).chunks(2).map(|p| (p[0], p[1])).collect();
    let start = Circle { x_px: found[0].x, y_px: found[0].y, radius_px: found[0].radius };
    let fit = fit_circle(&points, start, points.len()).unwrap().circle;
    let theirs = numbers(&o["circle_fit"]);
    // Algebraic least squares there, robust geometric here, on the same pixels.
    for (a, b) in [fit.x_px, fit.y_px, fit.radius_px].iter().zip(&theirs) {
        assert!((a - b).abs() < 0.05, "{fit:?} against {theirs:?}");
    }
}

#[test]
fn area_and_centroid_agree_with_regionprops() {
    let o = oracle();
    let corners: Vec<(f64, f64)> =
        numbers(&o["polygon"]).chunks(2).map(|p| (p[0], -p[1])).collect();
    let (area, mx, my) = area_and_moment(&corners);
    let theirs = numbers(&o["polygon_area_centroid"]);
    // Theirs counts cells of 1/16: half a cell along an outline of 300 units at random.
    assert!((area - theirs[0]).abs() < 3.0, "{area} against {theirs:?}");
    assert!((mx / area - theirs[1]).abs() < 0.05 && (-my / area - theirs[2]).abs() < 0.05);
}

#[test]
fn the_thesis_takes_the_third_of_four_transitions_and_the_fifth_of_six() {
    let column = |bits: &str| -> Vec<bool> { bits.chars().map(|c| c == '#').collect() };
    for (bits, expected) in [
        ("...####..", Some(2.5)),
        (".#..###..", Some(3.5)),
        (".#.#.##..", Some(4.5)),
        (".........", None),
        ("..#######", None),
    ] {
        let rows = column_transitions(&column(bits), 1, 9, 1);
        assert_eq!(rows.first().map(|p| p.1), expected, "{bits}");
    }
}
