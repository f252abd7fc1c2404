//! Films one analytic bed: `cargo run --release -p drum-film --example film_bed -- out.png`.

use drum_film::{Bed, Film};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "film_bed.png".into());
    let bed =
        Bed { fill: 0.35, aor_lin_deg: 32.0, s_shape_deg: 4.0, extruded: true, ..Bed::default() };
    let frame = Film::default().bed_frame(&bed, 0)?;
    frame.image.save(&path)?;
    let t = frame.truth;
    #[expect(clippy::print_stdout, reason = "an example speaks to its reader")]
    {
        println!("{path}: whole {:.2} deg, middle {:.2} deg", t.aor_lin_deg, t.aor_mid_deg);
        println!("centre of area {:.2} % of R, {:.2} % of R", t.cen_x_pct, t.cen_y_pct);
    }
    Ok(())
}
