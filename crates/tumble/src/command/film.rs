//! `tumble film`: positions of any code as pictures.

use drum_film::glam::DVec3;
use drum_film::{Drum, Film, Frames, Scene, Sphere, contact_sheet};
use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::FilmArgs;
use crate::input::InputError;
use crate::output;

/// Frames of the preview strip.
const SHOWN: usize = 6;

/// The picture that shows them, beside the frames.
pub(crate) const PREVIEW: &str = "preview.png";

pub(crate) fn run(args: &FilmArgs) -> anyhow::Result<()> {
    let path = args.positions.display().to_string();
    let drum = Drum { radius_m: args.drum_radius, length_m: args.drum_length };
    let mut film = Film { scene: Scene::about(drum), ..Film::default() };
    film.camera = film.camera.with_size(args.width, args.width * 2 / 3);
    for (parameter, value) in &args.settings {
        film.set(parameter, *value)?;
    }
    if !args.settings.iter().any(|(parameter, _)| parameter == "camera.focal_length_mm") {
        film.camera = film.camera.close_up(args.drum_radius);
    }
    let studio = film.studio()?;
    let rows = positions(&args.positions)?;
    let outside = rows.iter().filter(|(_, s)| s.center.truncate().length() > args.drum_radius);
    let outside = outside.count();
    if 2 * outside > rows.len() {
        let what = format!("{path}: {outside} of {} spheres lie outside the drum", rows.len());
        let expected = "positions in metres about its axis, z".to_owned();
        return Err(InputError::Run { what, expected }.into());
    }
    let folder = output::folder(args.out.as_deref(), "film")?;
    // Frames of another film would be measured with these.
    output::remove_stale(&folder, |name| {
        let number = name.strip_prefix("frame_").and_then(|n| n.strip_suffix(".png"));
        number.is_some_and(|n| n.bytes().all(|b| b.is_ascii_digit()))
    })?;
    let bar = ProgressBar::new_spinner();
    bar.set_style(ProgressStyle::with_template("{spinner} {pos} frames, {elapsed}")?);
    let mut preview = Vec::new();
    let mut all = Vec::new();
    for (index, snapshot) in Frames::new(rows).enumerate() {
        let snapshot = snapshot?;
        let picture = studio.sphere_frame(&snapshot.spheres, index as u64)?.image;
        let name = format!("frame_{:05}.png", snapshot.frame);
        let staged = folder.join(format!("{name}.tmp"));
        picture.save_with_format(&staged, drum_film::image::ImageFormat::Png)?;
        std::fs::rename(&staged, folder.join(name))?;
        let small = drum_film::image::imageops::thumbnail(&picture, 480, 320);
        if preview.len() < SHOWN {
            preview.push(small.clone());
        }
        if args.gif {
            all.push(small);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if preview.is_empty() {
        return Err(InputError::Position { path, line: 1, problem: "no rows".to_owned() }.into());
    }
    let strip = contact_sheet(&preview, preview.len().min(3) as u32)?;
    strip.save(folder.join(PREVIEW))?;
    if args.gif {
        let mut file = std::io::BufWriter::new(std::fs::File::create(folder.join("film.gif"))?);
        drum_film::gif::write_gif(&all, 100, &mut file)?;
    }
    println!("{} frames and preview.png in {}", bar.position(), folder.display());
    Ok(())
}

/// Rows of the table of positions, all checked before a picture is made.
fn positions(path: &std::path::Path) -> Result<Vec<(u64, Sphere)>, InputError> {
    let text = crate::input::read(path)?;
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.text.as_bytes());
    let fault = |line: u64, problem: String| InputError::Position {
        path: text.name.clone(),
        line,
        problem,
    };
    let header = reader.headers().map_err(|e| fault(1, e.to_string()))?;
    let expected = ["frame", "x", "y", "z", "radius"];
    if !header.iter().eq(expected) {
        return Err(fault(
            1,
            format!("the header is `{}`", header.iter().collect::<Vec<_>>().join(",")),
        ));
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record
            .map_err(|e| fault(e.position().map_or(1, csv::Position::line), e.to_string()))?;
        let line = record.position().map_or(1, csv::Position::line);
        let number = |i: usize| -> Result<f64, InputError> {
            let field = &record[i];
            let value = field.parse::<f64>().ok().filter(|v| v.is_finite());
            value.ok_or_else(|| fault(line, format!("`{field}` in column {}", expected[i])))
        };
        let frame = record[0]
            .parse::<u64>()
            .map_err(|_| fault(line, format!("`{}` in column frame", &record[0])))?;
        let centre = DVec3::new(number(1)?, number(2)?, number(3)?);
        let radius = number(4)?;
        if !(radius > 0.0) {
            return Err(fault(line, format!("radius {radius} is not above 0")));
        }
        rows.push((frame, Sphere::new(centre, radius)));
    }
    Ok(rows)
}
