//! The portable contact kernel: any model, one contact at a time.

use std::sync::Arc;

use glam::DVec3;

use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::Memory;
use crate::contact::model::{ContactLaw, ContactResponse};
use crate::energy::Flow;
use crate::gap_force::GapForce;
use crate::geometry::{Nearest, PlacedWall};
use crate::material::MaterialId;
use crate::neighbour::Period;
use crate::neighbour::verlet_list::{LANES, memory_index, memory_of};
use crate::noncontact::Separation;
use crate::particles::{END, MEAN};
use crate::spheres::SphereView;

/// Most numbers that a contact may remember.
pub(crate) const MAX_SLOTS: usize = 48;

/// Marks of a pair: its bodies touch (or hang together by a neck); they act across a gap.
pub(crate) const TOUCHES: u8 = 1;
pub(crate) const PULLS: u8 = 2;

/// Everything that a contact kernel reads.
#[derive(Clone, Copy)]
pub(crate) struct Contacts<'a, M> {
    pub(crate) spheres: SphereView<'a>,
    pub(crate) walls: &'a [PlacedWall],
    /// Laws by material times material.
    pub(crate) laws: &'a [M],
    pub(crate) materials: usize,
    pub(crate) period: Option<Period>,
    pub(crate) dt: f64,
    /// Largest overlap over the smaller radius.
    pub(crate) overlap_limit: f64,
    /// Largest gap across which any contact can act.
    pub(crate) neck: f64,
    /// Forces across gaps.
    pub(crate) gap_forces: &'a [Arc<dyn GapForce>],
    /// Whether powers and energies are wanted.
    pub(crate) ledger: bool,
}

/// Effect of one contact, as the spheres collect it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Wrench {
    /// Force on the first sphere; the second feels the opposite.
    pub(crate) force: DVec3,
    pub(crate) torque_on_first: DVec3,
    pub(crate) torque_on_second: DVec3,
}

/// Too deep an overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DeepOverlap {
    pub(crate) sphere: u32,
    /// Other sphere, or number of the wall.
    pub(crate) partner: u32,
    pub(crate) with_wall: bool,
    pub(crate) fraction: f64,
}

/// What one chunk of contacts yields besides its wrenches.
#[derive(Debug, Clone, Default)]
pub(crate) struct ChunkYield {
    pub(crate) flow: Flow,
    pub(crate) deep: Option<DeepOverlap>,
    /// Near pairs that act now.
    pub(crate) late: Vec<Late>,
}

impl ChunkYield {
    /// Room for what a chunk of near pairs usually yields.
    pub(crate) fn with_room() -> Self {
        Self { late: Vec::with_capacity(32), ..Self::default() }
    }

    pub(crate) fn reset(&mut self) {
        self.flow = Flow::default();
        self.deep = None;
        self.late.clear();
    }

    /// Say whether there is anything that a step without a ledger asks for: written only where that has changed, so that who looks finds
    /// it in its own cache as a rule.
    #[inline(always)]
    pub(crate) fn tell(&self, told: &mut bool) {
        let tells = self.deep.is_some() || !self.late.is_empty();
        if *told != tells {
            *told = tells;
        }
    }

    pub(crate) fn note_overlap(&mut self, fraction: f64, sphere: u32, partner: u32, wall: bool) {
        if self.deep.is_none_or(|d| fraction > d.fraction) {
            self.deep = Some(DeepOverlap { sphere, partner, with_wall: wall, fraction });
        }
    }
}

/// The deeper of two overlaps, the first of equals.
pub(crate) fn deeper(a: Option<DeepOverlap>, b: Option<DeepOverlap>) -> Option<DeepOverlap> {
    match (a, b) {
        (Some(a), Some(b)) if b.fraction > a.fraction => Some(b),
        (a, b) => a.or(b),
    }
}

/// A near pair in action.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Late {
    pub(crate) first: u32,
    pub(crate) second: u32,
    pub(crate) wrench: Wrench,
}

/// Remembered numbers of a run of contacts that begins with a whole block.
pub(crate) struct MemoryRun<'a> {
    pub(crate) slots: usize,
    pub(crate) numbers: &'a mut [f64],
}

