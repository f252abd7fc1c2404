//! The comparison as tables and as JSON.

use std::path::Path;

use anyhow::Context;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::physics::Bed;
use super::spread::Spread;

/// A code that is not installed or does not run: named, never estimated.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Absent {
    pub(crate) code: &'static str,
    pub(crate) why: String,
}

/// A skin that was tried.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Tried {
    pub(crate) code: &'static str,
    pub(crate) skin_mm: f64,
    pub(crate) ns_per_particle_step: f64,
}

/// What all codes had to do.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(crate) struct Workload {
    pub(crate) particles: usize,
    pub(crate) contacts_per_particle: f64,
    pub(crate) dt: f64,
    pub(crate) steps: u64,
    pub(crate) warm: u64,
    pub(crate) repeats: usize,
    /// How Tumble computed.
    pub(crate) kernels: &'static str,
}

/// One code with a number of threads.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Entry {
    pub(crate) code: &'static str,
    pub(crate) version: String,
    pub(crate) threads: usize,
    /// Median; processor time with one thread, wall time with several.
    pub(crate) ns_per_particle_step: f64,
    /// Half the range of the repeats, ns.
    pub(crate) spread: f64,
    pub(crate) wall_ns: Spread,
    pub(crate) processor_ns: Spread,
    pub(crate) particle_steps_per_s: f64,
    pub(crate) ns_per_contact: f64,
    pub(crate) contacts_per_particle: f64,
    pub(crate) list_pairs_per_particle: f64,
    pub(crate) steps_per_list: f64,
    pub(crate) skin_mm: f64,
    /// Contacts a particle within 2 percent of Tumble's with the same rolling resistance.
    pub(crate) same_contacts: bool,
    pub(crate) contacts_off_percent: f64,
    pub(crate) end: Bed,
}

/// Ratio of a code's time to Tumble's by processor and by wall time, if it ran.
pub(crate) type Ratio = (&'static str, Option<[Spread; 2]>);

/// Everything.
#[derive(Debug, Clone, Default)]
pub(crate) struct Report {
    pub(crate) machine: String,
    /// Load of the machine over a minute, before and after.
    pub(crate) load: [Option<f64>; 2],
    pub(crate) scene: Workload,
    pub(crate) start: Bed,
    pub(crate) runs: Vec<Entry>,
    pub(crate) ratios: [Ratio; 5],
    /// Two threads to one: as timed, and normalised by two independent processes.
    pub(crate) two_threads: [Spread; 2],
    pub(crate) same_bits_on_1_and_2_threads: bool,
    /// Tumble's ledger over the timed steps: dissipated, and not accounted for, mJ.
    pub(crate) ledger_mj: [f64; 2],
    pub(crate) skins_tried: Vec<Tried>,
    pub(crate) absent: Vec<Absent>,
}

/// Print as JSON or as tables; the JSON is kept in `path` in any case.
pub(crate) fn print(report: &Report, as_json: bool, path: &Path) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(&as_value(report))?;
    std::fs::write(path, &text).with_context(|| format!("cannot write {}", path.display()))?;
    if as_json {
        println!("{text}");
    } else {
        print_tables(report);
    }
    Ok(())
}

fn as_value(report: &Report) -> Value {
    let (mut medians, mut details) = (Map::new(), Map::new());
    for (code, ratio) in &report.ratios {
        medians.insert((*code).to_owned(), json!(ratio.map(|[processor, _]| processor.median)));
        let detail = ratio.map(|[processor, wall]| json!({"processor": processor, "wall": wall}));
        details.insert((*code).to_owned(), json!(detail));
    }
    let [raw, normalised] = report.two_threads;
    json!({
        "machine": report.machine,
        "load_before_and_after": report.load,
        "scene": report.scene,
        "bed_at_start": report.start,
        "runs": report.runs,
        "ratios": medians,
        "ratio_spreads": details,
        "two_threads": {"raw": raw, "normalised": normalised},
        "same_bits_on_1_and_2_threads": report.same_bits_on_1_and_2_threads,
        "ledger_mj": {"dissipated": report.ledger_mj[0], "remainder": report.ledger_mj[1]},
        "skins_tried": report.skins_tried,
        "absent": report.absent,
    })
}

fn print_tables(report: &Report) {
    let s = &report.scene;
    let load = |l: Option<f64>| l.map_or_else(|| "unknown".to_owned(), |l| format!("{l:.2}"));
    println!(
        "{}; load {} before, {} after",
        report.machine,
        load(report.load[0]),
        load(report.load[1])
    );
    println!(
        "{} beads, {} steps of {:.0} us after {} to warm up, {} rounds; Tumble with {} kernels\n",
        s.particles,
        s.steps,
        1e6 * s.dt,
        s.warm,
        s.repeats,
        s.kernels
    );
    println!(
        "| code | threads | processor ns a particle-step | wall ns a particle-step | particle-steps/s | ns a contact | contacts a particle | list pairs a particle | steps a list | skin (mm) |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for r in &report.runs {
        println!(
            "| {} | {} | {:.1} ({:.1}..{:.1}) | {:.1} ({:.1}..{:.1}) | {:.3e} | {:.1} | {:.3} ({:+.1} %){} | {:.2} | {:.1} | {:.2} |",
            r.code,
            r.threads,
            r.processor_ns.median,
            r.processor_ns.least,
            r.processor_ns.most,
            r.wall_ns.median,
            r.wall_ns.least,
            r.wall_ns.most,
            r.particle_steps_per_s,
            r.ns_per_contact,
            r.contacts_per_particle,
            r.contacts_off_percent,
            if r.same_contacts { "" } else { " NOT THE SAME WORK" },
            r.list_pairs_per_particle,
            r.steps_per_list,
            r.skin_mm,
        );
    }
    println!("\n| time over Tumble's, one thread | processor time | wall time |\n|---|---|---|");
    for (code, ratio) in &report.ratios {
        if let Some([p, w]) = ratio {
            println!(
                "| {code} | {:.2} ({:.2}..{:.2}) | {:.2} ({:.2}..{:.2}) |",
                p.median, p.least, p.most, w.median, w.least, w.most
            );
        }
    }
    let [raw, normalised] = report.two_threads;
    println!(
        "\ntwo threads against one: {:.2} ({:.2}..{:.2}); over half the rate of two independent processes x 2: {:.2} ({:.2}..{:.2})",
        raw.median, raw.least, raw.most, normalised.median, normalised.least, normalised.most
    );
    println!("same bits on 1 and 2 threads: {}\n", report.same_bits_on_1_and_2_threads);
    println!(
        "| at the end | threads | coordination number | angle (deg) | depth (mm) | kinetic (mJ) | potential (mJ) |"
    );
    println!("|---|---|---|---|---|---|---|");
    let row = |code: &str, threads: &str, coordination: &str, b: &Bed| {
        println!(
            "| {code} | {threads} | {coordination} | {:.2} | {:.2} | {:.2} | {:.1} |",
            b.angle_deg, b.depth_mm, b.kinetic_mj, b.potential_mj
        );
    };
    row("all, at the start", "", "", &report.start);
    for r in &report.runs {
        let coordination = format!("{:.3}", 2.0 * r.contacts_per_particle);
        row(r.code, &r.threads.to_string(), &coordination, &r.end);
    }
    println!(
        "\nTumble's ledger over the timed steps: dissipated {:.3} mJ, not accounted for {:+.2e} mJ",
        report.ledger_mj[0], report.ledger_mj[1]
    );
    for a in &report.absent {
        println!("absent: {}: {}", a.code, a.why);
    }
}
