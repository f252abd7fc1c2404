//! The world: particles, walls, laws and time.

mod kept;

use std::sync::Arc;

use glam::{DQuat, DVec3};

use crate::body_force::{Drag, Gravity};
use crate::contact::model::ContactLaw;
use crate::energy::{Energy, Flow, Ledger};
use crate::error::Error;
use crate::forces::{ChunkYield, Late, TOUCHES};
use crate::gap_force::GapForce;
use crate::geometry::{Motion, MotionState, PlacedWall, Wall};
use crate::integrate::{Integrator, VelocityVerlet};
use crate::material::{Material, MaterialId};
use crate::neighbour::Period;
use crate::neighbour::cell_list::CellList;
use crate::neighbour::near_order::{Moved, NearOrder};
use crate::neighbour::verlet_list::{Found, PairList};
use crate::neighbour::wall_gaps::WallGaps;
use crate::neighbour::wall_list::{NearWalls, WallList};
use crate::particles::{Bodies, Column, END, ParticleId, Record};
use crate::rigid::Clump;
use crate::spheres::{ClumpView, Seats, SphereView};
use crate::strips::{Shares, Strips};
use crate::sums::{LateEnds, Ring};
use crate::threads::Team;
use crate::tier::Tier;

pub(crate) use kept::{Kept, LARGE};

/// State of everything that moves.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    pub(crate) step: u64,
    pub(crate) bodies: Bodies,
    /// Only when there are clumps: the spheres of all bodies.
    pub(crate) members: Members,
    pub(crate) walls: Vec<MotionState>,
    pub(crate) pairs: PairList,
    pub(crate) wall_list: WallList,
    pub(crate) list: ListState,
    pub(crate) ledger: Ledger,
    /// The accelerations do not belong to the positions and velocities (something was set).
    pub(crate) forces_stale: bool,
    /// The list does not belong to the particles (some were added or moved).
    pub(crate) list_stale: bool,
}

/// When and how the neighbour list was made.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ListState {
    /// Positions of the bodies then; square of the displacement of each that calls for a new list, m2.
    pub(crate) reference: Column<Record>,
    /// Their attitudes then, where there are clumps.
    pub(crate) attitude: Vec<DQuat>,
    /// Time then, s.
    pub(crate) time: f64,
    /// Whether displacements are measured in the frame of the turning wall.
    pub(crate) turning: bool,
    /// Lists made so far.
    pub(crate) builds: u64,
}

/// Spheres of bodies, when some bodies are clumps.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Members {
    /// Name of each sphere.
    pub(crate) id: Vec<u32>,
    /// Body to which it belongs, by place.
    pub(crate) body: Vec<u32>,
    /// First sphere of each body; one more than bodies.
    pub(crate) first: Vec<u32>,
    /// Centres of the spheres; the radius.
    pub(crate) position: Column<Record>,
    /// Angular velocity foretold for the end of the step, of each body.
    pub(crate) end_spin: Column<Record>,
    /// Number of the clump's shape for each body; `SPHERE` for a single sphere.
    pub(crate) shape: Vec<u32>,
    /// Attitude of each body: principal axes to laboratory.
    pub(crate) attitude: Vec<DQuat>,
    /// Name of the first sphere of each body, by the body's name.
    pub(crate) first_id: Vec<u32>,
}

impl Members {
    /// Which bodies their spheres sit on.
    pub(crate) fn seats(&self) -> Seats<'_> {
        let clumps = !self.body.is_empty();
        Seats(clumps.then_some((&self.body[..], &self.first[..])))
    }

    /// Centres of the spheres of some bodies, where there are clumps.
    pub(crate) fn of_bodies(&self, bodies: std::ops::Range<usize>) -> &[Record] {
        match self.seats() {
            Seats(None) => &[],
            seats => &self.position[seats.first(bodies.start)..seats.first(bodies.end)],
        }
    }
}

/// Shape number of a single sphere.
pub(crate) const SPHERE: u32 = u32::MAX;

