//! The deck for YADE 2023.02: constants, and a script that is the same for every drum.
//!
//! The mantle is a prism of many faces, one triangle each, turned by a `RotationEngine`; end plates are walls
//! with an angular velocity.
//!
//! YADE takes a facet for a sphere of twice the bead's radius, a wall for one of the same radius. (Its
//! option `hertzian` makes both flat, but with a radius of 1e8 beads, on which the limit of its rolling moment
//! depends.) So the walls have stand-ins for materials, whose numbers mean nothing by themselves: with the
//! beads' and YADE's radius they give the force of `E*` and `G*` of the pair on a flat wall. The script compares
//! both with what YADE made of them.
//!
//! Its rolling moment is a spring in the relative rotation, without damping, with the limit `eta Rm N` (none
//! where `N` is zero), `Rm` the mean of both radii: `mu_r R* N` of a constant torque for equal beads. The
//! coefficient is one for all pairs; at walls the script sets the limits, every ten steps.

use drum_rig::{Experiment, GRAVITY};
use rig_schema::Ends;

use super::scene::{Elastic, Scene};
use super::schedule::{Mark, Stages};
use super::{Code, DeckFile, dump_name};

/// The part that is the same for every drum.
const BODY: &str = include_str!("yade_drum.py");
/// Sagitta of a face of the mantle over the radius of the smallest bead.
const SAGITTA: f64 = 0.01;
/// Radius that YADE gives a bead's partner at the mantle and at end plates, in radii of the bead.
const PARTNER: [f64; 2] = [2.0, 1.0];
/// Rolling spring times the squared time step over a bead's moment of inertia, at most. There is no limit
/// where damping has cut the normal force to zero, at the end of an impact, and a stiff spring
/// seems to brake the beads there: four times as stiff, 300 beads at 60 rpm lay at 31.9 degrees, not 31.0.
const STIFFEST: f64 = 0.005;

pub(super) fn files(scene: &Scene, drum: &Experiment, plan: &Stages) -> Vec<DeckFile> {
    let text = format!("{}{BODY}", constants(scene, drum, plan));
    vec![DeckFile { name: Code::Yade.script().to_owned(), text }]
}

fn constants(scene: &Scene, drum: &Experiment, plan: &Stages) -> String {
    let grains = drum.grains();
    let radius = grains.equivalent_radius();
    let mass = grains.total_mass() / grains.len() as f64;
    let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
    for ball in drum.exposure().balls(grains) {
        smallest = smallest.min(ball.radius);
        largest = largest.max(ball.radius);
    }
    let (faces, sagitta) = prism(scene.radius, SAGITTA * smallest);
    let periodic = scene.ends == Ends::Periodic;
    // YADE does not bring beads back into the period: the faces reach over many.
    let reach = if periodic { 200.0 * scene.length } else { 0.5 * scene.length + 2.0 * largest };
    let [rolling, friction, restitution] =
        [scene.rolling, scene.friction, scene.restitution].map(|v| list(&v.all()));
    let moduli = [0, 1, 2].map(|k| scene.elastic[0].with(&scene.elastic[k]));
    let bead = scene.elastic[0];
    let materials =
        [bead, stand_in(&bead, moduli[1], PARTNER[0]), stand_in(&bead, moduli[2], PARTNER[1])];
    let mut s = format!(
        "# {}: rotating drum for YADE 2023.02, written by tumble {}: yade -n -j1 -x {}\n\
         # Axis z through the origin, y up; the bed rises at positive x. SI units.\n\
         # Lists: beads with each other, with the mantle, with the end plates.\n\
         # The mantle is a prism of {faces} faces with the mean radius of the drum; sagitta {:.2} %\n\
         # of the radius of the smallest bead.\n\
         # {}\n\
         # MATERIALS of the walls are stand-ins: YADE takes walls for spheres, with these the forces\n\
         # are those of PAIR_MODULI on flat walls.\n",
        scene.name,
        env!("CARGO_PKG_VERSION"),
        Code::Yade.script(),
        100.0 * sagitta / smallest,
        if scene.rolls {
            "Rolling: a spring for a constant torque, same limit (approximate)."
        } else {
            "No rolling resistance."
        },
    );
    let ends = match scene.ends {
        Ends::Turning => "turning",
        Ends::Still => "still",
        Ends::Periodic => "periodic",
    };
    let constants = [
        ("RADIUS", scene.radius.to_string()),
        ("LENGTH", scene.length.to_string()),
        ("ENDS", format!("\"{ends}\"")),
        ("FACES", faces.to_string()),
        ("SAGITTA", sagitta.to_string()),
        ("REACH", reach.to_string()),
        ("MATERIALS", list(&materials.map(|e| Pair(e.young, e.poisson)))),
        ("PAIR_MODULI", list(&moduli.map(|(e, g)| Pair(e, g)))),
        ("FRICTION", friction),
        ("RESTITUTION", restitution),
        ("ROLLING", rolling),
        ("ROLLING_SPRING", rolling_spring(scene, mass, radius, plan.dt).to_string()),
        ("MEAN_RADIUS", radius.to_string()),
        ("DRAG", (mass * scene.settling_drag()).to_string()),
        ("SETTLING_GRAVITY", vector(scene.settling_gravity)),
        ("GRAVITY", vector(scene.gravity)),
        ("TIME_STEP", plan.dt.to_string()),
        ("SETTLING_STEPS", plan.settling.to_string()),
    ];
    for (name, value) in constants {
        s.push_str(&format!("{name} = {value}\n"));
    }
    s.push_str("# Speed, rpm; rad/s; dump; steps to run and what happens then.\nSTAGES = [\n");
    for stage in &plan.stages {
        let marks: Vec<String> = stage
            .marks()
            .iter()
            .map(|(steps, mark)| {
                let what = match mark {
                    Mark::Frame => "frame",
                    Mark::HalfDrag => "half drag",
                    Mark::NoDrag => "no drag",
                };
                format!("({steps}, \"{what}\")")
            })
            .collect();
        s.push_str(&format!(
            "    ({}, {}, \"{}\", [{}]),\n",
            stage.speed_rpm,
            stage.omega,
            dump_name(stage.speed_rpm),
            marks.join(", ")
        ));
    }
    s.push_str("]\n");
    s
}

