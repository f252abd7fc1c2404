//! Threads: fixed chunks of work, so that results do not depend on how many threads share them.
//!
//! A team lives as long as its world. Its workers wait for the next stage in a loop for half a
//! millisecond, then sleep; between two calls of `run` they sleep at once. A stage is a number
//! of chunks. Every thread takes chunks from its own share first, then from those of others, and
//! the stage is over when all chunks are done: nobody waits for a thread that was given no core.
//! The thread that calls waits likewise: first in a loop, then asleep.
#![expect(unsafe_code, reason = "chunks of one slice go to several threads, each exactly once")]

mod cut;

use std::cell::UnsafeCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock};
use std::thread::{JoinHandle, Thread};
use std::time::{Duration, Instant};

pub(crate) use cut::{
    Chunks, Cut, CutJoined, Groups, InTurn, NO_PARTS, PART, Runs, View, cells, chosen, cut,
    cut_groups, cut_groups_of, part,
};

/// How long a thread looks for the next stage before it sleeps: longer than what one thread does alone while a list of some thousand bodies
/// is made, since waking takes some tens of microseconds, as long as a good part of the search.
const PATIENCE: Duration = Duration::from_micros(500);

/// Work on `count` chunks.
pub(crate) struct Stage<'s, C, F> {
    pub(crate) count: usize,
    /// First chunk of the share of each thread and the end of the last one's, if they are not as large as each other.
    pub(crate) shares: &'s [u32],
    pub(crate) parts: C,
    /// Called with the number of the chunk and the chunk.
    pub(crate) work: F,
}

/// Every thread has as many chunks.
pub(crate) const EVEN: &[u32] = &[];

/// A stage, whatever it works on.
pub(crate) trait Work: Sync {
    fn count(&self) -> usize;
    /// First chunk of the share of each thread and the end of the last one's; nothing where all have as many.
    fn shares(&self) -> &[u32];
    /// # Safety
    /// Each `k` below the count is done at most once.
    unsafe fn chunk(&self, k: usize);
}

impl<C: Cut, F: Fn(usize, C::Part) + Sync> Work for Stage<'_, C, F> {
    fn count(&self) -> usize {
        self.count
    }

    fn shares(&self) -> &[u32] {
        self.shares
    }

    #[inline]
    unsafe fn chunk(&self, k: usize) {
        // SAFETY: by the caller.
        (self.work)(k, unsafe { self.parts.part(k) });
    }
}

/// The threads of one world; one thread means that everything runs on the caller's.
#[derive(Debug, Clone, Default)]
pub(crate) struct Team {
    crew: Option<Arc<Crew>>,
}

impl Team {
    /// A team of `threads`, fewer where the system gives no more.
    pub(crate) fn new(threads: usize) -> Self {
        Self { crew: (threads > 1).then(|| Crew::new(threads)).flatten().map(Arc::new) }
    }

    /// How many they are.
    pub(crate) fn threads(&self) -> usize {
        self.crew.as_ref().map_or(1, |crew| crew.shared.shares.len())
    }

    /// Run `work`, in which the team is awake.
    pub(crate) fn enter<R>(&self, work: impl FnOnce() -> R) -> R {
        let _awake = self.crew.as_ref().map(|crew| crew.wake());
        work()
    }

    /// Do all chunks of all stages, which must not depend on each other.
    pub(crate) fn run(&self, stages: &[&dyn Work]) {
        match &self.crew {
            Some(crew) => crew.run(stages),
            None => run_alone(stages),
        }
    }

    /// Do all chunks of one stage.
    pub(crate) fn each<C: Cut>(
        &self,
        count: usize,
        parts: C,
        work: impl Fn(usize, C::Part) + Sync,
    ) {
        self.run(&[&Stage { count, shares: EVEN, parts, work }]);
    }

    /// Whether something holds for all chunks.
    pub(crate) fn all(&self, count: usize, holds: impl Fn(usize) -> bool + Sync) -> bool {
        let fails = AtomicBool::new(false);
        self.each(count, NO_PARTS, |c, ()| {
            if !holds(c) {
                fails.store(true, Ordering::Relaxed);
            }
        });
        !fails.into_inner()
    }