impl MemoryRun<'_> {
    /// What the laws of contact number `contact` remember; forces across gaps come behind it.
    #[inline(always)]
    fn own<T: Memory>(&mut self, contact: usize) -> &mut [f64] {
        &mut self.numbers[memory_of(self.slots, contact)][..T::SLOTS]
    }
}

const _: () = assert!(LANES.is_power_of_two());

impl<M: ContactLaw> Contacts<'_, M> {
    #[inline(always)]
    fn law(&self, a: f64, b: f64) -> &M {
        &self.laws[a as usize * self.materials + b as usize]
    }

    /// What spheres `a` (first) and `b` do to each other, if anything.
    #[inline(always)]
    pub(crate) fn pair(
        &self,
        a: u32,
        b: u32,
        contact: usize,
        active: &mut u8,
        memory: &mut MemoryRun<'_>,
        into: &mut ChunkYield,
    ) -> Option<Wrench> {
        let touch = self.touch(a, b, contact, active, memory, into);
        if self.gap_forces.is_empty() {
            return touch;
        }
        let s = &self.spheres;
        let (i, j) = (a as usize, b as usize);
        let (pi, pj) = (s.position[i], s.position[j]);
        let (bi, bj) = (s.body(i), s.body(j));
        let (vi, vj) = (&s.velocities[bi][MEAN], &s.velocities[bj][MEAN]);
        let d = Period::shortest(self.period, pj.vector() - pi.vector());
        let distance = d.length();
        let pair = PairGeometry {
            r_star: pi.w * pj.w / (pi.w + pj.w),
            m_star: vi.w * vj.w / (vi.w + vj.w),
            radius_i: pi.w,
            radius_j: pj.w,
        };
        let separation = Separation {
            normal_i_to_j: d / distance,
            gap: distance - pi.w - pj.w,
            distance,
            charge_i: s.velocities[bi][END].w,
            charge_j: s.velocities[bj][END].w,
        };
        let materials = [s.mean_spin[bi].w, s.mean_spin[bj].w];
        let pull = self.across(materials, &pair, &separation, contact, active, memory, into);
        pulled(touch, pull)
    }

    /// Forces across the gap (or overlap) of one pair of bodies.
    #[cold]
    fn across(
        &self,
        materials: [f64; 2],
        pair: &PairGeometry,
        separation: &Separation,
        contact: usize,
        active: &mut u8,
        memory: &mut MemoryRun<'_>,
        into: &mut ChunkYield,
    ) -> Option<DVec3> {
        let [a, b] = materials.map(|m| MaterialId(m as u16));
        let mut offset = <M::Memory as Memory>::SLOTS;
        let mut sum = None;
        for force in self.gap_forces {
            let slots = force.slots();
            let mut buffer: crate::gap_force::Slots = [0.0; MAX_SLOTS];
            let index = |slot| memory_index(memory.slots, contact, offset + slot);
            for (slot, value) in buffer.iter_mut().enumerate().take(slots) {
                *value = memory.numbers[index(slot)];
            }
            if let Some(r) = force.respond(a, b, pair, separation, &mut buffer) {
                *sum.get_or_insert(DVec3::ZERO) += r.force_on_i(separation);
                if self.ledger {
                    into.flow.elastic += r.energy;
                    if self.dt > 0.0 {
                        into.flow.cohesion += r.lost_energy / self.dt;
                    }
                }
            }
            for (slot, value) in buffer.iter().enumerate().take(slots) {
                memory.numbers[index(slot)] = *value;
            }
            offset += slots;
        }
        *active = (*active & TOUCHES) | if sum.is_some() { PULLS } else { 0 };
        sum
    }

    /// Contact of spheres `a` (first) and `b`, if they touch.
    #[inline(always)]
    fn touch(
        &self,
        a: u32,
        b: u32,
        contact: usize,
        active: &mut u8,
        memory: &mut MemoryRun<'_>,
        into: &mut ChunkYield,
    ) -> Option<Wrench> {
        let s = &self.spheres;
        let (i, j) = (a as usize, b as usize);
        let (pi, pj) = (s.position[i], s.position[j]);
        let d = Period::shortest(self.period, pj.vector() - pi.vector());
        let distance_squared = d.length_squared();
        let touching = pi.w + pj.w;
        let reach = if *active & TOUCHES != 0 { touching + self.neck } else { touching };
        if distance_squared >= reach * reach {
            if *active & TOUCHES != 0 {
                *active &= !TOUCHES;
                memory.own::<M::Memory>(contact).fill(0.0);
            }
            return None;
        }
        let distance = distance_squared.sqrt();
        let overlap = touching - distance;
        let (mi, mj) = (s.motion(i), s.motion(j));
        let (vi, vj) = (mi.mean_velocity, mj.mean_velocity);
        let (wi, wj) = (mi.mean_spin, mj.mean_spin);
        let law = self.law(wi.w, wj.w);
        let pair = PairGeometry {
            r_star: pi.w * pj.w / touching,
            m_star: vi.w * vj.w / (vi.w + vj.w),
            radius_i: pi.w,
            radius_j: pj.w,
        };
        if overlap <= 0.0 && -overlap > law.reach(&pair) {
            *active &= !TOUCHES;
            memory.own::<M::Memory>(contact).fill(0.0);
            return None;
        }
        *active |= TOUCHES;
        if overlap > self.overlap_limit * pi.w.min(pj.w) {
            into.note_overlap(overlap / pi.w.min(pj.w), a, b, false);
        }
        let n = d * (1.0 / distance);
        let (lever_i, lever_j) = (pi.w - 0.5 * overlap, pj.w - 0.5 * overlap);
        let (wi, wj) = (wi.vector(), wj.vector());
        let approach = vi.vector() - vj.vector();
        // Slip is that of the middle of the step, and so are its levers.
        let back = (0.25 * self.dt) * approach.dot(n);
        let relative = approach + (wi * (lever_i + back) + wj * (lever_j + back)).cross(n);
        let end = mi.end_velocity.vector() - mj.end_velocity.vector();
        let motion = Kinematics {
            normal_i_to_j: n,
            overlap,
            overlap_rate: end.dot(n),
            slip_velocity: relative - n * relative.dot(n),
            spin_i: wi,
            spin_j: wj,
            lever_i,
            lever_j,
            dt: self.dt,
        };
        let mut remembered = M::Memory::load(memory.own::<M::Memory>(contact));
        remembered.transport(n, 0.5 * (wi + wj).dot(n) * self.dt);
        let response = law.respond(&pair, &motion, &mut remembered);
        remembered.store(memory.own::<M::Memory>(contact));
        if self.ledger {
            book(&mut into.flow, &response, self.dt);
        }
        Some(Wrench {
            force: response.force_on_i,
            torque_on_first: response.torque_on_i,
            torque_on_second: response.torque_on_j,
        })
    }

    /// What wall `w`, nearest to sphere `a` at `nearest`, does to it, if anything.
    #[inline(always)]
    pub(crate) fn wall(
        &self,
        a: u32,
        w: u16,
        nearest: &Nearest,
        contact: usize,
        active: &mut u8,
        memory: &mut MemoryRun<'_>,
        into: &mut ChunkYield,
    ) -> Option<Wrench> {
        let touch = self.touch_wall(a, w, nearest, contact, active, memory, into);
        if self.gap_forces.is_empty() || nearest.distance <= 0.0 {
            return touch;
        }
        let s = &self.spheres;
        let i = a as usize;
        let (radius, body) = (s.position[i].w, s.body(i));
        let pair = wall_pair(radius, s.velocities[body][MEAN].w, nearest);
        let separation = Separation {
            normal_i_to_j: nearest.normal_to_wall,
            gap: nearest.distance - radius,
            distance: nearest.distance,
            charge_i: s.velocities[body][END].w,
            charge_j: 0.0,
        };
        let wall = &self.walls[w as usize];
        let materials = [s.mean_spin[body].w, f64::from(wall.material.0)];
        let pull = self.across(materials, &pair, &separation, contact, active, memory, into);
        if let (true, Some(pull)) = (self.ledger, pull) {
            let point = s.position[i].vector() + nearest.normal_to_wall * nearest.distance;
            into.flow.walls += pull.dot(wall.velocity.at(point));
        }
        pulled(touch, pull)
    }

    /// Contact of sphere `a` with wall `w`, if they touch.
    #[inline(always)]
    fn touch_wall(
        &self,
        a: u32,
        w: u16,
        nearest: &Nearest,
        contact: usize,
        active: &mut u8,
        memory: &mut MemoryRun<'_>,
        into: &mut ChunkYield,
    ) -> Option<Wrench> {
        let s = &self.spheres;
        let i = a as usize;
        let radius = s.position[i].w;
        let overlap = radius - nearest.distance;
        let reach = if *active & TOUCHES != 0 { self.neck } else { 0.0 };
        // A centre that is a whole radius behind the surface is not in contact: it is outside.
        if overlap <= -reach || overlap >= 2.0 * radius {
            if *active & TOUCHES != 0 {
                *active &= !TOUCHES;
                memory.own::<M::Memory>(contact).fill(0.0);
            }
            return None;
        }
        let wall = &self.walls[w as usize];
        let own = s.motion(i);
        let law = self.law(own.mean_spin.w, f64::from(wall.material.0));
        let pair = wall_pair(radius, own.mean_velocity.w, nearest);
        if overlap <= 0.0 && -overlap > law.reach(&pair) {
            *active &= !TOUCHES;
            memory.own::<M::Memory>(contact).fill(0.0);
            return None;
        }
        *active |= TOUCHES;
        if overlap > self.overlap_limit * radius {
            into.note_overlap(overlap / radius, a, u32::from(w), true);
        }
        let n = nearest.normal_to_wall;
        let lever_i = nearest.distance;
        let point = s.position[i].vector() + n * nearest.distance;
        let wi = own.mean_spin.vector();
        let spin = wall.mean_velocity.spin;
        let approach = own.mean_velocity.vector() - wall.mean_velocity.at(point);
        // Slip is that of the middle of the step, and so is its lever.
        let back = 0.5 * self.dt * approach.dot(n);
        let relative = approach + (wi * (lever_i + back)).cross(n);
        let wall_end = wall.velocity.at(point);
        let motion = Kinematics {
            normal_i_to_j: n,
            overlap,
            overlap_rate: (own.end_velocity.vector() - wall_end).dot(n),
            slip_velocity: relative - n * relative.dot(n),
            spin_i: wi,
            spin_j: spin,
            lever_i,
            lever_j: 0.0,
            dt: self.dt,
        };
        let mut remembered = M::Memory::load(memory.own::<M::Memory>(contact));
        remembered.transport(n, 0.5 * (wi + spin).dot(n) * self.dt);
        let response = law.respond(&pair, &motion, &mut remembered);
        remembered.store(memory.own::<M::Memory>(contact));
        if self.ledger {
            book(&mut into.flow, &response, self.dt);
            into.flow.walls +=
                response.force_on_i.dot(wall_end) - response.torque_on_j.dot(wall.velocity.spin);
        }
        Some(Wrench {
            force: response.force_on_i,
            torque_on_first: response.torque_on_i,
            // On the wall, about the centre of the sphere.
            torque_on_second: response.torque_on_j - (n * lever_i).cross(response.force_on_i),
        })
    }
}

/// Size of a pair of a sphere and a wall.
#[inline(always)]
fn wall_pair(radius: f64, mass: f64, nearest: &Nearest) -> PairGeometry {
    let curvature = 1.0 / radius + 1.0 / nearest.wall_radius;
    PairGeometry {
        r_star: 1.0 / curvature,
        m_star: mass,
        radius_i: radius,
        radius_j: nearest.wall_radius,
    }
}

/// A contact's wrench and a pull between the centres together.
fn pulled(touch: Option<Wrench>, pull: Option<DVec3>) -> Option<Wrench> {
    match pull {
        None => touch,
        Some(force) => {
            let mut sum = touch.unwrap_or_default();
            sum.force += force;
            Some(sum)
        }
    }
}

/// Add the energies and powers of one contact.
fn book(flow: &mut Flow, response: &ContactResponse, dt: f64) {
    flow.elastic += response.elastic_energy();
    flow.normal += response.normal.dissipated_power;
    flow.cohesion += response.cohesion.dissipated_power;
    // Powers of springs are work over the step: without one there is none.
    if dt > 0.0 {
        flow.tangential += response.tangential.dissipated_power;
        flow.rolling += response.rolling.dissipated_power;
    }
}
