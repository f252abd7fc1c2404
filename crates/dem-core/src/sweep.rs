//! Several steps in one sweep over a bed that no cache holds.
//!
//! Where one pass (`one_pass.rs`) goes, spheres behind its window have made their step, and those of the next step need
//! nothing but their neighbours: so the next step may follow a window behind, and another one behind that, and the records
//! that one of them has left in the cache are found there by the next. A bed is fetched from memory once for several
//! steps. Each of these *tiers* has its own walls, near pairs in action and sums. Within a tier near pairs and walls go
//! ahead of touching pairs, which finish spheres.
//!
//! Everything is computed from the same numbers in the same order as by one pass after the other: the bits are the same.
//! The list is asked whether it still holds only between sweeps (`World::list_holds`), with any number of threads.

use crate::body_run::{Run, cut_bodies};
use crate::body_stage::{Drift, Kick};
use crate::contact::model::ContactLaw;
use crate::contact_stage::{CHUNK, NearPairs, near_pairs, wall_contacts};
use crate::error::Error;
use crate::forces::{ChunkYield, DeepOverlap, Late, MemoryRun, deeper};
use crate::geometry::PlacedWall;
use crate::integrate::Integrator;
use crate::neighbour::verlet_list::PairList;
use crate::neighbour::wall_list::WallList;
use crate::one_pass::{Gone, Pass};
use crate::particles::{Bodies, Record};
use crate::spheres::SphereView;
use crate::step::{contacts_of, kernel_of};
use crate::sums::{Collect, LateEnds, PIECE, Ring};
use crate::threads::{Runs, cut};
use crate::world::{Make, Scratch, World, sphere_view};

/// Bodies above which a bed is far: what is needed next is asked for before it is, and several steps go in a sweep.
pub(crate) const FAR: usize = 20_000;
/// Steps of a sweep at most.
pub(crate) const MOST_STEPS: u64 = 4;
/// Bodies by which one tier goes on before the next follows: fewer in beds that are no far ones but by a test's word.
const STATION: usize = 1024;
/// Bodies between the first tier and the last at most: what the cache is to hold.
const IN_CACHE: usize = 24_000;

/// One step of a sweep.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tier {
    placed: Vec<PlacedWall>,
    late: Vec<Late>,
    late_ends: LateEnds,
    ring: Ring,
    /// Chunks of near pairs and of walls that are computed.
    near: usize,
    walls: usize,
    gone: Gone,
    /// The deepest of overlaps that are too deep, of near pairs and with walls.
    deep: [Option<DeepOverlap>; 2],
}

impl Tier {
    fn is_deep(&self) -> bool {
        self.gone.into.deep
    }

    /// Bodies before this place have made the step.
    fn finished(&self, bodies: usize) -> usize {
        (self.gone.piece * PIECE).min(bodies)
    }
}

/// What a sweep works on.
struct Bed<'a> {
    bodies: &'a mut Bodies,
    pairs: &'a PairList,
    /// Marks and memory of its pairs.
    active: &'a mut [u8],
    memory: &'a mut [f64],
    walls: &'a mut WallList,
    s: &'a mut Scratch,
}