    /// The largest number that a chunk yields; zero if none is larger.
    pub(crate) fn largest(&self, count: usize, of: impl Fn(usize) -> f64 + Sync) -> f64 {
        // Numbers that are not negative are in the order of their bits.
        let largest = AtomicU64::new(0);
        self.each(count, NO_PARTS, |c, ()| {
            largest.fetch_max(of(c).max(0.0).to_bits(), Ordering::Relaxed);
        });
        f64::from_bits(largest.into_inner())
    }
}

fn run_alone(stages: &[&dyn Work]) {
    for stage in stages {
        for k in 0..stage.count() {
            // SAFETY: each chunk once.
            unsafe { stage.chunk(k) };
        }
    }
}

/// What is left of one thread's share, in one word, so that a chunk can be claimed only in its
/// round: from the top 24 bits of the round, 20 of the end, 20 of the next chunk.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Share(AtomicU64);

/// Bits of the number of a chunk.
const BITS: u32 = 20;
/// Most chunks of a round.
const MOST: usize = (1 << BITS) - 1;
/// Rounds are counted to here and on from 0.
const ROUNDS: u64 = 1 << 24;

impl Share {
    fn open(&self, round: u64, next: usize, end: usize) {
        let word = round << (2 * BITS) | (end as u64) << BITS | next as u64;
        self.0.store(word, Ordering::Release);
    }

    /// Claim the next chunk of this round, if there is one; the error tells whether the round is
    /// over.
    fn claim(&self, round: u64) -> Result<usize, bool> {
        let mut word = self.0.load(Ordering::Acquire);
        loop {
            let (next, end) = (word as usize & MOST, (word >> BITS) as usize & MOST);
            if word >> (2 * BITS) != round {
                return Err(true);
            }
            if next >= end {
                return Err(false);
            }
            let claim =
                self.0.compare_exchange_weak(word, word + 1, Ordering::AcqRel, Ordering::Acquire);
            match claim {
                Ok(_) => return Ok(next),
                Err(now) => word = now,
            }
        }
    }
}

/// A worker that may sleep.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Bed {
    asleep: AtomicBool,
    thread: OnceLock<Thread>,
}

/// The stages of the present round. The lifetimes are those of the call of `Crew::run`.
#[derive(Debug)]
struct Round(UnsafeCell<*const [&'static dyn Work]>);

// SAFETY: written by the calling thread while no chunk is claimed, read only by who claimed one.
unsafe impl Sync for Round {}
// SAFETY: likewise; the pointer is followed only while the call that set it lasts.
unsafe impl Send for Round {}

type Payload = Box<dyn std::any::Any + Send>;

#[derive(Debug)]
struct Shared {
    /// Number of the present round.
    round: AtomicU64,
    stages: Round,
    chunks: AtomicUsize,
    shares: Vec<Share>,
    done: AtomicUsize,
    /// Workers of a world that rests sleep at once.
    awake: AtomicBool,
    stop: AtomicBool,
    /// What a chunk panicked with.
    panic: Mutex<Option<Payload>>,
    beds: Vec<Bed>,
    /// Whether the calling thread sleeps, and which one it is.
    caller_sleeps: AtomicBool,
    caller: Mutex<Option<Thread>>,
    /// Whether waiting in a loop can help: not with more threads than cores.
    patient: bool,
}

#[derive(Debug)]
struct Crew {
    shared: Arc<Shared>,
    workers: Vec<JoinHandle<()>>,
    /// Held by the world that runs; a clone of it that runs meanwhile runs on its own thread.
    busy: AtomicBool,
    owner: Mutex<Option<std::thread::ThreadId>>,
}

/// The team is awake while this lives.
struct Awake<'a> {
    crew: &'a Crew,
    mine: bool,
}

impl Drop for Awake<'_> {
    fn drop(&mut self) {
        if self.mine {
            self.crew.shared.awake.store(false, Ordering::SeqCst);
            if let Ok(mut owner) = self.crew.owner.lock() {
                *owner = None;
            }
            self.crew.busy.store(false, Ordering::Release);
        }
    }
}

