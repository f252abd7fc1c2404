//! Neighbour lists lose no pair and no memory.

use dem_core::contact::cohesion::LinearCohesion;
use dem_core::prelude::*;

use crate::scenes::{Model, Random, bead_material, drum, model};

#[test]
fn a_small_skin_gives_the_trajectory_of_a_list_of_all_pairs() {
    let run = |skin: f64| {
        let mut w = drum(300, 1.5, 1).skin(skin).build().unwrap();
        w.run(2200).unwrap();
        w
    };
    let (listed, all) = (run(2e-4), run(0.2));
    assert_eq!(all.list_pairs(), 300 * 299 / 2);
    assert!(listed.list_builds() > 50 && all.list_builds() == 1);
    assert!(listed.contact_count() > 20, "{}", listed.contact_count());
    for id in listed.particles() {
        // The same contacts with the same memory: only the order of sums differs, rounding that
        // collisions amplify.
        assert!((listed.position(id) - all.position(id)).length() < 1e-8, "{id}");
        assert!((listed.spin(id) - all.spin(id)).length() < 1e-2, "{id}");
    }
}

#[test]
fn the_turning_frame_and_the_laboratory_frame_find_the_same_contacts() {
    let mut b = drum(400, 1.0, 1);
    let mut often = b.skin(1e-4).build().unwrap();
    let mut seldom = b.skin(1e-3).build().unwrap();
    for _ in 0..10 {
        often.run(100).unwrap();
        seldom.run(100).unwrap();
        let brute = (0..400u32)
            .flat_map(|i| (i + 1..400).map(move |j| (ParticleId(i), ParticleId(j))))
            .filter(|&(i, j)| {
                let d = (seldom.position(i) - seldom.position(j)).length();
                d < seldom.radius(i) + seldom.radius(j)
            })
            .count();
        assert_eq!(seldom.contact_count(), brute);
    }
    assert!(seldom.list_builds() < often.list_builds());
}

#[test]
fn beads_at_rest_list_no_pairs_for_the_sake_of_a_fast_one() {
    // A lattice with gaps of 0.3 mm, and a bead at 2 m/s that hits its middle 10 ms later.
    let run = |skin: f64| {
        let mut b = WorldBuilder::new(1e-5);
        let m = b.material(bead_material());
        b.pair_law(m, m, model(0.8, 0.3, 0.0)).skin(skin);
        b.domain(DVec3::splat(-0.1), DVec3::splat(0.1));
        for k in 0..125 {
            let at = DVec3::new((k % 5) as f64, (k / 5 % 5) as f64, (k / 25) as f64) - 2.0;
            b.sphere(Sphere::at(at * 6.3e-3, 3e-3, m));
        }
        let fast = Sphere::at(DVec3::new(1e-3, -4e-2, 1e-3), 3e-3, m);
        let fast = b.sphere(fast.with_velocity(DVec3::Y * 2.0));
        let mut w = b.build().unwrap();
        w.run(300).unwrap();
        (w, fast)
    };
    let ((mut listed, fast), (mut all, _)) = (run(1e-3), run(0.2));
    // Half a skin for two beads at rest together would list all 300 neighbours.
    assert_eq!((listed.list_pairs(), all.list_pairs()), (0, 126 * 125 / 2));
    listed.run(2000).unwrap();
    all.run(2000).unwrap();
    assert!(listed.velocity(fast).length() < 1.0, "{}", listed.velocity(fast));
    for id in listed.particles() {
        assert!((listed.position(id) - all.position(id)).length() < 1e-9, "{id}");
    }
}

#[test]
fn near_pairs_that_are_passed_over_change_no_bit() {
    // Who has been restored knows of no displacement and looks at all near pairs until the next list.
    for (ratio, skin) in [(1.0, 1e-3), (1.6, 2e-3)] {
        let world = || drum(400, ratio, 1).skin(skin).build().unwrap();
        let (mut sparing, mut state) = (world(), world().snapshot());
        for _ in 0..50 {
            sparing.run(60).unwrap();
            let mut looking = world();
            looking.restore(&state).unwrap();
            looking.run(60).unwrap();
            assert_eq!(sparing.state_hash(), looking.state_hash());
            state = looking.snapshot();
        }
        let (contacts, lists) = (sparing.contact_count(), sparing.list_builds());
        assert!(contacts > 50 && lists > 5, "{contacts}, {lists}");
    }
}

