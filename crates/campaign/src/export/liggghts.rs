//! The deck for LIGGGHTS-PUBLIC 3.8.
//!
//! The mantle is a primitive cylinder: `shear` turns it about its own axis only if the direction named
//! is not that axis, and the number is then rad/s. It gives the wall the velocity of the bead's centre,
//! a radius nearer to the axis, so the rate is one at which the mean bead meets the mantle's own velocity.
//! End plates are meshes of two triangles each, since primitive planes can only slide; `surface_ang_vel`
//! turns the surface and leaves the triangles where they are. A change of speed declares the walls anew,
//! which drops the tangential springs at them: they are loaded again within a bead's slip, long before
//! the first frame.

use drum_rig::Experiment;
use rig_schema::Ends;

use super::scene::{PerPair, Scene};
use super::schedule::{Mark, Stages};
use super::{Code, DeckFile, dump_name};

/// The script and the meshes of the end plates.
pub(super) fn files(scene: &Scene, drum: &Experiment, plan: &Stages) -> Vec<DeckFile> {
    let mut files = vec![DeckFile {
        name: Code::Liggghts.script().to_owned(),
        text: script(scene, drum, plan),
    }];
    if scene.ends != Ends::Periodic {
        let half = 0.5 * scene.length;
        let reach = 1.2 * scene.radius;
        for (name, z, inward) in [("near", -half, 1.0), ("far", half, -1.0)] {
            files.push(DeckFile { name: format!("{name}.stl"), text: plate(z, reach, inward) });
        }
    }
    files
}

fn script(scene: &Scene, drum: &Experiment, plan: &Stages) -> String {
    let grains = drum.grains();
    let bead = grains.equivalent_radius();
    let mass = grains.total_mass() / grains.len() as f64;
    let model = model(scene);
    let along = if scene.ends == Ends::Periodic { "p" } else { "f" };
    let mut s = format!(
        "# {}: rotating drum for LIGGGHTS-PUBLIC 3.8, written by tumble {}.\n\
         # Axis z through the origin, y up; the bed rises at positive x. SI units.\n\
         # Types: 1 beads, 2 mantle, 3 end plates.\n\
         atom_style granular\natom_modify map array\nboundary f f {along}\nnewton off\n\
         communicate single vel yes\nunits si\nsoft_particles yes\nhard_particles yes\n\
         read_data start.data\nneighbor {} bin\nneigh_modify delay 0 every 1 check yes\n\n",
        scene.name,
        env!("CARGO_PKG_VERSION"),
        0.4 * bead
    );
    let types = |name: &str, values: [f64; 3]| {
        let [a, b, c] = values;
        format!("fix {name} all property/global {name} peratomtype {a} {b} {c}\n")
    };
    // Walls never meet each other: those entries are the wall's own.
    let pairs = |name: &str, v: &PerPair| {
        let [pp, m, e] = v.all();
        format!(
            "fix {name} all property/global {name} peratomtypepair 3 {pp} {m} {e} {m} {m} {m} {e} {m} {e}\n"
        )
    };
    s.push_str(&types("youngsModulus", scene.elastic.map(|e| e.young)));
    s.push_str(&types("poissonsRatio", scene.elastic.map(|e| e.poisson)));
    s.push_str(&pairs("coefficientRestitution", &scene.restitution));
    s.push_str(&pairs("coefficientFriction", &scene.friction));
    if scene.rolls {
        s.push_str(&pairs("coefficientRollingFriction", &scene.rolling));
    }
    if let Some(cohesion) = &scene.cohesion {
        s.push_str(&pairs("cohesionEnergyDensity", cohesion));
    }
    let limit = if scene.tail { "" } else { " limitForce on" };
    s.push_str(&format!(
        "pair_style gran {model}{limit}\npair_coeff * *\ntimestep {}\n\n\
         fix motion all nve/sphere\nthermo_style custom step atoms ke\nthermo 10000\n\
         thermo_modify lost error norm no\ncompute_modify thermo_temp dynamic yes\n\n",
        plan.dt
    ));
    s.push_str("# The bed settles in the standing drum, gravity tilted with it.\n");
    s.push_str(&gravity(scene.settling_gravity));
    let drag = mass * scene.settling_drag();
    s.push_str(&format!("fix drag all viscous {drag}\n"));
    s.push_str(&walls(scene, &model, limit, 0.0, bead));
    s.push_str(&format!("run {}\n", plan.settling));
    for (k, stage) in plan.stages.iter().enumerate() {
        s.push_str(&format!("\n# {} rpm\n", stage.speed_rpm));
        if k == 0 {
            s.push_str(&format!("unfix gravity\n{}", gravity(scene.gravity)));
        }
        s.push_str(&unwall(scene));
        s.push_str(&walls(scene, &model, limit, stage.omega, bead));
        let dump = dump_name(stage.speed_rpm);
        s.push_str(&format!("shell rm -f {dump}\n"));
        for (steps, mark) in stage.marks() {
            if steps > 0 {
                s.push_str(&format!("run {steps}\n"));
            }
            s.push_str(&match mark {
                Mark::Frame => format!(
                    "write_dump all custom {dump} id type x y z radius modify append yes format \"%d %d %.9g %.9g %.9g %.9g\"\n"
                ),
                Mark::HalfDrag => format!("unfix drag\nfix drag all viscous {}\n", 0.5 * drag),
                Mark::NoDrag => "unfix drag\n".to_owned(),
            });
        }
    }
    s
}