/// What is the same for all tiers.
struct Sweep<'a, M: ContactLaw, I: Integrator> {
    world: &'a World<M, I>,
    near_window: usize,
}

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// How many steps may go in one sweep, as far as the cache and the threads let them.
    pub(crate) fn steps_in_a_sweep(&self) -> u64 {
        if self.len() <= self.make.far || self.team.threads() > 1 {
            return 1;
        }
        let station = STATION.min(self.len() / 16 + 1);
        let tier = self.state.pairs.window.max(self.scratch.near_window) + station;
        (IN_CACHE / tier).clamp(1, MOST_STEPS as usize) as u64
    }

    /// Contacts of so many steps, of which the list holds for all, each with its second half and the first half of the
    /// next one; returns whether after that the list may miss a pair.
    ///
    /// Where two overlap too deeply, the world is left at that step: who went ahead is put back by the velocity with which
    /// it moved last, which is off by what it was accelerated in a step where it had gone on by more than one.
    pub(crate) fn sweep(&mut self, steps: usize) -> Result<bool, Error> {
        let (begin, dt) = (self.state.step, self.make.dt);
        let mut pairs = std::mem::take(&mut self.state.pairs);
        let mut walls = std::mem::take(&mut self.state.wall_list);
        let mut bodies = std::mem::take(&mut self.state.bodies);
        let mut s = std::mem::take(&mut self.scratch);
        let mut tiers = std::mem::take(&mut s.tiers);
        let (mut active, mut memory) =
            (std::mem::take(&mut pairs.active), std::mem::take(&mut pairs.memory));
        let count = bodies.len();
        tiers.resize_with(tiers.len().max(steps), Tier::default);
        for (tier, step) in tiers.iter_mut().zip(begin..).take(steps) {
            tier.placed.clone_from(&s.placed);
            self.place_walls(&mut tier.placed, step as f64 * dt, dt);
            tier.late.clear();
            tier.late_ends.clear(count);
            tier.ring.cover(pairs.window, count);
            (tier.near, tier.walls, tier.deep) = (0, 0, [None; 2]);
            tier.gone = Gone::default();
        }
        s.make_room_for_a_sweep(&pairs, &walls);
        let sweep = Sweep { world: self, near_window: s.near_window };
        let mut bed = Bed {
            bodies: &mut bodies,
            pairs: &pairs,
            active: &mut active,
            memory: &mut memory,
            walls: &mut walls,
            s: &mut s,
        };
        let (mut goes_on, mut target) = (steps, 0);
        while tiers[goes_on - 1].finished(count) < count {
            target += STATION.min(count / 16 + 1);
            let mut limit = count;
            let mut nth = 0;
            while nth < goes_on {
                let tier = &mut tiers[nth];
                sweep.go(tier, begin + nth as u64, nth == 0, [limit, target], &mut bed);
                if tier.is_deep() {
                    // Steps after a fault are none.
                    goes_on = nth + 1;
                }
                limit = tier.finished(count);
                nth += 1;
            }
        }
        let last = &mut tiers[goes_on - 1];
        self.state.step = begin + goes_on as u64 - 1;
        std::mem::swap(&mut s.placed, &mut last.placed);
        let deepest = deeper(deeper(last.gone.deepest, last.deep[0]), last.deep[1]);
        let moved_far = last.gone.into.moved_far;
        if last.is_deep() {
            for tier in tiers[goes_on - 1..steps].iter().rev() {
                put_back(&mut bodies, tier.gone.into.drifted, dt);
            }
            if I::FROM_MEAN {
                let drifted = tiers[goes_on - 1].gone.into.drifted;
                let columns = cut_bodies(&mut bodies, PIECE);
                self.team.each(drifted, columns, |_, columns| Run::of(0, columns).recall(dt));
            }
            self.state.forces_stale = true;
        }
        for tier in &mut tiers[goes_on..] {
            // What went ahead of a fault has left sums behind.
            tier.ring = Ring::default();
        }
        s.tiers = tiers;
        (pairs.active, pairs.memory) = (active, memory);
        self.scratch = s;
        self.state.pairs = pairs;
        self.state.wall_list = walls;
        self.state.bodies = bodies;
        self.check_overlap(deepest).map(|()| moved_far)
    }
}

/// Move the bodies of so many pieces back by what they have moved last.
fn put_back(bodies: &mut Bodies, pieces: usize, dt: f64) {
    let end = (pieces * PIECE).min(bodies.len());
    for (x, v) in bodies.position[..end].iter_mut().zip(&bodies.mean_velocity) {
        x.add(v.vector() * -dt);
    }
}

impl Scratch {
    /// Have room for what the tiers compute.
    fn make_room_for_a_sweep(&mut self, pairs: &PairList, walls: &WallList) {
        let w = &mut self.wrenches;
        for v in [&mut w.wall_force, &mut w.wall_torque, &mut w.wall_torque_on_wall] {
            v.resize(walls.len(), Default::default());
        }
        self.pair_yield.resize_with(pairs.touching.div_ceil(CHUNK), Default::default);
        let near_chunks = pairs.near().len().div_ceil(CHUNK);
        if self.near_yield.len() < near_chunks {
            self.near_yield.resize_with(near_chunks + near_chunks / 4 + 1, ChunkYield::with_room);
        }
        self.near_yield[near_chunks..].iter_mut().for_each(ChunkYield::reset);
        self.wall_yield.resize_with(walls.len().div_ceil(CHUNK), Default::default);
        self.mesh_nearest.clear();
        self.moved.cover(pairs.touching_start.len() - 1);
        // Nothing is kept of what touches.
        self.keep_none();
    }
}

