//! The time loop on one screen, and its stages.

use crate::body_stage::Halves;
use crate::contact::model::ContactLaw;
use crate::contact_stage::all_contacts;
use crate::energy::Flow;
use crate::error::Error;
use crate::forces::Contacts;
use crate::geometry::PlacedWall;
use crate::integrate::Integrator;
use crate::simd::{Arithmetic, Features, PairKernel};
use crate::spheres::SphereView;
use crate::world::{Make, World, sphere_view};

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Advance by `steps` time steps.
    ///
    /// # Errors
    /// A [`crate::error::Fault`]; the world is left as it was when the fault was found. In a bed of more than 20 000 spheres some
    /// may have been up to three steps ahead then: they are put back to within a micrometre, what their contacts remember is not,
    /// and numbers that are none are found up to three steps later. Spheres that had begun the next step turn as they do on the mean
    /// of it.
    pub fn run(&mut self, steps: u64) -> Result<(), Error> {
        let team = self.team.clone();
        team.enter(|| {
            self.prepare()?;
            let done = self.advance_all(steps);
            self.spin_clumps();
            if done.is_err() {
                self.scratch.drop_some();
            }
            done
        })
    }

    fn advance_all(&mut self, mut left: u64) -> Result<(), Error> {
        let mut drifted = None;
        while left > 0 {
            left -= 1;
            drifted = self.advance(drifted, &mut left)?;
        }
        Ok(())
    }

    /// One time step. `drifted` says whether its first half was done already, and if so whether
    /// bodies moved far in it; if steps are `left` after it, the first half of the next one may be done here, or more of them.
    fn advance(&mut self, drifted: Option<bool>, left: &mut u64) -> Result<Option<bool>, Error> {
        let (dt, more) = (self.make.dt, *left > 0);
        let moved_far = drifted.unwrap_or_else(|| {
            let moved_far = self.move_bodies(Halves::Drift);
            self.turn_clumps() | moved_far
        });
        self.state.step += 1;
        self.move_walls(dt);
        let asks = self.scratch.hold == 0;
        if asks && (moved_far || self.walls_moved_far()) {
            let made = self.make_list();
            if made.is_err() && drifted.is_some() {
                self.recall();
            }
            made?;
        }
        self.scratch.hold = if asks { self.list_holds() } else { self.scratch.hold - 1 };
        if !std::mem::take(&mut self.scratch.members_placed) {
            self.place_members();
        }
        let steps =
            if more { self.steps_in_a_sweep().min(self.scratch.hold + 1).min(*left) } else { 0 };
        if steps > 1 {
            (*left, self.scratch.hold) = (*left - (steps - 1), self.scratch.hold - (steps - 1));
            return self.sweep(steps as usize).map(Some);
        }
        if more && self.goes_in_one_pass() {
            return self.one_pass().map(Some);
        }
        self.contact_forces(dt);
        let overlaps = self.check_overlaps();
        // A ledger and a fault look at the world between two steps.
        if more && overlaps.is_ok() && !self.ledger_wanted {
            let moved_far = self.move_bodies(Halves::KickAndDrift);
            return Ok(Some(self.turn_clumps() | moved_far));
        }
        self.move_bodies(Halves::Kick);
        if self.ledger_wanted {
            self.spin_clumps();
            self.book(dt);
        }
        overlaps.map(|()| None)
    }

    /// Bring lists, forces and accelerations in line with what was set from outside.
    pub(crate) fn prepare(&mut self) -> Result<(), Error> {
        if self.scratch.placed.len() != self.make.walls.len() || self.state.forces_stale {
            self.move_walls(0.0);
        }
        if self.state.list_stale {
            self.make_list()?;
        }
        self.scratch.hold = 0;
        // Left over from a run that ended in a fault of the list.
        self.scratch.members_placed = false;
        if !self.state.forces_stale {
            return Ok(());
        }
        // Who was set from outside may move as far as it likes.
        self.scratch.stride = f64::INFINITY;
        let b = &mut self.state.bodies;
        for k in 0..b.len() {
            let (v, w) = (b.velocity[k].vector(), b.spin[k].vector());
            b.velocities[k].iter_mut().for_each(|of_two| of_two.set(v));
            b.mean_spin[k].set(w);
            if let Some(end) = self.state.members.end_spin.get_mut(k) {
                end.set(w);
            }
        }
        self.place_members();
        // After a fault marks may be those of other steps than wrenches.
        self.scratch.wrenches.clear_walls();
        self.contact_forces(0.0);
        self.move_bodies(Halves::Sum);
        self.start_integrator();
        self.state.forces_stale = false;
        self.state.ledger.last = self.flow();
        self.check_overlaps()
    }

    fn move_walls(&mut self, dt: f64) {
        let mut placed = std::mem::take(&mut self.scratch.placed);
        self.place_walls(&mut placed, self.time(), dt);
        self.scratch.placed = placed;
    }

    /// Bring walls to `time`, which a step of `dt` has just reached.
    pub(crate) fn place_walls(&self, placed: &mut Vec<PlacedWall>, time: f64, dt: f64) {
        let walls = self.make.walls.iter().zip(&self.state.walls);
        if placed.len() == walls.len() {
            for (p, (w, m)) in placed.iter_mut().zip(walls) {
                p.update(w, m, time, dt);
            }
        } else {
            placed.clear();
            placed.extend(walls.map(|(w, m)| PlacedWall::new(w, m, time, dt)));
        }
    }

    /// All contacts: their wrenches go to buffers, in which spheres find them later.
    pub(crate) fn contact_forces(&mut self, dt: f64) {
        let clumps = self.has_clumps();
        let ledger = self.ledger_wanted;
        self.tell_shift_of_walls();
        let mut pairs = std::mem::take(&mut self.state.pairs);
        let mut walls = std::mem::take(&mut self.state.wall_list);
        let mut s = std::mem::take(&mut self.scratch);
        let placed = std::mem::take(&mut s.placed);
        let spheres = sphere_view(&self.state.bodies, &self.state.members, clumps, dt);
        let mut context = contacts_of(&self.make, spheres, &placed, dt, ledger);
        let kernel = kernel_of(&self.make, spheres, dt, ledger);
        let vector = kernel.as_ref().map(|kernel| (self.make.level, kernel));
        // With fast roots a copy of the contacts is booked, and the contacts go their own way.
        let mut booked = Flow::default();
        if ledger && vector.is_some() {
            let (mut pairs, mut walls) = (pairs.clone(), walls.clone());
            all_contacts(
                &context, None, &self.team, &self.make, &mut pairs, &mut walls, &mut s, None,
            );
            let yields = s.pair_yield.iter().chain(&s.near_yield).chain(&s.wall_yield);
            yields.for_each(|y| booked.add(&y.flow));
            context.ledger = false;
        }
        all_contacts(
            &context, vector, &self.team, &self.make, &mut pairs, &mut walls, &mut s, None,
        );
        if let Some(first) = s.pair_yield.first_mut() {
            first.flow.add(&booked);
        }
        s.placed = placed;
        self.scratch = s;
        self.state.pairs = pairs;
        self.state.wall_list = walls;
    }

    /// What the integrator remembers, from the present velocities and accelerations.
    fn start_integrator(&mut self) {
        let dt = self.make.dt;
        let b = &mut self.state.bodies;
        for k in 0..b.len() {
            let (v, a) = (b.velocity[k].vector(), b.acceleration[k].vector());
            if let Some(memory) = b.linear_memory.get_mut(k) {
                memory.set(self.integrator.start(v, a, dt));
            }
            let (w, a) = (b.spin[k].vector(), b.angular_acceleration[k].vector());
            let memory = if b.spin[k].w > 0.0 {
                self.integrator.start(w, a, dt)
            } else {
                let m = &self.state.members;
                let moments = self.make.shapes[m.shape[k] as usize].moments;
                let q = m.attitude[k];
                q * ((q.conjugate() * w) * moments)
            };
            if let Some(of_body) = b.angular_memory.get_mut(k) {
                of_body.set(memory);
            }
        }
    }
}

