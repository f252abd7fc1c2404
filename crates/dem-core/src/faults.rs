//! Finding out what went wrong, to whom and most likely why.

use crate::contact::model::ContactLaw;
use crate::error::{Cause, Error, Fault, FaultKind, Partner};
use crate::forces::{DeepOverlap, deeper};
use crate::integrate::Integrator;
use crate::particles::{MEAN, ParticleId};
use crate::world::World;

/// Radii moved in a step above which the time step is to blame.
const FAST: f64 = 0.05;

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Stop on overlaps beyond the limit.
    pub(crate) fn check_overlaps(&self) -> Result<(), Error> {
        let s = &self.scratch;
        let yields = s.pair_yield.iter().chain(&s.near_yield).chain(&s.wall_yield);
        self.check_overlap(yields.map(|y| y.deep).fold(None, deeper))
    }

    /// Stop on an overlap beyond the limit.
    pub(crate) fn check_overlap(&self, deepest: Option<DeepOverlap>) -> Result<(), Error> {
        match deepest {
            None => Ok(()),
            Some(deep) => Err(self.too_deep(deep)),
        }
    }

    fn body_of(&self, sphere: u32) -> usize {
        if self.has_clumps() {
            self.state.members.body[sphere as usize] as usize
        } else {
            sphere as usize
        }
    }

    fn too_deep(&self, deep: DeepOverlap) -> Error {
        let body = self.body_of(deep.sphere);
        let partner = if deep.with_wall {
            Partner::Wall(deep.partner as usize)
        } else {
            Partner::Particle(ParticleId(self.state.bodies.id[self.body_of(deep.partner)]))
        };
        let other = if deep.with_wall { body } else { self.body_of(deep.partner) };
        let radii_per_step = self.radii_per_step(body).max(self.radii_per_step(other));
        let cause = if self.state.step <= 1 {
            Cause::Placement
        } else if radii_per_step > FAST {
            Cause::TimeStep { radii_per_step }
        } else {
            Cause::Softness
        };
        let kind = FaultKind::Overlap { fraction: deep.fraction, limit: self.make.overlap_limit };
        self.fault(kind, body, Some(partner), cause)
    }

    pub(crate) fn not_finite(&self, body: usize) -> Error {
        self.fault(FaultKind::NotFinite, body, self.any_partner(body), Cause::Law)
    }

    pub(crate) fn lost(&self, body: usize) -> Error {
        let radii_per_step = self.radii_per_step(body);
        let cause = if radii_per_step > FAST {
            Cause::TimeStep { radii_per_step }
        } else {
            Cause::OpenBoundary
        };
        self.fault(FaultKind::Lost, body, self.any_partner(body), cause)
    }

    fn fault(&self, kind: FaultKind, body: usize, partner: Option<Partner>, cause: Cause) -> Error {
        Error::Fault(Fault {
            kind,
            particle: ParticleId(self.state.bodies.id[body]),
            partner,
            position: self.state.bodies.position[body].vector(),
            step: self.state.step,
            time: self.time(),
            cause,
        })
    }

    fn radii_per_step(&self, body: usize) -> f64 {
        let b = &self.state.bodies;
        b.velocities[body][MEAN].vector().length() * self.make.dt / b.position[body].w
    }

    /// A partner with which the body was last in contact.
    fn any_partner(&self, body: usize) -> Option<Partner> {
        let (p, w) = (&self.state.pairs, &self.state.wall_list);
        for pair in (0..p.touching).chain(p.near()) {
            if p.active[pair] == 0 {
                continue;
            }
            let ends = [self.body_of(p.first[pair]), self.body_of(p.second[pair])];
            if let Some(at) = ends.iter().position(|&e| e == body) {
                return Some(Partner::Particle(ParticleId(self.state.bodies.id[ends[1 - at]])));
            }
        }
        (0..w.len())
            .find(|&e| w.active[e] != 0 && self.body_of(w.sphere[e]) == body)
            .map(|e| Partner::Wall(w.wall[e] as usize))
    }
}
