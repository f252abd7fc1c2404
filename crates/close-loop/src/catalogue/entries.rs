//! Every entry of the catalogue, with strengths that suit the size of particles and drum.

use calib::attribution::Layer;
use rig_schema::{Cohesion, Rig, Shape};

use super::Needs;

/// Standard gravity, m/s2.
const G: f64 = 9.81;

/// An entry as it suits a rig, before the rig's own value is known.
pub(super) struct Draft<'a> {
    pub(super) path: &'static str,
    pub(super) layer: Layer,
    pub(super) probes: [f64; 2],
    pub(super) range: (f64, f64),
    pub(super) along: &'a [&'static str],
    pub(super) needs: Needs,
    pub(super) exposed_by: &'static str,
}

/// Cohesion energy density, J/m3, that pulls two particles together with the weight of one while
/// five weights press them.
fn energy_of_weight(rig: &Rig, diameter: f64) -> f64 {
    let Some(m) = rig.materials.get(&rig.particles.material) else { return 1e4 };
    let weight = m.density_kg_m3 * std::f64::consts::PI / 6.0 * diameter.powi(3) * G;
    let young = 2.0 * (1.0 + m.poisson_ratio) * m.shear_modulus_pa;
    let e_star = young / (2.0 * (1.0 - m.poisson_ratio.powi(2)));
    let r_star = 0.25 * diameter;
    // Hertz: F = 4/3 E* sqrt(R*) d^1.5; the contact area is that of the lens of two overlapping
    // spheres, pi d R*, to first order in the overlap d.
    let overlap = (3.75 * weight / (e_star * r_star.sqrt())).powf(2.0 / 3.0);
    weight / (2.0 * std::f64::consts::PI * r_star * overlap)
}

/// Drag coefficient of a lone sphere in air at the speed of a fall by the drum's radius, 1/s (Schiller and
/// Naumann; air of 1.2 kg/m3 and 18 uPa s).
pub(super) fn drag_in_air(rig: &Rig, diameter: f64) -> f64 {
    let density = rig.materials.get(&rig.particles.material).map_or(2500.0, |m| m.density_kg_m3);
    let (air, viscosity) = (1.2, 1.8e-5);
    let speed = (2.0 * G * rig.drum.radius_m).sqrt();
    let reynolds = air * speed * diameter / viscosity;
    18.0 * viscosity / (density * diameter.powi(2)) * (1.0 + 0.15 * reynolds.powf(0.687))
}

