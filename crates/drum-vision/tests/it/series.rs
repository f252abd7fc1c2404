//! A series: order, determinism, outliers, rejected frames and the shape of the report.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use drum_film::{Bed, Camera, Film};
use drum_vision::decode::list_frames;
use drum_vision::{VisionConfig, VisionError, measure_series, overlay};

use crate::scenes::to_frame;

/// Eight frames of a rolling bed, one of them far steeper, one truncated, and a text file.
fn folder() -> (tempfile::TempDir, Vec<PathBuf>) {
    let dir = tempfile::tempdir().unwrap();
    let film = Film { camera: Camera::default().with_size(242, 162), ..Film::default() };
    for k in 0..8u32 {
        let aor_lin_deg = if k == 5 { 44.0 } else { 30.0 + 0.3 * f64::from(k % 3) };
        let bed = Bed { aor_lin_deg, s_shape_deg: 1.0, fill: 0.4, ..Bed::default() };
        let frame = to_frame(film.bed_frame(&bed, k.into()).unwrap().image);
        overlay::write_png(&frame, &dir.path().join(format!("shot {}.png", k + 3))).unwrap();
    }
    let whole = std::fs::read(dir.path().join("shot 3.png")).unwrap();
    std::fs::write(dir.path().join("shot 99.png"), &whole[..whole.len() / 3]).unwrap();
    std::fs::write(dir.path().join("notes.txt"), "speed 12 rpm").unwrap();
    let paths = list_frames(dir.path()).unwrap();
    (dir, paths)
}

#[test]
fn a_bad_frame_is_named_and_the_rest_goes_on() {
    let (_dir, paths) = folder();
    assert_eq!(paths.len(), 9);
    let mut config = VisionConfig::default();
    config.rig.speed_rpm = Some(12.0);
    config.rig.drum_radius_m = Some(0.125);
    let seen = AtomicUsize::new(0);
    let report = measure_series(&paths, &config, None, |p| {
        seen.fetch_add(1, Ordering::Relaxed);
        assert_eq!(p.total, 9);
        assert_eq!(p.frame.is_some(), p.outcome.is_ok());
    })
    .unwrap();
    assert_eq!(seen.into_inner(), 9);
    assert_eq!((report.n_frames, report.rejected.len()), (8, 1));
    assert_eq!(report.rejected[0].frame, "shot 99.png");
    // Natural order: 3, 4, ... 10.
    assert_eq!(report.frames[7].frame, "shot 10.png");
    let outliers: Vec<&str> =
        report.frames.iter().filter(|f| f.outlier.is_some()).map(|f| f.frame.as_str()).collect();
    assert_eq!(outliers, ["shot 8.png"]);
    assert!((report.froude.unwrap() - 0.0201).abs() < 1e-4);
    let drum = report.drum.unwrap();
    assert!((drum.radius_px - 56.1).abs() < 0.3, "{drum:?}");
    let r = report.responses.unwrap();
    assert!((r.aor_lin_deg.mean - 32.0).abs() < 0.5 && r.aor_lin_deg.sd.unwrap() > 4.0);
    assert!(report.csv_row(12.0).unwrap().starts_with("12,3"));
}

#[test]
fn the_report_does_not_depend_on_the_number_of_threads() {
    let (_dir, paths) = folder();
    let config = VisionConfig::default();
    let text = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let report = pool.install(|| measure_series(&paths, &config, None, |_| {})).unwrap();
        serde_json::to_string(&report).unwrap()
    };
    assert_eq!(text(1), text(3));
}

#[test]
fn the_report_has_the_promised_keys() {
    let (_dir, paths) = folder();
    let report = measure_series(&paths, &VisionConfig::default(), None, |_| {}).unwrap();
    let v = serde_json::to_value(&report).unwrap();
    assert_eq!(v["n_frames"], 8);
    assert!(v["rejected"][0]["frame"].is_string() && v["rejected"][0]["reason"].is_string());
    assert_eq!(v["drum"]["center_px"].as_array().unwrap().len(), 2);
    assert!(v["drum"]["radius_px"].is_number());
    for name in drum_vision::series::RESPONSES {
        for key in ["mean", "sd", "n_eff"] {
            assert!(v["responses"][name][key].is_number(), "{name}.{key}");
        }
    }
    let c = v["covariance"].as_array().unwrap();
    assert_eq!((c.len(), c[0].as_array().unwrap().len()), (4, 4));
    // Symmetric, and no correlation beyond one.
    for i in 0..4 {
        for j in 0..4 {
            let at = |a: usize, b: usize| c[a][b].as_f64().unwrap();
            assert_eq!(at(i, j), at(j, i));
            assert!(at(i, j).powi(2) <= at(i, i) * at(j, j) * (1.0 + 1e-12));
        }
    }
    assert_eq!(v["frames"].as_array().unwrap().len(), 8);
    assert!(v["frames"][0]["aor_lin_deg"]["sd"].as_f64().unwrap() > 0.0);
}

#[test]
fn a_missing_reference_frame_stops_the_series_with_its_name() {
    let (_dir, paths) = folder();
    let mut config = VisionConfig::default();
    config.drum.source =
        drum_vision::config::CircleSource::Reference { path: "no_such_reference.png".into() };
    let e = measure_series(&paths, &config, None, |_| {}).unwrap_err();
    assert!(matches!(e, VisionError::Reference { .. }));
    assert!(e.to_string().contains("no_such_reference.png"), "{e}");
    assert!(measure_series(&[], &VisionConfig::default(), None, |_| {}).is_err());
}

#[test]
fn overlay_and_contact_sheet_show_what_was_found() {
    let (_dir, paths) = folder();
    let config = VisionConfig::default();
    let tiles = std::sync::Mutex::new(vec![None; paths.len()]);
    measure_series(&paths, &config, None, |p| {
        let tile = match (p.frame, p.outcome) {
            (Some(frame), Ok(m)) => {
                let drawn = overlay::overlay(frame, m);
                assert_eq!((drawn.width(), drawn.height()), (frame.width(), frame.height()));
                // The circle's colour stands on the circle.
                let c = m.drum.fit.circle;
                let at = (c.x_px.round() as usize, (c.y_px - c.radius_px).round() as usize);
                let [r, g, b] = drawn.pixel(at.0, at.1).unwrap();
                assert!(r > 150 && g > 100 && b < 120, "{r} {g} {b}");
                overlay::Tile::new(&drawn, 100, false, false)
            }
            _ => {
                let grey = drum_vision::Frame::from_grey(100, 66, &[90; 6600]).unwrap();
                overlay::Tile::new(&grey, 100, true, false)
            }
        };
        tiles.lock().unwrap()[p.index] = Some(tile);
    })
    .unwrap();
    let tiles: Vec<_> = tiles.into_inner().unwrap().into_iter().map(Option::unwrap).collect();
    let sheet = overlay::contact_sheet(&tiles, 4);
    let (w, h) = (tiles[0].picture.width() + 8, 66 + 8);
    assert_eq!(sheet.height() / 3, h.max(tiles[0].picture.height() + 8));
    assert!(sheet.width() >= 4 * w);
    // The ninth tile, rejected, has a red border.
    let [r, g, b] = sheet.pixel(1, 2 * (sheet.height() / 3) + 1).unwrap();
    assert!(r > 180 && g < 80 && b < 80);
}