/// What does not change in a run.
#[derive(Debug, Clone)]
pub(crate) struct Make<M> {
    pub(crate) dt: f64,
    pub(crate) gravity: Gravity,
    pub(crate) drag: Option<Drag>,
    pub(crate) domain: [DVec3; 2],
    pub(crate) period: Option<Period>,
    pub(crate) materials: Vec<Material>,
    pub(crate) laws: Vec<M>,
    pub(crate) walls: Vec<Wall>,
    pub(crate) shapes: Vec<Clump>,
    pub(crate) skin: f64,
    /// Largest gap across which a contact that was can act.
    pub(crate) neck: f64,
    /// Largest gap across which anything can act.
    pub(crate) range: f64,
    pub(crate) gap_forces: Vec<Arc<dyn GapForce>>,
    /// Numbers stored a contact: at least one, so that every run of contacts has chunks.
    pub(crate) slots: usize,
    /// Instructions that the kernels use.
    pub(crate) level: crate::simd::Level,
    /// Constants of all laws, if the vector kernel knows them.
    pub(crate) fast: Option<Vec<crate::simd::Constants>>,
    /// Material of all particles, if they have but one.
    pub(crate) one_material: Option<usize>,
    /// Radius and mass of all particles, if they are spheres alike.
    pub(crate) one_size: Option<[f64; 2]>,
    /// Mass and moment of inertia of all particles, likewise.
    pub(crate) one_inertia: Option<[f64; 2]>,
    /// Whether all particles are clumps.
    pub(crate) only_clumps: bool,
    /// How the vector kernels compute.
    pub(crate) arithmetic: crate::simd::Arithmetic,
    pub(crate) overlap_limit: f64,
    /// Bodies beyond which a bed is far: no cache holds it.
    pub(crate) far: usize,
    /// Bodies beyond which a bed is large: it gives memory back that it does not need at once.
    pub(crate) large: usize,
    /// Wall whose turn displacements may be measured against.
    pub(crate) turning_wall: Option<usize>,
}

impl<M> Make<M> {
    /// Whether steps that follow each other neither read nor write velocities and accelerations: where all bodies are alike in that
    /// they turn as spheres do, or as clumps.
    pub(crate) fn moves_on_without_velocities(&self) -> bool {
        self.shapes.is_empty() || self.only_clumps
    }
}

/// Forces and torques of the last evaluation, in which spheres, walls and observers find theirs.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Wrenches {
    pub(crate) pair_force: Column<Record>,
    pub(crate) pair_torque_first: Column<Record>,
    pub(crate) pair_torque_second: Column<Record>,
    pub(crate) wall_force: Column<Record>,
    pub(crate) wall_torque: Column<Record>,
    /// Torque on the wall about the centre of the sphere.
    pub(crate) wall_torque_on_wall: Column<Record>,
    /// Near pairs in action, in the order of the list.
    pub(crate) late: Vec<Late>,
}

impl Wrenches {
    /// Those of touching pairs: forces, torques on first and on second spheres.
    pub(crate) fn touching(&mut self) -> [&mut Column<Record>; 3] {
        [&mut self.pair_force, &mut self.pair_torque_first, &mut self.pair_torque_second]
    }

    /// Those of walls: forces, torques on spheres and on walls.
    pub(crate) fn walls(&mut self) -> [&mut Column<Record>; 3] {
        [&mut self.wall_force, &mut self.wall_torque, &mut self.wall_torque_on_wall]
    }

    /// No wall acts on any sphere.
    pub(crate) fn clear_walls(&mut self) {
        self.walls().into_iter().for_each(|column| column.fill(Record::ZERO));
    }
}

