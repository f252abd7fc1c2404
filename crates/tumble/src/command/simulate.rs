//! `tumble simulate`: one drum, simulated, filmed and measured.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use campaign::drum_rig::{Experiment, Flow, Outcome, Sampled};
use campaign::vtk::{Encoding, Series};
use campaign::{Footage, Observatory, Observed, Resolution};
use drum_film::contact_sheet;
use drum_film::image::imageops::thumbnail;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use crate::cli::SimulateArgs;
use crate::experiment::{self, Changes};
use crate::input::InputError;
use crate::output;

/// Checkpoint file beside the results.
const CHECKPOINT: &str = "checkpoint.tumble";

/// Time between two checkpoints.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(60);

#[derive(Serialize)]
struct Speed {
    omega_rpm: f64,
    froude: f64,
    regime: String,
    revolutions: f64,
    steady_from_s: f64,
    torque_n_m: f64,
    angle_of_centre_of_mass_deg: f64,
    coordination: f64,
    responses: Option<drum_vision::series::ResponseSummaries>,
    covariance: Option<[[f64; 4]; 4]>,
    n_frames: usize,
    rejected: usize,
    fill_seen: Option<f64>,
}

#[derive(Serialize)]
struct Done {
    rig: String,
    settings: Vec<(String, f64)>,
    seed: u64,
    version: &'static str,
    input_hash: String,
    responses: Vec<Speed>,
    wall_s: f64,
    steps: u64,
    particles: usize,
    particle_steps_per_s: f64,
    steady_from_s: f64,
    files: Vec<String>,
}

#[derive(Serialize)]
struct Plan {
    particles: usize,
    time_step_s: f64,
    least_steps: u64,
    memory_mib: f64,
    expected_s: f64,
}

pub(crate) fn run(args: &SimulateArgs) -> anyhow::Result<()> {
    let changes = Changes {
        calibrated: args.calibrated.as_deref(),
        settings: &args.settings,
        speeds: &args.speeds,
        frames: args.frames,
        seed: args.seed,
        coarse: args.coarse,
    };
    let (rig, hash) = experiment::rig(&args.rig, &changes)?;
    let resolution = Resolution { width_px: args.width, ..Resolution::default() };
    let observatory = Observatory::new(&rig, resolution)?;
    let mut options = observatory.options(args.threads);
    options.liner_stl = experiment::liner(&args.rig, &rig)?;
    if args.dry_run {
        return dry_run(&Experiment::new(&rig, &options)?, args);
    }
    let folder = output::folder(args.out.as_deref(), &rig.name)?;
    output::check_writable(&folder)?;
    let kept = folder.join(CHECKPOINT);
    let mut drum = if args.resume {
        let bytes = std::fs::read(&kept).map_err(|source| InputError::Unreadable {
            path: kept.display().to_string(),
            source,
        })?;
        Experiment::resume(&rig, &options, &bytes)?
    } else {
        if kept.exists() {
            eprintln!(
                "begun anew: {} of an interrupted run is not used (--resume goes on with it)",
                kept.display()
            );
        }
        Experiment::new(&rig, &options)?
    };
    let first_step = drum.progress().steps;
    let start = Instant::now();
    let stop = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&stop);
    output::on_interrupt(move || asked.swap(true, Ordering::Relaxed))?;
    let mut series = match &args.vtk {
        Some(to) if args.resume => Some(Series::go_on(to, Encoding::default())?),
        Some(to) => Some(Series::begin(to, Encoding::default())?),
        None => None,
    };
    let outcome = simulate(&mut drum, &kept, series.as_mut(), &stop)?;
    if outcome == Outcome::Stopped {
        output::write_bytes(&folder, CHECKPOINT, &drum.checkpoint())?;
        anyhow::bail!("stopped; {} keeps what was done, go on with --resume", kept.display());
    }
    let wall_s = start.elapsed().as_secs_f64();
    let steps = drum.progress().steps;
    let particles = drum.grains().len();
    let sampled = drum.sampled();
    if let Some(series) = &mut series {
        let frames = sampled.iter().flat_map(|s| &s.frames);
        let closed: Vec<f64> =
            frames.filter_map(|f| f.exposures.last().map(|e| e.time_s)).collect();
        series.keep_only(&closed)?;
    }
    // What comes is not simulated again if it is interrupted.
    output::write_bytes(&folder, CHECKPOINT, &drum.checkpoint())?;
    eprintln!(
        "filming and measuring {} frames",
        sampled.iter().map(|s| s.frames.len()).sum::<usize>()
    );
    let mut speeds = Vec::new();
    let mut files = Vec::new();
    let mut table = String::new();
    // Of what no frame could be measured of: why.
    let mut unseen: Option<(usize, String)> = None;
    for steady in &sampled {
        if stop.load(Ordering::Relaxed) {
            anyhow::bail!("stopped; {} keeps what was done, go on with --resume", kept.display());
        }
        let seen = observatory.observe(steady)?;
        if let (None, Some(first)) = (&seen.report.responses, seen.report.rejected.first()) {
            let reason = format!("{} at {} rpm: {}", first.frame, seen.speed_rpm, first.reason);
            unseen.get_or_insert((steady.frames.len(), reason));
        }
        if let Some(name) = preview(&seen, &folder)? {
            files.push(name);
        }
        if let Some(row) = seen.report.csv_row(seen.speed_rpm) {
            table.push_str(&row);
            table.push('\n');
        }
        if args.positions {
            files.push(positions(steady, &folder)?);
        }
        if args.gif {
            files.push(animation(&observatory, steady, &folder)?);
        }
        speeds.push(speed(steady, &seen));
    }
    let header = drum_vision::SeriesReport::CSV_HEADER;
    output::write(&folder, "responses.csv", &format!("{header}\n{table}"))?;
    files.extend(["responses.csv".to_owned(), "run.json".to_owned()]);
    let done = Done {
        rig: rig.name.clone(),
        settings: rig.settings.iter().map(|(p, v)| (p.to_owned(), v)).collect(),
        seed: rig.run.seed,
        version: env!("CARGO_PKG_VERSION"),
        input_hash: hash,
        steady_from_s: sampled.first().map_or(0.0, |s| s.steady_from_s),
        responses: speeds,
        wall_s,
        steps,
        particles,
        particle_steps_per_s: (steps - first_step) as f64 * particles as f64 / wall_s,
        files,
    };
    let text = serde_json::to_string_pretty(&done)?;
    output::write(&folder, "run.json", &text)?;
    // What is finished needs no checkpoint.
    if kept.exists() {
        std::fs::remove_file(&kept)?;
    }
    if args.json {
        println!("{text}");
    } else {
        print(&done, &folder);
    }
    let nothing = done.responses.iter().all(|s| s.responses.is_none());
    match unseen.filter(|_| nothing) {
        Some((total, reason)) => Err(InputError::NothingMeasured { total, reason }.into()),
        None => Ok(()),
    }
}

