//! Turns of clumps, and where their spheres are: eight bodies at once, by the same operations as one.

use glam::{DQuat, DVec3};

use super::lanes::{Lanes, Numbers, RECORD, V3};
use super::{Arithmetic, Level, widened};
use crate::body_stage::Farthest;
use crate::particles::Record;
use crate::rigid::{Clump, axes_of, free_turn, spin_of};
use crate::world::SPHERE;

/// Work on a chunk of bodies.
pub(crate) trait OnBodies: Sized {
    /// Do it for one body after another.
    fn one_by_one(&mut self);
    /// Do it for eight at a time: the same operations on each.
    fn eights<V: Lanes>(&mut self);
    /// Do it with the registers of `level`.
    fn run(mut self, level: Level, arithmetic: Arithmetic) {
        widened(
            level,
            #[inline(always)]
            || {
                #[cfg(target_arch = "x86_64")]
                {
                    use super::{avx2::Pair, avx512::Wide};
                    match (level, arithmetic) {
                        (Level::Portable, _) => self.one_by_one(),
                        (Level::Avx512, Arithmetic::Exact) => self.eights::<Wide<false, false>>(),
                        (Level::Avx512, _) => self.eights::<Wide<true, false>>(),
                        (Level::Avx2, Arithmetic::Exact) => self.eights::<Pair<false>>(),
                        (Level::Avx2, _) => self.eights::<Pair<true>>(),
                    }
                }
                #[cfg(not(target_arch = "x86_64"))]
                self.one_by_one();
            },
        );
    }
}

/// Clumps of a chunk of bodies that turn freely.
pub(crate) struct Turning<'a> {
    pub(crate) shapes: &'a [Clump],
    /// Shape of each body; single spheres are passed over.
    pub(crate) shape: &'a [u32],
    pub(crate) torque: &'a [Record],
    pub(crate) attitude: &'a mut [DQuat],
    pub(crate) mean_spin: &'a mut [Record],
    pub(crate) end_spin: &'a mut [Record],
    /// Angular momentum at the start, with the torque of half a step when they have turned.
    pub(crate) momentum: &'a mut [Record],
    /// Time step, s.
    pub(crate) dt: f64,
    pub(crate) since: Since<'a>,
    /// How far spheres of clumps have moved.
    pub(crate) farthest: &'a mut Farthest,
}

/// Where the bodies of a chunk were when the list was made, and how far the frame of the list has turned since.
#[derive(Clone, Copy)]
pub(crate) struct Since<'a> {
    pub(crate) position: &'a [Record],
    /// Positions then; square of the displacement that calls for a list, m2.
    pub(crate) reference: &'a [Record],
    pub(crate) attitude: &'a [DQuat],
    /// Columns of the rotation, the translation.
    pub(crate) frame: &'a [Record; 4],
    pub(crate) turn: DQuat,
}

/// At least how far any sphere of a body has moved in a turned frame: its centre at most `reach` from the body's, which went from
/// `reference` to `position` while the attitude went from `then` to `now`.
///
/// Two rotations with quaternions `p` and `q` take a vector to places that are at most `2 |p - q|` of its length apart: their chord
/// is `4 sin(a/4) cos(a/4)` for an angle `a` between them, and `|p - q|` is `2 sin(a/4)`. Of `q` and `-q`, which
/// are the same rotation, the nearer one counts.
#[inline(always)]
fn moved_since<V: Numbers>(
    [x, y, z, shift]: [V3<V>; 4],
    turn: [V; 4],
    [reference, position]: [V3<V>; 2],
    [then, now]: [[V; 4]; 2],
    reach: V,
) -> V {
    let image = z.times_plus(reference.z, y.times_plus(reference.y, x * reference.x)) + shift;
    let d = position - image;
    let [a, b, c, w] = turn;
    let [p, q, r, v] = then;
    let (t, o) = (V3 { x: a, y: b, z: c }, V3 { x: p, y: q, z: r });
    let turned = t.cross_plus(o, t.times_plus(v, o * w));
    let scalar = w * v - t.dot(o);
    let (own, l) = (V3 { x: now[0], y: now[1], z: now[2] }, now[3]);
    let (minus, plus) = (own - turned, own + turned);
    let (less, more) = (l - scalar, l + scalar);
    let nearer = less.times_plus(less, minus.dot(minus)).min(more.times_plus(more, plus.dot(plus)));
    nearer.sqrt().times_plus(reach * V::splat(2.0), d.dot(d).sqrt())
}

