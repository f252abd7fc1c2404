//! `tumble run`: every run of a plan, resumable.

use std::collections::BTreeMap;
use std::io::IsTerminal;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::Context;
use campaign::Resolution;
use campaign::drum_rig::Coarsening;
use campaign::plan::{
    Call, Campaign, Collected, Event, Freeze, Manifest, RowState, RunOptions, Summary,
    gnu_parallel, quoted, slurm, snakemake,
};
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use serde::Serialize;

use crate::cli::RunArgs;
use crate::input::{self, InputError};
use crate::output;

/// Seconds a particle-step on one core, as an order of size.
const COST_S: f64 = 80e-9;

#[derive(Serialize)]
struct Done<'a> {
    name: &'a str,
    manifest: &'a str,
    version: &'a str,
    input_hash: &'a str,
    runs: usize,
    done: &'a [u64],
    failed: Vec<Failed<'a>>,
    open: &'a [u64],
    carried_out: usize,
    wall_s: f64,
    table: Option<String>,
}

#[derive(Serialize)]
struct Failed<'a> {
    run: u64,
    class: String,
    reason: &'a str,
}

#[derive(Serialize)]
struct Outlook {
    runs: usize,
    particle_steps: f64,
    /// Frames to film and measure.
    frames: u64,
    /// Of the simulations alone.
    expected_s: f64,
}

pub(crate) fn run(args: &RunArgs) -> anyhow::Result<()> {
    let text = input::read(&args.plan)?;
    let how = Freeze {
        resolution: Resolution { width_px: args.width, ..Resolution::default() },
        coarse: args.coarse.then(Coarsening::default),
    };
    let manifest = Manifest::freeze(&text.name, &text.text, &how)?;
    if args.dry_run {
        return dry_run(&manifest, args);
    }
    let folder = output::folder(args.out.as_deref(), manifest.name())?;
    let campaign = Campaign::begin(&folder, manifest)?;
    if args.slurm || args.parallel || args.snakemake {
        return script(&campaign, args);
    }
    if args.collect {
        let collected = campaign.collect()?;
        return told(&campaign, &collected);
    }
    let stop = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&stop);
    output::on_interrupt(move || asked.swap(true, Ordering::Relaxed))?;
    let options = RunOptions {
        jobs: args.jobs,
        checkpoint_every: Duration::from_secs_f64(args.checkpoint_every),
        retry_failed: args.retry_failed,
        ..RunOptions::default()
    };
    let begun = Instant::now();
    let mut show = Show::new(&campaign, args)?;
    let summary = match args.index {
        Some(index) => campaign.run_one(index, &options, &stop, |event| show.hear(event))?,
        None => campaign.run(&options, &stop, |event| show.hear(event))?,
    };
    show.bar.finish_and_clear();
    // Single runs leave the table to `--collect`: others may be writing theirs.
    let collected = args.index.is_none().then(|| campaign.collect()).transpose()?;
    let done = Done {
        name: campaign.manifest().name(),
        manifest: campaign.manifest().checksum(),
        version: env!("CARGO_PKG_VERSION"),
        input_hash: &text.input().hash,
        runs: campaign.manifest().rows().len(),
        done: &summary.done,
        failed: summary
            .failed
            .iter()
            .map(|(run, f)| Failed { run: *run, class: f.class.to_string(), reason: &f.reason })
            .collect(),
        open: &summary.open,
        carried_out: summary.carried_out,
        wall_s: begun.elapsed().as_secs_f64(),
        table: collected.as_ref().map(|_| folder.join("responses.csv").display().to_string()),
    };
    if args.json {
        println!("{}", serde_json::to_string_pretty(&done)?);
    } else {
        println!(
            "{}: {} of {} runs done, {} failed, {} open; {} carried out in {:.1} s",
            done.name,
            done.done.len(),
            done.runs,
            done.failed.len(),
            done.open.len(),
            done.carried_out,
            done.wall_s
        );
    }
    if let Some(collected) = collected.filter(|_| !args.json) {
        told(&campaign, &collected)?;
    }
    verdict(args, &summary, done.runs, stop.load(Ordering::Relaxed))
}

