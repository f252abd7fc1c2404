//! No allocation in a step after warm-up.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

use dem_core::contact::kinematics::{Kinematics, PairGeometry};
use dem_core::contact::model::{ContactLaw, ContactResponse};
use dem_core::prelude::*;

use crate::scenes::{Model, Random, bead_material, drum, model};

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
    /// Whether the thread has computed a contact of a [`Marking`] law.
    static MARKED: Cell<bool> = const { Cell::new(false) };
}

/// Allocations of all marked threads.
static OF_MARKED: AtomicU64 = AtomicU64::new(0);

fn count() {
    // A thread that is being torn down has no counter any more.
    let _ = ALLOCATIONS.try_with(|a| a.set(a.get() + 1));
    if MARKED.try_with(Cell::get).unwrap_or(false) {
        OF_MARKED.fetch_add(1, Ordering::SeqCst);
    }
}

#[expect(unsafe_code, reason = "a global allocator is unsafe to write; this one only counts")]
// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn steps_and_list_builds_allocate_nothing_after_warm_up() {
    for threads in [1, 2] {
        let mut world = drum(500, 1.0, threads).build().unwrap();
        // Long enough that every buffer has seen its largest size: the bed has formed and turned.
        world.run(20_000).unwrap();
        let builds = world.list_builds();
        let before = ALLOCATIONS.get();
        world.run(4000).unwrap();
        assert_eq!(ALLOCATIONS.get() - before, 0, "{threads} threads");
        assert!(world.list_builds() > builds);
    }
}

/// A trough of 202 layers of a hundred beads, so many that steps go in sweeps.
fn trough(threads: usize) -> World<Model> {
    let mut b = WorldBuilder::new(2e-5);
    let bead = b.material(bead_material());
    b.pair_law(bead, bead, model(0.5, 0.8, 0.01));
    b.gravity(DVec3::NEG_Y * 9.81).threads(threads).skin(6e-4).allow_large_time_step();
    b.domain(DVec3::new(-0.03, -0.01, -0.01), DVec3::new(0.03, 0.06, 0.87));
    b.wall(Wall::plane(DVec3::ZERO, DVec3::Y, bead));
    b.wall(Wall::plane(DVec3::X * -0.0215, DVec3::X, bead));
    b.wall(Wall::plane(DVec3::X * 0.0215, DVec3::NEG_X, bead));
    b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, bead));
    b.wall(Wall::plane(DVec3::Z * 0.855, DVec3::NEG_Z, bead));
    let mut random = Random(9);
    for k in 0..20_200 {
        let (i, j, k) = (k % 10, k / 10 % 10, k / 100);
        let at = DVec3::new(i as f64 - 4.5, j as f64 + 0.6, k as f64 + 1.0) * 4.2e-3;
        b.sphere(Sphere::at(at + random.vector() * 1e-4, 2e-3, bead));
    }
    b.build().unwrap()
}

#[test]
fn sweeps_over_a_far_bed_allocate_nothing_after_warm_up() {
    for threads in [1, 2] {
        let mut world = trough(threads);
        world.run(5000).unwrap();
        let builds = world.list_builds();
        let before = ALLOCATIONS.get();
        world.run(1500).unwrap();
        assert_eq!(ALLOCATIONS.get() - before, 0, "{threads} threads");
        assert!(world.list_builds() > builds);
    }
}

/// The drum's law, which marks every thread that computes a contact.
#[derive(Clone, Copy)]
struct Marking(Model);

static MARKS: AtomicU64 = AtomicU64::new(0);

impl ContactLaw for Marking {
    type Memory = <Model as ContactLaw>::Memory;
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        memory: &mut Self::Memory,
    ) -> ContactResponse {
        if !MARKED.replace(true) {
            MARKS.fetch_add(1, Ordering::SeqCst);
        }
        self.0.respond(pair, motion, memory)
    }
    fn reach(&self, pair: &PairGeometry) -> f64 {
        self.0.reach(pair)
    }
}

#[test]
fn the_threads_of_a_team_allocate_nothing_either() {
    let mut b = WorldBuilder::new(2e-5);
    let bead = b.material(bead_material());
    b.pair_law(bead, bead, Marking(model(0.5, 0.8, 0.01)));
    b.gravity(DVec3::NEG_Z * 9.81).threads(2).allow_large_time_step();
    b.domain(DVec3::new(-0.1, -0.1, -0.01), DVec3::new(0.1, 0.1, 0.1));
    b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, bead));
    for k in 0..1200 {
        let (i, j) = (k % 35, k / 35);
        let p = DVec3::new(i as f64 * 4e-3 - 0.07, j as f64 * 4e-3 - 0.07, 1.9e-3);
        b.sphere(Sphere::at(p, 2.01e-3, bead));
    }
    let mut world = b.build().unwrap();
    world.run(4000).unwrap();
    let before = OF_MARKED.load(Ordering::SeqCst);
    // Until a worker was given a core, too.
    for _ in 0..200 {
        world.run(50).unwrap();
        if MARKS.load(Ordering::SeqCst) > 1 {
            break;
        }
    }
    world.run(1000).unwrap();
    assert!(MARKS.load(Ordering::SeqCst) > 1, "no worker took part");
    assert_eq!(OF_MARKED.load(Ordering::SeqCst), before);
}
