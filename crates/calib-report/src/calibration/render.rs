//! The order of the report and the words around its numbers.

use super::{CalibrationReport, FrictionRow, GoodnessRow, ResponseDiagnostics};
use crate::number::{fixed, fixed_or_dash, probability};
use crate::page::{Block, Column, Figure, Page, Row, Section, Table, Tone};

impl CalibrationReport {
    /// The report as a page, to which the caller may still add sections.
    pub fn page(&self) -> Page {
        let sections = [
            self.friction_section(),
            self.goodness_section(),
            self.map_section(),
            self.speed_section(),
            self.uncertainty_section(),
            self.fit_section(),
        ];
        let diagnostics = self.responses.iter().map(response_section);
        Page {
            title: format!("Calibration of {}", self.case),
            subtitle: self.subtitle.clone(),
            verdict: self.verdict.clone(),
            sections: sections
                .into_iter()
                .chain(diagnostics)
                .chain(self.extra.iter().cloned())
                .chain([self.assumption_section()])
                .collect(),
            provenance: self.provenance.clone(),
        }
    }

    /// The report as one self-contained HTML document.
    pub fn html(&self) -> String {
        self.page().html()
    }

    fn interval_heading(&self) -> String {
        format!("{} interval", self.interval_level).trim().to_string()
    }

    fn friction_section(&self) -> Section {
        let mut section = Section::new("Friction");
        let blocks = &mut section.blocks;
        blocks.extend(self.warnings.iter().map(|w| Block::Note(Tone::Caution, w.clone())));
        if !self.friction.is_empty() {
            blocks.push(Block::Table(self.friction_table()));
        }
        if let Some(wall) = &self.wall {
            let value = wall.value.map(|v| fixed(v, 3));
            let text = match (wall.identified, value) {
                (true, Some(value)) => format!(
                    "Wall friction μ_{{wall}} is {value} ({}). {}",
                    interval(wall.lo, wall.hi),
                    wall.reason
                ),
                (true, None) => format!("Wall friction: {}", wall.reason),
                (false, value) => format!(
                    "Wall friction μ_{{wall}} is not determined by these data{}. {}",
                    value
                        .map(|v| format!(
                            " (best value {v}, {}: it says little)",
                            interval(wall.lo, wall.hi)
                        ))
                        .unwrap_or_default(),
                    wall.reason
                ),
            };
            let tone = if wall.identified { Tone::Neutral } else { Tone::Caution };
            blocks.push(Block::Note(tone, text.trim().to_string()));
        }
        if !self.facts.is_empty() {
            blocks.push(Block::Table(Table {
                caption: "The case".into(),
                columns: vec![Column::text(""), Column::text("")],
                rows: self
                    .facts
                    .iter()
                    .map(|(name, value)| Row::new(vec![name.clone(), value.clone()]))
                    .collect(),
            }));
        }
        section
    }

    fn friction_table(&self) -> Table {
        let rows = self
            .friction
            .iter()
            .map(|f| Row {
                cells: vec![
                    f.omega_rpm.map_or_else(|| "all".into(), speed),
                    f.method.clone(),
                    fixed_or_dash(f.mu_pp, 3),
                    interval_of(f),
                    f.printed
                        .map(|(lo, hi)| format!("{} to {}", fixed(lo, 2), fixed(hi, 2)))
                        .unwrap_or_default(),
                    f.chi2.map(|c| fixed(c, 1)).unwrap_or_default(),
                    f.dof.map(|d| d.to_string()).unwrap_or_default(),
                    f.note.clone(),
                ],
                strong: f.omega_rpm.is_none() && f.method.is_empty(),
                flagged: false,
            })
            .collect();
        Table {
            caption: "Particle friction μ_{pp}".into(),
            columns: vec![
                Column::number("speed", "rpm"),
                Column::text("matched"),
                Column::number("μ_{pp}", ""),
                Column::number(self.interval_heading(), ""),
                Column::number("printed range", ""),
                Column::number("χ^{2}", ""),
                Column::number("dof", ""),
                Column::text("remark"),
            ],
            rows,
        }
    }

