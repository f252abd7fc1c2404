//! Slices cut into parts, of which every thread is handed its own.

use std::marker::PhantomData;
use std::ops::{Index, Range};
use std::sync::atomic::AtomicU64;

/// A slice cut into chunks of equal length (the last may be shorter).
pub(crate) struct Chunks<'a, T> {
    begin: *mut T,
    length: usize,
    size: usize,
    slice: PhantomData<&'a mut [T]>,
}

// SAFETY: chunks are disjoint and each is handed out once: as good as sending parts of the slice.
unsafe impl<T: Send> Sync for Chunks<'_, T> {}

/// Cut a slice into chunks of `size`.
pub(crate) fn cut<T>(slice: &mut [T], size: usize) -> Chunks<'_, T> {
    Chunks { begin: slice.as_mut_ptr(), length: slice.len(), size, slice: PhantomData }
}

impl<'a, T> Chunks<'a, T> {
    /// The whole slice, to be read by all threads while each writes chunks of its own.
    ///
    /// No element may be read while its chunk is handed out, unless by who holds the chunk: those who cut see
    /// to that (`strips.rs`).
    pub(crate) fn view(&self) -> View<'a, T> {
        View { begin: self.begin, length: self.length, slice: PhantomData }
    }
}

/// A slice of which one element at a time is read: others may be written meanwhile.
pub(crate) struct View<'a, T> {
    begin: *const T,
    length: usize,
    slice: PhantomData<&'a [T]>,
}

// SAFETY: as good as references to the elements that are read.
unsafe impl<T: Sync> Send for View<'_, T> {}
// SAFETY: likewise.
unsafe impl<T: Sync> Sync for View<'_, T> {}

impl<T> Clone for View<'_, T> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for View<'_, T> {}

impl<'a, T> From<&'a [T]> for View<'a, T> {
    #[inline(always)]
    fn from(slice: &'a [T]) -> Self {
        Self { begin: slice.as_ptr(), length: slice.len(), slice: PhantomData }
    }
}

impl<'a, T> View<'a, T> {
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.length
    }

    #[inline(always)]
    pub(crate) fn as_ptr(&self) -> *const T {
        self.begin
    }
}

impl<T> Index<usize> for View<'_, T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, k: usize) -> &T {
        if k >= self.length {
            outside(k, self.length);
        }
        // SAFETY: within the slice, and nobody else writes what is read.
        unsafe { &*self.begin.add(k) }
    }
}

#[cold]
#[inline(never)]
fn outside(k: usize, length: usize) -> ! {
    panic!("element {k} of {length}");
}

/// Something that can be handed out chunk by chunk.
pub(crate) trait Cut: Sync {
    /// One chunk.
    type Part;
    /// Chunk `k`, empty beyond the end.
    ///
    /// # Safety
    /// Each `k` is asked for at most once.
    unsafe fn part(&self, k: usize) -> Self::Part;
}

impl<'a, T: Send> Cut for Chunks<'a, T> {
    type Part = &'a mut [T];

    #[inline(always)]
    unsafe fn part(&self, k: usize) -> &'a mut [T] {
        // SAFETY: by the caller.
        unsafe { self.joined(k..k + 1) }
    }
}

/// Chunks of which some that follow each other can be handed out as one.
pub(crate) trait CutJoined: Cut {
    /// These chunks as one.
    ///
    /// # Safety
    /// Each of them is asked for at most once.
    unsafe fn joined(&self, own: Range<usize>) -> Self::Part;
}

impl<'a, T: Send> CutJoined for Chunks<'a, T> {
    #[inline(always)]
    unsafe fn joined(&self, own: Range<usize>) -> &'a mut [T] {
        let end = (own.end * self.size).min(self.length);
        let begin = (own.start * self.size).min(end);
        // SAFETY: within the slice, and no other chunk overlaps these.
        unsafe { std::slice::from_raw_parts_mut(self.begin.add(begin), end - begin) }
    }
}

