//! Snapshots: the complete restart state of a world as a value.
//!
//! A world that takes a snapshot back goes on bit by bit as the one it was taken from: particles,
//! walls in motion, neighbour list, what contacts remember, energy ledger. What a run does not
//! change (laws, shapes, materials) is not in it: build the world in the same way first.

use glam::{DQuat, DVec3};

use crate::body_force::{Drag, Gravity};
use crate::contact::model::ContactLaw;
use crate::error::Error;
use crate::forces::{Late, Wrench};
use crate::geometry::{Motion, MotionState, PlacedWall, Pose, Rotation, Vibration};
use crate::integrate::Integrator;
use crate::particles::{Column, END, MEAN, Record};
use crate::world::{Kept, State, World, Wrenches};

/// The state of a world at the end of a step.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Snapshot {
    make: Fingerprint,
    gravity: Gravity,
    drag: Option<Drag>,
    ledger_wanted: bool,
    state: State,
    wrenches: Wrenches,
}

/// What a world must have in common with the one that the snapshot was taken from.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Fingerprint {
    bodies: u64,
    walls: u64,
    materials: u64,
    clump_shapes: u64,
    slots: u64,
    dt_bits: u64,
    skin_bits: u64,
}

impl Snapshot {
    /// Step at which it was taken.
    pub fn step_number(&self) -> u64 {
        self.state.step
    }
}

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    fn fingerprint(&self) -> Fingerprint {
        Fingerprint {
            bodies: self.len() as u64,
            walls: self.make.walls.len() as u64,
            materials: self.make.materials.len() as u64,
            clump_shapes: self.make.shapes.len() as u64,
            slots: self.make.slots as u64,
            dt_bits: self.make.dt.to_bits(),
            skin_bits: self.make.skin.to_bits(),
        }
    }

    /// The present state as a value.
    pub fn snapshot(&self) -> Snapshot {
        let mut state = self.state.clone();
        // Made anew in the world that takes it back.
        state.pairs.forget_later();
        Snapshot {
            make: self.fingerprint(),
            gravity: self.make.gravity,
            drag: self.make.drag,
            ledger_wanted: self.ledger_wanted,
            state,
            wrenches: self.scratch.wrenches.clone(),
        }
    }

    /// Go back (or forward) to a snapshot.
    ///
    /// # Errors
    /// [`Error::SnapshotMismatch`] when the snapshot is of a world of another make: another
    /// number of particles, walls, materials, clump shapes or remembered numbers, another time
    /// step or skin.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Error> {
        let (own, its) = (self.fingerprint(), snapshot.make);
        let clumps = self.has_clumps();
        for (what, found, expected) in [
            ("number of particles", its.bodies, own.bodies),
            ("number of walls", its.walls, own.walls),
            ("number of materials", its.materials, own.materials),
            ("number of clump shapes", its.clump_shapes, own.clump_shapes),
            ("numbers remembered by a contact", its.slots, own.slots),
            ("time step (bits)", its.dt_bits, own.dt_bits),
            ("skin (bits)", its.skin_bits, own.skin_bits),
        ] {
            if found != expected {
                return Err(Error::SnapshotMismatch { what, found, expected });
            }
        }
        self.state.clone_from(&snapshot.state);
        // A snapshot of a world with another integrator may hold no memory, or one too many.
        let bodies = &mut self.state.bodies;
        let room = |remembers: bool| if remembers { bodies.id.len() } else { 0 };
        let (linear, angular) = (room(I::REMEMBERS), room(I::REMEMBERS || clumps));
        bodies.linear_memory.resize(linear, Record::default());
        bodies.angular_memory.resize(angular, Record::default());
        self.state.pairs.sort_by_later(self.state.members.seats());
        self.scratch.wrenches.clone_from(&snapshot.wrenches);
        self.scratch.kept = Kept::All;
        self.scratch.strips.forget();
        self.scratch.shares.forget();
        self.scratch.whole.forget();
        self.scratch.near_order.forget();
        self.scratch.wall_gaps.forget();
        // How far bodies have moved since its list was made is not known.
        self.scratch.stride = f64::INFINITY;
        self.make.gravity = snapshot.gravity;
        self.make.drag = snapshot.drag;
        self.ledger_wanted = snapshot.ledger_wanted;
        let place = |time: f64| -> Vec<PlacedWall> {
            (self.make.walls.iter().zip(&self.state.walls))
                .map(|(w, m)| PlacedWall::new(w, m, time, self.make.dt))
                .collect()
        };
        self.scratch.placed = place(self.time());
        self.scratch.placed_then = place(self.state.list.time);
        Ok(())
    }

    /// A number that depends on every bit of the state of the particles: equal for equal runs.
    pub fn state_hash(&self) -> u64 {
        let mut out = Writer::default();
        out.put(&self.state.step);
        for id in self.particles() {
            let k = self.state.bodies.place[id.0 as usize] as usize;
            let b = &self.state.bodies;
            for r in [&b.position[k], &b.velocity[k], &b.spin[k], &b.acceleration[k]] {
                out.put(r);
            }
            if let Some(q) = self.state.members.attitude.get(k) {
                out.put(q);
            }
        }
        fnv(&out.bytes)
    }
}