fn simulate(
    drum: &mut Experiment,
    kept: &Path,
    mut series: Option<&mut Series>,
    stop: &AtomicBool,
) -> anyhow::Result<Outcome> {
    let bar = ProgressBar::new(1);
    bar.set_style(ProgressStyle::with_template("{bar:30} {msg}, {eta} left")?);
    let mut written = Instant::now();
    let mut failed: Option<anyhow::Error> = None;
    let folder = kept.parent().unwrap_or(Path::new("."));
    let outcome = drum.run(|drum, p| {
        bar.set_length(p.steps + p.least_steps_left);
        bar.set_position(p.steps);
        bar.set_message(format!(
            "{:?} at {} rpm, {:.2} s, {:.2} turns, {:.1} deg, frame {} of {}",
            p.phase, p.speed_rpm, p.time_s, p.turns, p.angle_deg, p.frames_done, p.frames
        ));
        if let Some(series) = series.as_mut().filter(|_| p.new_frame)
            && let Err(e) = series.write(drum)
        {
            failed = Some(e.into());
            return Flow::Stop;
        }
        if written.elapsed() > CHECKPOINT_EVERY {
            written = Instant::now();
            if let Err(e) = output::write_bytes(folder, CHECKPOINT, &drum.checkpoint()) {
                failed = Some(e);
                return Flow::Stop;
            }
        }
        if stop.load(Ordering::Relaxed) { Flow::Stop } else { Flow::Go }
    })?;
    bar.finish_and_clear();
    match failed {
        Some(e) => Err(e),
        None => Ok(outcome),
    }
}