/// What comes of a turn.
struct Turned<V> {
    attitude: [V; 4],
    mean_spin: V3<V>,
    end_spin: V3<V>,
    momentum: V3<V>,
}

#[inline(always)]
fn turned<V: Numbers>(
    inverse: V3<V>,
    attitude: [V; 4],
    momentum: V3<V>,
    torque: V3<V>,
    dt: f64,
) -> Turned<V> {
    let kick = torque * V::splat(0.5 * dt);
    let momentum = torque.times_plus(V::splat(0.5 * dt), momentum);
    let turn = free_turn(inverse, attitude, momentum, dt);
    let end_spin = spin_of(inverse, turn.attitude, momentum + kick);
    Turned { attitude: turn.attitude, mean_spin: turn.mean_spin, end_spin, momentum }
}

impl OnBodies for Turning<'_> {
    fn one_by_one(&mut self) {
        for (k, &shape) in self.shape.iter().enumerate().filter(|s| *s.1 != SPHERE) {
            let (q, l, t) = (self.attitude[k], &mut self.momentum[k], &self.torque[k]);
            let inverse = self.shapes[shape as usize].moments.recip().into();
            let (before, torque) = (l.vector().into(), t.vector().into());
            let of = turned(inverse, q.to_array(), before, torque, self.dt);
            self.attitude[k] = DQuat::from_array(of.attitude);
            l.set(of.momentum.into());
            self.mean_spin[k].set(of.mean_spin.into());
            self.end_spin[k].set(of.end_spin.into());
            let s = &self.since;
            let frame = s.frame.each_ref().map(|r| r.vector().into());
            let [from, to] = [&s.reference[k], &s.position[k]].map(|r| r.vector().into());
            let attitudes = [s.attitude[k].to_array(), of.attitude];
            let reach = self.shapes[shape as usize].reach;
            let moved = moved_since(frame, s.turn.to_array(), [from, to], attitudes, reach);
            self.farthest.note(moved * moved, s.reference[k].w);
        }
    }

    #[inline(always)]
    fn eights<V: Lanes>(&mut self) {
        let (mut group, mut count) = ([0; 8], 0);
        for k in 0..self.shape.len() {
            if self.shape[k] == SPHERE {
                continue;
            }
            group[count] = k;
            count += 1;
            if count == 8 {
                self.eight::<V>(&group);
                count = 0;
            }
        }
        if count > 0 {
            // Lanes beyond the last repeat the first.
            let first = group[0];
            group[count..].fill(first);
            self.eight::<V>(&group);
        }
    }
}