#[test]
fn cohesive_contacts_and_their_friction_survive_rebuilds() {
    // A sticky pair rides on a belt of rebuilds that a third, fast particle forces.
    let run = |with_runner: bool| {
        let mut b = WorldBuilder::new(1e-5);
        let m = b.material(bead_material());
        let law = model(0.5, 0.5, 0.0);
        let cohesion = LinearCohesion { energy_density: 1e6 };
        let law = ContactModel {
            normal: law.normal,
            tangential: law.tangential,
            rolling: law.rolling,
            cohesion,
        };
        b.pair_law(m, m, law).domain(DVec3::splat(-1.0), DVec3::splat(1.0));
        let a = b.sphere(Sphere::at(DVec3::ZERO, 3e-3, m).with_spin(DVec3::Z * 3.0));
        let c = b.sphere(Sphere::at(DVec3::X * 5.995e-3, 3e-3, m).with_velocity(DVec3::Y * 0.01));
        let v = DVec3::X * if with_runner { 4.0 } else { 0.0 };
        b.sphere(Sphere::at(DVec3::new(-0.9, 0.5, 0.0), 3e-3, m).with_velocity(v));
        let mut w = b.build().unwrap();
        w.run(20_000).unwrap();
        (w.position(a), w.spin(a), w.position(c), w.list_builds(), w.contact_count())
    };
    let (quiet, busy) = (run(false), run(true));
    assert!(quiet.3 < 10 && busy.3 > 500, "{} {}", quiet.3, busy.3);
    assert_eq!(quiet.4, 1);
    // The same bits: a rebuild copies what a contact remembers.
    assert_eq!((quiet.0, quiet.1, quiet.2), (busy.0, busy.1, busy.2));
}

#[test]
fn a_periodic_axis_joins_both_ends() {
    // A head-on collision across the boundary mirrors one in the middle.
    let run = |shift: f64| {
        let mut b = WorldBuilder::<Model>::new(1e-5);
        let m = b.material(bead_material());
        b.pair_law(m, m, model(0.4, 0.8, 0.01));
        b.domain(DVec3::splat(-0.05), DVec3::splat(0.05)).periodic(Axis::Z);
        let mut random = Random(2);
        let ids: Vec<_> = (0..20)
            .map(|k| {
                let z = -0.045 + 4.6e-3 * f64::from(k) + shift;
                let z = (z + 0.05).rem_euclid(0.1) - 0.05;
                let v = DVec3::Z * (random.next() - 0.5) * 0.5;
                b.sphere(
                    Sphere::at(DVec3::new(1e-4 * random.next(), 0.0, z), 2e-3, m).with_velocity(v),
                )
            })
            .collect();
        let mut w = b.build().unwrap();
        w.run(5000).unwrap();
        ids.into_iter().map(|i| (w.velocity(i), w.spin(i))).collect::<Vec<_>>()
    };
    let (here, there) = (run(0.0), run(0.0337));
    let moved = here.iter().filter(|(_, w)| w.length() > 1e-3).count();
    assert!(moved > 10, "collisions happen: {moved}");
    for ((v, w), (v2, w2)) in here.iter().zip(&there) {
        // Rounding of shifted coordinates (1e-17 m over 1e-6 m of overlap), amplified.
        assert!((*v - *v2).length() < 1e-6 && (*w - *w2).length() < 1e-2);
    }
}

#[test]
fn size_ratios_of_ten_lose_no_contact() {
    let mut w = drum(500, 10.0, 1).build().unwrap();
    for _ in 0..6 {
        w.run(500).unwrap();
        let all: Vec<_> = w.particles().collect();
        let mut brute = 0;
        for (k, &i) in all.iter().enumerate() {
            brute += all[k + 1..]
                .iter()
                .filter(|&&j| (w.position(i) - w.position(j)).length() < w.radius(i) + w.radius(j))
                .count();
        }
        assert_eq!(w.contact_count(), brute);
    }
}

