//! Awkward input: empty, not finite, all equal, huge, tiny, single.

use calib_report::Picture;
use calib_report::contour::Grid;
use calib_report::pictures::*;

use crate::document::checked;

/// Every picture filled with values drawn in turn from a list.
fn pictures(values: &[f64]) -> Vec<(&'static str, Box<dyn Picture>)> {
    let at = |i: usize| values[i % values.len()];
    let n = values.len();
    let some = |i: usize| Some(at(i));
    let point =
        |i: usize| ChartPoint { x: at(i), y: at(i + 1), interval: Some((at(i + 2), at(i + 3))) };
    let chart = |spacing| LineChart {
        title: "chart".into(),
        x: ChartAxis { spacing, ..ChartAxis::new("x") },
        y: ChartAxis { spacing, range: Some((at(0), at(1))), ..ChartAxis::new("y") },
        series: [
            SeriesStyle::Line,
            SeriesStyle::Points,
            SeriesStyle::LineAndPoints,
            SeriesStyle::Steps,
        ]
        .map(|style| ChartSeries { name: "s".into(), style, points: (0..n).map(point).collect() })
        .into(),
        horizontal_limits: vec![(at(0), "limit".into())],
        vertical_limits: vec![(at(1), "limit".into())],
    };
    let grid = |shift: usize| Grid {
        nx: 3,
        ny: 3,
        x_range: (0.4, 0.8),
        y_range: (0.1, 0.9),
        values: (0..9).map(|i| at(i + shift)).collect(),
    };
    let map = CalibrationMap {
        title: "map".into(),
        responses: (0..3)
            .map(|i| MappedResponse {
                name: format!("response {i}"),
                field: grid(i),
                measured: some(i),
                sd: at(i + 1),
                ..Default::default()
            })
            .collect(),
        estimate: Some((at(0), some(1), some(2))),
        printed: Some((at(1), at(2))),
        ..Default::default()
    };
    vec![
        ("map", Box::new(map)),
        (
            "fit summary",
            Box::new(FitSummary {
                rows: (0..n)
                    .map(|i| FitQuality {
                        r2: some(i),
                        q2: some(i + 1),
                        validity: some(i + 2),
                        ..Default::default()
                    })
                    .collect(),
                ..Default::default()
            }),
        ),
        (
            "coefficients",
            Box::new(CoefficientPlot {
                coefficients: (0..n)
                    .map(|i| Coefficient {
                        term: "t".into(),
                        value: at(i),
                        interval: Some((at(i + 1), at(i + 2))),
                    })
                    .collect(),
                ..Default::default()
            }),
        ),
        (
            "replicates",
            Box::new(ReplicatePlot {
                points: (0..n)
                    .map(|i| ReplicatePoint { run: i.to_string(), setting: i / 2, value: at(i) })
                    .collect(),
                ..Default::default()
            }),
        ),
        (
            "histogram",
            Box::new(ResponseHistogram {
                values: values.to_vec(),
                skewness: some(0),
                skewness_se: some(1),
                ..Default::default()
            }),
        ),
        (
            "normal probability",
            Box::new(NormalProbability {
                residuals: (0..n)
                    .map(|i| StudentisedResidual { run: i.to_string(), residual: at(i) })
                    .collect(),
                limit: some(0),
                ..Default::default()
            }),
        ),
        (
            "observed",
            Box::new(ObservedPredicted {
                points: (0..n)
                    .map(|i| ObservedPrediction {
                        run: i.to_string(),
                        observed: at(i),
                        predicted: at(i + 1),
                    })
                    .collect(),
                ..Default::default()
            }),
        ),
        (
            "effect",
            Box::new(EffectPlot {
                points: (0..n)
                    .map(|i| EffectPoint {
                        factor: at(i),
                        response: at(i + 1),
                        interval: Some((at(i + 2), at(i))),
                    })
                    .collect(),
                response_range: Some((at(0), at(1))),
                ..Default::default()
            }),
        ),
        (
            "interaction",
            Box::new(InteractionPlot {
                lines: vec![InteractionLine {
                    level: "one".into(),
                    points: (0..n).map(|i| (at(i), at(i + 1))).collect(),
                }],
                ..Default::default()
            }),
        ),
        (
            "friction",
            Box::new(FrictionSpeed {
                estimates: (0..n)
                    .map(|i| FrictionAtSpeed {
                        omega_rpm: at(i),
                        value: some(i + 1),
                        lo: some(i + 2),
                        hi: None,
                    })
                    .collect(),
                joint: Some(FrictionAtSpeed { value: some(0), lo: some(1), ..Default::default() }),
                printed: vec![PrintedRange { omega_rpm: at(0), lo: at(1), hi: at(2) }],
                range: Some((at(0), at(1))),
                ..Default::default()
            }),
        ),
        (
            "residuals",
            Box::new(ResidualSpeed {
                responses: vec![ResponseResiduals {
                    response: "r".into(),
                    points: (0..n)
                        .map(|i| ResidualAtSpeed {
                            omega_rpm: at(i),
                            residual_sd: at(i + 1),
                            outlier: true,
                        })
                        .collect(),
                }],
                limit: some(0),
                ..Default::default()
            }),
        ),
        (
            "profile",
            Box::new(ProfileLikelihood {
                points: (0..n).map(|i| (at(i), at(i + 1))).collect(),
                best: some(0),
                threshold: at(1),
                interval: (some(0), None),
                ..Default::default()
            }),
        ),
        (
            "posterior",
            Box::new(PosteriorDensity {
                points: (0..n).map(|i| (at(i), at(i + 1))).collect(),
                prior: (0..n).map(|i| (at(i), at(i))).collect(),
                centre: some(0),
                interval: Some((at(0), at(1))),
                ..Default::default()
            }),
        ),
        ("chart", Box::new(chart(AxisSpacing::Linear))),
        ("logarithmic chart", Box::new(chart(AxisSpacing::Logarithmic))),
        (
            "bars",
            Box::new(GroupedBars {
                groups: (0..n)
                    .map(|i| BarGroup { name: i.to_string(), values: vec![some(i), None] })
                    .collect(),
                decimals: Some(2),
                limit: Some((at(0), "limit".into())),
                ..Default::default()
            }),
        ),
        (
            "heat map",
            Box::new(HeatMap {
                rows: vec!["a".into(), "b".into()],
                columns: (0..n).map(|i| i.to_string()).collect(),
                values: (0..2 * n).map(at).collect(),
                ..Default::default()
            }),
        ),
    ]
}