impl<M: ContactLaw + 'static, I: Integrator> Sweep<'_, M, I> {
    /// Go on with a tier, which is step number `step`, up to the owners at `target`; bodies before `limit` have
    /// made the step before it.
    fn go(
        &self,
        tier: &mut Tier,
        step: u64,
        is_first: bool,
        [limit, target]: [usize; 2],
        bed: &mut Bed<'_>,
    ) {
        let count = bed.bodies.len();
        let covered = self.near_and_walls(tier, [limit, target], bed);
        let pairs = bed.pairs;
        let chunks = pairs.touching.div_ceil(CHUNK);
        let mut until = tier.gone.chunk;
        let ready = |chunk: usize| {
            let owner = pairs.owner(chunk * CHUNK);
            owner <= target.min(covered) && (owner + pairs.window).min(count) <= limit
        };
        while until < chunks && ready(until) {
            until += 1;
        }
        let to_its_end = until == chunks && limit == count && covered == count;
        if until > tier.gone.chunk || to_its_end {
            self.pass(tier, step, is_first, (until, to_its_end), bed);
        }
    }

    /// Near pairs and walls; returns the place before which all spheres have all of theirs.
    fn near_and_walls(
        &self,
        tier: &mut Tier,
        [limit, target]: [usize; 2],
        bed: &mut Bed<'_>,
    ) -> usize {
        let Bed { bodies, pairs, active, memory, walls, s } = bed;
        let (make, members) = (&self.world.make, &self.world.state.members);
        let (count, near_begin, slots) = (bodies.len(), pairs.near_begin, pairs.slots);
        let spheres = sphere_view(bodies, members, false, make.dt);
        let context = contacts_of(make, spheres, &tier.placed, make.dt, false);
        let kernel = kernel_of(make, spheres, make.dt, false);
        let vector = kernel.as_ref().map(|kernel| (make.level, kernel));
        let near = pairs.near().len();
        let owner = loop {
            let begin = near_begin + tier.near * CHUNK;
            if begin >= near_begin + near {
                break count;
            }
            let owner = pairs.owner(begin);
            if owner > target || (owner + self.near_window).min(count) > limit {
                break owner;
            }
            let end = (begin + CHUNK).min(near_begin + near);
            let into = &mut s.near_yield[tier.near];
            let chunk = NearPairs {
                first: &pairs.first[begin..],
                second: &pairs.second[begin..],
                active: &mut active[begin..end],
            };
            let numbers = &mut memory[begin * slots..end * slots];
            let looks = s.near_order.looks(tier.near, near, &s.moved);
            near_pairs(&context, vector, looks, chunk, MemoryRun { slots, numbers }, into);
            for late in &into.late {
                tier.late.push(*late);
                tier.late_ends.push(late);
            }
            tier.deep[0] = deeper(tier.deep[0], into.deep.take());
            tier.near += 1;
        };
        let w = &mut s.wrenches;
        let sphere = loop {
            let begin = tier.walls * CHUNK;
            if begin >= walls.len() {
                break count;
            }
            let (end, first) = ((begin + CHUNK).min(walls.len()), walls.sphere[begin] as usize);
            if first > target || walls.sphere[end - 1] as usize >= limit {
                break first;
            }
            let into = &mut s.wall_yield[tier.walls..=tier.walls];
            let own = begin..end;
            let parts = (
                &mut walls.active[own.clone()],
                &mut walls.memory[begin * slots..end * slots],
                &mut w.wall_force[own.clone()],
                &mut w.wall_torque[own.clone()],
                &mut w.wall_torque_on_wall[own.clone()],
                &mut *into,
            );
            let (sphere, wall) = (&walls.sphere[own.clone()], &walls.wall[own]);
            wall_contacts(&context, vector, slots, sphere, wall, &[], parts);
            tier.deep[1] = deeper(tier.deep[1], into[0].deep.take());
            tier.walls += 1;
        };
        tier.gone.into.deep |= tier.deep.iter().any(Option::is_some);
        owner.min(sphere)
    }