const MAGIC: u64 = u64::from_le_bytes(*b"demcore5");

impl Snapshot {
    /// The snapshot as bytes: little-endian numbers behind a version mark, with a checksum.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::default();
        out.put(&MAGIC);
        let mut copy = self.clone();
        copy.visit(&mut out);
        let sum = fnv(&out.bytes);
        out.put(&sum);
        out.bytes
    }

    /// The snapshot that [`Snapshot::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`Error::SnapshotCorrupt`] for bytes of another version, cut short, or altered.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let corrupt = |what, offset| Error::SnapshotCorrupt { what, offset };
        let body = bytes.len().checked_sub(8).ok_or(corrupt("too few bytes", 0))?;
        let mut input = Reader { bytes, at: 0, failed: None };
        let mut magic = 0u64;
        input.visit(&mut magic);
        if magic != MAGIC {
            return Err(corrupt("another format or version", 0));
        }
        let mut tail = Reader { bytes, at: body, failed: None };
        let mut sum = 0u64;
        tail.visit(&mut sum);
        if sum != fnv(&bytes[..body]) {
            return Err(corrupt("a checksum that does not match", body));
        }
        let mut out = Snapshot {
            make: Fingerprint::default(),
            gravity: Gravity::default(),
            drag: None,
            ledger_wanted: false,
            state: State::default(),
            wrenches: Wrenches::default(),
        };
        out.visit(&mut input);
        match input.failed {
            Some(offset) => Err(corrupt("a value cut short", offset)),
            None if input.at != body => Err(corrupt("bytes left over", input.at)),
            None => Ok(out),
        }
    }

    fn visit(&mut self, v: &mut impl Visitor) {
        let m = &mut self.make;
        for x in [
            &mut m.bodies,
            &mut m.walls,
            &mut m.materials,
            &mut m.clump_shapes,
            &mut m.slots,
            &mut m.dt_bits,
            &mut m.skin_bits,
        ] {
            v.visit(x);
        }
        v.visit(&mut self.gravity);
        v.visit(&mut self.drag);
        v.visit(&mut self.ledger_wanted);
        let s = &mut self.state;
        v.visit(&mut s.step);
        v.visit(&mut s.forces_stale);
        v.visit(&mut s.list_stale);
        let b = &mut s.bodies;
        v.visit(&mut b.id);
        v.visit(&mut b.place);
        let of_two = |which: usize| b.velocities.iter().map(|of_two| of_two[which]).collect();
        let (mut mean, mut end): (Column<Record>, Column<Record>) = (of_two(MEAN), of_two(END));
        for x in [
            &mut b.position,
            &mut b.velocity,
            &mut b.spin,
            &mut b.acceleration,
            &mut b.angular_acceleration,
            &mut mean,
            &mut b.mean_spin,
            &mut end,
            &mut b.linear_memory,
            &mut b.angular_memory,
        ] {
            v.visit(x);
        }
        b.velocities = mean.iter().zip(&end).map(|(mean, end)| [*mean, *end]).collect();
        let m = &mut s.members;
        for x in [&mut m.id, &mut m.body, &mut m.first, &mut m.shape, &mut m.first_id] {
            v.visit(x);
        }
        for x in [&mut m.position, &mut m.end_spin] {
            v.visit(x);
        }
        v.visit(&mut m.attitude);
        v.visit(&mut s.walls);
        let p = &mut s.pairs;
        for x in [&mut p.slots, &mut p.touching, &mut p.near_begin] {
            v.visit(x);
        }
        for x in [&mut p.first, &mut p.second] {
            v.visit(x);
        }
        for x in [&mut p.touching_start, &mut p.near_start] {
            v.visit(x);
        }
        v.visit(&mut p.active);
        v.visit(&mut p.memory);
        let w = &mut s.wall_list;
        v.visit(&mut w.slots);
        v.visit(&mut w.wall);
        v.visit(&mut w.active);
        v.visit(&mut w.memory);
        v.visit(&mut w.facets_of);
        for x in [&mut w.sphere, &mut w.facet, &mut w.start, &mut w.facets] {
            v.visit(x);
        }
        let l = &mut s.list;
        v.visit(&mut l.reference);
        v.visit(&mut l.attitude);
        v.visit(&mut l.time);
        v.visit(&mut l.turning);
        v.visit(&mut l.builds);
        let e = &mut s.ledger;
        v.visit(&mut e.open);
        let (d, f) = (&mut e.dissipated, &mut e.last);
        for x in [
            &mut e.start,
            &mut d.normal,
            &mut d.tangential,
            &mut d.rolling,
            &mut d.cohesion,
            &mut d.drag,
            &mut e.work_of_walls,
            &mut e.work_of_gravity_turn,
            &mut f.elastic,
            &mut f.normal,
            &mut f.tangential,
            &mut f.rolling,
            &mut f.cohesion,
            &mut f.drag,
            &mut f.walls,
            &mut f.gravity_turn,
        ] {
            v.visit(x);
        }
        let w = &mut self.wrenches;
        for x in [
            &mut w.pair_force,
            &mut w.pair_torque_first,
            &mut w.pair_torque_second,
            &mut w.wall_force,
            &mut w.wall_torque,
            &mut w.wall_torque_on_wall,
        ] {
            v.visit(x);
        }
        v.visit(&mut w.late);
    }
}

