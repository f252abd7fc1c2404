//! Tables that follow from formulas: the angles of Table 3, the tablets of Table 6, the plan of
//! Table 8.

use dem_shapes::solids::SolidOfRevolution;
use dem_shapes::{Ball, BiconvexTablet, FlatTablet, RingTabletSpec};
use doe::{Factor, design::full_factorial};

use super::{Row, records};

pub(crate) fn all() -> anyhow::Result<Vec<(String, Vec<Row>)>> {
    Ok(vec![
        (
            "Table 3: lower angle from the upper (equation 38) and dynamic angle (equation 37)"
                .to_owned(),
            angles()?,
        ),
        ("Table 6: volumes and masses of the particles".to_owned(), particles()?),
        ("Table 8: simulation plan from its factors".to_owned(), plan()?),
    ])
}

fn number(record: &csv::StringRecord, i: usize) -> anyhow::Result<f64> {
    Ok(record.get(i).unwrap_or_default().parse()?)
}

/// Equation 38 claims an error of at most 5 %.
fn angles() -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for r in records("liu_table3.csv")? {
        let (lower, upper) = (number(&r, 3)?, number(&r, 4)?);
        let from_upper = 0.65 * upper + 8.75;
        let error = (from_upper / lower - 1.0).abs();
        rows.push(Row::new(
            format!("{} mm beads, {} mm drum, fill {}", &r[0], &r[1], &r[2]),
            format!("lower {lower}, upper {upper} deg"),
            format!(
                "lower {from_upper:.2} ({:+.1} %), dynamic {:.2} deg",
                100.0 * (from_upper / lower - 1.0),
                0.5 * (lower + upper)
            ),
            error <= 0.05,
            if error <= 0.05 {
                "within the 5 % that equation 38 claims"
            } else {
                "outside the 5 % that equation 38 claims"
            },
        ));
    }
    Ok(rows)
}

const MM3: f64 = 1e9;

/// Relative difference below which a volume agrees: the printed uncertainty of glued spheres.
const VOLUME_TOLERANCE: f64 = 0.003;

fn particles() -> anyhow::Result<Vec<Row>> {
    let bead = Ball::new(3e-3)?;
    let (volume, mass) = (bead.volume(), bead.volume() * 2500.0);
    let coated = BiconvexTablet::new(4.00e-3, 2.25e-3, 9.64e-3)?;
    let coated_sd = coated.volume_sd(0.03e-3, 0.05e-3, 0.47e-3)?;
    let pressed = FlatTablet::new(4.00e-3, 2.90e-3)?;
    let pressed_sd = pressed.volume_sd(0.01e-3, 0.04e-3)?;
    let ring = |radius: f64, sphere: f64, middle: f64| RingTabletSpec {
        ring_spheres: 9,
        ring_radius: radius,
        sphere_radius: sphere,
        middle_radius: Some(middle),
    };
    let pressed_clump = ring(2.5e-3, 1.747e-3, 1.747e-3).build()?.union()?.volume;
    let coated_at = ring(2.5e-3, 1.87e-3, 2.3e-3);
    let coated_clump = coated_at.build()?.union()?.volume;
    let solved = coated_at.with_union_volume(167.03e-9)?;
    let near = |ours: f64, printed: f64| (ours / printed - 1.0).abs() < VOLUME_TOLERANCE;
    Ok(vec![
        Row::new(
            "bead, volume",
            "904.77 mm3",
            format!("{:.2} mm3", volume * MM3),
            near(volume * MM3, 904.77),
            "the diameter was used as the radius",
        ),
        Row::new(
            "bead, mass",
            "2.262 g",
            format!("{:.4} g", mass * 1e3),
            near(mass * 1e3, 2.262),
            "density times the volume above",
        ),
        Row::new(
            "coated tablet, volume from its dimensions",
            "165.91 ± 9.36 mm3",
            format!("{:.2} ± {:.2} mm3", coated.volume() * MM3, coated_sd * MM3),
            near(coated.volume() * MM3, 165.91),
            "band and two caps of the printed radius, height and crown radius; 165.91 needs another cap height",
        ),
        Row::new(
            "coated tablet, glued spheres",
            "167.03 mm3",
            format!("{:.2} mm3", coated_clump * MM3),
            near(coated_clump * MM3, 167.03),
            format!(
                "ring of 2.5 mm as in the program; the printed volume needs a ring of {:.3} mm",
                solved.ring_radius * 1e3
            ),
        ),
        Row::new(
            "coated tablet, mass",
            "0.225 g measured",
            format!("{:.4} g", 1350.0 * 167.03e-9 * 1e3),
            near(1350.0 * 167.03e-6, 0.225),
            "printed density times printed glued volume",
        ),
        Row::new(
            "pressed tablet, volume from its dimensions",
            "147.28 ± 2.12 mm3",
            format!("{:.2} ± {:.2} mm3", pressed.volume() * MM3, pressed_sd * MM3),
            near(pressed.volume() * MM3, 147.28),
            "147.28 needs a height of 2.93 mm",
        ),
        Row::new(
            "pressed tablet, glued spheres",
            "145.67 mm3",
            format!("{:.2} mm3", pressed_clump * MM3),
            near(pressed_clump * MM3, 145.67),
            "nine spheres on a ring of 2.5 mm and one in the middle",
        ),
        Row::new(
            "pressed tablet, mass",
            "0.15 g measured",
            format!("{:.4} g", 1030.0 * pressed_clump * 1e3),
            near(1030.0 * pressed_clump * 1e3, 0.15),
            "printed density times our glued volume",
        ),
    ])
}

fn plan() -> anyhow::Result<Vec<Row>> {
    let factors = [
        Factor::new("omega_rpm", 4.0, 30.0)?,
        Factor::new("mu_wall", 0.4, 0.8)?,
        Factor::new("mu_pp", 0.1, 0.9)?,
    ];
    let design = full_factorial(&factors, &[3, 3, 3])?.with_centre_points(2);
    let printed = records("plan_table8.csv")?;
    let mut equal = 0;
    for (r, point) in printed.iter().zip(&design.points) {
        let same = (0..3).all(|k| number(r, 3 + k).is_ok_and(|v| (v - point[k]).abs() < 1e-12));
        equal += usize::from(same);
    }
    let orders: Vec<f64> = printed.iter().map(|r| number(r, 2)).collect::<Result<_, _>>()?;
    let missing: Vec<usize> = (1..=30).filter(|k| !orders.contains(&(*k as f64))).collect();
    Ok(vec![
        Row::new(
            "settings in the printed order",
            format!("{} runs", printed.len()),
            format!("{equal} of {} equal", design.points.len()),
            equal == printed.len() && equal == design.points.len(),
            "3 x 3 x 3 levels, speed fastest, and two more centre points",
        ),
        Row::new(
            "run order",
            format!("1 to 30 without {missing:?}"),
            "a permutation of 1 to 29",
            missing.is_empty(),
            "a thirtieth run was dropped from the worksheet; N29 has no row in Tables 22 to 33",
        ),
    ])
}
