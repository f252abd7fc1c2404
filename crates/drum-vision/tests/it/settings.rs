//! Settings: every accepted key is used, unknown ones are refused with their place.

use drum_vision::config::{CircleSource, Definition, Rotation, SurfaceMethod, Threshold, Tone};
use drum_vision::parameters::parameters;
use drum_vision::{Context, RegionSidecar, VisionConfig, VisionError, measure_frame};

use crate::scenes;

fn values(config: &VisionConfig) -> [f64; 4] {
    let case = scenes::clean(7, (484, 324));
    measure_frame(&case.frame, config, Context::default()).unwrap().four().map(|m| m.value)
}

#[test]
fn unknown_keys_are_refused_with_their_line() {
    let e = VisionConfig::from_toml("[bed]\nhub = 0.1\nmedain_px = 3\n").unwrap_err();
    let text = e.to_string();
    assert!(text.contains("medain_px") && text.contains("line 3"), "{text}");
    let e = VisionConfig::from_toml("[measure]\nscale = 3.0\n").unwrap_err();
    assert!(e.to_string().contains("measure.scale is not valid: 3"), "{e}");
}

#[test]
fn a_configuration_survives_its_own_text() {
    let mut config = VisionConfig::thesis();
    config.drum.source = CircleSource::Circle { x_px: 10.5, y_px: 20.0, radius_px: 90.0 };
    config.rig.speed_rpm = Some(12.0);
    let text = toml::to_string(&config).unwrap();
    assert_eq!(VisionConfig::from_toml(&text).unwrap(), config);
    assert_eq!(VisionConfig::from_toml("").unwrap(), VisionConfig::default());
}

#[test]
fn every_declared_parameter_moves_what_it_says() {
    let base = values(&VisionConfig::default());
    for p in parameters() {
        let mut config = VisionConfig::default();
        let step = if p.path == "measure.scale" { 1.01 } else { 0.1 };
        assert!(config.measure.set(p.path, step), "{} has no field", p.path);
        assert_eq!(config.measure.get(p.path), Some(step));
        let moved = values(&config);
        let d: [f64; 4] = std::array::from_fn(|k| moved[k] - base[k]);
        let expected = match p.path {
            "measure.offset_x_pct" => [0.0, 0.0, 0.1, 0.0],
            "measure.offset_y_pct" => [0.0, 0.0, 0.0, 0.1],
            "measure.bias_lin_deg" => [0.1, 0.0, 0.0, 0.0],
            "measure.bias_mid_deg" => [0.0, 0.1, 0.0, 0.0],
            "measure.scale" => [0.0, 0.0, base[2] / 1.01 - base[2], base[3] / 1.01 - base[3]],
            "measure.threshold_bias" => {
                assert!(d.iter().any(|v| v.abs() > 1e-4), "no effect: {d:?}");
                continue;
            }
            other => panic!("{other} is declared but not tested"),
        };
        for k in 0..4 {
            // The circle is detected anew: rounding only.
            assert!((d[k] - expected[k]).abs() < 1e-9, "{}: {d:?}", p.path);
        }
    }
}

#[test]
fn every_way_of_reading_a_clean_frame_agrees() {
    let case = scenes::clean(7, (968, 648));
    let t = case.truth;
    let truth = [t.aor_lin_deg, t.aor_mid_deg, t.cen_x_pct, t.cen_y_pct];
    let mut ways: Vec<(&str, VisionConfig, f64)> = Vec::new();
    let mut add = |name, tolerance, change: &dyn Fn(&mut VisionConfig)| {
        let mut c = VisionConfig::default();
        change(&mut c);
        ways.push((name, c, tolerance));
    };
    add("otsu", 0.3, &|c| c.bed.threshold = Threshold::Otsu);
    add("fixed", 0.4, &|c| c.bed.threshold = Threshold::Fixed { level: 100.0 });
    add("bright", 0.2, &|c| c.bed.tone = Tone::Bright);
    add("outline", 0.8, &|c| c.drum.source = CircleSource::Outline);
    add("hand", 0.2, &|c| {
        c.drum.source = CircleSource::Circle {
            x_px: t.center_x_px,
            y_px: t.center_y_px,
            radius_px: t.radius_px,
        };
    });
    // Whole pixels and a majority filter: half a pixel of 224.
    add("columns", 0.6, &|c| c.surface.method = SurfaceMethod::Columns);
    for (name, config, tolerance) in ways {
        let m = measure_frame(&case.frame, &config, Context::default());
        let four = m.unwrap_or_else(|e| panic!("{name}: {e}")).four();
        for k in 0..4 {
            let d = (four[k].value - truth[k]).abs();
            assert!(d < tolerance, "{name}: response {k} off by {d:.3}");
        }
    }
}

#[test]
fn the_given_rotation_decides_the_sign() {
    let case = scenes::clean(7, (484, 324));
    let mut config = VisionConfig::default();
    let auto = measure_frame(&case.frame, &config, Context::default()).unwrap();
    assert!(auto.responses.aor_lin_deg > 0.0);
    config.response.rotation = match auto.raised {
        drum_vision::surface::RaisedSide::Left => Rotation::CounterClockwise,
        drum_vision::surface::RaisedSide::Right => Rotation::Clockwise,
    };
    let turned = measure_frame(&case.frame, &config, Context::default()).unwrap();
    assert!((turned.responses.aor_lin_deg + auto.responses.aor_lin_deg).abs() < 1e-12);
    assert!((turned.responses.cen_x_pct + auto.responses.cen_x_pct).abs() < 1e-12);
}