/// Goes through the values of a snapshot in one order, for writing and for reading.
trait Visitor {
    fn visit<T: Value>(&mut self, value: &mut T);
}

/// A value that can be written and read.
trait Value: Clone + Default {
    fn write(&self, out: &mut Writer);
    fn read(input: &mut Reader<'_>) -> Self;
}

#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    fn put<T: Value>(&mut self, value: &T) {
        value.write(self);
    }
}

impl Visitor for Writer {
    fn visit<T: Value>(&mut self, value: &mut T) {
        value.write(self);
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    failed: Option<usize>,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let slice = self.bytes.get(self.at..self.at + N);
        match slice.and_then(|s| s.try_into().ok()) {
            Some(array) => {
                self.at += N;
                array
            }
            None => {
                self.failed.get_or_insert(self.at);
                [0; N]
            }
        }
    }
}

impl Visitor for Reader<'_> {
    fn visit<T: Value>(&mut self, value: &mut T) {
        *value = T::read(self);
    }
}

macro_rules! number {
    ($($t:ty),+) => {$(
        impl Value for $t {
            fn write(&self, out: &mut Writer) {
                out.bytes.extend_from_slice(&self.to_le_bytes());
            }
            fn read(input: &mut Reader<'_>) -> Self {
                <$t>::from_le_bytes(input.take())
            }
        }
    )+};
}
number!(u8, u16, u32, u64, f64);