/// Buffers that can be made anew from the state.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scratch {
    pub(crate) cells: CellList,
    /// Coordinates and radii of the spheres of clumps.
    pub(crate) sphere_columns: [Column<f64>; 4],
    pub(crate) found: Vec<Found>,
    /// What each body may move before the list is made again, m.
    pub(crate) reserve: Vec<f64>,
    /// The same in the order of the search, with room for one more vector at the end.
    pub(crate) sorted_reserve: Column<f64>,
    pub(crate) old_pairs: PairList,
    pub(crate) near_order: NearOrder,
    /// Displacements since the list was made.
    pub(crate) moved: Moved,
    pub(crate) old_walls: WallList,
    /// Whether the spheres of clumps are where their bodies have gone for the next step.
    pub(crate) members_placed: bool,
    /// Walls near spheres, in chunks of bodies.
    pub(crate) near_walls: Vec<NearWalls>,
    pub(crate) wall_gaps: WallGaps,
    /// By how much surfaces of walls have moved since the list was made, m.
    pub(crate) wall_shift: f64,
    pub(crate) order: Vec<u32>,
    pub(crate) old_sphere_place: Vec<u32>,
    /// Where each sphere of the old list is now.
    pub(crate) new_sphere_place: Vec<u32>,
    pub(crate) placed: Vec<PlacedWall>,
    /// Walls at a step to come.
    pub(crate) placed_later: Vec<PlacedWall>,
    /// Walls when the list was made.
    pub(crate) placed_then: Vec<PlacedWall>,
    pub(crate) wrenches: Wrenches,
    pub(crate) pair_yield: Vec<ChunkYield>,
    pub(crate) near_yield: Vec<ChunkYield>,
    pub(crate) wall_yield: Vec<ChunkYield>,
    /// Which of those of near pairs and of walls hold near pairs in action or an overlap that is too deep.
    pub(crate) near_told: Vec<bool>,
    /// Of chunks of touching pairs in the order in which they were computed.
    pub(crate) pair_told: Vec<bool>,
    pub(crate) wall_told: Vec<bool>,
    pub(crate) body_yield: Vec<BodyYield>,
    /// Most places from the owner of the first near pair of a chunk to any sphere in it, in a far bed.
    pub(crate) near_window: usize,
    /// More than any body moves in a step, m.
    pub(crate) stride: f64,
    /// Steps to come in which the list is not asked whether it still holds.
    pub(crate) hold: u64,
    /// Steps that are taken in one sweep.
    pub(crate) tiers: Vec<Tier>,
    /// Of which touching pairs `wrenches` are those of the last step.
    pub(crate) kept: Kept,
    /// How one pass is shared out.
    pub(crate) strips: Strips,
    /// How walls, near pairs and what is computed ahead are shared out.
    pub(crate) shares: Shares,
    /// The list in one strip, in a far bed.
    pub(crate) whole: Strips,
    /// For each strip, sums of touching pairs of the bodies that it has not finished yet.
    pub(crate) rings: Vec<Ring>,
    pub(crate) strip_yield: Vec<StripYield>,
    /// Ends of near pairs in action by pieces of spheres.
    pub(crate) late_ends: LateEnds,
    /// Nearest points of meshes, by entry of the wall list.
    pub(crate) mesh_nearest: Vec<Option<crate::geometry::Nearest>>,
}

/// What one strip yields.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct StripYield {
    /// A body may have left the range of the list, or is nowhere.
    pub(crate) moved_far: bool,
    /// Two overlap too deeply.
    pub(crate) deep: bool,
    /// Pieces that have moved on: those before it.
    pub(crate) drifted: usize,
    /// What it has taken, s.
    pub(crate) seconds: f64,
}

/// What one chunk of bodies yields.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct BodyYield {
    /// A body may have left the range of the list, or is nowhere.
    pub(crate) moved_far: bool,
    pub(crate) flow: Flow,
}

/// A world of particles and walls under the contact model `M`, advanced by the integrator `I`.
///
/// Made by [`crate::builder::WorldBuilder`].
#[derive(Debug, Clone)]
pub struct World<M: ContactLaw, I: Integrator = VelocityVerlet> {
    pub(crate) make: Make<M>,
    pub(crate) integrator: I,
    pub(crate) state: State,
    pub(crate) scratch: Scratch,
    pub(crate) team: Team,
    pub(crate) ledger_wanted: bool,
}

