//! Balance laws and effects whose sign or size is known beforehand.

use drum_rig::rig_schema::{Ends, RigidRing, Shape};
use drum_rig::{Coarsening, Error, Experiment, GRAVITY, Options, coarse};

use crate::rigs::{finished, small, turned_for, with, without};

fn quick() -> Options {
    Options { frame_interval_s: Some(0.1), ..Options::default() }
}

#[test]
fn the_torque_of_a_steady_drum_is_weight_times_offset() {
    let mut rig = small(150);
    rig.drum.ends = Ends::Periodic;
    rig.run.frames = 20;
    let (drum, sampled) = finished(&rig, &quick());
    let s = &sampled[0];
    let weight = drum.grains().total_mass() * GRAVITY;
    let expected = weight * s.centre_of_mass[0].mean;
    // The angular momentum of the bed about the axis does not grow: only its fluctuation over the
    // 2.5 s of sampling is left, below three standard errors of the torque.
    assert!(expected > 0.0);
    assert!(
        (s.torque.mean - expected).abs() < 3.0 * s.torque.error + 0.01 * expected,
        "{:?} against {expected}",
        s.torque
    );
    assert!((s.froude - 0.0537).abs() < 1e-4); // (40 rpm)^2 0.03 m / 9.81
    assert_eq!(s.frames.len(), 20);
    assert!(s.steady_from_s > s.turned_from_s && s.revolutions > 1.0);
}

#[test]
fn end_plates_that_turn_lift_the_bed_and_still_ones_hold_it_back() {
    let angle = |ends| {
        let mut rig = small(150);
        rig.drum.ends = ends;
        rig.run.frames = 60;
        finished(&rig, &quick()).1[0].angle_deg
    };
    let (turning, still) = (angle(Ends::Turning), angle(Ends::Still));
    let periodic = angle(Ends::Periodic);
    let clear =
        |a: drum_rig::Mean, b: drum_rig::Mean| a.mean - b.mean > 3.0 * a.error.hypot(b.error);
    assert!(clear(turning, still), "{turning:?} {still:?}");
    assert!(clear(turning, periodic), "{turning:?} {periodic:?}");
}

#[test]
fn a_drum_whose_far_end_is_lifted_gathers_its_bed_at_the_other() {
    let z = |degrees: f64| {
        let rig = with(&small(100), &[("axis.inclination_deg", degrees)]);
        turned_for(&rig, 0.5).centre_of_mass().z
    };
    let (down, level, up) = (z(15.0), z(0.0), z(-15.0));
    // tan(15 deg) of the bed's own length would be 3 mm; walls leave at least a tenth of it.
    assert!(down < level - 3e-4 && up > level + 3e-4, "{down} {level} {up}");
}

#[test]
fn diameters_have_the_asked_spread_and_mean() {
    let mut rig = small(4000);
    rig.drum.radius_m = 0.1;
    rig.drum.length_m = 0.1;
    rig.run.time_step_s = None;
    let drum = Experiment::new(&with(&rig, &[("size.spread", 0.08)]), &Options::default()).unwrap();
    let g = drum.grains();
    let n = g.len() as f64;
    let mean = (0..g.len()).map(|k| g.scale(k)).sum::<f64>() / n;
    let variance = (0..g.len()).map(|k| (g.scale(k) - mean).powi(2)).sum::<f64>() / (n - 1.0);
    // Standard errors: s/sqrt(n) = 0.0013 for the mean, s/sqrt(2 n) = 0.0009 for the deviation.
    assert!((mean - 1.0).abs() < 4.0 * 0.0013, "{mean}");
    assert!((variance.sqrt() - 0.08).abs() < 4.0 * 0.0009, "{}", variance.sqrt());
}