/// A slice cut into runs of groups of unlike lengths.
pub(crate) struct Groups<'a, T> {
    begin: *mut T,
    starts: &'a [u32],
    size: usize,
    /// Elements a place.
    each: usize,
    slice: PhantomData<&'a mut [T]>,
}

// SAFETY: as for `Chunks`: `cut_groups` has seen that the groups are disjoint.
unsafe impl<T: Send> Sync for Groups<'_, T> {}

/// Cut a slice into runs of `size` groups, where group `g` is `starts[g]..starts[g + 1]`.
pub(crate) fn cut_groups<'a, T>(
    slice: &'a mut [T],
    starts: &'a [u32],
    size: usize,
) -> Groups<'a, T> {
    cut_groups_of(slice, starts, size, 1)
}

/// The same of places of `each` elements.
pub(crate) fn cut_groups_of<'a, T>(
    slice: &'a mut [T],
    starts: &'a [u32],
    size: usize,
    each: usize,
) -> Groups<'a, T> {
    let within = starts.last().is_none_or(|&end| end as usize * each <= slice.len());
    assert!(within && starts.is_sorted(), "groups are not disjoint parts of their slice");
    Groups { begin: slice.as_mut_ptr(), starts, size, each, slice: PhantomData }
}

impl<'a, T> Groups<'a, T> {
    /// As [`Chunks::view`].
    pub(crate) fn view(&self) -> View<'a, T> {
        let length = self.starts.last().map_or(0, |&end| end as usize * self.each);
        View { begin: self.begin, length, slice: PhantomData }
    }
}

impl<'a, T: Send> Cut for Groups<'a, T> {
    type Part = &'a mut [T];

    #[inline(always)]
    unsafe fn part(&self, k: usize) -> &'a mut [T] {
        let at = |group: usize| {
            let last = self.starts.len().saturating_sub(1);
            self.starts.get(group.min(last)).map_or(0, |&s| s as usize * self.each)
        };
        let (begin, end) = (at(k * self.size), at((k + 1) * self.size));
        // SAFETY: within the slice, and no other run of groups overlaps it.
        unsafe { std::slice::from_raw_parts_mut(self.begin.add(begin), end - begin) }
    }
}

/// Bodies in one chunk of light work.
pub(crate) const PART: usize = 1024;

/// Bodies of chunk `c` of so many.
pub(crate) fn part(c: usize, bodies: usize) -> Range<usize> {
    c * PART..((c + 1) * PART).min(bodies)
}

/// Numbers as cells that any thread may write.
pub(crate) fn cells(numbers: &mut [f64]) -> &[AtomicU64] {
    const { assert!(align_of::<f64>() == align_of::<AtomicU64>(), "a number can be a cell") };
    // SAFETY: both are eight bytes that may be anything, and nobody else has the numbers while the cells live.
    unsafe { &*(std::ptr::from_mut(numbers) as *const [AtomicU64]) }
}

/// Chunks that have no parts of their own: what they work on is shared.
pub(crate) struct NoParts;

/// No parts.
pub(crate) const NO_PARTS: NoParts = NoParts;

impl Cut for NoParts {
    type Part = ();

    #[inline(always)]
    unsafe fn part(&self, _: usize) {}
}

impl<C: Cut, const N: usize> Cut for [C; N] {
    type Part = [C::Part; N];

    #[inline(always)]
    unsafe fn part(&self, k: usize) -> Self::Part {
        // SAFETY: by the caller.
        self.each_ref().map(|of| unsafe { of.part(k) })
    }
}

impl<C: CutJoined, const N: usize> CutJoined for [C; N] {
    #[inline(always)]
    unsafe fn joined(&self, own: Range<usize>) -> Self::Part {
        // SAFETY: by the caller.
        self.each_ref().map(|of| unsafe { of.joined(own.clone()) })
    }
}