fn dry_run(drum: &Experiment, args: &SimulateArgs) -> anyhow::Result<()> {
    /// Bytes a particle: state, lists and contacts of a dense bed.
    const BYTES: f64 = 1000.0;
    /// Seconds a particle-step on one core, as an order of size.
    const COST_S: f64 = 80e-9;
    let p = drum.progress();
    let particles = drum.grains().len();
    let plan = Plan {
        particles,
        time_step_s: drum.time_step(),
        least_steps: p.least_steps_left,
        memory_mib: particles as f64 * BYTES / f64::from(1 << 20),
        expected_s: p.least_steps_left as f64 * particles as f64 * COST_S / args.threads as f64,
    };
    if args.json {
        println!("{}", serde_json::to_string_pretty(&plan)?);
    } else {
        println!(
            "{} particles, step {:.1e} s, at least {} steps, about {:.0} MiB, about {:.0} s",
            plan.particles, plan.time_step_s, plan.least_steps, plan.memory_mib, plan.expected_s
        );
    }
    Ok(())
}

fn speed(steady: &Sampled, seen: &Observed) -> Speed {
    Speed {
        omega_rpm: steady.speed_rpm,
        froude: steady.froude,
        // As `measure` names it from the same pictures; by the Froude number alone where none could be measured.
        regime: seen
            .report
            .regime
            .map_or_else(|| format!("{:?}", steady.regime), |r| format!("{r:?}")),
        revolutions: steady.revolutions,
        steady_from_s: steady.steady_from_s,
        torque_n_m: steady.torque.mean,
        angle_of_centre_of_mass_deg: steady.angle_deg.mean,
        coordination: steady.coordination.mean,
        responses: seen.report.responses,
        covariance: seen.report.covariance,
        n_frames: seen.report.n_frames,
        rejected: seen.report.rejected.len(),
        fill_seen: seen.report.fill,
    }
}

fn preview(seen: &Observed, folder: &Path) -> anyhow::Result<Option<String>> {
    if seen.preview.is_empty() {
        return Ok(None);
    }
    let name = format!("preview_{}rpm.png", seen.speed_rpm);
    let sheet = contact_sheet(&seen.preview, 3)?;
    sheet.save(folder.join(&name))?;
    Ok(Some(name))
}

/// All frames of one speed as an animated GIF, a frame every tenth of a second.
fn animation(observatory: &Observatory, steady: &Sampled, folder: &Path) -> anyhow::Result<String> {
    /// Width of a picture, pixels: a GIF has 256 colours and no good compression.
    const WIDTH: u32 = 480;
    let footage = Footage::of(steady);
    let mut small = Vec::new();
    for index in 0..footage.frames.len() {
        let picture = observatory.frame(&footage, index)?;
        let (width, height) = picture.dimensions();
        let to = WIDTH.min(width);
        small.push(thumbnail(&picture, to, (height * to / width).max(1)));
    }
    let mut bytes = Vec::new();
    drum_film::gif::write_gif(&small, 100, &mut bytes)?;
    let name = format!("film_{}rpm.gif", steady.speed_rpm);
    output::write_bytes(folder, &name, &bytes)?;
    Ok(name)
}

/// The positions of every frame's first instant, as `tumble film` reads them.
fn positions(steady: &Sampled, folder: &Path) -> anyhow::Result<String> {
    let mut text = String::from("frame,x,y,z,radius\n");
    for (k, frame) in steady.frames.iter().enumerate() {
        for e in frame.exposures.iter().take(1) {
            for b in e.balls(&steady.grains) {
                let c = b.centre;
                text.push_str(&format!("{k},{:.7},{:.7},{:.7},{:.7}\n", c.x, c.y, c.z, b.radius));
            }
        }
    }
    let name = format!("positions_{}rpm.csv", steady.speed_rpm);
    output::write(folder, &name, &text)?;
    Ok(name)
}

fn print(done: &Done, folder: &Path) {
    println!(
        "{}: {} particles, {} steps in {:.1} s ({:.1} million particle-steps a second)",
        done.rig,
        done.particles,
        done.steps,
        done.wall_s,
        done.particle_steps_per_s / 1e6
    );
    println!(
        "{:>6} {:>16} {:>16} {:>16} {:>16} {:>7} {:>7}",
        "rpm", "aor_lin, deg", "aor_mid, deg", "cen_x, % R", "cen_y, % R", "frames", "turns"
    );
    for s in &done.responses {
        print!("{:>6}", s.omega_rpm);
        match &s.responses {
            Some(r) => {
                for v in [r.aor_lin_deg, r.aor_mid_deg, r.cen_x_pct, r.cen_y_pct] {
                    print!(" {:>8.2} ± {:>5.2}", v.mean, v.sd.unwrap_or(f64::NAN));
                }
            }
            None => print!("   no frame could be measured"),
        }
        println!(" {:>7} {:>7.2}", s.n_frames, s.revolutions);
    }
    println!("results: {}", folder.display());
}
