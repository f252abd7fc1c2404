//! Faults that users of other codes met, and the test here that would catch each.

use std::path::Path;

use anyhow::{Context, ensure};

/// A fault: where it was reported, what it was, and our test: (file, function).
pub(crate) struct Row {
    pub(crate) report: &'static str,
    pub(crate) fault: &'static str,
    pub(crate) file: &'static str,
    pub(crate) test: &'static str,
}

const WALLS: &str = "crates/dem-core/tests/it/walls.rs";

const ROWS: &[Row] = &[
    row(
        "lammps#4141",
        "moduli of walls and particles mixed differently",
        "crates/dem-validation/src/engine_restitution.rs",
        "mixed_moduli",
    ),
    row(
        "lammps#2812",
        "wall restitution other than asked",
        WALLS,
        "the_restitution_of_every_shape_of_wall_is_the_one_asked_for",
    ),
    row(
        "lammps#5007",
        "energy gained at grazing wall impact",
        "crates/dem-core/tests/it/conservation.rs",
        "grazing_wall_impacts_create_no_energy",
    ),
    row(
        "lammps#2196",
        "tangential history wrong under unloading",
        "crates/dem-core/src/contact/tangential/cycle_tests.rs",
        "mindlin_never_returns_more_work_than_it_took",
    ),
    row(
        "lammps#1631",
        "asking for output changes the trajectory",
        "crates/dem-core/tests/it/observers.rs",
        "observers_change_no_bit",
    ),
    row(
        "lammps#4060",
        "cohesive contacts lost when the list is rebuilt",
        "crates/dem-core/tests/it/lists.rs",
        "cohesive_contacts_and_their_friction_survive_rebuilds",
    ),
    row(
        "DEM-Engine#73",
        "mesh wall and analytic wall rebound differently",
        "crates/dem-core/tests/it/meshes.rs",
        "rebound_from_a_mesh_equals_that_from_a_plane_at_faces_edges_and_vertices",
    ),
    row(
        "lethe#1422",
        "end plates that do not turn with the drum",
        WALLS,
        "a_turning_end_plate_takes_its_particles_along",
    ),
    row(
        "yade!101",
        "wrong inertia of clumps",
        "crates/dem-shapes/tests/it/monte_carlo.rs",
        "volume_and_inertia_agree_with_monte_carlo_within_its_error",
    ),
    row(
        "lethe#632",
        "a coefficient accepted while its law is off (here a coefficient is a field of its law)",
        "crates/dem-core/src/contact/rolling/none.rs",
        "FreeRolling",
    ),
    row(
        "lethe#959",
        "moving walls not in the checkpoint",
        "crates/dem-core/tests/it/determinism.rs",
        "a_restart_goes_on_bit_by_bit_at_every_later_step",
    ),
    row(
        "musen",
        "rolling torque from absolute spin",
        "crates/dem-core/tests/it/conservation.rs",
        "turning_the_whole_system_turns_the_result",
    ),
];

const fn row(
    report: &'static str,
    fault: &'static str,
    file: &'static str,
    test: &'static str,
) -> Row {
    Row { report, fault, file, test }
}

/// The rows, after looking that each test is where it is said to be.
pub(crate) fn rows(root: &Path) -> anyhow::Result<&'static [Row]> {
    for row in ROWS {
        let text = std::fs::read_to_string(root.join(row.file)).with_context(|| row.file)?;
        ensure!(text.contains(row.test), "{} has no test {}", row.file, row.test);
    }
    Ok(ROWS)
}