/// A rod of seven spheres, 16 mm long.
fn rod(material: MaterialId) -> Clump {
    let spheres = (-3..=3)
        .map(|k| ClumpSphere { centre: DVec3::X * 2e-3 * f64::from(k), radius: 2e-3 })
        .collect();
    let inertia = DMat3::from_diagonal(DVec3::new(4e-10, 4e-9, 4e-9));
    ClumpSpec { spheres, mass: 2e-4, centre_of_mass: DVec3::ZERO, inertia, material }
        .try_into()
        .unwrap()
}

#[test]
fn a_clump_that_turns_on_the_spot_meets_its_neighbours() {
    // Its centre stays and its end sweeps over ten skins, until it strikes a bead, or a wall.
    let strikes = |with_wall: bool| {
        let mut b = WorldBuilder::<Model>::new(1e-5);
        let m = b.material(bead_material());
        b.pair_law(m, m, model(0.4, 0.8, 0.01)).skin(2e-4);
        b.domain(DVec3::splat(-0.05), DVec3::splat(0.05));
        let shape = b.clump_shape(rod(m));
        let (position, orientation) = (DVec3::ZERO, DQuat::IDENTITY);
        let (velocity, spin) = (DVec3::ZERO, DVec3::Z * 10.0);
        let turning = b.clump(PlacedClump { shape, position, orientation, velocity, spin });
        let bead =
            (!with_wall).then(|| b.sphere(Sphere::at(DVec3::new(2.5e-3, 7e-3, 0.0), 2e-3, m)));
        if with_wall {
            b.wall(Wall::plane(DVec3::Y * 7e-3, DVec3::NEG_Y, m));
        }
        let mut w = b.build().unwrap();
        w.run(15_000).unwrap();
        w.velocity(bead.unwrap_or(turning)).length()
    };
    // Tips of 60 mm/s: what they meet, or the rod itself, goes away with a good part of that.
    for with_wall in [false, true] {
        let speed = strikes(with_wall);
        assert!((5e-3..0.2).contains(&speed), "{with_wall}: {speed}");
    }
}

#[test]
fn clumps_move_by_a_small_skin_as_by_a_list_of_all_pairs() {
    let run = |skin: f64| {
        let mut b = WorldBuilder::<Model>::new(1e-5);
        let m = b.material(bead_material());
        b.pair_law(m, m, model(0.5, 0.6, 0.01)).skin(skin).gravity(DVec3::NEG_Y * 9.81);
        b.domain(DVec3::splat(-0.1), DVec3::splat(0.1));
        let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 8.0);
        b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, 30e-3, m).with_motion(turning));
        b.wall(Wall::plane(DVec3::NEG_Z * 15e-3, DVec3::Z, m));
        b.wall(Wall::plane(DVec3::Z * 15e-3, DVec3::NEG_Z, m));
        let shape = b.clump_shape(rod(m));
        let mut random = Random(11);
        for k in 0..27 {
            let place = DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9));
            let spin = random.vector() * 300.0;
            b.clump(PlacedClump {
                shape,
                position: (place - DVec3::ONE) * DVec3::new(16e-3, 12e-3, 10e-3),
                orientation: DQuat::from_rotation_y(0.5 * (random.next() - 0.5)),
                velocity: random.vector() * 0.1,
                spin,
            });
        }
        let mut w = b.build().unwrap();
        let mut contacts = 0;
        for _ in 0..80 {
            w.run(100).unwrap();
            contacts += w.contact_count();
        }
        (w, contacts)
    };
    // So far apart as this no two can come, however little of the skin is left to each.
    let (all, contacts) = run(1.0);
    assert_eq!(all.list_builds(), 1);
    assert!(contacts > 20, "{contacts}");
    for (skin, lists) in [(1e-4, 500), (1e-3, 50)] {
        let (listed, _) = run(skin);
        assert!(listed.list_builds() > lists, "{}", listed.list_builds());
        for id in listed.particles() {
            let apart = (listed.position(id) - all.position(id)).length();
            assert!(apart < 1e-8, "{skin}, {id}: {apart}");
        }
    }
}
