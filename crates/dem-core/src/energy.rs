//! The energy ledger: where every joule is, and what the integrator lost.
//!
//! `remainder = kinetic + potential + elastic + dissipated - work - (the same sum at the start)`
//!
//! is the error of integration: each dissipation is what its own law computes, none is found as a
//! difference. It falls as the square of the time step.

use glam::DVec3;

use crate::contact::model::ContactLaw;
use crate::error::Error;
use crate::integrate::Integrator;
use crate::world::World;

/// Energy lost so far, by the law that lost it, J.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dissipation {
    /// Normal laws.
    pub normal: f64,
    /// Tangential laws: sliding and shear damping.
    pub tangential: f64,
    /// Rolling and torsion laws.
    pub rolling: f64,
    /// Cohesion laws.
    pub cohesion: f64,
    /// Drag.
    pub drag: f64,
}

impl Dissipation {
    /// All of it, J.
    pub fn total(&self) -> f64 {
        self.normal + self.tangential + self.rolling + self.cohesion + self.drag
    }
}

/// The ledger at one instant, J.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Energy {
    /// Kinetic energy of translation.
    pub kinetic_translation: f64,
    /// Kinetic energy of rotation.
    pub kinetic_rotation: f64,
    /// Potential energy in gravity, relative to the origin.
    pub potential: f64,
    /// Elastic energy of all contacts (negative in the well of an attraction).
    pub elastic: f64,
    /// Lost since the ledger was opened.
    pub dissipated: Dissipation,
    /// Work done by moving walls since then.
    pub work_of_walls: f64,
    /// Work done by the turning of gravity since then.
    pub work_of_gravity_turn: f64,
    /// Error of integration since then.
    pub remainder: f64,
}

impl Energy {
    /// Kinetic, potential and elastic energy together, J.
    pub fn mechanical(&self) -> f64 {
        self.kinetic_translation + self.kinetic_rotation + self.potential + self.elastic
    }
}

/// Rates and amounts that one chunk of contacts contributes in one step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Flow {
    pub(crate) elastic: f64,
    pub(crate) normal: f64,
    pub(crate) tangential: f64,
    pub(crate) rolling: f64,
    pub(crate) cohesion: f64,
    pub(crate) drag: f64,
    pub(crate) walls: f64,
    pub(crate) gravity_turn: f64,
}

impl Flow {
    pub(crate) fn add(&mut self, other: &Flow) {
        self.elastic += other.elastic;
        self.normal += other.normal;
        self.tangential += other.tangential;
        self.rolling += other.rolling;
        self.cohesion += other.cohesion;
        self.drag += other.drag;
        self.walls += other.walls;
        self.gravity_turn += other.gravity_turn;
    }
}

/// What the world carries from step to step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Ledger {
    pub(crate) open: bool,
    pub(crate) start: f64,
    pub(crate) dissipated: Dissipation,
    pub(crate) work_of_walls: f64,
    pub(crate) work_of_gravity_turn: f64,
    /// Rates at the end of the last step.
    pub(crate) last: Flow,
}

impl Ledger {
    /// Book a step of `dt` at whose end the rates are `now`.
    ///
    /// Powers that belong to the end of a step are integrated by the trapezoidal rule; those of
    /// shear and rolling springs are already mean values of the step.
    pub(crate) fn book(&mut self, now: &Flow, dt: f64) {
        let mean = |a: f64, b: f64| 0.5 * (a + b) * dt;
        let last = self.last;
        self.dissipated.normal += mean(last.normal, now.normal);
        self.dissipated.tangential += now.tangential * dt;
        self.dissipated.rolling += now.rolling * dt;
        self.dissipated.cohesion += mean(last.cohesion, now.cohesion);
        self.dissipated.drag += mean(last.drag, now.drag);
        self.work_of_walls += mean(last.walls, now.walls);
        self.work_of_gravity_turn += mean(last.gravity_turn, now.gravity_turn);
        self.last = *now;
    }
}

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Sum of what all contacts and bodies yielded in the last evaluation of forces.
    pub(crate) fn flow(&self) -> Flow {
        let s = &self.scratch;
        let mut sum = Flow::default();
        let contacts = s.pair_yield.iter().chain(&s.near_yield).chain(&s.wall_yield);
        for flow in contacts.map(|y| &y.flow).chain(s.body_yield.iter().map(|y| &y.flow)) {
            sum.add(flow);
        }
        sum
    }

    pub(crate) fn book(&mut self, dt: f64) {
        let now = self.flow();
        self.state.ledger.book(&now, dt);
    }

    /// Compute the present rates without touching anything that the motion depends on.
    pub(crate) fn refresh_flow(&mut self) -> Result<(), Error> {
        self.prepare()?;
        // Contacts remember what they did in this step: let a copy do it again.
        let (pairs, walls) = (self.state.pairs.clone(), self.state.wall_list.clone());
        self.contact_forces(0.0);
        self.state.pairs = pairs;
        self.state.wall_list = walls;
        self.state.ledger.last = self.flow();
        Ok(())
    }

    /// Rate of change of gravity now, m/s3.
    pub(crate) fn gravity_rate(&self) -> DVec3 {
        let g = &self.make.gravity;
        if g.rate == 0.0 {
            return DVec3::ZERO;
        }
        (g.axis.normalize() * g.rate).cross(g.at(self.time()))
    }
}
