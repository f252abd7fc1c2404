//! Sweeps against one step after the other: bits, restarts and faults.

use super::MOST_STEPS;
use crate::prelude::*;
use crate::world::StripYield;

type Model = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;

fn model(material: &Material) -> Model {
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    let spec = HertzSpec { e_star: e / (2.0 * (1.0 - nu * nu)), restitution: 0.8 };
    let normal = HertzTailCut::try_from(spec).unwrap();
    ContactModel {
        normal,
        tangential: Mindlin {
            g_star: material.shear_modulus() / (2.0 * (2.0 - nu)),
            friction: Friction::coulomb(0.5).unwrap(),
            damping: normal.damping,
        },
        rolling: ConstantTorqueSpec { coefficient: RollingCoefficient::Ratio(0.01) }
            .try_into()
            .unwrap(),
        cohesion: Cohesionless,
    }
}

/// A tube of 44 by 506 mm that turns: some thirty beads in each of 120 layers, of which steps go in sweeps if it counts as far.
fn tube(far: usize, threads: usize, kernels: Kernels) -> World<Model> {
    let (length, radius) = (0.506, 0.022);
    let mut b = WorldBuilder::<Model>::new(2e-5);
    let bead = b.material(Material::from_shear_modulus(2.52e7, 0.29, 2500.0));
    let law = model(&Material::from_shear_modulus(2.52e7, 0.29, 2500.0));
    b.pair_law(bead, bead, law).gravity(DVec3::NEG_Y * 9.81).largest_overlap(0.2);
    b.threads(threads).kernels(kernels).allow_large_time_step();
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 9.0);
    b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, radius, bead).with_motion(turning));
    b.domain(DVec3::new(-0.03, -0.03, -0.01), DVec3::new(0.03, 0.03, length + 0.01));
    b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.03, bead));
    b.wall(Wall::disc(DVec3::Z * length, DVec3::NEG_Z, 0.03, bead));
    let mut state = 11u64;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    for k in 0..120 {
        for (i, j) in (0..9).flat_map(|i| (0..7).map(move |j| (i, j))) {
            let noise = DVec3::new(random(), random(), random());
            let at = DVec3::new(i as f64 - 4.0, j as f64 - 4.5, k as f64 + 0.5) * 4.2e-3;
            if at.truncate().length() < 0.0195 {
                let sphere = Sphere::at(at + noise * 1e-4, 2e-3, bead);
                b.sphere(sphere.with_velocity(noise * 0.2));
            }
        }
    }
    let mut world = b.build().unwrap();
    world.make.far = far;
    // Those of an even number of threads give memory back.
    world.make.large = if threads.is_multiple_of(2) { 0 } else { usize::MAX };
    world
}

/// No wall acts without a mark: steps leave the wrenches of those entries alone.
fn assert_walls_without_a_mark_do_nothing(world: &World<Model>) {
    let (list, w) = (&world.state.wall_list, &world.scratch.wrenches);
    let unmarked = (0..list.len()).filter(|e| list.active[*e] == 0);
    let of = |e: usize| [w.wall_force[e], w.wall_torque[e], w.wall_torque_on_wall[e]];
    let acts = unmarked.clone().find(|e| of(*e) != [crate::particles::Record::ZERO; 3]);
    assert!(acts.is_none(), "entry {acts:?} of {}: {:?}", list.len(), acts.map(of));
    assert!(unmarked.count() > list.len() / 10);
}

#[test]
fn sweeps_give_the_bits_of_one_step_after_the_other() {
    for kernels in [Kernels::Fastest, Kernels::Fused, Kernels::Portable] {
        let mut swept = tube(0, 1, kernels);
        let mut others = [
            tube(usize::MAX, 1, kernels),
            tube(0, 2, kernels),
            tube(0, 3, kernels),
            tube(0, 5, kernels),
            tube(usize::MAX, 3, kernels),
        ];
        for piece in 0..25 {
            swept.run(97).unwrap();
            for (nth, other) in others.iter_mut().enumerate() {
                other.run(97).unwrap();
                assert_eq!(swept.state_hash(), other.state_hash(), "{kernels:?} {piece} {nth}");
                assert_walls_without_a_mark_do_nothing(other);
            }
            assert_walls_without_a_mark_do_nothing(&swept);
        }
        assert_eq!(swept.scratch.tiers.len(), MOST_STEPS, "no sweep was made");
        assert_eq!(swept.step_number(), 25 * 97);
        let holds = |world: &World<Model>| !world.scratch.old_pairs.first.is_empty();
        assert!(holds(&swept) && !holds(&others[1]), "a large bed gives memory back");
        assert_eq!(swept.list_builds(), others[0].list_builds());
        assert!(2 * swept.contact_count() > swept.len(), "{}", swept.contact_count());
        // Observers see every wrench after the last step.
        assert!(swept.snapshot() == others[0].snapshot());
    }
}