#[test]
fn particles_have_the_mass_of_their_form() {
    let mass = |rig| Experiment::new(&rig, &Options::default()).unwrap().grains().mass(0);
    let ball = 2500.0 * std::f64::consts::PI / 6.0 * 0.004f64.powi(3);
    assert!((mass(small(20)) / ball - 1.0).abs() < 1e-14);
    // A clump of the same volume; the union is exact to 1e-9.
    let rod = with(&small(20), &[("shape.aspect_ratio", 1.3)]);
    assert!((mass(rod) / ball - 1.0).abs() < 1e-8);
    let large = with(&small(20), &[("size.scale", 1.1)]);
    assert!((mass(large) / ball - 1.331).abs() < 1e-12);
    let mut weighed = small(20);
    weighed.particles.mass_kg = Some(9e-5);
    assert_eq!(mass(weighed), 9e-5);
    let mut tablet = small(20);
    tablet.particles.shape = Shape::RingTablet(RigidRing {
        ring_spheres: 9,
        sphere_radius_m: 1.747e-3,
        ring_radius_m: 2.5e-3,
        middle_radius_m: Some(1.747e-3),
    });
    tablet.materials.get_mut("glass").unwrap().density_kg_m3 = 1030.0;
    // 145.464 mm3 at 1030 kg/m3
    assert!((mass(tablet) - 1.49828e-4).abs() < 1e-8);
}

#[test]
fn a_fill_by_mass_is_met_to_half_a_particle() {
    let rig = with(
        &without(&small(1), "fill.count"),
        &[("fill.mass_kg", 0.01), ("fill.scale", 0.9), ("size.spread", 0.05)],
    );
    let drum = Experiment::new(&rig, &Options::default()).unwrap();
    let g = drum.grains();
    let left = g.total_mass() - 0.009;
    // The half of a particle up to 20 % larger than the mean one.
    assert!(left.abs() < 0.5 * 8.4e-5 * 1.2f64.powi(3), "{left}");
}

#[test]
fn tablets_and_rods_tumble_without_faults_and_stay_inside() {
    let mut tablet = small(40);
    tablet.drum.length_m = 0.03;
    tablet.run.time_step_s = Some(5e-5);
    tablet.particles.shape = Shape::RingTablet(RigidRing {
        ring_spheres: 9,
        sphere_radius_m: 1.747e-3,
        ring_radius_m: 2.5e-3,
        middle_radius_m: None,
    });
    let rods = with(&small(60), &[("shape.aspect_ratio", 2.0), ("size.spread", 0.05)]);
    for rig in [tablet, Rodded(rods).half_step()] {
        let drum = turned_for(&rig, 0.3);
        let exposure = drum.exposure();
        for b in exposure.balls(drum.grains()) {
            let rho = b.centre.x.hypot(b.centre.y);
            // Soft walls give way by a few percent of a radius.
            assert!(rho + b.radius < 0.03 + 0.1 * b.radius, "{rho}");
            assert!(b.centre.z.abs() + b.radius < 0.5 * rig.drum.length_m + 0.1 * b.radius);
        }
        assert_eq!(exposure.orientations.len(), drum.grains().len());
        assert!(drum.coordination().0 > 0.5);
    }
}

struct Rodded(drum_rig::rig_schema::Rig);

impl Rodded {
    /// Spheres of a rod are smaller than the ball of its volume.
    fn half_step(self) -> drum_rig::rig_schema::Rig {
        let mut rig = self.0;
        rig.run.time_step_s = Some(4e-5);
        rig
    }
}

#[test]
fn no_two_beads_overlap_at_the_start() {
    for values in [&[][..], &[("size.spread", 0.3)], &[("shape.aspect_ratio", 1.8)]] {
        let mut rig = with(&small(250), values);
        rig.run.time_step_s = Some(1e-5);
        let drum = Experiment::new(&rig, &Options::default()).unwrap();
        let balls: Vec<_> = drum.exposure().balls(drum.grains()).collect();
        for (k, a) in balls.iter().enumerate() {
            for b in balls[..k].iter().filter(|b| b.particle != a.particle) {
                assert!(a.centre.distance(b.centre) > a.radius + b.radius, "{values:?}");
            }
            assert!(a.centre.x.hypot(a.centre.y) + a.radius < 0.03);
        }
    }
}

