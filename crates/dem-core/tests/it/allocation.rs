//! No allocation in a step after warm-up.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use crate::scenes::drum;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

#[expect(unsafe_code, reason = "a global allocator is unsafe to write; this one only counts")]
// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // A thread that is being torn down has no counter any more.
        let _ = ALLOCATIONS.try_with(|a| a.set(a.get() + 1));
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let _ = ALLOCATIONS.try_with(|a| a.set(a.get() + 1));
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn steps_and_list_builds_allocate_nothing_after_warm_up() {
    let mut world = drum(500, 1.0, 1).build().unwrap();
    // Long enough that every buffer has seen its largest size: the bed has formed and turned.
    world.run(20_000).unwrap();
    let builds = world.list_builds();
    let before = ALLOCATIONS.get();
    world.run(4000).unwrap();
    assert_eq!(ALLOCATIONS.get() - before, 0);
    assert!(world.list_builds() > builds + 20);
}