#[test]
fn no_number_makes_a_picture_panic_or_write_nonsense() {
    let lists: &[&[f64]] = &[
        &[f64::NAN],
        &[f64::INFINITY, f64::NEG_INFINITY],
        &[1.0],
        &[0.0],
        &[-3.0, -3.0, -3.0],
        &[1e300, -1e300, 1e-300],
        &[1e99, -1e99],
        &[1e-99, 2e-99, 3e-99],
        &[f64::MIN_POSITIVE, f64::MAX, 0.0],
        &[1e17, 1e17 + 16.0, 1e17 + 32.0],
        &[0.3, f64::NAN, 0.5, f64::INFINITY, 0.1],
        &[5.0, 4.0, 3.0, 2.0, 1.0, -1.0],
    ];
    for values in lists {
        for (name, picture) in pictures(values) {
            let svg = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| picture.svg()))
                .unwrap_or_else(|_| panic!("{name} panicked on {values:?}"));
            checked(&svg);
        }
    }
}

#[test]
fn nothing_finite_is_said_to_be_no_data() {
    for (name, picture) in pictures(&[f64::NAN]) {
        if name != "fit summary" {
            assert!(picture.svg().contains(">no data<"), "{name}");
        }
    }
}

#[test]
fn empty_pictures_are_said_to_be_no_data() {
    let empty: Vec<Box<dyn Picture>> = vec![
        Box::new(CalibrationMap::default()),
        Box::new(FitSummary::default()),
        Box::new(CoefficientPlot::default()),
        Box::new(ReplicatePlot::default()),
        Box::new(ResponseHistogram::default()),
        Box::new(NormalProbability::default()),
        Box::new(ObservedPredicted::default()),
        Box::new(EffectPlot::default()),
        Box::new(InteractionPlot::default()),
        Box::new(FrictionSpeed::default()),
        Box::new(ResidualSpeed::default()),
        Box::new(ProfileLikelihood::default()),
        Box::new(PosteriorDensity::default()),
        Box::new(LineChart::default()),
        Box::new(GroupedBars::default()),
        Box::new(HeatMap::default()),
    ];
    for picture in empty {
        let svg = picture.svg();
        checked(&svg);
        assert!(svg.contains(">no data<"), "{svg}");
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let draw = || -> Vec<String> {
        pictures(&[5.0, 4.0, 3.0, 2.0]).iter().map(|(_, p)| p.svg()).collect()
    };
    assert_eq!(draw(), draw());
}

#[test]
fn marks_of_xml_in_names_are_escaped() {
    let svg = FitSummary {
        title: "<a & \"b\"> \u{1}".into(),
        rows: vec![FitQuality { response: "]]> & <".into(), r2: Some(0.5), ..Default::default() }],
    }
    .svg();
    checked(&svg);
}

#[test]
fn maps_of_different_grids_are_refused_not_misdrawn() {
    let response = |n| MappedResponse {
        name: "r".into(),
        field: Grid::sample(n, n, (0.0, 1.0), (0.0, 1.0), |x, _| x),
        measured: Some(0.5),
        sd: 0.1,
        ..Default::default()
    };
    let map = CalibrationMap { responses: vec![response(4), response(5)], ..Default::default() };
    assert!(map.svg().contains("grids differ"));
    assert!(map.overlaps().is_empty());
    assert_eq!(map.closer(), None);
}
