//! The report of a closed loop.

use calib::attribution::Verdict as Found;
use calib_report::page::{
    Block, Column, Figure, InputFile, Page, Provenance, Row, Section, Table, Tone, Verdict,
};
use calib_report::pictures::{ChartAxis, ChartPoint, ChartSeries, LineChart, SeriesStyle};
use close_loop::{Errors, HALF_AS_MUCH, LoadOf, Outcome, Point, Side};
use rig_schema::{Case, Response};

use crate::cli::CloseLoopArgs;

/// What a report is made of.
pub(crate) struct Closed<'a> {
    pub(crate) outcome: &'a Outcome,
    pub(crate) case: &'a Case,
    pub(crate) inputs: Vec<InputFile>,
    pub(crate) args: &'a CloseLoopArgs,
}

/// Make the report.
pub(crate) fn page(c: &Closed<'_>) -> Page {
    let o = c.outcome;
    let tone = match o.verdict {
        "none" | "effect" => Tone::Good,
        "class" => Tone::Caution,
        _ => Tone::Bad,
    };
    Page {
        title: format!("What {} lacks", c.case.rig.name),
        subtitle: c.case.rig.title.clone(),
        verdict: Some(Verdict { sentence: o.sentence.clone(), tone }),
        sections: std::iter::once(errors(o))
            .chain(predictions(o))
            .chain([curves(o), candidates(o), apart(o), detectable(o), stability(o), assumed(o)])
            .collect(),
        provenance: Some(Provenance {
            inputs: c.inputs.clone(),
            seed: Some(c.args.seed),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: format!(
                "tumble close-loop {}--seed {}{}",
                c.args.case.as_ref().map_or_else(String::new, |c| format!("{c} ")),
                c.args.seed,
                c.args.runs.map_or_else(String::new, |r| format!(" --runs {r}")),
            ),
            settings: [
                ("runs".to_owned(), o.runs.to_string()),
                ("processor time of the runs".to_owned(), format!("{:.0} s", o.cost_s)),
            ]
            .into_iter()
            .chain(speeds(o))
            .collect(),
        }),
    }
}

/// What was simulated: at which speeds, with which load.
fn speeds(o: &Outcome) -> Vec<(String, String)> {
    let what = "speeds simulated, rpm";
    match &o.loads[..] {
        [] | [_] => vec![(what.to_owned(), list(&o.speeds_rpm))],
        all => {
            let row = |l: &LoadOf| (format!("{what}, with {}", amount(l)), list(&l.speeds_rpm));
            all.iter().map(row).collect()
        }
    }
}

/// How much a load is.
fn amount(load: &LoadOf) -> String {
    format!("{} = {}", load.fill.0, load.fill.1)
}

/// What tells a load from others, where there is more than one.
fn told_load(o: &Outcome, load: usize) -> Option<String> {
    o.loads.get(load).filter(|_| o.loads.len() > 1).map(amount)
}

fn list(values: &[f64]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// A number with as many digits as it deserves.
fn plus_minus(mean: f64, sd: f64) -> String {
    format!("{mean:.2} ± {sd:.2}")
}

fn short(v: f64) -> String {
    match v.abs() {
        a if a >= 1000.0 => format!("{v:.0}"),
        a if a >= 10.0 => format!("{v:.1}"),
        a if a >= 0.01 || a == 0.0 => format!("{v:.3}"),
        _ => format!("{v:.2e}"),
    }
}

fn unit(response: &str) -> &'static str {
    if response.ends_with("deg") { "deg" } else { "% R" }
}

fn model(side: &Side) -> String {
    side.at.iter().map(|(p, v)| format!("{p} = {}", short(*v))).collect::<Vec<_>>().join(", ")
}

