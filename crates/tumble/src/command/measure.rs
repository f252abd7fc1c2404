//! `tumble measure`: pictures to responses, with an overlay for each.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use drum_vision::decode::list_frames;
use drum_vision::overlay::{Tile, contact_sheet, overlay, write_png};
use drum_vision::{RegionSidecar, SeriesReport, VisionConfig, VisionError, measure_series};
use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::MeasureArgs;
use crate::command::film::PREVIEW;
use crate::input::{self, InputError};
use crate::output;

/// Side of a picture on the contact sheet, pixels, and pictures in a row.
const TILE: (usize, usize) = (320, 6);

pub(crate) fn run(args: &MeasureArgs) -> anyhow::Result<()> {
    let mut config = match &args.config {
        Some(path) => VisionConfig::from_toml(&input::read(path)?.text)?,
        None => VisionConfig::default(),
    };
    if let Some(rpm) = args.speed.filter(|s| !(s.is_finite() && *s > 0.0)) {
        let (what, expected) = (format!("--speed {rpm}"), "a speed above 0 rpm".to_owned());
        return Err(InputError::Run { what, expected }.into());
    }
    config.rig.speed_rpm = args.speed.or(config.rig.speed_rpm);
    config.rig.drum_radius_m = args.drum_radius.or(config.rig.drum_radius_m);
    let region = args.roi.as_deref().map(RegionSidecar::from_file).transpose()?;
    let frames = pictures(&args.frames)?;
    let folder = output::folder(args.out.as_deref(), "measure")?;
    // What an earlier call has left is of other pictures.
    output::remove_stale(&folder, |name| {
        name == "responses.csv" || name == "contact_sheet.png" || is_overlay(name)
    })?;
    let bar = ProgressBar::new(frames.len() as u64);
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos}/{len} frames, {eta} left")?);
    let tiles: Mutex<Vec<Option<Tile>>> = Mutex::new(frames.iter().map(|_| None).collect());
    let failed: Mutex<Option<drum_vision::VisionError>> = Mutex::new(None);
    let report = measure_series(&frames, &config, region.as_ref(), |p| {
        bar.inc(1);
        let Some(frame) = p.frame else { return };
        let (picture, rejected) = match p.outcome {
            Ok(found) => (overlay(frame, found), false),
            Err(_) => (frame.clone(), true),
        };
        if !rejected {
            let stem = p.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let name = format!("{:04}_{stem}_overlay.png", p.index);
            if let Err(e) = write_png(&picture, &folder.join(name)) {
                *failed.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(e);
            }
        }
        let tile = Tile::new(&picture, TILE.0, rejected, false);
        tiles.lock().unwrap_or_else(std::sync::PoisonError::into_inner)[p.index] = Some(tile);
    })?;
    bar.finish_and_clear();
    if let Some(error) = failed.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
        return Err(error.into());
    }
    let mut tiles = tiles.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    for (tile, path) in tiles.iter_mut().zip(&frames) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let outlier = report.frames.iter().any(|f| f.frame == name && f.outlier.is_some());
        if let Some(tile) = tile {
            tile.outlier = outlier;
        }
    }
    let tiles: Vec<Tile> = tiles.into_iter().flatten().collect();
    if !tiles.is_empty() {
        write_png(&contact_sheet(&tiles, TILE.1), &folder.join("contact_sheet.png"))?;
    }
    let json = serde_json::to_string_pretty(&report)?;
    output::write(&folder, "result.json", &json)?;
    output::write(&folder, "frames.csv", &frame_table(&report))?;
    if let (Some(row), Some(r)) = (args.speed.and_then(|s| report.csv_row(s)), &report.responses) {
        let n_eff = r.aor_lin_deg.n_eff;
        let text = format!(
            "{},n_frames,n_eff\n{row},{},{n_eff:.2}\n",
            SeriesReport::CSV_HEADER,
            report.n_frames
        );
        output::write(&folder, "responses.csv", &text)?;
    }
    if args.json {
        println!("{json}");
    } else {
        print(&report, &folder);
    }
    match report.rejected.first() {
        Some(first) if report.frames.is_empty() => Err(InputError::NothingMeasured {
            total: frames.len(),
            reason: format!("{}, at {:?}: {}", first.frame, first.stage, first.reason),
        }
        .into()),
        _ => Ok(()),
    }
}

/// Whether a file is an overlay by its name: number, name of the picture, `_overlay.png`.
fn is_overlay(name: &str) -> bool {
    let stem = name.strip_suffix("_overlay.png").and_then(|n| n.split_once('_'));
    stem.is_some_and(|(n, _)| n.len() >= 4 && n.bytes().all(|b| b.is_ascii_digit()))
}

/// The files named, and the frames in the folders named, each folder sorted.
fn pictures(named: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for path in named {
        if !path.exists() {
            return Err(InputError::NoPicture { path: path.display().to_string() }.into());
        }
        if !path.is_dir() {
            all.push(path.clone());
            continue;
        }
        // In the order of their numbers; what `tumble film` wrote to be looked at is no frame.
        let mut found = list_frames(path)?;
        found.retain(|p| p.file_name().is_none_or(|name| name != PREVIEW));
        if found.is_empty() {
            return Err(VisionError::NoFrames { what: path.display().to_string() }.into());
        }
        all.extend(found);
    }
    Ok(all)
}

fn frame_table(report: &SeriesReport) -> String {
    let mut text = String::from(
        "frame,aor_lin_deg,aor_lin_u,aor_mid_deg,aor_mid_u,cen_x_pct,cen_x_u,cen_y_pct,cen_y_u,fill,radius_px,outlier\n",
    );
    for f in &report.frames {
        text.push_str(&f.frame);
        for m in [f.aor_lin_deg, f.aor_mid_deg, f.cen_x_pct, f.cen_y_pct] {
            text.push_str(&format!(",{:.4},{:.4}", m.value, m.sd));
        }
        let outlier = f.outlier.as_deref().unwrap_or_default().replace(',', ";");
        text.push_str(&format!(",{:.4},{:.2},{outlier}\n", f.fill.value, f.drum.radius_px));
    }
    text
}

fn print(report: &SeriesReport, folder: &Path) {
    println!(
        "{:<28} {:>15} {:>15} {:>15} {:>15}",
        "frame", "aor_lin, deg", "aor_mid, deg", "cen_x, % R", "cen_y, % R"
    );
    for f in &report.frames {
        print!("{:<28}", f.frame);
        for m in [f.aor_lin_deg, f.aor_mid_deg, f.cen_x_pct, f.cen_y_pct] {
            print!(" {:>7.2} ± {:>5.2}", m.value, m.sd);
        }
        println!("{}", f.outlier.as_ref().map_or(String::new(), |o| format!("  outlier: {o}")));
    }
    for r in &report.rejected {
        println!("{:<28} rejected at {:?}: {}", r.frame, r.stage, r.reason);
    }
    if let (Some(r), true) = (&report.responses, report.frames.len() > 1) {
        print!("{:<28}", format!("mean of {}", report.n_frames));
        for s in [r.aor_lin_deg, r.aor_mid_deg, r.cen_x_pct, r.cen_y_pct] {
            print!(" {:>7.2} ± {:>5.2}", s.mean, s.sd.unwrap_or(f64::NAN));
        }
        println!("  (sd over frames; n_eff {:.1})", r.aor_lin_deg.n_eff);
    }
    if let Some(regime) = &report.regime {
        println!("regime: {regime:?}");
    }
    report.notes.iter().for_each(|n| println!("note: {n}"));
    println!("overlays: {}", folder.display());
}
