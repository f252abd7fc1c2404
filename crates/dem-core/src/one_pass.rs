//! One pass over touching pairs and bodies.
//!
//! Pairs are sorted by the earlier of their two spheres, so a sphere has all its pairs as soon as those that
//! it owns are computed. Then it is finished, while it lies in the cache: forces are summed, velocities brought
//! up, and it moves on to the next step. The partners of a sphere lie within two layers of cells, so the window
//! between what is touched first and what is finished is small, however many spheres there are, and a step
//! fetches every sphere once from memory. Wrenches are not kept: they are added to sums as they come,
//! in the order in which the stages of `contact_stage.rs` and `body_stage.rs` add them, so to the same bits.

use crate::body_stage::{Drift, Kick, Piece, Run};
use crate::contact::model::ContactLaw;
use crate::contact_stage::{CHUNK, Touching, all_contacts, touching_pairs};
use crate::error::Error;
use crate::integrate::Integrator;
use crate::simd::{Wrenches, on_records};
use crate::step::{contacts_of, kernel_of};
use crate::sums::{Collect, PIECE};
use crate::world::{World, sphere_view};

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Whether a step goes in one pass: on one thread, where every body is one sphere and nobody books energies.
    pub(crate) fn goes_in_one_pass(&self) -> bool {
        !self.ledger_wanted && !self.has_clumps() && self.team.is_one()
    }

    /// Contacts of a step, its second half, and the first half of the next one; returns whether after that
    /// the list may miss a pair.
    pub(crate) fn one_pass(&mut self) -> Result<bool, Error> {
        let dt = self.make.dt;
        let mut pairs = std::mem::take(&mut self.state.pairs);
        let mut walls = std::mem::take(&mut self.state.wall_list);
        let mut bodies = std::mem::take(&mut self.state.bodies);
        let mut s = std::mem::take(&mut self.scratch);
        let placed = std::mem::take(&mut s.placed);
        let (make, members, level) = (&self.make, &self.state.members, self.make.level);
        {
            let spheres = sphere_view(&bodies, members, false, dt);
            let context = contacts_of(make, spheres, &placed, dt, false);
            let kernel = kernel_of(make, spheres, dt, false);
            let vector = kernel.as_ref().map(|kernel| (level, kernel));
            all_contacts(&context, vector, &self.team, make, &mut pairs, &mut walls, &mut s, false);
        }
        let kick = Kick {
            make,
            members,
            collect: Collect {
                pairs: None,
                walls: &walls,
                w: &s.wrenches,
                late_start: &s.late_start,
                late_ends: &s.late_ends,
            },
            gravity: make.gravity.at(self.time()),
            gravity_rate: self.gravity_rate(),
            ledger: false,
            dt,
        };
        let drift = Drift {
            reference: &self.state.list.reference,
            frame: self.turn_since_list((self.state.step + 1) as f64 * dt),
            limit: (0.5 * make.skin).powi(2),
            dt,
        };
        s.ring.cover(pairs.window, bodies.len());
        let (mut done, mut moved_far) = (0, false);
        // A fault leaves bodies where they were when it was found.
        let mut deep = s.near_yield.iter().chain(&s.wall_yield).any(|y| y.deep.is_some());
        let mut drifted = 0;
        let (touching, slots) = (pairs.touching, pairs.slots);
        let chunks = touching.div_ceil(CHUNK);
        for chunk in 0..=chunks {
            let own = chunk * CHUNK..((chunk + 1) * CHUNK).min(pairs.near_begin);
            // Spheres before the owner of the next pair have all theirs.
            let frontier = if chunk < chunks { pairs.owner(own.start) } else { bodies.len() };
            while done < frontier {
                let end = (done + PIECE).min(bodies.len());
                if end > frontier {
                    break;
                }
                let piece = Piece {
                    integrator: self.integrator,
                    kick: Some(&kick),
                    drift: (!deep).then_some(&drift),
                    run: Run::of(&mut bodies, done..end),
                    sums: s.ring.piece(done, end - done),
                };
                let (_, far) = on_records(level, piece);
                moved_far |= far;
                done = end;
                if !deep {
                    drifted = end;
                }
            }
            if let Some(into) = s.pair_yield.get_mut(chunk) {
                let spheres = sphere_view(&bodies, members, false, dt);
                let context = contacts_of(make, spheres, &placed, dt, false);
                let kernel = kernel_of(make, spheres, dt, false);
                let vector = kernel.as_ref().map(|kernel| (level, kernel));
                let run = Touching {
                    pairs: own.len().min(touching - own.start),
                    slots,
                    first: &pairs.first[own.clone()],
                    second: &pairs.second[own.clone()],
                    active: &mut pairs.active[own.clone()],
                    numbers: &mut pairs.memory[own.start * slots..own.end * slots],
                    wrenches: Wrenches::Summed(s.ring.slots()),
                };
                touching_pairs(&context, vector, run, into);
                deep |= into.deep.is_some();
            }
        }
        if deep {
            for (x, v) in bodies.position.iter_mut().zip(&bodies.mean_velocity).take(drifted) {
                x.add(v.vector() * -dt);
            }
            self.state.forces_stale = true;
        }
        s.placed = placed;
        self.scratch = s;
        self.state.pairs = pairs;
        self.state.wall_list = walls;
        self.state.bodies = bodies;
        self.check_overlaps().map(|()| moved_far)
    }
}