fn errors(o: &Outcome) -> Section {
    let mut section = Section::new("Error before and after");
    let how = if o.runs == 0 {
        "Both models are those of the table of simulated responses."
    } else {
        "Both models are shown by fresh simulations at the fitted values, with fillings that no fit has seen."
    };
    section.blocks.push(Block::Paragraph(format!(
        "Before: {}. After: {}. {how} The noise column is the root mean square error that a true model would leave: measurement, filling and the fresh runs themselves.",
        model(&o.before),
        if o.after.effect.is_some() { model(&o.after) } else { "the same, since nothing was named".to_owned() },
    )));
    let mut rows = Vec::new();
    let mut add = |set: &str, before: &Errors, after: &Errors, held: bool| {
        let pick = |e: &Errors| if held { e.held_out.clone() } else { e.fitted.clone() };
        for (b, a) in pick(before).iter().zip(&pick(after)) {
            rows.push(Row::new(vec![
                set.to_owned(),
                b.response.to_owned(),
                unit(b.response).to_owned(),
                b.points.to_string(),
                short(b.rmse),
                short(a.rmse),
                short(b.floor),
                short(b.rmse_sd),
                short(a.rmse_sd),
            ]));
        }
    };
    add("fitted", &o.before.errors, &o.after.errors, false);
    add("held out", &o.before.errors, &o.after.errors, true);
    section.blocks.push(Block::Table(Table {
        caption: "Root mean square error".to_owned(),
        columns: vec![
            Column::text("speeds"),
            Column::text("response"),
            Column::text("unit"),
            Column::number("points", ""),
            Column::number("before", ""),
            Column::number("after", ""),
            Column::number("noise alone", ""),
            Column::number("before", "sd"),
            Column::number("after", "sd"),
        ],
        rows,
    }));
    let chi = |name: &str, s: &Side| {
        format!(
            "{name}: chi-square {} with {} degrees of freedom at the fitted speeds, p = {}; with those held out p = {}",
            short(s.errors.chi2),
            s.errors.dof,
            short(s.errors.p),
            short(s.errors.p_all)
        )
    };
    let mut facts = vec![chi("Before", &o.before)];
    if o.after.effect.is_some() {
        facts.push(chi("After", &o.after));
        for other in &o.others {
            facts.push(chi(&format!("With {} instead", model(other)), other));
        }
    }
    if let Some(removed) = o.removed.filter(|_| o.confirmed != Some(false)) {
        facts.push(format!(
            "{:.0} % of the mean square error above the noise goes away.",
            100.0 * removed
        ));
    }
    if o.confirmed == Some(false) {
        facts.push("The fresh runs contradict the fitted effect.".to_owned());
    }
    section.blocks.push(Block::List(facts));
    section
}

/// What the confirmed models say of speeds that were asked for.
fn predictions(o: &Outcome) -> Option<Section> {
    let rows: Vec<Row> = o
        .models()
        .flat_map(|side| side.predictions.chunks(4).map(move |four| (side, four)))
        .map(|(side, four)| {
            let own = [model(side), short(four[0].omega_rpm)];
            let values = four.iter().map(|p| plus_minus(p.mean, p.sd));
            Row::new(own.into_iter().chain(values).collect::<Vec<_>>())
        })
        .collect();
    if rows.is_empty() {
        return None;
    }
    let columns = with_responses(&[Column::text("model"), Column::number("speed", "rpm")]);
    Some(Section::new("Predictions").with(Block::Table(Table {
        caption:
            "Means of fresh runs, with one standard deviation of a drum filled anew".to_owned(),
        columns,
        rows,
    })))
}

/// Columns, and one for each response.
fn with_responses(first: &[Column]) -> Vec<Column> {
    let responses = Response::ALL.map(|r| Column::number(r.column(), unit(r.column())));
    first.iter().cloned().chain(responses).collect()
}

fn curves(o: &Outcome) -> Section {
    let named = o.after.effect.is_some();
    let all = (0..o.loads.len().max(1)).flat_map(|load| Response::ALL.map(|r| (load, r)));
    let figures = all.filter_map(|(load, r)| {
        let here = |p: &&Point| p.load == load && p.response == r.column();
        let of: Vec<_> = o.points.iter().filter(here).collect();
        if of.is_empty() {
            return None;
        }
        let residual = |after: bool| -> Vec<ChartPoint> {
            let mut points: Vec<ChartPoint> = of
                .iter()
                .map(|p| {
                    let y = p.measured - if after { p.after } else { p.before };
                    ChartPoint { x: p.omega_rpm, y, interval: Some((y - p.sd, y + p.sd)) }
                })
                .collect();
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
            points
        };
        let series = |name: &str, points| ChartSeries {
            name: name.to_owned(),
            style: SeriesStyle::LineAndPoints,
            points,
        };
        let mut all = vec![series("before", residual(false))];
        if named {
            all.push(series("after", residual(true)));
        }
        let chart = LineChart {
            title: told_load(o, load)
                .map_or_else(|| r.column().to_owned(), |l| format!("{}, {l}", r.column())),
            x: ChartAxis::new("speed, rpm"),
            y: ChartAxis::new(format!("measured less model, {}", unit(r.column()))),
            series: all,
            horizontal_limits: vec![(0.0, String::new())],
            vertical_limits: Vec::new(),
        };
        Some(Figure::new(&chart, "Bars: one standard deviation of the difference."))
    });
    Section::new("Residual over speed").with(Block::Figures(figures.collect()))
}