impl Turning<'_> {
    /// Turn eight; those that are there twice come to the same.
    #[inline(always)]
    fn eight<V: Lanes>(&mut self, group: &[usize; 8]) {
        let s = &self.since;
        let columns: [&[Record]; 4] = [self.torque, self.mean_spin, self.end_spin, self.momentum];
        let (columns, bodies) = (columns.map(<[Record]>::len), self.shape.len());
        let since = [s.position.len(), s.reference.len(), s.attitude.len(), self.attitude.len()];
        assert!(columns.iter().chain(&since).all(|len| *len >= bodies));
        assert!(group.iter().all(|k| *k < bodies));
        let mut at = [0; 8];
        for (at, k) in at.iter_mut().zip(group) {
            *at = RECORD * *k as u32;
        }
        let (inverse, reach) = self.inverse_and_reach::<V>(group);
        // SAFETY of these and of what is put there: all columns have the bodies of the group.
        let [attitude, momentum, torque, mean] = unsafe {
            [
                attitudes::<V>(self.attitude, &at),
                records(self.momentum, &at),
                records(self.torque, &at),
                records(self.mean_spin, &at),
            ]
        };
        let of = turned(inverse, attitude, V3::of(momentum), V3::of(torque), self.dt);
        let [from, to, then] = unsafe {
            [records::<V>(s.reference, &at), records(s.position, &at), attitudes(s.attitude, &at)]
        };
        let (l, spin, end) = (of.momentum, of.mean_spin, of.end_spin);
        unsafe {
            V::put_quads(of.attitude, self.attitude.as_mut_ptr().cast(), &at);
            let to = self.momentum.as_mut_ptr().cast();
            V::put_quads([l.x, l.y, l.z, momentum[3]], to, &at);
            let to = self.mean_spin.as_mut_ptr().cast();
            V::put_quads([spin.x, spin.y, spin.z, mean[3]], to, &at);
            let to = self.end_spin.as_mut_ptr().cast();
            V::put_quads([end.x, end.y, end.z, V::splat(0.0)], to, &at);
        }
        let [x, y, z, shift] = s.frame;
        let frame = [alike::<V>(x), alike(y), alike(z), alike(shift)];
        let centres = [V3::of(from), V3::of(to)];
        let [a, b, c, w] = s.turn.to_array();
        let turn = [V::splat(a), V::splat(b), V::splat(c), V::splat(w)];
        let moved = moved_since(frame, turn, centres, [then, of.attitude], reach);
        let (square, limits) = (moved * moved, from[3]);
        // Also if it is no number.
        let beyond = limits.less(square) | !square.less(V::splat(f64::INFINITY));
        self.farthest.too_far |= beyond != 0;
        if V::splat(self.farthest.square).less(square) != 0 {
            let mut squares = [0.0; 8];
            square.store(&mut squares);
            for (square, &k) in squares.into_iter().zip(group) {
                self.farthest.note(square, s.reference[k].w);
            }
        }
    }

    /// One over the principal moments of eight bodies, and how far their spheres reach.
    #[inline(always)]
    fn inverse_and_reach<V: Lanes>(&self, group: &[usize; 8]) -> (V3<V>, V) {
        let shape = self.shape[group[0]];
        if group.iter().all(|k| self.shape[*k] == shape) {
            let of = &self.shapes[shape as usize];
            let inverse = Record::new(of.moments.recip(), of.reach);
            return (alike(&inverse), V::splat(inverse.w));
        }
        let each = group.map(|k| {
            let of = &self.shapes[self.shape[k] as usize];
            Record::new(of.moments.recip(), of.reach)
        });
        // SAFETY: there are eight.
        let [x, y, z, reach] = unsafe { V::gather(each[..].into(), &[0, 1, 2, 3, 4, 5, 6, 7]) };
        (V3 { x, y, z }, reach)
    }
}

/// Spheres of a chunk of bodies that are put in their places.
pub(crate) struct Placing<'a> {
    pub(crate) shapes: &'a [Clump],
    pub(crate) shape: &'a [u32],
    pub(crate) attitude: &'a [DQuat],
    /// Centres of the bodies.
    pub(crate) centre: &'a [Record],
    /// First sphere of each body, and of the one behind the last.
    pub(crate) first: &'a [u32],
    /// Of the spheres: centre; radius.
    pub(crate) position: &'a mut [Record],
}

/// Where a sphere at `own` of the body's frame is, by the body's axes and centre.
#[inline(always)]
fn place<V: Numbers>([x, y, z]: [V3<V>; 3], centre: V3<V>, own: DVec3) -> V3<V> {
    let [a, b, c] = [V::splat(own.x), V::splat(own.y), V::splat(own.z)];
    if V::FUSED {
        return z.times_plus(c, y.times_plus(b, x.times_plus(a, centre)));
    }
    centre + (x * a + y * b + z * c)
}