/// Every entry, with strengths that suit the size of particles and drum.
pub(super) fn drafts(rig: &Rig) -> Vec<Draft<'static>> {
    let diameter = match rig.particles.shape {
        Shape::Sphere(s) => s.diameter_m,
        Shape::RingTablet(t) => 2.0 * (t.ring_radius_m + t.sphere_radius_m),
    };
    let energy = |bond: f64| (bond * energy_of_weight(rig, diameter)).min(1e7);
    let amplitude = |gamma: f64| gamma * G / (std::f64::consts::TAU * 50.0).powi(2);
    let own = |path: &str, or: f64| rig.settings.value(path).unwrap_or(or);
    let rolling = own("rolling.pp", 0.0);
    let cohesion = own("cohesion.energy_density_j_m3", 0.0);
    let mantle = own("friction.mantle", 0.5);
    let plate = own("friction.end_plate", mantle);
    let restitution = own("restitution.pp", 0.8);
    let radius = rig.drum.radius_m;
    let drag = drag_in_air(rig, diameter);
    let physics = |path, probes, range, along: &'static [&'static str], needs, exposed_by| Draft {
        path,
        layer: Layer::Physics,
        probes,
        range,
        along,
        needs,
        exposed_by,
    };
    let camera = |path, probes, range, exposed_by| Draft {
        path,
        layer: Layer::Camera,
        probes,
        range,
        along: &[],
        needs: Needs::Nothing,
        exposed_by,
    };
    let reading = |path, unit: f64, range, exposed_by| Draft {
        path,
        layer: Layer::Measurement,
        probes: [-unit, unit],
        range,
        along: &[],
        needs: Needs::Nothing,
        exposed_by,
    };
    vec![
        physics(
            "rolling.pp",
            [rolling + 0.03, rolling + 0.1],
            (0.0, 0.5),
            &["rolling.mantle", "rolling.end_plate"],
            Needs::Rolling,
            "a bead rolling to rest on a plate of its own material",
        ),
        physics(
            "cohesion.energy_density_j_m3",
            [cohesion + energy(1.5), cohesion + energy(4.0)],
            (0.0, cohesion + energy(15.0)),
            &[],
            Needs::Cohesion(Cohesion::SimplifiedJkr),
            "larger beads of the same material, or a dried bed",
        ),
        physics(
            "friction.kinetic_ratio",
            [0.8, 0.6],
            (0.3, 1.0),
            &[],
            Needs::Nothing,
            "a sliding plate: force at the start against force while it slides",
        ),
        physics(
            "friction.mantle",
            [0.6 * mantle, 0.3 * mantle],
            (0.02, 2.0),
            &[],
            Needs::Nothing,
            "a bed that slides in a drum lined with another material",
        ),
        physics(
            "friction.end_plate",
            [0.4 * plate, (1.7 * plate).min(1.5)],
            (0.02, 2.0),
            &[],
            Needs::Nothing,
            "a drum of another length",
        ),
        physics("fill.scale", [0.88, 1.12], (0.6, 1.4), &[], Needs::Nothing, "weighing the bed"),
        physics(
            "size.scale",
            [0.85, 1.15],
            (0.7, 1.4),
            &[],
            Needs::Nothing,
            "a sieve or a caliper",
        ),
        physics("size.spread", [0.12, 0.25], (0.0, 0.4), &[], Needs::Nothing, "a sieve"),
        physics(
            "shape.aspect_ratio",
            [1.15, 1.4],
            (1.0, 2.0),
            &[],
            Needs::Nothing,
            "a look at the particles",
        ),
        physics(
            "restitution.pp",
            [(restitution - 0.2).max(0.2), (restitution - 0.4).max(0.15)],
            (0.1, 1.0),
            &["restitution.mantle", "restitution.end_plate"],
            Needs::Nothing,
            "a bead dropped on a plate",
        ),
        physics(
            "axis.inclination_deg",
            [-2.5, 2.5],
            (-10.0, 10.0),
            &[],
            Needs::Nothing,
            "turning the drum the other way round, or a spirit level",
        ),
        physics(
            "speed.scale",
            [0.8, 1.25],
            (0.5, 2.0),
            &[],
            Needs::Nothing,
            "counting the turns of the drum",
        ),
        physics(
            "vibration.amplitude_m",
            [amplitude(0.7), amplitude(2.0)],
            (0.0, amplitude(5.0)),
            &[],
            Needs::Nothing,
            "an accelerometer, or the drive switched off after a turn",
        ),
        physics(
            "wall_layer.thickness_m",
            [0.025 * radius, 0.06 * radius],
            (0.0, 0.15 * radius),
            &[],
            Needs::Nothing,
            "a look into the emptied drum",
        ),
        physics(
            "drag.coefficient_s",
            [3.0 * drag, 10.0 * drag],
            // Between many beads air resists more than about one; it turns with the drum, too.
            (0.0, 20.0 * drag),
            &[],
            Needs::Nothing,
            "the same drum at lower air pressure, or larger beads",
        ),
        physics(
            "stiffness.scale",
            [0.3, 3.0],
            (0.1, 10.0),
            &[],
            Needs::Nothing,
            "a simulation with stiffer particles",
        ),
        camera(
            "camera.roll_deg",
            [-2.0, 2.0],
            (-5.0, 5.0),
            "a plumb line in the picture, or turning the drum the other way round",
        ),
        camera(
            "camera.pitch_deg",
            [-3.0, 3.0],
            (-4.0, 4.0),
            "the ellipse of the ring, which shows more than 4 degrees",
        ),
        camera(
            "camera.yaw_deg",
            [-3.0, 3.0],
            (-4.0, 4.0),
            "the ellipse of the ring, which shows more than 4 degrees",
        ),
        reading("measure.offset_x_pct", 2.0, (-8.0, 8.0), "the circle drawn over the picture"),
        reading("measure.offset_y_pct", 2.0, (-8.0, 8.0), "the circle drawn over the picture"),
        reading("measure.bias_lin_deg", 2.0, (-8.0, 8.0), "the line drawn over the picture"),
        reading("measure.bias_mid_deg", 2.0, (-8.0, 8.0), "the line drawn over the picture"),
        Draft {
            probes: [0.97, 1.03],
            ..reading("measure.scale", 0.05, (0.94, 1.06), "a ruler in the picture")
        },
    ]
}
