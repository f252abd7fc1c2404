//! Rows of positions, as codes write them, to frames of spheres.

use crate::error::Error;
use crate::spheres::Sphere;

/// The spheres of one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Number of the frame.
    pub frame: u64,
    /// Its spheres.
    pub spheres: Vec<Sphere>,
}

/// Groups rows `(frame, sphere)` that follow each other into snapshots, one in memory at a time.
///
/// Where every sphere has body 0 the place in the frame becomes its body, so that each has its own shade.
///
/// ```
/// use drum_film::{Frames, Sphere, glam::DVec3};
/// let rows = [0, 0, 1].map(|frame| (frame, Sphere::new(DVec3::ZERO, 0.003)));
/// let sizes: Vec<usize> = Frames::new(rows).map(|s| s.map(|s| s.spheres.len())).collect::<Result<_, _>>()?;
/// assert_eq!(sizes, [2, 1]);
/// # Ok::<(), drum_film::Error>(())
/// ```
pub struct Frames<I: Iterator> {
    rows: std::iter::Peekable<I>,
    done: std::collections::BTreeSet<u64>,
}

impl<I: Iterator<Item = (u64, Sphere)>> Frames<I> {
    /// Groups the rows of an iterator.
    pub fn new(rows: impl IntoIterator<IntoIter = I>) -> Self {
        Self { rows: rows.into_iter().peekable(), done: std::collections::BTreeSet::new() }
    }
}

impl<I: Iterator<Item = (u64, Sphere)>> Iterator for Frames<I> {
    /// A snapshot, or [`Error::FrameReturns`] when rows of a frame come in two places.
    type Item = Result<Snapshot, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let frame = self.rows.peek()?.0;
        let mut spheres = Vec::new();
        while let Some((_, sphere)) = self.rows.next_if(|row| row.0 == frame) {
            spheres.push(sphere);
        }
        if !self.done.insert(frame) {
            return Some(Err(Error::FrameReturns { frame }));
        }
        if spheres.iter().all(|s| s.body == 0) {
            for (i, s) in spheres.iter_mut().enumerate() {
                s.body = i as u32;
            }
        }
        Some(Ok(Snapshot { frame, spheres }))
    }
}
