//! Text stays within the picture and labels do not cover each other.

use calib_report::Picture;
use calib_report::contour::Grid;
use calib_report::pictures::*;
use roxmltree::Document;

use crate::document::{all, checked, number, text};

/// Mean advance of English text in DejaVu Sans, the widest of the common faces, em: 0.51 to 0.537
/// were measured on the names below.
const ADVANCE: f64 = 0.54;

/// The box of an upright text: left, top, right, bottom.
fn boxes(document: &Document<'_>, halo_only: bool) -> Vec<(String, [f64; 4])> {
    all(document, "text")
        .filter(|t| t.attribute("transform").is_none())
        .filter(|t| !halo_only || t.attribute("paint-order").is_some())
        .map(|t| {
            let content = text(&t);
            let size = number(&t, "font-size");
            let width = ADVANCE * size * content.chars().count() as f64;
            let x = number(&t, "x");
            let left = match t.attribute("text-anchor") {
                Some("middle") => x - 0.5 * width,
                Some("end") => x - width,
                _ => x,
            };
            let y = number(&t, "y");
            (content, [left, y - 0.75 * size, left + width, y + 0.2 * size])
        })
        .collect()
}

fn assert_within(svg: &str) {
    let document = checked(svg);
    let root = document.root_element();
    let (width, height) = (number(&root, "width"), number(&root, "height"));
    for (content, [left, top, right, bottom]) in boxes(&document, false) {
        assert!(
            left >= 0.0 && right <= width && top >= 0.0 && bottom <= height,
            "'{content}' at {left:.0} {top:.0} {right:.0} {bottom:.0} in {width} x {height}"
        );
    }
}

fn long(text: &str) -> String {
    format!("{text} with a name that is much longer than anybody would wish it to be in print")
}

#[test]
fn long_names_are_wrapped_or_shortened() {
    let pictures: Vec<Box<dyn Picture>> = vec![
        Box::new(LineChart {
            title: long("A chart"),
            x: ChartAxis::new(long("abscissa")),
            y: ChartAxis::new(long("ordinate")),
            series: vec![ChartSeries {
                name: long("series"),
                points: vec![(0.9999, -123_456.0).into(), (1.0, 123_456.0).into()],
                ..Default::default()
            }],
            ..Default::default()
        }),
        Box::new(GroupedBars {
            title: long("Bars"),
            groups: (0..6)
                .map(|i| BarGroup {
                    name: long(&i.to_string()),
                    values: vec![Some(1.0), Some(2.0)],
                })
                .collect(),
            series: vec![long("one"), long("two")],
            ..Default::default()
        }),
        Box::new(FitSummary {
            title: long("Fit"),
            rows: vec![FitQuality {
                response: long("response"),
                r2: Some(0.9),
                ..Default::default()
            }],
        }),
        Box::new(CoefficientPlot {
            title: long("Coefficients"),
            response: long("response"),
            coefficients: vec![Coefficient { term: long("term"), value: 1.0, interval: None }],
            ..Default::default()
        }),
        Box::new(HeatMap {
            title: long("Confusion"),
            rows: vec![long("row"), long("row")],
            columns: vec![long("column")],
            values: vec![0.1, 0.2],
            row_label: "true".into(),
            column_label: long("named"),
            ..Default::default()
        }),
        Box::new(FrictionSpeed {
            title: long("Friction"),
            estimates: vec![FrictionAtSpeed {
                omega_rpm: 4.0,
                value: Some(0.3),
                ..Default::default()
            }],
            ..Default::default()
        }),
        Box::new(FrictionSpeed { title: long("No friction"), ..Default::default() }),
    ];
    for picture in pictures {
        assert_within(&picture.svg());
    }
}

#[test]
fn labels_of_a_map_do_not_cover_each_other() {
    let names = ["AoR line", "AoR mid", "centre x", "centre y"];
    for tilt in [0.0, 0.5, 2.0, 8.0] {
        let map = CalibrationMap {
            title: "map".into(),
            responses: names
                .iter()
                .enumerate()
                .map(|(i, name)| MappedResponse {
                    name: (*name).into(),
                    field: Grid::sample(41, 81, (0.4, 0.8), (0.1, 0.9), |w, p| {
                        20.0 + 20.0 * p - 9.0 * p * p + tilt * w + i as f64
                    }),
                    measured: Some(24.0 + i as f64),
                    sd: 1.2,
                    ..Default::default()
                })
                .collect(),
            ..Default::default()
        };
        let svg = map.svg();
        assert_within(&svg);
        let document = checked(&svg);
        let labels = boxes(&document, true);
        assert!(labels.len() > 10, "contours are labelled");
        for (i, (a, p)) in labels.iter().enumerate() {
            for (b, q) in &labels[i + 1..] {
                let apart = p[2] < q[0] || q[2] < p[0] || p[3] < q[1] || q[3] < p[1];
                assert!(apart, "'{a}' covers '{b}' at tilt {tilt}");
            }
        }
    }
}

#[test]
fn labels_of_outliers_do_not_cover_each_other() {
    // Three rpm apart there is room for every label, a tenth of it apart for some.
    for (step, at_least) in [(3.0, 12), (0.1, 2)] {
        let outlier = |i: i32| ResidualAtSpeed {
            omega_rpm: 4.0 + step * f64::from(i),
            residual_sd: 5.0,
            outlier: true,
        };
        let last = ResidualAtSpeed { omega_rpm: 50.0, ..Default::default() };
        let svg = ResidualSpeed {
            responses: vec![ResponseResiduals {
                response: "AoR line".into(),
                points: (0..12).map(outlier).chain([last]).collect(),
            }],
            ..Default::default()
        }
        .svg();
        let document = checked(&svg);
        let labels = boxes(&document, true);
        assert!(labels.len() >= at_least, "{} labels were set at step {step}", labels.len());
        for (i, (a, p)) in labels.iter().enumerate() {
            for (b, q) in &labels[i + 1..] {
                let apart = p[2] < q[0] || q[2] < p[0] || p[3] < q[1] || q[3] < p[1];
                assert!(apart, "'{a}' covers '{b}'");
            }
        }
    }
}

#[test]
fn an_open_interval_ends_in_an_arrow_and_a_closed_one_in_caps() {
    let draw = |hi| {
        FrictionSpeed {
            estimates: vec![FrictionAtSpeed {
                omega_rpm: 4.0,
                value: Some(0.5),
                lo: Some(0.4),
                hi,
            }],
            range: Some((0.1, 0.9)),
            ..Default::default()
        }
        .svg()
    };
    let arrows = |svg: &str| {
        let document = checked(svg);
        all(&document, "path").filter(|p| p.attribute("fill") == Some("none")).count()
    };
    assert_eq!(arrows(&draw(None)), 1);
    assert_eq!(arrows(&draw(Some(0.6))), 0);
}

#[test]
fn undefined_qualities_are_written_out() {
    let svg = FitSummary {
        title: "Fit".into(),
        rows: vec![FitQuality { response: "AoR".into(), r2: Some(0.99), ..Default::default() }],
    }
    .svg();
    assert_eq!(svg.matches(">undefined<").count(), 3, "Q2, validity, reproducibility");
    assert!(svg.contains(">0.990<"));
}