/// Force and torque of all particles on a wall.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WallLoad {
    /// Force on the wall, N.
    pub force: DVec3,
    /// Torque on the wall about the point of its rotation axis (about the origin if it does not
    /// rotate), N m.
    pub torque: DVec3,
    /// Number of contacts.
    pub contacts: usize,
}

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Number of particles (spheres and clumps).
    pub fn len(&self) -> usize {
        self.state.bodies.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All particles, in the order of adding.
    pub fn particles(&self) -> impl Iterator<Item = ParticleId> + use<M, I> {
        (0..self.len() as u32).map(ParticleId)
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.state.step as f64 * self.make.dt
    }

    /// Steps done so far.
    pub fn step_number(&self) -> u64 {
        self.state.step
    }

    /// Time step, s.
    pub fn time_step(&self) -> f64 {
        self.make.dt
    }

    fn place(&self, particle: ParticleId) -> usize {
        self.state.bodies.place[particle.0 as usize] as usize
    }

    /// Centre of mass, m.
    ///
    /// # Panics
    /// For a particle that this world does not have, as all such queries do.
    pub fn position(&self, particle: ParticleId) -> DVec3 {
        self.state.bodies.position[self.place(particle)].vector()
    }

    /// Velocity of the centre of mass, m/s.
    pub fn velocity(&self, particle: ParticleId) -> DVec3 {
        self.state.bodies.velocity[self.place(particle)].vector()
    }

    /// Angular velocity in the laboratory frame, rad/s.
    pub fn spin(&self, particle: ParticleId) -> DVec3 {
        self.state.bodies.spin[self.place(particle)].vector()
    }

    /// Acceleration of the centre of mass at the end of the last step, m/s2.
    pub fn acceleration(&self, particle: ParticleId) -> DVec3 {
        self.state.bodies.acceleration[self.place(particle)].vector()
    }

    /// Radius of a sphere, or of the sphere about a clump's centre that holds it, m.
    pub fn radius(&self, particle: ParticleId) -> f64 {
        self.state.bodies.position[self.place(particle)].w
    }

    /// Mass, kg.
    pub fn mass(&self, particle: ParticleId) -> f64 {
        self.state.bodies.velocity[self.place(particle)].w
    }

    /// Material.
    pub fn material(&self, particle: ParticleId) -> MaterialId {
        MaterialId(self.state.bodies.mean_spin[self.place(particle)].w as u16)
    }

    /// Turn from a clump's frame of description to the laboratory; the identity for a sphere,
    /// whose attitude is not followed.
    pub fn orientation(&self, particle: ParticleId) -> DQuat {
        let place = self.place(particle);
        match self.state.members.shape.get(place) {
            Some(&shape) if shape != SPHERE => {
                let clump = &self.make.shapes[shape as usize];
                self.state.members.attitude[place] * clump.principal.conjugate()
            }
            _ => DQuat::IDENTITY,
        }
    }

    /// Electric charge, C.
    pub fn charge(&self, particle: ParticleId) -> f64 {
        self.state.bodies.velocities[self.place(particle)][END].w
    }

    /// Set a particle's velocity (m/s) and angular velocity (rad/s).
    ///
    /// # Errors
    /// [`Error::NoSuch`] for an unknown particle, [`Error::Vector`] for values not finite.
    pub fn set_velocity(
        &mut self,
        particle: ParticleId,
        velocity: DVec3,
        spin: DVec3,
    ) -> Result<(), Error> {
        if particle.0 as usize >= self.len() {
            return Err(Error::NoSuch {
                what: "particle",
                number: particle.0 as usize,
                count: self.len(),
            });
        }
        crate::error::finite("velocity (m/s)", velocity)?;
        crate::error::finite("spin (rad/s)", spin)?;
        let place = self.place(particle);
        self.state.bodies.velocity[place].set(velocity);
        self.state.bodies.spin[place].set(spin);
        self.state.forces_stale = true;
        Ok(())
    }

    /// Go on with another gravity.
    ///
    /// # Errors
    /// [`Error::Vector`] or [`Error::Parameter`] for values not finite.
    pub fn set_gravity(&mut self, gravity: Gravity) -> Result<(), Error> {
        gravity.check()?;
        self.make.gravity = gravity;
        self.state.forces_stale = true;
        Ok(())
    }

    /// Gravity.
    pub fn gravity(&self) -> Gravity {
        self.make.gravity
    }

    /// Go on with another drag, or none.
    ///
    /// # Errors
    /// [`Error::Parameter`] for values that are negative or not finite.
    pub fn set_drag(&mut self, drag: Option<Drag>) -> Result<(), Error> {
        if let Some(d) = &drag {
            d.check()?;
        }
        self.make.drag = drag;
        self.state.forces_stale = true;
        Ok(())
    }

    /// Number of walls.
    pub fn walls(&self) -> usize {
        self.make.walls.len()
    }

    /// Let a wall go on with another motion, from where it is.
    ///
    /// # Errors
    /// [`Error::NoSuch`] for an unknown wall; [`Error::Vector`] or [`Error::Parameter`] for a
    /// motion that is not finite.
    pub fn set_wall_motion(&mut self, wall: usize, motion: Motion) -> Result<(), Error> {
        motion.check()?;
        let (time, count) = (self.time(), self.walls());
        let state = self.state.walls.get_mut(wall).ok_or(Error::NoSuch {
            what: "wall",
            number: wall,
            count,
        })?;
        state.change(motion, time);
        // The displacement of walls since the list was made is bounded from the present motion.
        self.state.list_stale = true;
        self.state.forces_stale = true;
        Ok(())
    }

    /// Present motion of a wall.
    ///
    /// # Errors
    /// [`Error::NoSuch`] for an unknown wall.
    pub fn wall_motion(&self, wall: usize) -> Result<MotionState, Error> {
        self.state.walls.get(wall).copied().ok_or(Error::NoSuch {
            what: "wall",
            number: wall,
            count: self.walls(),
        })
    }

    /// Force and torque of the particles on a wall at the end of the last step.
    ///
    /// # Errors
    /// [`Error::NoSuch`] for an unknown wall.
    pub fn wall_load(&self, wall: usize) -> Result<WallLoad, Error> {
        let motion = self.wall_motion(wall)?;
        let about = match motion.motion.rotation {
            Some(_) => motion.velocity(self.time()).point,
            None => DVec3::ZERO,
        };
        let list = &self.state.wall_list;
        let mut load = WallLoad::default();
        for entry in 0..list.len().min(self.scratch.wrenches.wall_force.len()) {
            if list.wall[entry] as usize != wall || list.active[entry] & TOUCHES == 0 {
                continue;
            }
            let force = -self.scratch.wrenches.wall_force[entry].vector();
            let centre = self.sphere_positions()[list.sphere[entry] as usize].vector();
            let about_centre = self.scratch.wrenches.wall_torque_on_wall[entry].vector();
            load.force += force;
            load.torque += (centre - about).cross(force) + about_centre;
            load.contacts += 1;
        }
        Ok(load)
    }

    /// The energy ledger now. The remainder counts from the first call of [`World::open_ledger`].
    pub fn energy(&self) -> Energy {
        let mut e = self.energy_of_state();
        let l = &self.state.ledger;
        e.elastic = l.last.elastic;
        e.dissipated = l.dissipated;
        e.work_of_walls = l.work_of_walls;
        e.work_of_gravity_turn = l.work_of_gravity_turn;
        if l.open {
            e.remainder = e.mechanical() + e.dissipated.total()
                - e.work_of_walls
                - e.work_of_gravity_turn
                - l.start;
        }
        e
    }

    fn energy_of_state(&self) -> Energy {
        let mut e = Energy::default();
        let g = self.make.gravity.at(self.time());
        let b = &self.state.bodies;
        for k in 0..b.len() {
            let mass = b.velocity[k].w;
            e.kinetic_translation += 0.5 * mass * b.velocity[k].vector().length_squared();
            let w = b.spin[k].vector();
            e.kinetic_rotation += match self.state.members.shape.get(k) {
                Some(&shape) if shape != SPHERE => {
                    let local = self.state.members.attitude[k].conjugate() * w;
                    0.5 * local.dot(local * self.make.shapes[shape as usize].moments)
                }
                _ => 0.5 * b.spin[k].w * w.length_squared(),
            };
            e.potential -= mass * g.dot(b.position[k].vector());
        }
        e
    }

    /// Open the energy ledger here (or anew): from now on every law's losses are booked.
    ///
    /// Booking reads the forces and never changes them.
    ///
    /// # Errors
    /// A [`crate::error::Fault`] found while the present forces are computed.
    pub fn open_ledger(&mut self) -> Result<(), Error> {
        self.ledger_wanted = true;
        self.refresh_flow()?;
        let last = self.state.ledger.last;
        self.state.ledger = Ledger { open: true, last, ..Ledger::default() };
        let mut e = self.energy_of_state();
        e.elastic = last.elastic;
        self.state.ledger.start = e.mechanical();
        Ok(())
    }

    /// Number of times that the neighbour list was made.
    pub fn list_builds(&self) -> u64 {
        self.state.list.builds
    }

    /// Pairs in the neighbour list.
    pub fn list_pairs(&self) -> usize {
        self.state.pairs.touching + self.state.pairs.near().len()
    }

    /// Pairs of spheres in contact at the end of the last step.
    pub fn contact_count(&self) -> usize {
        self.state.pairs.active.iter().filter(|&&a| a & TOUCHES != 0).count()
    }

    pub(crate) fn has_clumps(&self) -> bool {
        !self.make.shapes.is_empty()
    }

    /// Centres and radii of all spheres.
    pub(crate) fn sphere_positions(&self) -> &[Record] {
        self.state.sphere_positions(self.has_clumps())
    }
}

impl State {
    fn sphere_positions(&self, clumps: bool) -> &[Record] {
        if clumps { &self.members.position } else { &self.bodies.position }
    }
}

/// The spheres that contacts see: the bodies themselves, or the members of clumps, which turned for `dt`.
pub(crate) fn sphere_view<'a>(
    b: &'a Bodies,
    m: &'a Members,
    clumps: bool,
    dt: f64,
) -> SphereView<'a> {
    let (centre, end_spin) = (b.position[..].into(), m.end_spin[..].into());
    let view = ClumpView { body: &m.body, centre, end_spin, dt };
    SphereView {
        position: if clumps { m.position[..].into() } else { b.position[..].into() },
        velocities: b.velocities[..].into(),
        mean_spin: b.mean_spin[..].into(),
        clumps: clumps.then_some(view),
    }
}
