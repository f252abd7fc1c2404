//! The deck for LAMMPS with the package GRANULAR.
//!
//! Mantle and end plates are regions that turn: the wall styles `zcylinder ... shear` add up the wall's
//! velocity over the beads and feed energy in. The constants of each pair are worked out here,
//! since a wall style of LAMMPS knows one material alone. The angle of the regions goes on without a jump from
//! speed to speed: LAMMPS takes the wall's velocity from its change.
//!
//! Damping is `coeff_restitution` (2024 and later): `tsuji` rebounds with 0.70 where 0.6 is asked for, since its
//! polynomial was made for the mass of a sphere and is given half of it.
//!
//! LAMMPS has no constant rolling torque. It is written as its spring-dashpot-slider with the same limit, `mu_r R N`,
//! and a spring that reaches the limit of ten weights within a thousandth of a radius.

use drum_rig::{Experiment, GRAVITY};
use rig_schema::Ends;

use super::scene::Scene;
use super::schedule::{Mark, Stages};
use super::{Code, DeckFile, dump_name};

/// Ratio of rolling damping to its spring, s.
const ROLLING_DAMPING_S: f64 = 1e-3;

pub(super) fn files(scene: &Scene, drum: &Experiment, plan: &Stages) -> Vec<DeckFile> {
    vec![DeckFile { name: Code::Lammps.script().to_owned(), text: script(scene, drum, plan) }]
}

/// The coefficients of one pair: beads with beads (0), mantle (1), end plates (2).
fn coefficients(scene: &Scene, drum: &Experiment, which: usize) -> String {
    let (e_star, g_star) = scene.elastic[0].with(&scene.elastic[which]);
    let grains = drum.grains();
    let rolling = scene.rolling.all()[which];
    let roll = if rolling > 0.0 {
        let weight = GRAVITY * grains.total_mass() / grains.len() as f64;
        let spring = rolling * 10.0 * weight / (1e-3 * grains.equivalent_radius());
        format!("sds {spring} {} {rolling}", ROLLING_DAMPING_S * spring)
    } else {
        "none".to_owned()
    };
    let limit = if scene.tail { "" } else { " limit_damping" };
    format!(
        "hertz {} {} tangential mindlin_rescale/force {} {} {} rolling {roll} damping coeff_restitution{limit}",
        4.0 / 3.0 * e_star,
        scene.restitution.all()[which],
        8.0 * g_star,
        // Tangential damping over normal damping: the root of the ratio of the tangents' stiffnesses.
        (4.0 * g_star / e_star).sqrt(),
        scene.friction.all()[which],
    )
}

fn script(scene: &Scene, drum: &Experiment, plan: &Stages) -> String {
    let grains = drum.grains();
    let diameter = 2.0 * grains.equivalent_radius();
    let mass = grains.total_mass() / grains.len() as f64;
    let along = if scene.ends == Ends::Periodic { "p" } else { "f" };
    let half = 0.5 * scene.length;
    let drag = mass * scene.settling_drag();
    let mut s = format!(
        "# {}: rotating drum for LAMMPS (package GRANULAR), written by tumble {}.\n\
         # Axis z through the origin, y up; the bed rises at positive x. SI units.\n\
         # {}\n\
         units si\natom_style sphere\nboundary f f {along}\nnewton off\ncomm_modify vel yes\n\
         read_data start.data\nneighbor {} bin\nneigh_modify delay 0 every 1 check yes\n\
         pair_style granular\npair_coeff * * {}\ntimestep {}\n\n",
        scene.name,
        env!("CARGO_PKG_VERSION"),
        if scene.rolls {
            "Rolling: spring-dashpot-slider for a constant torque, same limit (approximate)."
        } else {
            "No rolling resistance."
        },
        0.2 * diameter,
        coefficients(scene, drum, 0),
        plan.dt
    );
    // The mantle goes on beyond the box: its own ends are open.
    s.push_str(&format!(
        "variable angle equal 0.0*step\n\
         region mantle cylinder z 0 0 {} {} {} side in open 1 open 2 rotate v_angle 0 0 0 0 0 1\n\
         fix mantle all wall/gran/region granular {} region mantle\n",
        scene.radius,
        -3.0 * half,
        3.0 * half,
        coefficients(scene, drum, 1)
    ));
    if scene.ends != Ends::Periodic {
        let turn = if scene.ends == Ends::Turning { " rotate v_angle 0 0 0 0 0 1" } else { "" };
        for (name, z, inward) in [("near", -half, 1), ("far", half, -1)] {
            s.push_str(&format!(
                "region {name} plane 0 0 {z} 0 0 {inward}{turn}\n\
                 fix {name} all wall/gran/region granular {} region {name}\n",
                coefficients(scene, drum, 2)
            ));
        }
    }
    s.push_str(&format!(
        "fix motion all nve/sphere\nthermo_style custom step atoms ke\nthermo 10000\n\
         thermo_modify lost error norm no\n\n\
         # The bed settles in the standing drum, gravity tilted with it.\n{}\
         fix drag all viscous {drag}\nrun {}\n",
        gravity(scene.settling_gravity),
        plan.settling
    ));
    let (mut begun, mut angle) = (plan.settling, 0.0);
    for (k, stage) in plan.stages.iter().enumerate() {
        s.push_str(&format!("\n# {} rpm\n", stage.speed_rpm));
        if k == 0 {
            s.push_str(&format!("unfix gravity\n{}", gravity(scene.gravity)));
        }
        s.push_str(&format!(
            "variable angle equal {angle}+{}*(step-{begun})*{}\n",
            stage.omega, plan.dt
        ));
        let dump = dump_name(stage.speed_rpm);
        s.push_str(&format!("shell rm -f {dump}\n"));
        for (steps, mark) in stage.marks() {
            if steps > 0 {
                s.push_str(&format!("run {steps}\n"));
            }
            s.push_str(&match mark {
                Mark::Frame => format!(
                    "write_dump all custom {dump} id type x y z radius modify append yes format float %.9g\n"
                ),
                Mark::HalfDrag => format!("unfix drag\nfix drag all viscous {}\n", 0.5 * drag),
                Mark::NoDrag => "unfix drag\n".to_owned(),
            });
        }
        begun += stage.steps();
        angle += stage.omega * stage.steps() as f64 * plan.dt;
    }
    s
}

fn gravity(g: drum_rig::dem_core::glam::DVec3) -> String {
    let size = g.length();
    let d = g / size;
    format!("fix gravity all gravity {size} vector {} {} {}\n", d.x, d.y, d.z)
}