impl Crew {
    fn new(threads: usize) -> Option<Self> {
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
        let mut shared = Shared {
            round: AtomicU64::new(0),
            stages: Round(UnsafeCell::new(&[])),
            chunks: AtomicUsize::new(0),
            shares: Vec::new(),
            done: AtomicUsize::new(0),
            awake: AtomicBool::new(false),
            stop: AtomicBool::new(false),
            panic: Mutex::new(None),
            beds: Vec::new(),
            caller_sleeps: AtomicBool::new(false),
            caller: Mutex::new(None),
            patient: threads <= cores,
        };
        shared.shares.resize_with(threads, Share::default);
        shared.beds.resize_with(threads, Bed::default);
        let shared = Arc::new(shared);
        let workers: Vec<_> = (1..threads)
            .map_while(|own| {
                let shared = shared.clone();
                let name = format!("dem-core {own}");
                std::thread::Builder::new().name(name).spawn(move || shared.serve(own)).ok()
            })
            .collect();
        // Shares of threads that did not start are taken by the others.
        (!workers.is_empty()).then(|| Self {
            shared,
            workers,
            busy: AtomicBool::new(false),
            owner: Mutex::new(None),
        })
    }

    fn wake(&self) -> Awake<'_> {
        let mine = !self.busy.swap(true, Ordering::Acquire);
        if mine {
            let current = std::thread::current();
            if let Ok(mut owner) = self.owner.lock() {
                *owner = Some(current.id());
            }
            if let Ok(mut caller) = self.shared.caller.lock() {
                *caller = Some(current);
            }
            self.shared.awake.store(true, Ordering::SeqCst);
        }
        Awake { crew: self, mine }
    }

    fn is_mine(&self) -> bool {
        let own = std::thread::current().id();
        self.busy.load(Ordering::Acquire) && self.owner.lock().is_ok_and(|o| *o == Some(own))
    }

    fn run(&self, stages: &[&dyn Work]) {
        let chunks: usize = stages.iter().map(|s| s.count()).sum();
        if !(2..=MOST).contains(&chunks) || !self.is_mine() {
            return run_alone(stages);
        }
        let s = &*self.shared;
        let disjoint = stages.iter().all(|stage| stage.shares().is_sorted());
        assert!(disjoint, "two threads have one chunk in their shares");
        // SAFETY: the lifetime is forgotten, but no chunk is claimed after this call returns.
        let stages: *const [&'static dyn Work] = unsafe {
            std::mem::transmute::<*const [&dyn Work], *const [&'static dyn Work]>(stages)
        };
        let round = s.round.load(Ordering::Relaxed).wrapping_add(1) % ROUNDS;
        // SAFETY: all chunks of the last round are done, so nobody reads.
        unsafe { *s.stages.0.get() = stages };
        s.done.store(0, Ordering::Relaxed);
        s.chunks.store(chunks, Ordering::Relaxed);
        for (k, share) in s.shares.iter().enumerate() {
            // SAFETY: just set, and read only.
            let own: usize = unsafe { &*stages }.iter().map(|stage| s.part(k, *stage).len()).sum();
            share.open(round, 0, own);
        }
        s.round.store(round, Ordering::SeqCst);
        for bed in &s.beds[1..] {
            if bed.asleep.load(Ordering::SeqCst)
                && bed.asleep.swap(false, Ordering::SeqCst)
                && let Some(thread) = bed.thread.get()
            {
                thread.unpark();
            }
        }
        s.take_chunks(0, round);
        s.wait_for_all(chunks);
        let panic = s.panic.lock().ok().and_then(|mut p| p.take());
        if let Some(payload) = panic {
            std::panic::resume_unwind(payload);
        }
    }
}

impl Drop for Crew {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::SeqCst);
        for worker in self.workers.drain(..) {
            worker.thread().unpark();
            // Panics were handed to the caller.
            let _ = worker.join();
        }
    }
}