    /// Touching pairs, and the bodies that they finish.
    fn pass(
        &self,
        tier: &mut Tier,
        step: u64,
        is_first: bool,
        until: (usize, bool),
        bed: &mut Bed<'_>,
    ) {
        let Bed { bodies, pairs, active, memory, walls, s } = bed;
        let world = self.world;
        let (make, members): (&Make<M>, _) = (&world.make, &world.state.members);
        let (dt, time) = (make.dt, step as f64 * make.dt);
        let count = bodies.len();
        let kick = Kick {
            make,
            members,
            collect: Collect {
                pairs: None,
                walls,
                w: &s.wrenches,
                late: (&tier.late, &tier.late_ends),
            },
            gravity: make.gravity.at(time),
            // Nobody books energies here.
            gravity_rate: glam::DVec3::ZERO,
            ledger: false,
            dt,
        };
        let drift = Drift {
            reference: &world.state.list.reference,
            frame: world.turn_since_list((step + 1) as f64 * dt),
            limit: (0.5 * make.skin).powi(2),
            dt,
        };
        let columns = cut_bodies(bodies, PIECE);
        let view = |column: usize| columns[column].view();
        let spheres = SphereView {
            position: view(0),
            mean_velocity: view(1),
            mean_spin: view(2),
            end_velocity: view(3),
            clumps: None,
        };
        let kernel = kernel_of(make, spheres, dt, false);
        let pass = Pass {
            context: contacts_of(make, spheres, &tier.placed, dt, false),
            vector: kernel.as_ref().map(|kernel| (make.level, kernel)),
            integrator: world.integrator,
            level: make.level,
            strips: &s.strips,
            pairs,
            bodies: count,
            kick: &kick,
            drift: &drift,
            // Later tiers find in the cache what the first has left there.
            far: is_first.then(|| [view(5), drift.reference.into()]),
            deep: false,
        };
        let (near_begin, slots) = (pairs.near_begin, pairs.slots);
        let mut kept: [[Record; 0]; 3] = [[]; 3];
        let mut chunks = (
            cut(&mut active[..near_begin], CHUNK),
            cut(&mut memory[..near_begin * slots], CHUNK * slots),
            kept.each_mut().map(|none| cut(&mut none[..], CHUNK)),
            cut(&mut s.pair_yield, 1),
        );
        let mut pieces = (columns, cut(&mut s.moved.square, 1));
        let left = [tier.gone.piece, count.div_ceil(PIECE)].map(|piece| piece as u32);
        let to_do = [tier.gone.chunk, until.0].map(|chunk| chunk as u32);
        let parts = (
            Runs::new(&mut pieces, &left),
            Runs::new(&mut chunks, &to_do),
            cut(std::slice::from_mut(&mut tier.ring), 1),
            cut(std::slice::from_mut(&mut tier.gone), 1),
        );
        world.team.each(1, parts, |strip, (mut bodies, mut chunks, ring, gone)| {
            pass.go(strip, &mut bodies, &mut chunks, &mut ring[0], &mut gone[0], until);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prelude::*;

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
        world
    }

    #[test]
    fn sweeps_give_the_bits_of_one_step_after_the_other() {
        for kernels in [Kernels::Fastest, Kernels::Fused, Kernels::Portable] {
            let mut swept = tube(0, 1, kernels);
            let mut others =
                [tube(usize::MAX, 1, kernels), tube(0, 2, kernels), tube(usize::MAX, 3, kernels)];
            for piece in 0..25 {
                swept.run(97).unwrap();
                for (nth, other) in others.iter_mut().enumerate() {
                    other.run(97).unwrap();
                    assert_eq!(swept.state_hash(), other.state_hash(), "{kernels:?} {piece} {nth}");
                }
            }
            assert_eq!(swept.scratch.tiers.len(), MOST_STEPS as usize, "no sweep was made");
            assert_eq!(swept.step_number(), 25 * 97);
            assert_eq!(swept.list_builds(), others[0].list_builds());
            assert!(2 * swept.contact_count() > swept.len(), "{}", swept.contact_count());
            // Observers see every wrench after the last step.
            assert_eq!(swept.snapshot(), others[0].snapshot());
        }
    }

    #[test]
    fn a_restart_between_sweeps_changes_no_bit() {
        let mut straight = tube(0, 1, Kernels::Fastest);
        straight.run(1500).unwrap();
        let mut stopped = tube(0, 1, Kernels::Fastest);
        stopped.run(777).unwrap();
        let state = stopped.snapshot();
        let mut resumed = tube(0, 1, Kernels::Fastest);
        resumed.restore(&state).unwrap();
        resumed.run(1500 - 777).unwrap();
        assert_eq!(straight.snapshot(), resumed.snapshot());
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
            found.push(swept.scratch.tiers.iter().filter(|tier| tier.is_deep()).count());
            for p in single.particles() {
                let off = (swept.position(p) - single.position(p)).length();
                // Who went on by one step comes back to rounding; another one in a blow of 2000 m/s2 makes 8e-7 m.
                assert!(off < 1e-6, "{limit}, {p}: {off:e} m");
            }
        }
        assert!(found.iter().any(|deep| *deep > 0), "no fault in a sweep: {found:?}");
    }
}