/// Success only if what was asked for is done.
fn verdict(args: &RunArgs, summary: &Summary, runs: usize, stopped: bool) -> anyhow::Result<()> {
    let asked = |index: &u64| args.index.is_none_or(|wanted| wanted == *index);
    let failed: Vec<_> = summary.failed.iter().filter(|(index, _)| asked(index)).collect();
    if stopped && summary.open.iter().any(asked) {
        anyhow::bail!("stopped; checkpoints keep what was done, the same call goes on");
    }
    let Some((index, first)) = failed.first() else { return Ok(()) };
    let fault = InputError::RunsFailed {
        failed: failed.len(),
        runs,
        index: *index,
        class: first.class.to_string(),
        reason: first.reason.clone(),
    };
    if failed.iter().all(|(_, f)| f.class.passes()) {
        anyhow::bail!("{fault}; the same call tries again");
    }
    Err(fault.into())
}

/// Say where the table is and what it lacks.
fn told(campaign: &Campaign, collected: &Collected) -> anyhow::Result<()> {
    for m in &collected.missing {
        match &m.failure {
            Some(f) => eprintln!("run {} failed ({}): {}", m.index, f.class, f.reason),
            None => eprintln!("run {} has no result yet", m.index),
        }
    }
    for (index, rpm) in &collected.unmeasured {
        eprintln!("run {index}: no frame at {rpm} rpm could be measured");
    }
    println!(
        "{} rows, {} runs missing: {}",
        collected.rows,
        collected.missing.len(),
        campaign.folder().join("responses.csv").display()
    );
    Ok(())
}

fn dry_run(manifest: &Manifest, args: &RunArgs) -> anyhow::Result<()> {
    let (mut particle_steps, mut frames) = (0.0, 0);
    for row in manifest.rows() {
        let o = manifest.outline(row)?;
        particle_steps += (o.particles * o.spheres_per_particle) as f64 * o.least_steps as f64;
        frames += row.speeds_rpm.len() as u64 * u64::from(manifest.rig(row)?.run.frames);
    }
    let runs = manifest.rows().len();
    let workers = args.jobs.clamp(1, runs.max(1));
    let expected_s = particle_steps * COST_S / workers as f64;
    if args.json {
        let outlook = Outlook { runs, particle_steps, frames, expected_s };
        println!("{}", serde_json::to_string_pretty(&outlook)?);
    } else {
        println!(
            "{runs} runs, at least {particle_steps:.2e} particle-steps, about {} with {workers} workers; \
             then {frames} frames to film and measure",
            HumanDuration(Duration::from_secs_f64(expected_s))
        );
    }
    Ok(())
}

/// Write the script of a scheduler into the campaign's folder.
fn script(campaign: &Campaign, args: &RunArgs) -> anyhow::Result<()> {
    let mut arguments = Vec::new();
    if args.coarse {
        arguments.push("--coarse".to_owned());
    }
    arguments.extend(["--width".to_owned(), args.width.to_string()]);
    let absolute = |path: &Path| -> anyhow::Result<String> {
        let whole = std::path::absolute(path).with_context(|| path.display().to_string())?;
        Ok(whole.display().to_string())
    };
    let call = Call {
        program: "tumble".to_owned(),
        plan: absolute(&args.plan)?,
        folder: absolute(campaign.folder())?,
        arguments,
    };
    let (name, text, use_it) = if args.slurm {
        ("campaign.slurm", slurm(campaign.manifest(), &call), "sbatch")
    } else if args.parallel {
        ("campaign.sh", gnu_parallel(campaign.manifest(), &call), "sh")
    } else {
        ("Snakefile", snakemake(campaign.manifest(), &call), "snakemake --cores all --snakefile")
    };
    let path = output::write(campaign.folder(), name, &text)?;
    println!("{use_it} {}", quoted(&path.display().to_string()));
    Ok(())
}

