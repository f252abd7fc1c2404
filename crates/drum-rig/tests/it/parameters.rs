//! Every parameter of the namespace acts, or is refused.

use drum_rig::rig_schema::{Cohesion, Ends, Rig, RollingLaw, namespace::PHYSICS};
use drum_rig::{Error, Experiment, Options};

use crate::rigs::{small, turned_for, with, without};

/// A rig in which the parameter can act, and another value for it.
fn case(path: &str) -> (Rig, f64) {
    let rig = small(100);
    let law = |cohesion| {
        let mut rig = rig.clone();
        rig.contact.cohesion = cohesion;
        rig
    };
    match path {
        "friction.pp" | "friction.mantle" | "friction.end_plate" => (rig, 0.3),
        "friction.kinetic_ratio" => (rig, 0.5),
        "friction.decay_speed_m_s" => (with(&rig, &[("friction.kinetic_ratio", 0.5)]), 0.2),
        "rolling.pp" | "rolling.mantle" | "rolling.end_plate" => (rig, 0.05),
        "restitution.pp" | "restitution.mantle" | "restitution.end_plate" => (rig, 0.4),
        "stiffness.scale" => (rig, 0.7),
        "cohesion.surface_energy_j_m2" => (law(Cohesion::Jkr), 0.05),
        "cohesion.energy_density_j_m3" => (law(Cohesion::SimplifiedJkr), 1e3),
        "cohesion.liquid_fraction" => (law(Cohesion::Capillary), 1e-3),
        "cohesion.surface_tension_n_m" => {
            (with(&law(Cohesion::Capillary), &[("cohesion.liquid_fraction", 1e-3)]), 0.03)
        }
        "cohesion.wall_ratio" => {
            (with(&law(Cohesion::Jkr), &[("cohesion.surface_energy_j_m2", 0.05)]), 0.5)
        }
        "size.scale" => (rig, 0.98),
        "size.spread" => (rig, 0.02),
        "shape.aspect_ratio" => (rig, 1.1),
        "fill.count" => (rig, 99.0),
        "fill.mass_kg" => (without(&rig, "fill.count"), 0.008),
        "fill.scale" => (rig, 0.9),
        "axis.inclination_deg" => (rig, 2.0),
        "speed.scale" => (rig, 1.05),
        "vibration.amplitude_m" => (rig, 1e-4),
        "vibration.frequency_hz" => (with(&rig, &[("vibration.amplitude_m", 1e-4)]), 80.0),
        "wall_layer.thickness_m" => (rig, 5e-4),
        "wall_layer.friction_ratio" => (rig, 0.7),
        "drag.coefficient_s" => (rig, 0.5),
        "step.scale" => (rig, 0.9),
        other => panic!("no case for `{other}`: a new parameter needs one"),
    }
}

#[test]
fn every_physics_parameter_changes_the_motion_and_its_nominal_value_does_not() {
    for p in PHYSICS {
        let (rig, value) = case(p.path);
        let changed = turned_for(&with(&rig, &[(p.path, value)]), 0.1).state_hash();
        if p.path == "fill.mass_kg" {
            let other = turned_for(&with(&rig, &[(p.path, 0.007)]), 0.1).state_hash();
            assert_ne!(changed, other, "{}", p.path);
            continue;
        }
        let base = turned_for(&rig, 0.1).state_hash();
        assert_ne!(base, changed, "{} = {value} changes nothing", p.path);
        if let Some(nominal) = p.nominal
            && rig.settings.given(p.path).is_none()
        {
            let same = turned_for(&with(&rig, &[(p.path, nominal)]), 0.1).state_hash();
            assert_eq!(base, same, "{} at its nominal value {nominal}", p.path);
        }
    }
}

fn refused(rig: &Rig) -> Error {
    Experiment::new(rig, &Options::default()).expect_err("a rig that should be refused")
}

#[test]
fn a_parameter_that_cannot_act_is_an_error_that_says_why() {
    let rig = small(50);
    let mut periodic = rig.clone();
    periodic.drum.ends = Ends::Periodic;
    let mut free = without(&without(&rig, "rolling.pp"), "rolling.mantle");
    free.contact.rolling = RollingLaw::None;
    let vibration = with(&rig, &[("vibration.amplitude_m", 1e-4)]);
    for (rig, path, value) in [
        (&rig, "friction.decay_speed_m_s", 0.1),
        (&rig, "cohesion.surface_energy_j_m2", 0.1),
        (&rig, "cohesion.energy_density_j_m3", 1e3),
        (&rig, "cohesion.liquid_fraction", 1e-3),
        (&rig, "cohesion.surface_tension_n_m", 0.03),
        (&rig, "cohesion.wall_ratio", 0.5),
        (&rig, "vibration.frequency_hz", 20.0),
        (&vibration, "vibration.frequency_hz", 0.0),
        (&periodic, "friction.end_plate", 0.3),
        (&periodic, "rolling.end_plate", 0.3),
        (&periodic, "restitution.end_plate", 0.3),
        (&free, "rolling.pp", 0.1),
        (&free, "rolling.mantle", 0.1),
        (&free, "rolling.end_plate", 0.1),
    ] {
        match refused(&with(rig, &[(path, value)])) {
            Error::Inactive { path: named, because, .. } => {
                let expected = if value == 0.0 { "vibration.amplitude_m" } else { path };
                assert_eq!(named, expected);
                assert!(because.len() > 10);
            }
            other => panic!("{path}: {other}"),
        }
    }
}

#[test]
fn a_parameter_without_a_nominal_value_has_to_be_given() {
    for path in
        ["friction.pp", "friction.mantle", "restitution.pp", "restitution.mantle", "fill.count"]
    {
        match refused(&without(&small(50), path)) {
            Error::Missing { path: named, .. } => assert_eq!(named, path),
            other => panic!("{path}: {other}"),
        }
    }
}
