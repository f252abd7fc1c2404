//! Neighbour search: cells find the pairs, Verlet lists keep them for some steps.
//!
//! A pair is always kept in the order of its names (the lower one is `first`), whatever the place
//! of its spheres in memory, so that what a contact remembers never has to be turned round.

pub(crate) mod cell_list;
pub(crate) mod near_order;
pub(crate) mod search;
pub(crate) mod verlet_list;
pub(crate) mod wall_gaps;
pub(crate) mod wall_list;
mod wall_search;

use glam::DVec3;

/// A direction in which the domain repeats itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Period {
    /// 0, 1, 2 for x, y, z.
    pub(crate) axis: usize,
    /// Lower end, m.
    pub(crate) min: f64,
    /// Length, m.
    pub(crate) length: f64,
}

impl Period {
    /// The shortest of the images of a difference of positions.
    #[inline(always)]
    pub(crate) fn shortest(period: Option<Self>, mut d: DVec3) -> DVec3 {
        if let Some(p) = period {
            // Of two places within the period no other image can be nearer than the next one; the
            // comparison spares a division and the rounding.
            let half = 0.5 * p.length;
            let x = d[p.axis];
            if x.abs() > half {
                d[p.axis] = if x.abs() < 3.0 * half {
                    x - p.length.copysign(x)
                } else {
                    x - (x / p.length).round() * p.length
                };
            }
        }
        d
    }
}