    fn goodness_section(&self) -> Section {
        let mut section = Section::new("Goodness of fit");
        if !self.goodness.is_empty() {
            section.blocks.push(Block::Paragraph(
                "χ^{2} of the joint fit under each reading of the measured standard deviations. A \
                 small probability p says that friction alone does not explain the measurements."
                    .into(),
            ));
            section.blocks.push(Block::Table(Table {
                caption: String::new(),
                columns: vec![
                    Column::text("errors"),
                    Column::number("χ^{2}", ""),
                    Column::number("dof", ""),
                    Column::number("p (χ^{2})", ""),
                    Column::number("p (bootstrap)", ""),
                    Column::number("μ_{pp}", ""),
                    Column::text("reading"),
                ],
                rows: self.goodness.iter().map(goodness_row).collect(),
            }));
        }
        section
    }

    fn map_section(&self) -> Section {
        let mut section = Section::new("Contours with measured bands");
        if !self.maps.is_empty() {
            section.blocks.push(Block::Paragraph(
                "Each colour is one response: thin lines are contours of its surrogate, the \
                 translucent band is where it lies within one standard deviation of the \
                 measurement, the thick line is the measured mean. The strongly outlined region is \
                 where the largest number of bands overlap: there the simulation agrees with the \
                 measurement in all of these responses at once."
                    .into(),
            ));
            let figures = self.maps.iter().map(|m| Figure::new(m, "")).collect();
            section.blocks.push(Block::Figures(figures));
            let closer: Vec<Figure> =
                self.maps.iter().filter_map(|m| m.closer()).map(|m| Figure::new(&m, "")).collect();
            if !closer.is_empty() {
                section.blocks.push(Block::Heading("The bands closer".into()));
                section.blocks.push(Block::Figures(closer));
            }
        }
        section
    }

    fn speed_section(&self) -> Section {
        let mut section = Section::new("Against speed");
        let mut figures = Vec::new();
        if let Some(picture) = &self.friction_speed {
            figures.push(Figure::new(
                picture,
                "Friction should not depend on speed: a trend says that the model lacks something.",
            ));
        }
        if let Some(picture) = &self.residual_speed {
            figures.push(Figure::new(
                picture,
                "Residuals without structure scatter about zero; a run of one sign is a misfit.",
            ));
        }
        if !figures.is_empty() {
            section.blocks.push(Block::Figures(figures));
        }
        if !self.outliers.is_empty() {
            section.blocks.push(Block::Table(self.outlier_table()));
        }
        if !self.residuals.is_empty() {
            let table = Block::Table(self.residual_table());
            let summary = format!("All {} residuals as a table", self.residuals.len());
            section.blocks.push(Block::Folded(summary, vec![table]));
        }
        section
    }

    fn outlier_table(&self) -> Table {
        Table {
            caption: "Doubtful cells of the data".into(),
            columns: vec![
                Column::text("where"),
                Column::text("response"),
                Column::number("given", ""),
                Column::number("expected", ""),
                Column::number("distance", "sd"),
                Column::text("remark"),
            ],
            rows: self
                .outliers
                .iter()
                .map(|o| Row {
                    cells: vec![
                        o.place.clone(),
                        o.response.clone(),
                        o.value.map(|v| fixed(v, 2)).unwrap_or_default(),
                        o.expected.map(|v| fixed(v, 2)).unwrap_or_default(),
                        o.distance_sd.map(|v| fixed(v, 1)).unwrap_or_default(),
                        o.note.clone(),
                    ],
                    flagged: true,
                    strong: false,
                })
                .collect(),
        }
    }

    fn residual_table(&self) -> Table {
        Table {
            caption: String::new(),
            columns: vec![
                Column::number("speed", "rpm"),
                Column::text("response"),
                Column::number("measured", ""),
                Column::number("model", ""),
                Column::number("sd", ""),
                Column::text("unit"),
                Column::number("residual", "sd"),
            ],
            rows: self
                .residuals
                .iter()
                .map(|r| Row {
                    cells: vec![
                        speed(r.omega_rpm),
                        r.response.clone(),
                        fixed(r.measured, 2),
                        fixed(r.model, 2),
                        fixed(r.sd, 2),
                        r.unit.clone(),
                        fixed((r.measured - r.model) / r.sd, 2),
                    ],
                    flagged: r.outlier,
                    strong: false,
                })
                .collect(),
        }
    }