impl OnBodies for Placing<'_> {
    fn one_by_one(&mut self) {
        (0..self.shape.len()).for_each(|k| self.one(k));
    }

    #[inline(always)]
    fn eights<V: Lanes>(&mut self) {
        let mut k = 0;
        while k < self.shape.len() {
            let shape = self.shape[k];
            if shape == SPHERE {
                self.one(k);
                k += 1;
                continue;
            }
            let alike = self.shape[k..].iter().take(8).take_while(|s| **s == shape).count();
            self.some::<V>(k, alike, shape);
            k += alike;
        }
    }
}

impl Placing<'_> {
    /// Where the spheres of body `k` begin in this chunk.
    #[inline(always)]
    fn begin(&self, k: usize) -> usize {
        (self.first[k] - self.first[0]) as usize
    }

    /// Place the spheres of one body.
    #[inline(always)]
    fn one(&mut self, k: usize) {
        let (begin, centre) = (self.begin(k), self.centre[k]);
        if self.shape[k] == SPHERE {
            self.position[begin] = centre;
            return;
        }
        let axes = axes_of(self.attitude[k].to_array());
        for (nth, s) in self.shapes[self.shape[k] as usize].spheres.iter().enumerate() {
            let own = DVec3::from(place(axes, centre.vector().into(), s.centre));
            self.position[begin + nth] = Record::new(own, s.radius);
        }
    }

    /// Place the spheres of up to eight bodies of one shape, from `k` on.
    #[inline(always)]
    fn some<V: Lanes>(&mut self, k: usize, count: usize, shape: u32) {
        assert!(k + count <= self.attitude.len() && k + count <= self.centre.len());
        let spheres = &self.shapes[shape as usize].spheres;
        let (begin, step) = (self.begin(k), spheres.len());
        assert!(count > 0 && begin + count * step <= self.position.len());
        let (mut own, mut at) = ([0; 8], [0; 8]);
        for (lane, (own, at)) in own.iter_mut().zip(&mut at).enumerate() {
            // Lanes beyond the last do what it does.
            let lane = lane.min(count - 1);
            *own = RECORD * (k + lane) as u32;
            *at = RECORD * (lane * step) as u32;
        }
        // SAFETY: as was just asked.
        let (attitude, centre) =
            unsafe { (attitudes::<V>(self.attitude, &own), records::<V>(self.centre, &own)) };
        let (axes, centre) = (axes_of(attitude), V3::of(centre));
        let to = self.position[begin..].as_mut_ptr();
        for (nth, s) in spheres.iter().enumerate() {
            let (x, radius) = (place(axes, centre, s.centre), V::splat(s.radius));
            // SAFETY: bodies of as many spheres lie within the slice.
            unsafe { V::put_quads([x.x, x.y, x.z, radius], to.add(nth).cast(), &at) }
        }
    }
}

/// The vector of a record in all lanes.
#[inline(always)]
fn alike<V: Lanes>(record: &Record) -> V3<V> {
    V3 { x: V::splat(record.x), y: V::splat(record.y), z: V::splat(record.z) }
}

/// Fields of eight records, which begin at these numbers.
///
/// # Safety
/// All of them can be read.
#[inline(always)]
unsafe fn records<V: Lanes>(from: &[Record], at: &[u32; 8]) -> [V; 4] {
    // SAFETY: by the caller; a record is four numbers.
    unsafe { V::quads::<1>(from.as_ptr().cast(), at) }
}

/// A quaternion is four numbers, the vector first.
const _: () = assert!(
    size_of::<DQuat>() == 32
        && std::mem::offset_of!(DQuat, x) == 0
        && std::mem::offset_of!(DQuat, y) == 8
        && std::mem::offset_of!(DQuat, z) == 16
        && std::mem::offset_of!(DQuat, w) == 24
);

/// The same of attitudes.
///
/// # Safety
/// As of [`records`].
#[inline(always)]
unsafe fn attitudes<V: Lanes>(from: &[DQuat], at: &[u32; 8]) -> [V; 4] {
    // SAFETY: by the caller, and see above.
    unsafe { V::quads::<1>(from.as_ptr().cast(), at) }
}

#[cfg(test)]
#[path = "clumps_tests.rs"]
mod tests;