macro_rules! cut_together {
    ($($name:ident)+) => {
        impl<$($name: CutJoined),+> CutJoined for ($($name,)+) {
            #[inline(always)]
            unsafe fn joined(&self, own: Range<usize>) -> Self::Part {
                #[expect(non_snake_case, reason = "types and values share their names")]
                let ($($name,)+) = self;
                // SAFETY: by the caller.
                unsafe { ($($name.joined(own.clone()),)+) }
            }
        }

        impl<$($name: Cut),+> Cut for ($($name,)+) {
            type Part = ($($name::Part,)+);

            #[inline(always)]
            unsafe fn part(&self, k: usize) -> Self::Part {
                #[expect(non_snake_case, reason = "types and values share their names")]
                let ($($name,)+) = self;
                // SAFETY: by the caller.
                unsafe { ($($name.part(k),)+) }
            }
        }
    };
}
cut_together!(A B);
cut_together!(A B C);
cut_together!(A B C D);
cut_together!(A B C D E);
cut_together!(A B C D E F);
cut_together!(A B C D E F G);

/// Runs of chunks: each part is the chunks from one start to the next, which are handed out in turn.
pub(crate) struct Runs<'s, C> {
    of: &'s C,
    starts: &'s [u32],
}

impl<'s, C: Cut> Runs<'s, C> {
    pub(crate) fn new(of: &'s mut C, starts: &'s [u32]) -> Self {
        assert!(starts.is_sorted(), "runs are not disjoint");
        Self { of, starts }
    }
}

impl<'s, C: Cut> Cut for Runs<'s, C> {
    type Part = InTurn<'s, C>;

    #[inline(always)]
    unsafe fn part(&self, k: usize) -> InTurn<'s, C> {
        let at = |k: usize| self.starts.get(k).map_or(0, |&s| s as usize);
        InTurn { of: self.of, next: at(k), end: at(k + 1) }
    }
}

/// The chunks of a run, each handed out once at most.
pub(crate) struct InTurn<'s, C> {
    of: &'s C,
    next: usize,
    end: usize,
}

impl<C: Cut> InTurn<'_, C> {
    /// The chunks that are left.
    pub(crate) fn left(&self) -> Range<usize> {
        self.next..self.end
    }

    /// Chunk `k` of the whole, if it is left; none before it will be handed out after it.
    #[inline(always)]
    pub(crate) fn take(&mut self, k: usize) -> Option<C::Part> {
        // SAFETY: runs are disjoint, each is a part once, and what is left of it only shrinks.
        self.hands_out(&(k..k + 1)).then(|| unsafe { self.of.part(k) })
    }

    /// Whether these chunks are left, which they are no more then.
    #[inline(always)]
    fn hands_out(&mut self, own: &Range<usize>) -> bool {
        let left = !own.is_empty() && own.start >= self.next && own.end <= self.end;
        if left {
            self.next = own.end;
        }
        left
    }
}

impl<C: CutJoined> InTurn<'_, C> {
    /// The same of some that follow each other, as one.
    #[inline(always)]
    pub(crate) fn take_joined(&mut self, own: Range<usize>) -> Option<C::Part> {
        // SAFETY: as above.
        self.hands_out(&own).then(|| unsafe { self.of.joined(own) })
    }
}

/// Some chunks of the whole.
pub(crate) struct Chosen<'s, C> {
    of: C,
    which: Option<&'s [u32]>,
}

/// Only those of these numbers, each of which is told once, if there are such: else all.
pub(crate) fn chosen<C: Cut>(of: C, which: Option<&[u32]>) -> Chosen<'_, C> {
    let once = which.is_none_or(|which| which.is_sorted_by(|a, b| a < b));
    assert!(once, "a chunk is chosen twice");
    Chosen { of, which }
}