/// What the portable kernels read.
pub(crate) fn contacts_of<'a, M: ContactLaw>(
    make: &'a Make<M>,
    spheres: SphereView<'a>,
    walls: &'a [PlacedWall],
    dt: f64,
    ledger: bool,
) -> Contacts<'a, M> {
    Contacts {
        spheres,
        walls,
        laws: &make.laws,
        materials: make.materials.len(),
        period: make.period,
        dt,
        overlap_limit: make.overlap_limit,
        neck: make.neck,
        gap_forces: &make.gap_forces,
        ledger,
    }
}

/// What the vector kernels read, where they know the laws.
pub(crate) fn kernel_of<'a, M>(
    make: &'a Make<M>,
    spheres: SphereView<'a>,
    dt: f64,
    ledger: bool,
) -> Option<PairKernel<'a>> {
    // The portable kernel books energies and gives the bits of exact ones.
    let all = make.fast.as_deref().filter(|_| !ledger || make.arithmetic != Arithmetic::Exact)?;
    let only = make.one_material.map(|m| m * make.materials.len() + m);
    Some(PairKernel {
        spheres,
        constants: only.map_or(all, |k| &all[k..=k]),
        all,
        one_material: make.one_material,
        materials: make.materials.len(),
        one_size: make.one_size,
        period: make.period,
        dt,
        overlap_limit: make.overlap_limit,
        arithmetic: make.arithmetic,
        features: Features::of(all),
    })
}