impl Shared {
    /// Chunks of a stage in the share of thread `k`: the same part of every stage, so that a thread finds what
    /// lies side by side in its own cache, from stage to stage and from step to step.
    fn part(&self, k: usize, stage: &dyn Work) -> std::ops::Range<usize> {
        let (count, threads, shares) = (stage.count(), self.shares.len(), stage.shares());
        if shares.len() == threads + 1 && shares[0] == 0 && shares[threads] as usize == count {
            return shares[k] as usize..shares[k + 1] as usize;
        }
        k * count / threads..(k + 1) * count / threads
    }

    /// Do chunks of this round, own ones first, until none is left.
    fn take_chunks(&self, own: usize, round: u64) {
        let threads = self.shares.len();
        for victim in (own..threads).chain(0..own) {
            let mut taken = 0;
            let over = loop {
                let chunk = match self.shares[victim].claim(round) {
                    Ok(chunk) => chunk,
                    Err(over) => break over,
                };
                // SAFETY: a chunk of this round is claimed and not done, so the round lasts.
                let work = || unsafe { self.chunk(victim, chunk) };
                if let Err(payload) = catch_unwind(AssertUnwindSafe(work))
                    && let Ok(mut panic) = self.panic.lock()
                {
                    *panic = Some(payload);
                }
                taken += 1;
            };
            // While some are not told, the round lasts.
            if taken > 0 {
                let chunks = self.chunks.load(Ordering::Relaxed);
                if self.done.fetch_add(taken, Ordering::SeqCst) + taken == chunks {
                    self.wake_caller();
                }
            }
            if over {
                return;
            }
        }
    }

    fn wake_caller(&self) {
        if self.caller_sleeps.load(Ordering::SeqCst)
            && let Ok(caller) = self.caller.lock()
            && let Some(caller) = &*caller
        {
            caller.unpark();
        }
    }

    /// Do a chunk of the share of thread `k`, counted over all stages.
    ///
    /// # Safety
    /// The caller has claimed the chunk.
    unsafe fn chunk(&self, k: usize, mut chunk: usize) {
        // SAFETY: by the caller the round lasts.
        let stages = unsafe { &**self.stages.0.get() };
        for stage in stages {
            let part = self.part(k, *stage);
            if chunk < part.len() {
                // SAFETY: a chunk is claimed once.
                unsafe { stage.chunk(part.start + chunk) };
                return;
            }
            chunk -= part.len();
        }
    }

    /// The calling thread waits for chunks that others still work on.
    fn wait_for_all(&self, chunks: usize) {
        let all_done = || self.done.load(Ordering::SeqCst) == chunks;
        if all_done() || self.look(all_done) {
            return;
        }
        // A worker may have lost its core in the middle of a chunk: leave it this one.
        self.caller_sleeps.store(true, Ordering::SeqCst);
        while !all_done() {
            std::thread::park();
        }
        self.caller_sleeps.store(false, Ordering::SeqCst);
    }

    /// Look for `sign` in a loop, as long as that is worth it.
    fn look(&self, sign: impl Fn() -> bool) -> bool {
        if !self.patient {
            return sign();
        }
        let start = Instant::now();
        loop {
            for _ in 0..8 {
                if sign() {
                    return true;
                }
                std::hint::spin_loop();
            }
            if start.elapsed() > PATIENCE {
                return false;
            }
        }
    }