#[test]
fn forces_of_particles_and_contacts_agree_with_their_weight() {
    // After the drag that damps the start has faded.
    let drum = turned_for(&small(100), 0.6);
    let particles = drum.particles();
    let force: f64 =
        drum.contacts().iter().map(|c| if c.other.is_none() { c.force.y } else { 0.0 }).sum();
    let total: f64 = particles.iter().map(|p| p.force.y).sum();
    // Without drag, forces between particles cancel: what is left comes from walls.
    assert!((force / total - 1.0).abs() < 1e-9, "{force} {total}");
    let counted: u32 = particles.iter().map(|p| p.contacts).sum();
    let (pairs, _) = drum.coordination();
    assert!((f64::from(counted) / 100.0 - pairs).abs() < 1e-12);
}

#[test]
fn a_coarse_stand_in_keeps_the_fill_and_the_share_of_the_rayleigh_time() {
    let mut rig = with(&small(400), &[("rolling.end_plate", 0.01)]);
    rig.drum.length_m = 0.06;
    let by = Coarsening { size: 1.25, diameters: 8.0 };
    let short = coarse(&rig, by).unwrap();
    let volume = |r: &drum_rig::rig_schema::Rig| {
        let g = Experiment::new(r, &Options::default()).unwrap();
        g.grains().solid_volume() / r.drum.length_m
    };
    // The count is rounded to a whole bead of some 136.
    assert!((volume(&short) / volume(&rig) - 1.0).abs() < 0.5 / 130.0);
    assert_eq!(short.drum.length_m, 0.04);
    assert_eq!(short.run.time_step_s, Some(1e-4));
    // A drum that is no longer than the slice keeps its ends.
    rig.drum.length_m = 0.035;
    let whole = coarse(&with(&rig, &[("axis.inclination_deg", 1.0)]), by).unwrap();
    assert_eq!((whole.drum.length_m, whole.drum.ends), (0.035, rig.drum.ends));
    assert_eq!(whole.settings.given("rolling.end_plate"), Some(0.01));
    rig.drum.length_m = 0.06;
    let refused = coarse(&with(&rig, &[("axis.inclination_deg", 1.0)]), by);
    assert!(matches!(refused, Err(Error::Contradiction { .. })));
}

#[test]
fn a_stand_in_is_as_fine_as_a_number_of_particles_allows() {
    let mut rig = small(30_000);
    rig.drum.radius_m = 0.042;
    rig.drum.length_m = 0.02;
    if let drum_rig::rig_schema::Shape::Sphere(s) = &mut rig.particles.shape {
        s.diameter_m = 0.0012;
    }
    // 30 000 / 2.25^3 = 2634 in the whole length (8 x 2.7 mm is longer), / 2.5^3 = 1920.
    let by = Coarsening::default().until(&rig, 2000).unwrap();
    assert_eq!(by.size, 2.5);
    assert!(!by.cuts(&rig));
    // Slices of 8 x 1.8 mm hold 30 000 x 0.72 / 1.5^3 = 6400.
    let fine = Coarsening::default().until(&rig, 7000).unwrap();
    assert_eq!(fine.size, 1.5);
    assert!(fine.cuts(&rig));
    // Not beyond a tenth of the radius.
    rig.drum.radius_m = 0.028;
    assert_eq!(Coarsening::default().until(&rig, 100).unwrap().size, 2.25);
}

#[test]
fn much_damped_and_cohesive_grains_take_shorter_steps_of_their_own() {
    let step = |restitution: f64, cohesive: bool| {
        let mut rig = with(&small(100), &[("restitution.pp", restitution)]);
        rig.run.time_step_s = None;
        if cohesive {
            rig.contact.cohesion = drum_rig::rig_schema::Cohesion::SimplifiedJkr;
        }
        drum_rig::outline(&rig, &Options::default()).unwrap().time_step_s
    };
    // Damping ratios of restitution 0.9, 0.5 and 0.15: 0.034, 0.215 and 0.517.
    assert_eq!(step(0.9, false), step(0.5, false));
    assert!((step(0.15, false) / step(0.9, false) - 0.25 / 0.517).abs() < 1e-3);
    assert!((step(0.9, true) / step(0.9, false) - 0.7).abs() < 1e-12);
}
