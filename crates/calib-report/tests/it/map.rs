//! The central picture against surrogates whose contours are known.

use calib_report::Picture;
use calib_report::contour::Grid;
use calib_report::pictures::{CalibrationMap, MappedResponse};

use crate::document::{all, checked};

fn response(name: &str, mean: f64, sd: f64, field: impl FnMut(f64, f64) -> f64) -> MappedResponse {
    MappedResponse {
        name: name.into(),
        unit: "°".into(),
        field: Grid::sample(41, 81, (0.4, 0.8), (0.1, 0.9), field),
        measured: Some(mean),
        sd,
    }
}

/// Two planes: 20 + 10 mu_pp and 50 - 10 mu_wall.
fn crossing() -> CalibrationMap {
    CalibrationMap {
        title: "crossing".into(),
        x_label: "μ_{wall}".into(),
        y_label: "μ_{pp}".into(),
        responses: vec![
            response("angle", 25.0, 0.5, |_, p| 20.0 + 10.0 * p),
            response("centre", 44.0, 0.3, |w, _| 50.0 - 10.0 * w),
        ],
        ..Default::default()
    }
}

#[test]
fn overlap_of_two_planes_is_their_rectangle() {
    let overlaps = crossing().overlaps();
    assert_eq!(overlaps.len(), 1);
    let overlap = &overlaps[0];
    assert_eq!(overlap.responses, [0, 1]);
    // Linear fields: exact to rounding.
    let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
    assert!(close(overlap.x_range.0, 0.57) && close(overlap.x_range.1, 0.63));
    assert!(close(overlap.y_ranges[0].0, 0.45) && close(overlap.y_ranges[0].1, 0.55));
    assert!(close(overlap.area, 0.06 * 0.10));
}

#[test]
fn the_largest_sets_of_bands_that_meet_are_found() {
    let mut map = crossing();
    map.responses.push(response("far", 22.0, 0.2, |_, p| 20.0 + 10.0 * p));
    // "angle" and "far" ask for different mu_pp; each meets "centre".
    let overlaps = map.overlaps();
    let sets: Vec<&[usize]> = overlaps.iter().map(|o| o.responses.as_slice()).collect();
    assert_eq!(sets, [&[0, 1][..], &[1, 2][..]], "larger area first");
    assert!(map.svg().contains("at most 2 of 3 bands overlap"));
}

#[test]
fn a_region_in_two_pieces_has_two_intervals() {
    let fold = |_: f64, p: f64| 30.0 - 100.0 * (p - 0.5).powi(2);
    let map = CalibrationMap {
        responses: vec![
            response("angle", 26.0, 0.5, fold),
            response("centre", 44.0, 0.3, |w, _| 50.0 - 10.0 * w),
        ],
        ..Default::default()
    };
    let overlaps = map.overlaps();
    // Roots of the fold: p = 0.5 -+ sqrt((30 - level)/100) for levels 25.5 and 26.5; the chord of a
    // cell of 0.01 lies off the parabola by at most 100*(0.01/2)^2 = 2.5e-3 deg, 6e-5 in p.
    let (near, far) = (0.035f64.sqrt(), 0.045f64.sqrt());
    let expected = [(0.5 - far, 0.5 - near), (0.5 + near, 0.5 + far)];
    assert_eq!(overlaps[0].y_ranges.len(), 2);
    for ((lo, hi), (a, b)) in overlaps[0].y_ranges.iter().zip(expected) {
        assert!((lo - a).abs() < 1e-4 && (hi - b).abs() < 1e-4, "{lo} {hi} against {a} {b}");
    }
}

#[test]
fn drawn_contours_lie_on_their_level() {
    // Read the drawn paths back: of the plane 20 + 10 mu_pp every contour is a horizontal line at a
    // round level, so the pixels of mu_pp = 0.2, 0.3 ... can be had from the axis ticks.
    let svg = crossing().svg();
    let document = checked(&svg);
    let ticks: Vec<f64> = all(&document, "text")
        .filter(|t| t.attribute("text-anchor") == Some("end"))
        .map(|t| crate::document::number(&t, "y") - 4.0)
        .collect();
    assert!(ticks.len() >= 8, "ticks 0.1 to 0.9");
    let contours: Vec<f64> = all(&document, "path")
        .filter(|p| p.attribute("class") == Some("s-0") && p.attribute("stroke-opacity").is_some())
        .filter_map(|p| p.attribute("d"))
        .map(|d| {
            let ys: Vec<f64> =
                d[1..].split('L').filter_map(|xy| xy.split(' ').nth(1)?.parse().ok()).collect();
            assert!(ys.iter().all(|y| (y - ys[0]).abs() < 0.011), "horizontal: {d}");
            ys[0]
        })
        .collect();
    assert!(!contours.is_empty());
    // Levels 21 to 29 by 1 or 2 are mu_pp 0.1 to 0.9 by 0.1: each on a tick, to the two decimals
    // of the file.
    for y in contours {
        assert!(ticks.iter().any(|t| (t - y).abs() < 0.02), "{y} not on a tick of {ticks:?}");
    }
}

#[test]
fn a_band_beyond_the_map_is_said_to_be_so() {
    let mut map = crossing();
    map.responses[1].measured = Some(60.0);
    let svg = map.svg();
    assert!(svg.contains("off the map: model 42.0 to 46.0"));
    assert!(svg.contains("No two measured bands overlap."));
}

#[test]
fn the_closer_map_keeps_the_overlap() {
    let mut map = crossing();
    map.responses.truncate(1);
    map.responses.push(response("other", 25.2, 0.4, |_, p| 20.0 + 10.0 * p));
    let closer = map.closer().expect("bands take up an eighth of the height");
    let field = &closer.responses[0].field;
    assert!(field.ny < 81 && field.y_range.0 > 0.3 && field.y_range.1 < 0.7);
    assert_eq!(field.values.len(), field.nx * field.ny);
    let (whole, part) = (map.overlaps(), closer.overlaps());
    assert!((whole[0].area - part[0].area).abs() < 1e-9);
}
