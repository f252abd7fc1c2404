//! Draws a coated tablet of ten spheres over the tablet it stands for, from above and from the
//! side, as SVG: `cargo run --example draw_tablet -- tablet.svg`.

use std::fmt::Write as _;
use std::process::ExitCode;

use dem_shapes::solids::SolidOfRevolution;
use dem_shapes::{
    BiconvexTablet, ClumpMass, Fidelity, FidelityOptions, RingTabletSpec, ShapeError, Sphere,
};

/// Pixels a millimetre.
const SCALE: f64 = 50.0;

fn main() -> ExitCode {
    let path = std::env::args().nth(1).unwrap_or_else(|| "tablet.svg".into());
    let svg = match drawing() {
        Ok(svg) => svg,
        Err(error) => return report(&error),
    };
    match std::fs::write(&path, svg) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => report(&error),
    }
}

#[expect(clippy::print_stderr, reason = "an example speaks to its user")]
fn report(error: &dyn std::error::Error) -> ExitCode {
    eprintln!("draw_tablet: {error}");
    ExitCode::FAILURE
}

fn drawing() -> Result<String, ShapeError> {
    let solid = BiconvexTablet::new(4.00e-3, 2.25e-3, 9.64e-3)?;
    let tablet = RingTabletSpec {
        ring_spheres: 9,
        ring_radius: 2.5e-3, // replaced by the one that gives the volume
        sphere_radius: 1.87e-3,
        middle_radius: Some(2.3e-3),
    }
    .with_union_volume(167.03e-9)?
    .build()?;
    let spheres = tablet.spheres();
    let clump = tablet.clump(ClumpMass::Density(1350.0))?;
    let fit = Fidelity::measure(&spheres, &solid, &FidelityOptions::default())?;

    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 980 600\" width=\"980\" \
         height=\"600\" font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"980\" height=\"600\" fill=\"white\"/>\n",
    );
    let from_above = |s: &Sphere| (s.center.x, s.center.y);
    let from_the_side = |s: &Sphere| (s.center.x, s.center.z);
    draw_spheres(&mut svg, &spheres, (245.0, 270.0), from_above);
    draw_spheres(&mut svg, &spheres, (735.0, 270.0), from_the_side);
    let outline = "fill=\"none\" stroke=\"#b3261e\" stroke-width=\"2.5\"";
    let radius = solid.spec().radius * 1e3 * SCALE;
    put(&mut svg, format_args!("<circle cx=\"245\" cy=\"270\" r=\"{radius}\" {outline}/>"));
    let points = side_outline(&solid, (735.0, 270.0));
    put(&mut svg, format_args!("<polygon points=\"{points}\" {outline}/>"));
    let mm = 1e3;
    let lines = [
        format!(
            "ring {:.4} mm; union {:.2} mm3, mass {:.4} g, moments {:.3} and {:.3} g mm2",
            tablet.spec().ring_radius * mm,
            clump.volume * 1e9,
            clump.mass * 1e3,
            clump.principal_moments.x * 1e9,
            clump.principal_moments.z * 1e9,
        ),
        format!(
            "template {:.2} mm3: volume {:+.1} %, symmetric difference {:.1} %, moments {:+.1} and \
             {:+.1} % at equal mass",
            solid.volume() * 1e9,
            100.0 * fit.volume_error_rel(),
            100.0 * fit.symmetric_difference_rel(),
            100.0 * fit.inertia_error_rel.x,
            100.0 * fit.inertia_error_rel.z,
        ),
        format!(
            "protrusion {:.3} mm, uncovered depth {:.3} mm, R_q {:.3} mm, groove at the rim {:.3} mm",
            fit.protrusion * mm,
            fit.uncovered_depth * mm,
            fit.roughness.rq * mm,
            tablet.rim_groove_depth().unwrap_or(f64::NAN) * mm,
        ),
    ];
    for (k, line) in lines.iter().enumerate() {
        put(&mut svg, format_args!("<text x=\"40\" y=\"{}\">{line}</text>", 530 + 24 * k));
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn draw_spheres(
    svg: &mut String,
    spheres: &[Sphere],
    (x, y): (f64, f64),
    view: impl Fn(&Sphere) -> (f64, f64),
) {
    let pixels = 1e3 * SCALE;
    for fill in ["fill=\"#9bb7d4\" stroke=\"#35618e\"", "fill=\"none\" stroke=\"#35618e\""] {
        for s in spheres {
            let (right, up) = view(s);
            put(
                svg,
                format_args!(
                    "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\" {fill}/>",
                    x + right * pixels,
                    y - up * pixels,
                    s.radius * pixels
                ),
            );
        }
    }
}

/// The tablet's outline from the side: up the right flank and down the left one.
fn side_outline(solid: &BiconvexTablet, (x, y): (f64, f64)) -> String {
    let (top, pixels) = (solid.half_height(), 1e3 * SCALE);
    let mut points = String::new();
    for k in 0..400 {
        // A height that goes like a cosine puts points where the outline bends.
        let angle = std::f64::consts::TAU * f64::from(k) / 400.0;
        let z = top * angle.cos();
        let reach = solid.radius_at(z) * angle.sin().signum();
        put(&mut points, format_args!("{:.2},{:.2}", x + reach * pixels, y - z * pixels));
    }
    points
}

fn put(text: &mut String, line: std::fmt::Arguments<'_>) {
    writeln!(text, "{line}").expect("writing to a string cannot fail");
}
