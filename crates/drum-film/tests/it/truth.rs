//! The truth of a frame: equal to the closed form straight on, and changed by the camera as geometry says.

use approx::assert_abs_diff_eq;
use drum_film::{Bed, Camera, Film, Projection, RaisedSide};

fn small(camera: Camera) -> Film {
    Film { camera: camera.with_size(242, 162), ..Film::default() }
}

fn bed() -> Bed {
    Bed { fill: 0.4, aor_lin_deg: 33.0, s_shape_deg: 5.0, curvature: 0.1, ..Bed::default() }
}

#[test]
fn straight_on_the_picture_shows_the_closed_form() {
    for raised in [RaisedSide::Right, RaisedSide::Left] {
        let bed = Bed { raised, ..bed() };
        let truth = small(Camera::default()).bed_frame(&bed, 0).unwrap().truth;
        let closed = bed.shape().unwrap().responses();
        // Polygons of 4001 points: relative error (2 pi / 4000)^2 / 6 of an arc, less of the smooth surface.
        assert_abs_diff_eq!(truth.aor_lin_deg, closed.aor_lin_deg, epsilon = 1e-5);
        assert_abs_diff_eq!(truth.aor_mid_deg, closed.aor_mid_deg, epsilon = 1e-5);
        assert_abs_diff_eq!(truth.cen_x_pct, closed.cen_x_pct, epsilon = 1e-4);
        assert_abs_diff_eq!(truth.cen_y_pct, closed.cen_y_pct, epsilon = 1e-4);
        assert_abs_diff_eq!(truth.fill, closed.fill, epsilon = 1e-6);
        assert_abs_diff_eq!(truth.axis_ratio, 1.0, epsilon = 1e-9);
    }
}

#[test]
fn roll_turns_the_picture_by_its_angle() {
    let plane = Bed { s_shape_deg: 0.0, curvature: 0.0, ..bed() };
    let straight = small(Camera::default()).bed_frame(&plane, 0).unwrap().truth;
    for (raised, sign) in [(RaisedSide::Right, 1.0), (RaisedSide::Left, -1.0)] {
        let plane = Bed { raised, ..plane };
        let turned = small(Camera { roll_deg: 4.0, ..Camera::default() })
            .bed_frame(&plane, 0)
            .unwrap()
            .truth;
        // A straight surface keeps its line whatever the columns: rounding only.
        assert_abs_diff_eq!(turned.aor_lin_deg, 33.0 + sign * 4.0, epsilon = 1e-9);
        assert_abs_diff_eq!(turned.aor_mid_deg, 33.0 + sign * 4.0, epsilon = 1e-9);
        // The centroid turns with it, at its distance.
        assert_abs_diff_eq!(
            turned.cen_x_pct.hypot(turned.cen_y_pct),
            straight.cen_x_pct.hypot(straight.cen_y_pct),
            epsilon = 1e-9
        );
        let angle = |t: &drum_film::Truth| t.cen_x_pct.atan2(t.cen_y_pct).to_degrees();
        assert_abs_diff_eq!(angle(&turned) - angle(&straight), sign * 4.0, epsilon = 1e-9);
    }
}

#[test]
fn pitch_of_parallel_rays_compresses_heights_by_its_cosine() {
    let plane = Bed { s_shape_deg: 0.0, curvature: 0.0, ..bed() };
    let camera =
        Camera { pitch_deg: 12.0, projection: Projection::Orthographic, ..Camera::default() };
    let truth = small(camera).bed_frame(&plane, 0).unwrap().truth;
    let cos = 12.0_f64.to_radians().cos();
    let expected = (33.0_f64.to_radians().tan() * cos).atan().to_degrees();
    assert_abs_diff_eq!(truth.aor_lin_deg, expected, epsilon = 1e-9);
    // An ellipse of half axes a and a cos: moments of its edge in equal steps of the angle are in the ratio cos^2.
    assert_abs_diff_eq!(truth.axis_ratio, cos, epsilon = 1e-9);
}

#[test]
fn the_free_surface_seen_in_perspective_adds_apparent_fill() {
    let flat = small(Camera::default()).bed_frame(&bed(), 0).unwrap().truth;
    let bed = Bed { extruded: true, ..bed() };
    let deep = small(Camera::default()).bed_frame(&bed, 0).unwrap().truth;
    assert!(deep.fill > flat.fill + 0.01, "{} {}", deep.fill, flat.fill);
    assert!(deep.cen_y_pct < flat.cen_y_pct);
    let parallel = small(Camera { projection: Projection::Orthographic, ..Camera::default() })
        .bed_frame(&bed, 0)
        .unwrap()
        .truth;
    assert_abs_diff_eq!(parallel.fill, flat.fill, epsilon = 1e-9);
}

#[test]
fn a_bed_above_the_axis_hides_its_free_surface() {
    let full = Bed { fill: 0.7, s_shape_deg: 0.0, curvature: 0.0, extruded: true, ..bed() };
    let truth = small(Camera::default()).bed_frame(&full, 0).unwrap().truth;
    assert_abs_diff_eq!(truth.fill, 0.7, epsilon = 1e-6);
}

#[test]
fn pixels_covered_by_the_bed_are_those_of_the_truth() {
    for extruded in [false, true] {
        for (fill, aor_lin_deg) in [(0.1, 55.0), (0.35, 30.0), (0.6, 12.0)] {
            for camera in [
                Camera::default(),
                Camera { roll_deg: 3.0, pitch_deg: 2.0, yaw_deg: -2.0, ..Camera::default() },
            ] {
                let film = Film { camera: camera.with_size(484, 324), ..Film::default() };
                let bed = Bed { fill, aor_lin_deg, extruded, ..bed() };
                let bed = Bed { curvature: 0.0, ..bed };
                let (coverage, truth) = film.studio().unwrap().bed_coverage(&bed).unwrap();
                let area = coverage.area_px2();
                let [x, y] = coverage.centroid_px().unwrap();
                let r = truth.radius_px;
                let cen_x = 100.0 * (x - truth.center_x_px) / r;
                let cen_y = 100.0 * (y - truth.center_y_px) / r;
                // 8 x 8 points a pixel: sd 0.3/8 px on each of some 600 edge pixels, far below 0.01 % of R.
                let tolerance = 0.01;
                let label = format!("{fill} {aor_lin_deg} {extruded} {:?}", film.camera);
                assert!((cen_x - truth.cen_x_pct).abs() < tolerance, "{label}: {cen_x} {truth:?}");
                assert!((cen_y - truth.cen_y_pct).abs() < tolerance, "{label}: {cen_y} {truth:?}");
                let fill = area / (std::f64::consts::PI * r * r);
                assert!((fill / truth.fill - 1.0).abs() < 3e-4, "{label}: {fill} {truth:?}");
            }
        }
    }
}