/// Two numbers, shown as a tuple.
struct Pair(f64, f64);

impl std::fmt::Display for Pair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "({}, {})", self.0, self.1)
    }
}

fn list(values: &[impl std::fmt::Display]) -> String {
    let shown: Vec<String> = values.iter().map(ToString::to_string).collect();
    format!("[{}]", shown.join(", "))
}

fn vector(v: drum_rig::dem_core::glam::DVec3) -> String {
    format!("({}, {}, {})", v.x, v.y, v.z)
}

/// Faces of the prism about a cylinder whose sagitta is at most that given, and the sagitta.
fn prism(radius: f64, at_most: f64) -> (u32, f64) {
    let half = (1.0 - at_most / radius).clamp(0.0, 1.0).acos();
    let faces = (std::f64::consts::PI / half).ceil().max(3.0);
    (faces as u32, radius * (1.0 - (std::f64::consts::PI / faces).cos()))
}

/// Rolling spring, N m/rad: the highest limit, at ten weights, within 0.002 rad.
fn rolling_spring(scene: &Scene, mass: f64, radius: f64, dt: f64) -> f64 {
    let [pp, mantle, end_plate] = scene.rolling.all();
    let arm = (0.5 * pp).max(mantle).max(end_plate) * radius;
    let inertia = 0.4 * mass * radius * radius;
    (arm * 10.0 * mass * GRAVITY / 2e-3).min(STIFFEST * inertia / (dt * dt))
}

/// Moduli of a wall that YADE combines with the beads' to the pair's `E*` and `G*`, where it takes
/// the wall for a sphere of `partner` radii of the bead.
///
/// With `f = sqrt(1 + 1/partner)`, the root of true over YADE's effective radius:
/// `1/(E* f) = (1 - nu_b^2)/E_b + (1 - nu_w)/(2 G_w)`, `1/(G* f) = (2 - nu_b)/G_b + (2 - nu_w)/G_w`.
fn stand_in(bead: &Elastic, (e_star, g_star): (f64, f64), partner: f64) -> Elastic {
    let f = (1.0 + 1.0 / partner).sqrt();
    let shear = bead.young / (2.0 * (1.0 + bead.poisson));
    let plane = 1.0 / (e_star * f) - (1.0 - bead.poisson * bead.poisson) / bead.young;
    let compliance = 1.0 / (g_star * f) - (2.0 - bead.poisson) / shear - 2.0 * plane;
    // No finite modulus gives a compliance of exactly zero.
    let least = 1e-8 / shear;
    let wall = 1.0 / if compliance.abs() < least { least } else { compliance };
    let poisson = 1.0 - 2.0 * plane * wall;
    Elastic { young: 2.0 * (1.0 + poisson) * wall, poisson }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stand_ins_give_the_moduli_of_the_pair() {
        let bead = Elastic { young: 6.5e5, poisson: 0.29 };
        // The last has a stand-in of almost no compliance as a sphere of the bead's radius.
        let walls = [
            bead,
            Elastic { young: 2e11, poisson: 0.265 },
            Elastic { young: 3e4, poisson: 0.48 },
            Elastic { young: bead.young / (2f64.sqrt() - 1.0), poisson: bead.poisson },
        ];
        for wall in walls {
            let (e_star, g_star) = bead.with(&wall);
            for partner in [1.0, 2.0, 1e9] {
                let s = stand_in(&bead, (e_star, g_star), partner);
                let root = (partner / (1.0 + partner)).sqrt();
                // As YADE combines them.
                let plane = |e: &Elastic| (1.0 - e.poisson * e.poisson) / e.young;
                let normal = root / (plane(&bead) + plane(&s));
                let shear = |e: &Elastic| 2.0 * (2.0 - e.poisson) * (1.0 + e.poisson) / e.young;
                let tangential = root / (shear(&bead) + shear(&s));
                assert!((normal / e_star - 1.0).abs() < 1e-7, "{wall:?} {partner}: {s:?}");
                assert!((tangential / g_star - 1.0).abs() < 1e-7, "{wall:?} {partner}: {s:?}");
            }
        }
        let same = stand_in(&bead, bead.with(&bead), 1e9);
        assert!((same.young / bead.young - 1.0).abs() < 1e-6, "{same:?}");
    }

    #[test]
    fn a_prism_keeps_its_sagitta() {
        let (faces, sagitta) = prism(0.03, 2e-5);
        assert!(sagitta <= 2e-5 && sagitta > 1.9e-5, "{faces}: {sagitta}");
        assert_eq!(prism(1.0, 2.0).0, 3);
    }
}