#[test]
fn where_strips_are_cut_changes_no_bit() {
    let [mut alone, mut others @ ..] =
        [1, 2, 2, 3].map(|threads| tube(usize::MAX, threads, Kernels::Fastest));
    for piece in 0..20 {
        alone.run(97).unwrap();
        for (nth, other) in others.iter_mut().enumerate() {
            // As if one thread were slower than the others: another one each time.
            let strips = &mut other.scratch.strips;
            let slow = (piece + nth) % strips.count().max(1);
            let of = |k| if k == slow { 3.0 } else { 1.0 };
            let told: Vec<_> = (0..strips.count())
                .map(|k| StripYield { seconds: of(k), ..StripYield::default() })
                .collect();
            strips.note(&told);
            other.run(97).unwrap();
            assert_eq!(alone.state_hash(), other.state_hash(), "{piece} {nth}");
        }
    }
    assert!(alone.list_builds() > 5, "{}", alone.list_builds());
}

#[test]
fn a_restart_between_sweeps_changes_no_bit() {
    let mut straight = tube(0, 1, Kernels::Fastest);
    straight.run(1500).unwrap();
    let mut stopped = tube(0, 1, Kernels::Fastest);
    stopped.run(777).unwrap();
    let state = stopped.snapshot();
    // In a world that has gone on, nothing of its own is left.
    stopped.run(990).unwrap();
    let fresh = [0, usize::MAX].map(|far| tube(far, 1, Kernels::Fastest));
    for mut resumed in fresh.into_iter().chain([stopped]) {
        resumed.restore(&state).unwrap();
        resumed.run(1500 - 777).unwrap();
        assert_eq!(straight.state_hash(), resumed.state_hash());
        assert!(straight.snapshot() == resumed.snapshot());
    }
}

#[test]
fn single_steps_after_a_restart_share_out_the_walls_of_the_snapshot() {
    for threads in [1, 2] {
        let mut straight = tube(usize::MAX, threads, Kernels::Fastest);
        straight.run(200).unwrap();
        let mut resumed = straight.clone();
        resumed.run(1).unwrap();
        straight.run(1800).unwrap();
        // Those of the world that is restored are fewer.
        let entries = [&resumed, &straight].map(|world| world.state.wall_list.len());
        assert!(entries[0] < entries[1], "{entries:?}");
        resumed.restore(&straight.snapshot()).unwrap();
        for _ in 0..5 {
            straight.run(1).unwrap();
            resumed.run(1).unwrap();
        }
        assert_eq!(straight.state_hash(), resumed.state_hash(), "{threads}");
        assert!(straight.snapshot() == resumed.snapshot(), "{threads}");
    }
}

#[test]
fn a_fault_in_a_sweep_is_told_as_by_single_steps_and_leaves_the_world_there() {
    let mut found = Vec::new();
    for limit in [3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3] {
        let run = |far: usize, threads: usize| {
            let mut w = tube(far, threads, Kernels::Fastest);
            w.run(300).unwrap();
            w.make.overlap_limit = limit;
            (w.run(4000).map_err(|error| error.to_string()), w)
        };
        let ((told, swept), (expected, single)) = (run(0, 1), run(usize::MAX, 1));
        assert_eq!(told, expected);
        assert_eq!(told, run(0, 2).0);
        assert_eq!(swept.step_number(), single.step_number());
        // Observers see the near pairs and the walls of that step.
        assert!(swept.scratch.wrenches == single.scratch.wrenches, "{limit}");
        found.push(swept.scratch.tiers.iter().filter(|tier| tier.is_deep()).count());
        for mut world in [swept.clone(), single.clone()] {
            world.make.overlap_limit = 0.2;
            world.run(1).unwrap();
            assert_walls_without_a_mark_do_nothing(&world);
        }
        for p in single.particles() {
            let off = (swept.position(p) - single.position(p)).length();
            // Who went on by one step comes back to rounding; another one in a blow of 2000 m/s2 makes 8e-7 m.
            assert!(off < 1e-6, "{limit}, {p}: {off:e} m");
        }
    }
    assert!(found.iter().any(|deep| *deep > 0), "no fault in a sweep: {found:?}");
}

#[test]
fn after_a_fault_who_has_moved_on_turns_as_in_the_step_that_it_had_begun() {
    let mut moved_on = 0;
    for limit in [3e-3, 5e-3, 7e-3] {
        let run = |steps: u64| {
            let mut w = tube(usize::MAX, 1, Kernels::Fastest);
            w.run(300).unwrap();
            w.make.overlap_limit = limit;
            while w.run(steps).is_ok() {}
            w
        };
        let (together, mut apart) = (run(4000), run(1));
        assert_eq!(together.step_number(), apart.step_number());
        let team = apart.team.clone();
        team.enter(|| apart.move_bodies(crate::body_stage::Halves::Drift));
        for p in apart.particles() {
            let (b, other) = (&together.state.bodies, &apart.state.bodies);
            let [own, place] = [b, other].map(|b| b.place[p.0 as usize] as usize);
            let (now, then) = (other.spin[place].vector(), other.mean_spin[place].vector());
            if b.spin[own].vector() != now {
                assert_eq!(b.spin[own].vector(), then, "{limit}, {p}");
                assert_eq!(b.angular_acceleration[own].vector(), glam::DVec3::ZERO);
                moved_on += 1;
            }
        }
    }
    assert!(moved_on > 100, "only {moved_on} had moved on");
}