macro_rules! fields {
    ($t:ty: $($field:ident),+) => {
        impl Value for $t {
            fn write(&self, out: &mut Writer) {
                $(out.put(&self.$field);)+
            }
            fn read(input: &mut Reader<'_>) -> Self {
                let mut value = Self::default();
                $(input.visit(&mut value.$field);)+
                value
            }
        }
    };
}
fields!(Record: x, y, z, w);
fields!(DVec3: x, y, z);
fields!(DQuat: x, y, z, w);
fields!(Wrench: force, torque_on_first, torque_on_second);
fields!(Late: first, second, wrench);
fields!(Gravity: acceleration, axis, rate);
fields!(Pose: rotation, translation);
fields!(Motion: velocity, rotation, vibration);
fields!(MotionState: motion, base, since);

impl Value for usize {
    fn write(&self, out: &mut Writer) {
        out.put(&(*self as u64));
    }
    fn read(input: &mut Reader<'_>) -> Self {
        u64::read(input) as usize
    }
}

impl Value for bool {
    fn write(&self, out: &mut Writer) {
        out.put(&u8::from(*self));
    }
    fn read(input: &mut Reader<'_>) -> Self {
        u8::read(input) != 0
    }
}

impl Value for [u32; 2] {
    fn write(&self, out: &mut Writer) {
        out.put(&self[0]);
        out.put(&self[1]);
    }
    fn read(input: &mut Reader<'_>) -> Self {
        [u32::read(input), u32::read(input)]
    }
}

impl<T: Value> Value for Vec<T> {
    fn write(&self, out: &mut Writer) {
        out.put(&self.len());
        for value in self {
            out.put(value);
        }
    }
    fn read(input: &mut Reader<'_>) -> Self {
        let n = usize::read(input);
        // A length that the rest cannot hold is a fault, not a reason to ask for memory.
        if n > input.bytes.len().saturating_sub(input.at) {
            input.failed.get_or_insert(input.at);
            return Self::new();
        }
        (0..n).map(|_| T::read(input)).collect()
    }
}

impl<T: Value> Value for Column<T> {
    fn write(&self, out: &mut Writer) {
        out.put(&self.len());
        for value in self {
            out.put(value);
        }
    }
    fn read(input: &mut Reader<'_>) -> Self {
        Vec::read(input).into_iter().collect()
    }
}

impl Value for Option<Rotation> {
    fn write(&self, out: &mut Writer) {
        out.put(&self.is_some());
        if let Some(r) = self {
            out.put(&r.point);
            out.put(&r.axis);
            out.put(&r.rate);
        }
    }
    fn read(input: &mut Reader<'_>) -> Self {
        bool::read(input).then(|| Rotation {
            point: DVec3::read(input),
            axis: DVec3::read(input),
            rate: f64::read(input),
        })
    }
}

impl Value for Option<Vibration> {
    fn write(&self, out: &mut Writer) {
        out.put(&self.is_some());
        if let Some(v) = self {
            out.put(&v.amplitude);
            out.put(&v.frequency_hz);
            out.put(&v.phase_rad);
        }
    }
    fn read(input: &mut Reader<'_>) -> Self {
        bool::read(input).then(|| Vibration {
            amplitude: DVec3::read(input),
            frequency_hz: f64::read(input),
            phase_rad: f64::read(input),
        })
    }
}

impl Value for Option<Drag> {
    fn write(&self, out: &mut Writer) {
        let (kind, a, b) = match self {
            None => (0u8, 0.0, 0.0),
            Some(Drag::Uniform { rate }) => (1, *rate, 0.0),
            Some(Drag::Stokes { viscosity }) => (2, *viscosity, 0.0),
            Some(Drag::Newton { density, coefficient }) => (3, *density, *coefficient),
        };
        out.put(&kind);
        out.put(&a);
        out.put(&b);
    }
    fn read(input: &mut Reader<'_>) -> Self {
        let (kind, a, b) = (u8::read(input), f64::read(input), f64::read(input));
        match kind {
            1 => Some(Drag::Uniform { rate: a }),
            2 => Some(Drag::Stokes { viscosity: a }),
            3 => Some(Drag::Newton { density: a, coefficient: b }),
            _ => None,
        }
    }
}

/// FNV-1a, 64 bits: finds damage, is no seal. Fowler, Noll & Vo, draft-eastlake-fnv.
fn fnv(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}
