//! Pages: self-contained, well formed, and silent about what is absent.

use calib_report::calibration::{
    CalibrationReport, FrictionRow, GoodnessRow, ResidualRow, ResponseDiagnostics, WallFriction,
};
use calib_report::page::{
    Block, Column, Figure, InputFile, Page, Provenance, Row, Section, Table, Tone, Verdict,
};
use calib_report::pictures::{FitQuality, FitSummary, FrictionSpeed};

/// The body parsed as XML: it holds no void elements, so that both readings agree.
fn body(html: &str) -> &str {
    let start = html.find("<body>").expect("a body");
    let end = html.rfind("</body>").expect("its end") + "</body>".len();
    let body = &html[start..end];
    roxmltree::Document::parse(body).unwrap_or_else(|e| panic!("{e}\n{body}"));
    body
}

fn full() -> CalibrationReport {
    CalibrationReport {
        case: "AZ4_Steel".into(),
        verdict: Some(Verdict { sentence: "a < b & c".into(), tone: Tone::Bad }),
        warnings: vec!["50 rpm left out".into()],
        friction: vec![
            FrictionRow {
                omega_rpm: Some(4.0),
                mu_pp: Some(0.2649),
                lo: Some(0.25),
                printed: Some((0.25, 0.3)),
                ..Default::default()
            },
            FrictionRow {
                mu_pp: Some(0.284),
                lo: Some(0.28),
                hi: Some(0.29),
                ..Default::default()
            },
        ],
        interval_level: "95 %".into(),
        wall: Some(WallFriction { reason: "It is flat.".into(), ..Default::default() }),
        goodness: vec![GoodnessRow {
            errors: "frame sd".into(),
            chi2: Some(12.5),
            dof: Some(11),
            p_chi2: Some(1e-9),
            ..Default::default()
        }],
        friction_speed: Some(FrictionSpeed::default()),
        residuals: vec![ResidualRow {
            omega_rpm: 4.0,
            response: "AoR".into(),
            measured: 30.0,
            model: 29.0,
            sd: 0.5,
            outlier: true,
            ..Default::default()
        }],
        fit_summary: Some(FitSummary {
            title: "Fit".into(),
            rows: vec![FitQuality { response: "AoR".into(), ..Default::default() }],
        }),
        responses: vec![ResponseDiagnostics {
            response: "AoR".into(),
            summary: "Ten terms.".into(),
            ..Default::default()
        }],
        assumptions: vec!["Independent.".into()],
        provenance: Some(Provenance {
            inputs: vec![InputFile { name: "a.csv".into(), hash: "blake3 12ab".into() }],
            seed: Some(7),
            version: "tumble 0.1.0".into(),
            command: "tumble calibrate AZ4_Steel".into(),
            ..Default::default()
        }),
        ..Default::default()
    }
}

#[test]
fn the_page_of_an_empty_report_is_well_formed_and_empty() {
    let html = CalibrationReport { case: "X".into(), ..Default::default() }.html();
    let body = body(&html);
    assert!(!body.contains("<h2") && !body.contains("<table") && !body.contains("<svg"));
}

#[test]
fn the_page_needs_nothing_from_elsewhere() {
    let html = full().html();
    body(&html);
    for word in ["http:", "https:", "<script", "<link", "@import", "url(", "src="] {
        let found = html.replace("http://www.w3.org/2000/svg", "").contains(word);
        assert!(!found, "{word}");
    }
    for word in ["prefers-color-scheme: dark", "@media print", "break-inside: avoid", "viewport"] {
        assert!(html.contains(word), "{word}");
    }
}

#[test]
fn the_order_is_result_first_and_provenance_last() {
    let html = full().html();
    let body = body(&html);
    let places: Vec<usize> = [
        "a &lt; b &amp; c",
        "Particle friction",
        "Goodness of fit</h2>",
        "Against speed</h2>",
        "Summary of fit of the surrogates</h2>",
        "Diagnostics: AoR</h2>",
        "Assumptions</h2>",
        "Where the numbers come from",
    ]
    .iter()
    .map(|word| body.find(word).unwrap_or_else(|| panic!("{word} is missing")))
    .collect();
    assert!(places.is_sorted(), "{places:?}");
}

#[test]
fn every_number_given_is_on_the_page() {
    let html = full().html();
    for text in [
        "0.265",
        "≥ 0.250",
        "0.25 to 0.30",
        "0.280 to 0.290",
        "12.5",
        "&lt; 0.001",
        "30.00",
        "2.00",
        "blake3 12ab",
        ">7<",
        "tumble 0.1.0",
        "tumble calibrate AZ4_Steel",
        "50 rpm left out",
        "not determined by these data",
    ] {
        assert!(html.contains(text), "{text}");
    }
    assert!(html.contains("class=\"flagged\"") && html.contains("class=\"strong\""));
}

#[test]
fn columns_without_content_are_left_out() {
    let html = full().html();
    assert!(!html.contains("bootstrap"), "no bootstrap was given");
    assert!(!html.contains(">remark<"));
}

#[test]
fn ragged_rows_do_not_break_a_table() {
    let table = Table {
        caption: "t".into(),
        columns: vec![Column::text("a"), Column::number("b", "mm")],
        rows: vec![
            Row::new(vec!["1".into()]),
            Row::new(vec!["1".into(), "2".into(), "3".into()]),
            Row::default(),
        ],
    };
    let page = Page::new("t").with(Section::new("s").with(Block::Table(table)));
    let html = page.html();
    let body = body(&html);
    assert_eq!(body.matches("<td").count(), 6);
    assert!(body.contains("[mm]"));
}

#[test]
fn every_block_is_well_formed() {
    let figure = Figure::new(&FitSummary::default(), "caption R^{2}");
    let section = Section::new("μ_{pp} & <more>")
        .with(Block::Paragraph("p".into()))
        .with(Block::Note(Tone::Good, "n".into()))
        .with(Block::List(vec!["i".into()]))
        .with(Block::Heading("h".into()))
        .with(Block::Figures(vec![figure.clone()]))
        .with(Block::Folded("more".into(), vec![Block::Figures(vec![figure])]));
    let html = Page::new("t <&>").with(section).html();
    let body = body(&html);
    assert!(body.contains("μ<sub>pp</sub> &amp; &lt;more&gt;"));
    assert!(body.contains("R<sup>2</sup>"));
    assert_eq!(body.matches("<svg").count(), 2);
}