fn candidates(o: &Outcome) -> Section {
    let gate = &o.finding.gate;
    let text = format!(
        "The calibrated model alone: chi-square {} with {} degrees of freedom. Chance gives as much with p = {} (bootstrap), the best single improvement with p = {}, either of them with p = {}{}.",
        short(gate.chi2),
        gate.dof,
        short(gate.p_bootstrap),
        short(gate.p_focused),
        short(gate.p_combined),
        gate.lag1.map_or_else(String::new, |l| format!(
            "; lag-1 correlation of the residuals over speed {l:.2}"
        )),
    );
    let rows = o
        .finding
        .ranked
        .iter()
        .map(|r| {
            let end = |e: Option<f64>| e.map_or_else(|| "open".to_owned(), short);
            Row {
                cells: vec![
                    r.name.clone(),
                    short(r.strength.value),
                    format!("{} to {}", end(r.strength.lo), end(r.strength.hi)),
                    short(r.improvement),
                    short(r.p_family),
                    short(r.p_absolute),
                    format!("{:+.1}", r.aside),
                    short(r.evidence),
                ],
                flagged: false,
                strong: o.members.contains(&r.name),
            }
        })
        .collect();
    let mut section = Section::new("Effects of the catalogue").with(Block::Paragraph(text));
    if let Some(closest) = &o.closest {
        let further = if closest.ends() {
            " What stands as far as it is looked for may be stronger: [catalogue.range] in the case gives it more room, unless its drum cannot be simulated there (effects that were not tried)."
        } else {
            ""
        };
        let text = format!("Closest comes {}.{further}", closest.words());
        section.blocks.push(Block::Paragraph(text));
    }
    section.blocks.push(Block::Table(Table {
        caption: "Each effect fitted together with the free parameters. Gain: of chi-square, with its probability by chance in the whole catalogue. Frames: by their scatter they speak for an effect below 0, against it above."
            .to_owned(),
        columns: vec![
            Column::text("effect"),
            Column::number("strength", ""),
            Column::text("95 %"),
            Column::number("gain", ""),
            Column::number("its p", ""),
            Column::number("p of the fit", ""),
            Column::number("frames", ""),
            Column::number("posterior", ""),
        ],
        rows,
    }));
    let objections = o.finding.ranked.iter().filter(|r| !r.objections.is_empty());
    let objections: Vec<String> =
        objections.map(|r| format!("{}: {}", r.name, r.objections.join("; "))).collect();
    if !objections.is_empty() {
        let why = "Why the others are not named".to_owned();
        section.blocks.push(Block::Folded(why, vec![Block::List(objections)]));
    }
    if !o.left_out.is_empty() {
        let all = o.left_out.iter().map(|(p, why)| format!("{p}: {why}")).collect();
        section
            .blocks
            .push(Block::Folded("Effects that were not tried".to_owned(), vec![Block::List(all)]));
    }
    if !o.finding.pairs.is_empty() {
        let rows = o
            .finding
            .pairs
            .iter()
            .take(8)
            .map(|p| Row::new(vec![p.names.join(" + "), short(p.fit.chi2), short(p.fit.p)]));
        section.blocks.push(Block::Table(Table {
            caption: "Pairs".to_owned(),
            columns: vec![
                Column::text("pair"),
                Column::number("chi-square", ""),
                Column::number("p", ""),
            ],
            rows: rows.collect(),
        }));
    }
    section
}

fn apart(o: &Outcome) -> Section {
    let mut section = Section::new("What would tell them apart");
    let each = o.finding.ranked.iter().filter(|r| o.members.contains(&r.name));
    let mut all: Vec<String> =
        each.map(|r| format!("{} ({}): {}.", r.name, r.meaning, r.exposed_by)).collect();
    let half_asked = o.finding.next.iter().any(|n| n.name.starts_with(HALF_AS_MUCH));
    if o.loads.len() == 1 && !half_asked && matches!(o.verdict, "class" | "unknown") {
        all.push(
            "Most effects: the same photographs of a second load as well, half as much in the drum, say ([[data.loads]] in the case)."
                .to_owned(),
        );
    }
    if !all.is_empty() {
        section.blocks.push(Block::List(all));
    }
    let rows: Vec<Row> = o
        .finding
        .next
        .iter()
        .map(|n| {
            let part = format!("{:.0} %", 100.0 * n.gain_bits / n.most_bits);
            Row::new(vec![n.name.clone(), n.between.join(", "), short(n.gain_bits), part])
        })
        .collect();
    if !rows.is_empty() {
        section.blocks.push(Block::Table(Table {
            caption: "Information that an experiment is expected to give on which of them it is, with what the frictions leave open; of all that there is to know"
                .to_owned(),
            columns: vec![
                Column::text("experiment"),
                Column::text("between"),
                Column::number("gain", "bits"),
                Column::number("of all", ""),
            ],
            rows,
        }));
    }
    section
}

