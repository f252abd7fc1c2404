//! A run of bodies, column by column.

use crate::integrate::Integrator;
use crate::particles::{Bodies, END, MEAN, Record, Velocities};
use crate::simd::Quad;
use crate::spheres::{ClumpView, SphereView};
use crate::threads::{Chunks, View, cut};

/// A run of bodies.
pub(crate) struct Run<'a> {
    /// Place of the first.
    pub(crate) begin: usize,
    pub(crate) position: &'a mut [Record],
    pub(crate) velocity: &'a mut [Record],
    pub(crate) spin: &'a mut [Record],
    pub(crate) acceleration: &'a mut [Record],
    pub(crate) angular: &'a mut [Record],
    /// Mean ones, and those at the end of the step.
    pub(crate) velocities: &'a mut [Velocities],
    pub(crate) mean_spin: &'a mut [Record],
    pub(crate) linear: &'a mut [Record],
    pub(crate) turn: &'a mut [Record],
}

/// The records of a run of bodies in the order of [`cut_bodies`], and their velocities.
pub(crate) type Columns<'a> = ([&'a mut [Record]; 8], &'a mut [Velocities]);

/// The same of all bodies, cut into runs.
pub(crate) type CutColumns<'a> = ([Chunks<'a, Record>; 8], Chunks<'a, Velocities>);

/// Which of [`cut_bodies`] are the positions.
pub(crate) const POSITION: usize = 0;

/// Which of [`cut_bodies`] are the spins.
pub(crate) const SPIN: usize = 3;

/// Cut the bodies into runs of `size`.
pub(crate) fn cut_bodies(b: &mut Bodies, size: usize) -> CutColumns<'_> {
    let columns = [
        cut(&mut b.position, size),
        cut(&mut b.mean_spin, size),
        cut(&mut b.velocity, size),
        cut(&mut b.spin, size),
        cut(&mut b.acceleration, size),
        cut(&mut b.angular_acceleration, size),
        cut(&mut b.linear_memory, size),
        cut(&mut b.angular_memory, size),
    ];
    (columns, cut(&mut b.velocities, size))
}

impl<'a> SphereView<'a> {
    /// What contacts read of bodies, while others are written, which are spheres or have theirs in `clumps`.
    pub(crate) fn of_columns(
        columns: &CutColumns<'a>,
        clumps: Option<(View<'a, Record>, ClumpView<'a>)>,
    ) -> Self {
        let ([position, mean_spin, ..], velocities) = columns;
        SphereView {
            position: clumps.map_or(position.view(), |(spheres, _)| spheres),
            velocities: velocities.view(),
            mean_spin: mean_spin.view(),
            clumps: clumps.map(|(_, clumps)| clumps),
        }
    }
}

impl<'a> Run<'a> {
    /// The run that begins at place `begin`, of its columns in the order of [`cut_bodies`].
    #[inline(always)]
    pub(crate) fn of(begin: usize, columns: Columns<'a>) -> Self {
        let (columns, velocities) = columns;
        let [position, mean_spin, velocity, spin, acceleration, angular, linear, turn] = columns;
        Run {
            begin,
            position,
            velocity,
            spin,
            acceleration,
            angular,
            velocities,
            mean_spin,
            linear,
            turn,
        }
    }

    /// How many bodies.
    pub(crate) fn count(&self) -> usize {
        self.position.len()
    }

    /// Move all back by what they have moved last.
    pub(crate) fn undo_drift(&mut self, dt: f64) {
        for (x, v) in self.position.iter_mut().zip(&*self.velocities) {
            x.add(v[MEAN].vector() * -dt);
        }
    }

    /// Velocities and accelerations that were not kept when bodies moved on, to rounding: the mean velocity of the step to
    /// come lies half-way between the velocity at its beginning and that foretold for its end. Clumps turn as their momenta tell. Of
    /// how spheres turn nothing else was kept than the mean of that step: it stands for the angular velocity at its beginning,
    /// without an angular acceleration, so that who begins the step anew turns as far.
    pub(crate) fn recall(&mut self, dt: f64, clumps: bool) {
        let run = self.even();
        for k in 0..run.position.len() {
            let (mean, end) = (run.velocities[k][MEAN].vector(), run.velocities[k][END].vector());
            run.velocity[k].set(2.0 * mean - end);
            run.acceleration[k].set((end - mean) * (2.0 / dt));
            if clumps {
                continue;
            }
            run.spin[k].set(run.mean_spin[k].vector());
            run.angular[k].set(glam::DVec3::ZERO);
        }
    }

    /// Some of them.
    #[inline(always)]
    pub(crate) fn some(&mut self, own: std::ops::Range<usize>) -> Run<'_> {
        Run {
            begin: self.begin + own.start,
            position: &mut self.position[own.clone()],
            velocity: &mut self.velocity[own.clone()],
            spin: &mut self.spin[own.clone()],
            acceleration: &mut self.acceleration[own.clone()],
            angular: &mut self.angular[own.clone()],
            velocities: &mut self.velocities[own.clone()],
            mean_spin: &mut self.mean_spin[own.clone()],
            linear: self.linear.get_mut(own.clone()).unwrap_or_default(),
            turn: self.turn.get_mut(own).unwrap_or_default(),
        }
    }

    /// The same run, its slices cut to one length that the compiler knows to be one.
    #[inline(always)]
    pub(crate) fn even(&mut self) -> Run<'_> {
        let n = self.position.len();
        Run {
            begin: self.begin,
            position: &mut self.position[..n],
            velocity: &mut self.velocity[..n],
            spin: &mut self.spin[..n],
            acceleration: &mut self.acceleration[..n],
            angular: &mut self.angular[..n],
            velocities: &mut self.velocities[..n],
            mean_spin: &mut self.mean_spin[..n],
            linear: &mut *self.linear,
            turn: &mut *self.turn,
        }
    }
}

/// What the integrator remembers, if it does.
#[inline(always)]
pub(crate) fn remembered<Q: Quad, I: Integrator>(records: &[Record], k: usize) -> Q {
    Q::load(if I::REMEMBERS { &records[k] } else { &Record::ZERO })
}

/// Keep what the integrator remembers, if it does.
#[inline(always)]
pub(crate) fn remember<Q: Quad, I: Integrator>(records: &mut [Record], k: usize, memory: Q) {
    if I::REMEMBERS {
        let record = &mut records[k];
        memory.with_scalar_of(Q::load(record)).store(record);
    }
}
