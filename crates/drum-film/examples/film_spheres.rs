//! Films a heap of loosely packed beads: `cargo run --release -p drum-film --example film_spheres -- out.png`.

use std::time::Instant;

use drum_film::glam::{DVec2, DVec3};
use drum_film::{Bed, Film, Sphere};

/// Beads on a close-packed lattice with some disorder, cut to the shape of a bed.
fn beads(bed: &Bed, film: &Film, radius_m: f64) -> Result<Vec<Sphere>, drum_film::Error> {
    let shape = bed.shape()?;
    let drum = film.scene.drum;
    let mut spheres = Vec::new();
    let layers = (drum.length_m / (2.0 * radius_m)) as i32;
    let rows = (drum.radius_m / radius_m) as i32;
    for k in 0..layers {
        for j in -rows..=rows {
            for i in -rows..=rows {
                let stray = |q: i32| (f64::from(i * 37 + j * 59 + k * 83 + q * 17) * 12.9898).sin();
                let x = radius_m * (2.0 * f64::from(i) + f64::from((j + k) & 1))
                    + 0.3 * radius_m * stray(1);
                let y = radius_m * 1.9 * f64::from(j) + 0.3 * radius_m * stray(2);
                let z = drum.length_m / 2.0 - radius_m * (1.0 + 2.0 * f64::from(k));
                let p = DVec2::new(x, y);
                if p.length() < drum.radius_m - radius_m && shape.contains(p / drum.radius_m) {
                    let body = spheres.len() as u32;
                    spheres.push(Sphere { body, ..Sphere::new(DVec3::new(x, y, z), radius_m) });
                }
            }
        }
    }
    Ok(spheres)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "film_spheres.png".into());
    let film = Film::default();
    let bed = Bed { fill: 0.24, aor_lin_deg: 30.0, s_shape_deg: 4.0, ..Bed::default() };
    let spheres = beads(&bed, &film, 0.003)?;
    let studio = film.studio()?;
    studio.sphere_frame(&spheres[..1], 0)?;
    let start = Instant::now();
    let frame = studio.sphere_frame(&spheres, 0)?;
    let seconds = start.elapsed().as_secs_f64();
    frame.image.save(&path)?;
    #[expect(clippy::print_stdout, reason = "an example speaks to its reader")]
    {
        println!("{path}: {} spheres in {seconds:.3} s", spheres.len());
    }
    Ok(())
}