    fn uncertainty_section(&self) -> Section {
        let mut section = Section::new("Uncertainty of the parameters");
        let profiles = self.profiles.iter().map(|p| {
            Figure::new(p, "Rise of χ^{2} when the parameter is held and all others are refitted.")
        });
        let posteriors = self.posteriors.iter().map(|p| Figure::new(p, ""));
        let figures: Vec<Figure> = profiles.chain(posteriors).collect();
        if !figures.is_empty() {
            section.blocks.push(Block::Figures(figures));
        }
        if !self.parameters.is_empty() {
            section.blocks.push(Block::Table(Table {
                caption: "Free parameters and nuisances".into(),
                columns: vec![
                    Column::text("parameter"),
                    Column::text("unit"),
                    Column::text("prior"),
                    Column::number("value", ""),
                    Column::number(self.interval_heading(), ""),
                    Column::text("remark"),
                ],
                rows: self
                    .parameters
                    .iter()
                    .map(|p| {
                        Row::new(vec![
                            p.name.clone(),
                            p.unit.clone(),
                            p.prior.clone(),
                            fixed_or_dash(p.value, 3),
                            interval(p.lo, p.hi),
                            p.note.clone(),
                        ])
                    })
                    .collect(),
            }));
        }
        section.blocks.extend(self.sensitivity.iter().cloned().map(Block::Table));
        section
    }

    fn fit_section(&self) -> Section {
        let mut section = Section::new("Summary of fit of the surrogates");
        if let Some(picture) = &self.fit_summary {
            let caption = "R^{2}: variation explained; Q^{2}: variation predicted; validity: above \
                           0.25 there is no lack of fit at the 5 % level; reproducibility: scatter \
                           of replicates against that of all runs. A number in red is below its \
                           guide.";
            section.blocks.push(Block::Figures(vec![Figure::new(picture, caption)]));
        }
        section
    }

    fn assumption_section(&self) -> Section {
        let mut section = Section::new("Assumptions");
        if !self.assumptions.is_empty() {
            section.blocks.push(Block::List(self.assumptions.clone()));
        }
        section
    }
}

fn response_section(response: &ResponseDiagnostics) -> Section {
    let mut section = Section::new(format!("Diagnostics: {}", response.response));
    if !response.summary.is_empty() {
        section.blocks.push(Block::Paragraph(response.summary.clone()));
    }
    let mut figures = Vec::new();
    if let Some(p) = &response.coefficients {
        figures.push(Figure::new(p, "Coefficients, scaled and centred."));
    }
    if let Some(p) = &response.replicates {
        figures.push(Figure::new(p, "Replicates should scatter less than the runs do."));
    }
    if let Some(p) = &response.histogram {
        figures.push(Figure::new(p, "A skew response may need a transform."));
    }
    if let Some(p) = &response.normal {
        figures.push(Figure::new(
            p,
            "Normal residuals lie on the line; beyond the limits is suspect.",
        ));
    }
    if let Some(p) = &response.observed {
        figures.push(Figure::new(p, "The three runs farthest from the line are named."));
    }
    figures.extend(response.effects.iter().map(|p| Figure::new(p, "")));
    figures.extend(
        response.interactions.iter().map(|p| Figure::new(p, "Parallel lines: no interaction.")),
    );
    if !figures.is_empty() {
        section.blocks.push(Block::Figures(figures));
    }
    section.blocks.extend(response.tables.iter().cloned().map(Block::Table));
    section
}

fn goodness_row(row: &GoodnessRow) -> Row {
    let friction =
        row.mu_pp.map(|(value, lo, hi)| format!("{} ({})", fixed(value, 3), interval(lo, hi)));
    Row::new(vec![
        row.errors.clone(),
        row.chi2.map(|c| fixed(c, 1)).unwrap_or_default(),
        row.dof.map(|d| d.to_string()).unwrap_or_default(),
        row.p_chi2.map(probability).unwrap_or_default(),
        row.p_bootstrap.map(probability).unwrap_or_default(),
        friction.unwrap_or_default(),
        row.reading.clone(),
    ])
}

fn interval_of(row: &FrictionRow) -> String {
    if row.mu_pp.is_none() && row.lo.is_none() && row.hi.is_none() {
        "–".into()
    } else {
        interval(row.lo, row.hi)
    }
}

fn interval(lo: Option<f64>, hi: Option<f64>) -> String {
    match (lo, hi) {
        (Some(lo), Some(hi)) => format!("{} to {}", fixed(lo, 3), fixed(hi, 3)),
        (Some(lo), None) => format!("≥ {}", fixed(lo, 3)),
        (None, Some(hi)) => format!("≤ {}", fixed(hi, 3)),
        (None, None) => "unbounded".into(),
    }
}

fn speed(omega_rpm: f64) -> String {
    fixed(omega_rpm, if omega_rpm.fract() == 0.0 { 0 } else { 1 })
}