/// Work of one run in particle-steps: done and at least still to come.
#[derive(Clone, Copy)]
struct Work {
    particles: f64,
    done: f64,
    left: f64,
}

/// Progress over all runs: a bar on a terminal, a line a run elsewhere.
struct Show {
    bar: ProgressBar,
    lines: bool,
    work: BTreeMap<u64, Work>,
    running: BTreeMap<u64, f64>,
    ended: usize,
    failed: usize,
    begun: Instant,
    /// Particle-steps that were found done when a run began.
    found: f64,
}

impl Show {
    fn new(campaign: &Campaign, args: &RunArgs) -> anyhow::Result<Self> {
        let manifest = campaign.manifest();
        let mut work = BTreeMap::new();
        for row in manifest.rows() {
            let asked = args.index.is_none_or(|index| index == row.index);
            if !asked || matches!(campaign.state(row)?, RowState::Ended(_)) {
                continue;
            }
            let o = manifest.outline(row)?;
            let particles = (o.particles * o.spheres_per_particle) as f64;
            let left = particles * o.least_steps as f64;
            work.insert(row.index, Work { particles, done: 0.0, left });
        }
        let bar = ProgressBar::new(work.len() as u64);
        bar.set_style(ProgressStyle::with_template("{bar:30} {msg}")?);
        Ok(Self {
            lines: !std::io::stderr().is_terminal(),
            bar,
            work,
            running: BTreeMap::new(),
            ended: 0,
            failed: 0,
            begun: Instant::now(),
            found: 0.0,
        })
    }

    fn hear(&mut self, event: &Event) {
        match event {
            Event::Started { index, resumed } => {
                self.running.insert(*index, -1.0);
                if self.lines {
                    let how = if *resumed { "goes on" } else { "begins" };
                    eprintln!("run {index} {how}");
                }
            }
            Event::Progress { index, steps, least_steps_left } => {
                let Some(w) = self.work.get_mut(index) else { return };
                w.done = *steps as f64 * w.particles;
                w.left = *least_steps_left as f64 * w.particles;
                if let Some(first @ -1.0) = self.running.get_mut(index) {
                    *first = w.done;
                    self.found += w.done;
                }
            }
            Event::Ended { index, failure, effort } => {
                if let Some(w) = self.work.get_mut(index) {
                    w.left = 0.0;
                }
                self.running.remove(index);
                self.ended += 1;
                self.failed += usize::from(failure.is_some());
                if self.lines {
                    match failure {
                        Some(f) => eprintln!("run {index} failed ({}): {}", f.class, f.reason),
                        None => {
                            eprintln!("run {index} is done, {:.1} s{}", effort.wall_s, self.eta());
                        }
                    }
                }
            }
            Event::Stopped { index } => {
                self.running.remove(index);
                if self.lines {
                    eprintln!("run {index} stopped; its checkpoint is kept");
                }
            }
        }
        let (done, left) = self.sums();
        self.bar.set_length((done + left) as u64);
        self.bar.set_position(done as u64);
        self.bar.set_message(format!(
            "{} of {} runs ended, {} failed, {} under way{}",
            self.ended,
            self.work.len(),
            self.failed,
            self.running.len(),
            self.eta()
        ));
    }

    fn sums(&self) -> (f64, f64) {
        self.work.values().fold((0.0, 0.0), |(d, l), w| (d + w.done, l + w.left))
    }

    /// Time left, from the pace so far.
    fn eta(&self) -> String {
        let (done, left) = self.sums();
        let pace = (done - self.found) / self.begun.elapsed().as_secs_f64();
        if !(pace > 0.0) {
            return String::new();
        }
        // What is known of the work left is its least.
        format!(", at least {} left", HumanDuration(Duration::from_secs_f64(left / pace)))
    }
}
