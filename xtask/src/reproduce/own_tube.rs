//! The photographs by drums of 240 mm inside.

use std::fmt::Write as _;

use super::campaigns::Kept;
use super::markdown;
use super::materials::Material;
use super::own::{
    CONFIGS, TABLE_8_WALL, basis, calibrated, configuration, own_study_of, own_table,
};

/// Drums that are held against each other.
const DRUMS: [(Kept, &str, &str); 2] = [
    (Kept::Printed, "250 mm", "By our own runs in a drum of 250 mm inside"),
    (Kept::Tube, "240 mm", "By our own runs in a drum of 240 mm inside"),
];

/// What either diameter makes of the photographs, at the settings that both have; empty where the second was not simulated.
pub(super) fn section() -> anyhow::Result<String> {
    let fixtures = crate::root().join("fixtures");
    if !CONFIGS.iter().all(|name| fixtures.join(Kept::Tube.table(configuration(name))).exists()) {
        return Ok(String::new());
    }
    let (mut s, mut ties) = (String::from(HEAD), String::new());
    for (drum, diameter, title) in DRUMS {
        let mut studies = Vec::new();
        for name in CONFIGS {
            let mut simulated = own_table(name, drum)?;
            let both = own_table(name, Kept::Tube)?;
            simulated.rows.retain(|row| {
                both.rows.iter().any(|o| o.omega_rpm == row.omega_rpm && o.factors == row.factors)
            });
            let (case, study) = own_study_of(name, TABLE_8_WALL, simulated)?;
            let c = calibrated(name, "Tumble", basis(&case), &study)?;
            let _ = writeln!(s, "| {diameter} | {name} | {} |", c.cells());
            studies.push(study);
        }
        markdown::material(&mut ties, &Material::of(title, &studies)?);
    }
    Ok(s + &ties)
}

const HEAD: &str = "\n## In a drum of 240 mm inside\n\n\
    The same photographs by runs at the settings of Table 8 in the drum as printed and in one [whose tube measures 250 mm outside](own-dem-tube.md).\n\n\
    | inside | configuration | chi-square (dof) | rmse aor_lin, aor_mid (deg), cen_x, cen_y (% R) | friction.pp | friction.mantle |\n|---|---|---|---|---|---|\n";