impl<C: Cut> Cut for Chosen<'_, C> {
    type Part = C::Part;

    #[inline(always)]
    unsafe fn part(&self, k: usize) -> C::Part {
        let k = self.which.map_or(k, |which| which[k] as usize);
        // SAFETY: no number is told twice.
        unsafe { self.of.part(k) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::threads::Team;

    #[test]
    fn each_thread_writes_its_own_chunks_and_reads_those_that_nobody_holds() {
        let team = Team::new(3);
        let (mut numbers, mut sums) = ((0..70).collect::<Vec<u64>>(), [0; 3]);
        let starts = [0, 3, 4, 7];
        team.enter(|| {
            let mut chunks = cut(&mut numbers, 10);
            let view = chunks.view();
            // The middle of each run is left alone.
            let parts = (Runs::new(&mut chunks, &starts), cut(&mut sums, 1));
            team.each(3, parts, |_, (mut run, sum): (InTurn<'_, _>, &mut [u64])| {
                let own = run.left();
                sum[0] = [1, 5].map(|middle| view[10 * middle]).iter().sum::<u64>();
                for k in own.filter(|k| ![1, 5].contains(k)) {
                    let chunk: &mut [u64] = run.take(k).unwrap();
                    chunk.iter_mut().for_each(|x| *x += 1000);
                    assert!(run.take(k).is_none(), "handed out twice");
                }
            });
        });
        assert_eq!(sums, [60; 3]);
        let expected = |k: u64| if [1, 5].contains(&(k / 10)) { k } else { k + 1000 };
        assert!((0..70).zip(&numbers).all(|(k, x)| *x == expected(k)));
        let which = [1, 5];
        let part = chosen(cut(&mut numbers, 10), Some(&which));
        team.each(2, part, |_, chunk| chunk.fill(7));
        assert_eq!(numbers.iter().filter(|x| **x == 7).count(), 20);
        team.each(7, chosen(cut(&mut numbers, 10), None), |k, chunk| chunk.fill(k as u64));
        assert!((0..70).zip(&numbers).all(|(k, x)| *x == k / 10));
    }

    #[test]
    fn groups_of_places_have_as_many_elements_each() {
        let (mut marks, mut numbers) = ([0; 9], [0; 20]);
        let starts = [0, 1, 1, 4];
        let team = Team::new(2);
        team.enter(|| {
            let parts =
                (cut_groups(&mut marks, &starts, 1), cut_groups_of(&mut numbers, &starts, 1, 4));
            team.each(3, parts, |k, (marks, numbers): (&mut [usize], &mut [usize])| {
                assert_eq!(4 * marks.len(), numbers.len());
                marks.fill(k + 1);
                numbers.fill(k + 1);
            });
        });
        assert_eq!(marks, [1, 3, 3, 3, 0, 0, 0, 0, 0]);
        let whole = numbers.as_chunks::<4>().0;
        assert_eq!(whole, [[1; 4], [3; 4], [3; 4], [3; 4], [0; 4]]);
        let short =
            std::panic::catch_unwind(|| cut_groups_of(&mut [0; 15], &[0, 1, 4], 1, 4).view().len());
        assert!(short.is_err(), "groups reach beyond their slice");
    }

    #[test]
    fn chunks_that_follow_each_other_are_handed_out_as_one() {
        let (mut numbers, mut marks) = ([0; 68], [[0; 7], [0; 7]]);
        let starts = [0, 7];
        let mut chunks = (cut(&mut numbers, 10), marks.each_mut().map(|of| cut(of, 1)));
        // SAFETY: one run, taken once.
        let mut run = unsafe { Runs::new(&mut chunks, &starts).part(0) };
        let mut lengths = Vec::new();
        for own in [0..2, 2..3, 3..4, 4..7] {
            let part = run.take_joined(own.clone()).expect("they are left");
            let (numbers, [a, b]): (&mut [usize], [&mut [usize]; 2]) = part;
            numbers.fill(own.start);
            a.fill(own.start);
            lengths.push([numbers.len(), a.len(), b.len()]);
            assert!(run.take_joined(own).is_none(), "handed out twice");
        }
        assert!(run.take_joined(7..8).is_none() && run.left().is_empty());
        let expected = [[20, 2, 2], [10, 1, 1], [10, 1, 1], [28, 3, 3]];
        assert_eq!(lengths, expected);
        assert_eq!(marks[0], [0, 0, 2, 3, 4, 4, 4]);
        assert!(numbers.iter().enumerate().all(|(k, x)| *x == marks[0][k / 10]));
    }
}