fn detectable(o: &Outcome) -> Section {
    let mut section = Section::new("What would have been seen");
    let rows: Vec<Row> = o
        .finding
        .detectable
        .iter()
        .map(|d| {
            let free = o.calibrated.iter().zip(&d.at);
            let at: Vec<String> = free.map(|((p, ..), v)| format!("{p} = {}", short(*v))).collect();
            Row::new(vec![
                d.name.clone(),
                short(d.towards),
                d.strength.map_or_else(|| "not within its range".to_owned(), short),
                at.join(", "),
                format!("{:.0} %", 100.0 * d.power_at_end),
            ])
        })
        .collect();
    if !rows.is_empty() {
        section.blocks.push(Block::Table(Table {
            caption: "Smallest strength that these data would show nine times in ten, in the drum that would hide it best"
                .to_owned(),
            columns: vec![
                Column::text("effect"),
                Column::number("towards", ""),
                Column::number("strength", ""),
                Column::text("with"),
                Column::number("power at the end of the range", ""),
            ],
            rows,
        }));
    }
    section
}

/// A verdict in words.
fn worded(verdict: &Found) -> String {
    match verdict {
        Found::None => "nothing is missing".to_owned(),
        Found::Effect(name) => name.clone(),
        Found::Class(names) => format!("one of {}", names.join(", ")),
        Found::Pairs(pairs) => {
            let both: Vec<String> = pairs.iter().map(|p| p.join(" with ")).collect();
            both.join(" or ")
        }
        Found::Unknown => "something that is not in the catalogue".to_owned(),
    }
}

fn stability(o: &Outcome) -> Section {
    let mut section = Section::new("Stability");
    let rows: Vec<Row> = o
        .finding
        .stability
        .iter()
        .map(|s| {
            let verdict = match &s.verdict {
                Ok(v) => worded(v),
                Err(e) => e.clone(),
            };
            Row::new(vec![s.change.clone(), verdict])
        })
        .collect();
    if !rows.is_empty() {
        section.blocks.push(Block::Table(Table {
            caption: "The verdict under changes of the data".to_owned(),
            columns: vec![Column::text("change"), Column::text("verdict")],
            rows,
        }));
    }
    if let Some(without) = &o.finding.verdict_without_code {
        section.blocks.push(Block::Paragraph(format!(
            "Without what codes differ by among themselves the data say: {}.",
            worded(without)
        )));
    }
    if let Some(over) = &o.finding.overturn {
        let sd = |v: Option<f64>| v.map_or_else(|| "more than 30".to_owned(), short);
        section.blocks.push(Block::Paragraph(format!(
            "Another scatter of the set-up would overturn the finding that something is missing: {} (independent from point to point) or {} (shared by all speeds), deg and % R.",
            sd(over.independent),
            sd(over.shared)
        )));
    }
    section
}

fn assumed(o: &Outcome) -> Section {
    let mut section = Section::new("What was assumed").with(Block::List(o.assumed.clone()));
    if !o.off_by.is_empty() {
        let rows = o.off_by.chunks(4).map(|four| {
            let at = short(four[0].omega_rpm);
            let own = std::iter::once(
                told_load(o, four[0].load).map_or(at.clone(), |l| format!("{at}, {l}")),
            );
            Row::new(own.chain(four.iter().map(|b| plus_minus(b.mean, b.sd))).collect::<Vec<_>>())
        });
        section.blocks.push(Block::Table(Table {
            caption: "Added to the stand-in: what runs of the rig show beyond it, with a standard deviation"
                .to_owned(),
            columns: with_responses(&[Column::number("speed", "rpm")]),
            rows: rows.collect(),
        }));
    }
    if !o.failed.is_empty() {
        let all = o.failed.iter().map(|(what, why)| format!("{what}: {why}")).collect();
        section.blocks.push(Block::Folded("Runs that failed".to_owned(), vec![Block::List(all)]));
    }
    section
}