#[test]
fn the_edem_definition_reads_lower_on_an_s_shaped_bed() {
    // A bed whose shoulder lies above the axis has wall columns.
    let bed =
        drum_film::Bed { fill: 0.45, aor_lin_deg: 35.0, s_shape_deg: 3.0, ..Default::default() };
    let film = drum_film::Film {
        camera: drum_film::Camera::default().with_size(484, 324),
        ..Default::default()
    };
    let frame = scenes::to_frame(film.bed_frame(&bed, 1).unwrap().image);
    let mut config = VisionConfig::default();
    let a = measure_frame(&frame, &config, Context::default()).unwrap().responses;
    config.response.definition = Definition::Edem;
    let b = measure_frame(&frame, &config, Context::default()).unwrap().responses;
    // The two scripts of the thesis differ by 0.1 to 1.8 deg on one bed.
    let d = a.aor_lin_deg - b.aor_lin_deg;
    assert!(d > 0.1 && d < 4.0, "{d}");
    assert!((a.cen_x_pct - b.cen_x_pct).abs() < 1e-12);
}

#[test]
fn a_side_car_is_read_from_toml_and_json_and_checked() {
    let toml = "polygon_px = [[1.0, 2.0], [3.0, 4.0], [5.0, 0.0]]\nwindow = [10, 200]\n";
    let json = r#"{"polygon_px": [[1, 2], [3, 4], [5, 0]], "window": [10, 200]}"#;
    assert_eq!(RegionSidecar::from_text(toml).unwrap(), RegionSidecar::from_text(json).unwrap());
    let bad = |text| RegionSidecar::from_text(text).unwrap_err().to_string();
    assert!(bad("polygon_px = [[1.0, 2.0]]\nwindow = [1, 2]").contains("1 corners"));
    assert!(
        bad("polygon_px = [[1.0, 2.0], [3.0, 4.0], [5.0, 0.0]]\nwindow = [9, 2]")
            .contains("[9, 2]")
    );
    assert!(bad("polygon = []").contains("polygon"));
    assert!(matches!(RegionSidecar::from_text("{"), Err(VisionError::Parse { .. })));
}

#[test]
fn silhouettes_are_measured_with_the_circle_of_a_reference_picture() {
    use drum_film::{Bed, Camera, Drum, Film};
    let mut film = Film::silhouette(Drum::default(), [0.2, 0.2, 0.6], [1.0; 3]);
    film.camera = Camera::default().with_size(484, 324);
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("reference_circle.png");
    let reference = film.studio().unwrap().reference_circle().unwrap();
    drum_vision::overlay::write_png(&scenes::to_frame(reference), &path).unwrap();
    let bed = Bed { fill: 0.4, aor_lin_deg: 28.0, s_shape_deg: 2.0, ..Bed::default() };
    let made = film.bed_frame(&bed, 0).unwrap();
    let mut config = VisionConfig::default();
    config.drum.source = CircleSource::Reference { path };
    config.bed.hub = 0.0;
    let drum = drum_vision::series::reference_drum(&config).unwrap().unwrap();
    let context = Context { reference: Some(&drum), region: None };
    let m = measure_frame(&scenes::to_frame(made.image), &config, context).unwrap();
    assert!(!m.bright_bed);
    let t = made.truth;
    for (found, drawn) in
        m.four().iter().zip([t.aor_lin_deg, t.aor_mid_deg, t.cen_x_pct, t.cen_y_pct])
    {
        // Flat colours, edges one pixel wide.
        assert!((found.value - drawn).abs() < 0.15, "{found:?} against {drawn}");
    }
}

#[test]
fn the_books_file_holds_every_setting_at_its_default() {
    let book =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/files/measure.toml");
    let Ok(text) = std::fs::read_to_string(book) else {
        println!("skipped: the crate stands outside its repository, docs/ is absent");
        return;
    };
    assert_eq!(VisionConfig::from_toml(&text).unwrap(), VisionConfig::default());
    // Those without a default too: they have a line that is commented out.
    let mut all = VisionConfig::thesis();
    all.drum.radius_range_px = Some([1.0, 2.0]);
    all.drum.red.median_px = Some(3);
    all.rig.speed_rpm = Some(1.0);
    all.rig.drum_radius_m = Some(1.0);
    all.rig.particle_diameter_m = Some(1.0);
    let every = toml::to_string(&all).unwrap();
    let key = |line: &str| {
        let (name, _) = line.trim_start_matches("# ").split_once(" = ")?;
        Some(name.to_owned())
    };
    let told: Vec<String> = text.lines().filter_map(key).collect();
    for name in every.lines().filter_map(key).filter(|k| k != "level") {
        assert!(told.contains(&name), "{name}");
    }
    assert!(told.len() > 30, "{told:?}");
}