fn model(scene: &Scene) -> String {
    let cohesion = if scene.cohesion.is_some() { " cohesion sjkr" } else { "" };
    let rolling = if scene.rolls { " rolling_friction cdt" } else { "" };
    format!("model hertz tangential history{cohesion}{rolling}")
}

fn gravity(g: drum_rig::dem_core::glam::DVec3) -> String {
    let size = g.length();
    let d = g / size;
    format!("fix gravity all gravity {size} vector {} {} {}\n", d.x, d.y, d.z)
}

/// The walls, turning at `omega` rad/s, for beads of this radius.
fn walls(scene: &Scene, model: &str, limit: &str, omega: f64, bead: f64) -> String {
    let at_centre = omega * scene.radius / (scene.radius - bead);
    let mut s = format!(
        "fix mantle all wall/gran {model} primitive type 2 zcylinder {} 0. 0. shear x {at_centre}{limit}\n",
        scene.radius
    );
    if scene.ends == Ends::Periodic {
        return s;
    }
    let turns = scene.ends == Ends::Turning && omega != 0.0;
    for name in ["near", "far"] {
        let turn = if turns {
            format!(" surface_ang_vel origin 0. 0. 0. axis 0. 0. 1. omega {omega}")
        } else {
            String::new()
        };
        s.push_str(&format!("fix {name} all mesh/surface file {name}.stl type 3{turn}\n"));
    }
    s.push_str(&format!(
        "fix plates all wall/gran {model} mesh n_meshes 2 meshes near far{limit}\n"
    ));
    s
}

fn unwall(scene: &Scene) -> String {
    if scene.ends == Ends::Periodic {
        return "unfix mantle\n".to_owned();
    }
    "unfix plates\nunfix near\nunfix far\nunfix mantle\n".to_owned()
}

/// A square of two triangles at `z`, facing inward.
fn plate(z: f64, reach: f64, inward: f64) -> String {
    let (a, b, c, d) = ((-reach, -reach), (reach, -reach), (reach, reach), (-reach, reach));
    let mut text = String::from("solid plate\n");
    for (one, two, three) in [(a, b, c), (a, c, d)] {
        let corners = if inward > 0.0 { [one, two, three] } else { [one, three, two] };
        text.push_str(&format!("facet normal 0 0 {inward}\nouter loop\n"));
        for (x, y) in corners {
            text.push_str(&format!("vertex {x} {y} {z}\n"));
        }
        text.push_str("endloop\nendfacet\n");
    }
    text.push_str("endsolid plate\n");
    text
}