    /// Life of a worker.
    fn serve(&self, own: usize) {
        let bed = &self.beds[own];
        let _ = bed.thread.set(std::thread::current());
        let mut last = 0;
        loop {
            let news =
                || self.round.load(Ordering::SeqCst) != last || self.stop.load(Ordering::Relaxed);
            let found = news()
                || (self.awake.load(Ordering::Relaxed)
                    && self.look(|| news() || !self.awake.load(Ordering::Relaxed))
                    && news());
            if !found {
                bed.asleep.store(true, Ordering::SeqCst);
                while !news() {
                    std::thread::park();
                }
                bed.asleep.store(false, Ordering::SeqCst);
            }
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
            last = self.round.load(Ordering::SeqCst);
            self.take_chunks(own, last);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn squares(team: &Team, n: usize) -> Vec<usize> {
        let mut out = vec![0; n];
        team.each(n.div_ceil(7), cut(&mut out, 7), |c, part| {
            for (k, x) in part.iter_mut().enumerate() {
                *x += (7 * c + k) * (7 * c + k);
            }
        });
        out
    }

    #[test]
    fn every_chunk_is_done_exactly_once() {
        let expected: Vec<usize> = (0..1000).map(|k| k * k).collect();
        for threads in [1, 2, 3, 8] {
            let team = Team::new(threads);
            assert_eq!(team.crew.is_some(), threads > 1);
            team.enter(|| {
                for n in (0..1000).step_by(37) {
                    assert_eq!(squares(&team, n), expected[..n]);
                }
            });
        }
    }

    #[test]
    fn what_holds_for_all_chunks_and_the_largest_of_them_are_told() {
        for threads in [1, 3] {
            let team = Team::new(threads);
            team.enter(|| {
                assert!(team.all(100, |c| c < 100) && team.all(0, |_| false));
                assert!(!team.all(100, |c| c != 57));
                assert_eq!(team.largest(100, |c| (c as f64 - 40.0).powi(2)), 59.0f64.powi(2));
                assert_eq!(team.largest(100, |_| -1.0), 0.0);
            });
        }
    }

    #[test]
    fn stages_share_a_round_and_a_clone_of_the_team_works_at_the_same_time() {
        let team = Team::new(2);
        let work = |team: &Team| {
            for _ in 0..200 {
                let (mut a, mut b) = (vec![0u8; 50], vec![0u8; 90]);
                team.enter(|| {
                    let first = Stage {
                        count: 5,
                        shares: EVEN,
                        parts: cut(&mut a, 10),
                        work: |_, p: &mut [u8]| p.fill(1),
                    };
                    let second = Stage {
                        count: 9,
                        shares: &[0, 7, 9],
                        parts: cut(&mut b, 10),
                        work: |_, p: &mut [u8]| p.fill(2),
                    };
                    team.run(&[&first, &second]);
                });
                assert!(a.iter().all(|&x| x == 1) && b.iter().all(|&x| x == 2));
            }
        };
        std::thread::scope(|s| {
            let other = team.clone();
            s.spawn(move || work(&other));
            work(&team);
        });
    }

    #[test]
    fn a_stage_is_cut_into_the_shares_it_asks_for_if_they_are_all_of_it() {
        let crew = Crew::new(2).unwrap();
        let shares = |count, shares: &'static [u32]| {
            let stage = Stage { count, shares, parts: NO_PARTS, work: |_, ()| {} };
            [0, 1].map(|k| crew.shared.part(k, &stage))
        };
        assert_eq!(shares(9, &[0, 7, 9]), [0..7, 7..9]);
        assert_eq!(shares(9, &[0, 0, 9]), [0..0, 0..9]);
        // Of another list, or of another team.
        for other in [&[0, 7, 10][..], &[0, 4, 7, 9], EVEN] {
            assert_eq!(shares(9, other), [0..4, 4..9], "{other:?}");
        }
    }

    #[test]
    #[should_panic(expected = "two threads have one chunk in their shares")]
    fn shares_that_overlap_are_refused() {
        let team = Team::new(3);
        let shares = &[0, 7, 5, 9];
        let stage = Stage { count: 9, shares, parts: NO_PARTS, work: |_, ()| {} };
        team.enter(|| team.run(&[&stage]));
    }

    #[test]
    fn a_panic_in_a_chunk_reaches_the_caller() {
        let team = Team::new(2);
        let mut x = vec![0u8; 64];
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            team.enter(|| team.each(64, cut(&mut x, 1), |k, _| assert!(k != 33, "as asked")));
        }));
        assert!(result.is_err());
    }
}
