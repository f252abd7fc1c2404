//! A dense random start without overlaps.
//!
//! Particles are thrown at random into the lower part of the drum, where they take up two fifths
//! of the room, with random directions. Then overlapping ones are pushed apart, pair by pair, in
//! rounds, until spheres enlarged by 2 % overlap by less than 1 %: the true ones do not touch, so no
//! contact begins with stored energy, however stiff the material. What cannot be pushed apart
//! does not fit.

use dem_core::glam::{DQuat, DVec3};
use rand::RngExt;

use crate::error::Error;
use crate::grains::{Grains, Stream, generator};

/// Share of the room that particles take up at the start.
const PACKING: f64 = 0.4;
/// Spheres are pushed apart as if they were larger by this factor.
const ENLARGED: f64 = 1.02;
/// Overlap, over the smaller enlarged radius, at which two spheres count as apart.
const APART: f64 = 0.01;
/// Rounds of pushing after which particles do not fit.
const ROUNDS: u32 = 2000;

/// The room for particles: a cylinder about the z axis, centred.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Room {
    pub(crate) radius: f64,
    pub(crate) length: f64,
    pub(crate) periodic: bool,
}

impl Room {
    pub(crate) fn volume(&self) -> f64 {
        std::f64::consts::PI * self.radius * self.radius * self.length
    }

    /// Height of the plane below which the share `fill` of the cross-section lies.
    fn level(&self, fill: f64) -> f64 {
        let below = |y: f64| {
            let c = (y / self.radius).clamp(-1.0, 1.0);
            // Area of the segment below y over that of the circle.
            ((c * (1.0 - c * c).sqrt() + c.asin()) / std::f64::consts::PI) + 0.5
        };
        let (mut low, mut high) = (-self.radius, self.radius);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if below(middle) < fill {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }
}

/// Places and directions of all particles.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Start {
    pub(crate) position: Vec<DVec3>,
    pub(crate) orientation: Vec<DQuat>,
}

impl Start {
    /// The same turned about the drum's axis.
    pub(crate) fn turned(mut self, turn: DQuat) -> Self {
        for p in &mut self.position {
            *p = turn * *p;
        }
        for q in &mut self.orientation {
            *q = (turn * *q).normalize();
        }
        self
    }
}

/// Particles at random, without overlaps.
///
/// # Errors
/// [`Error::DoesNotFit`].
pub(crate) fn start(grains: &Grains, room: &Room, seed: u64) -> Result<Start, Error> {
    let mut random = generator(seed, Stream::Places);
    let solid = grains.solid_volume();
    let fill = solid / (PACKING * room.volume());
    // Room for the largest particle above the level.
    let rim = 2.0 * grains.largest_bounding_radius();
    let top = if fill < 1.0 { (room.level(fill) + rim).min(room.radius) } else { room.radius };
    let mut place = || loop {
        let p = DVec3::new(
            random.random_range(-room.radius..room.radius),
            random.random_range(-room.radius..top),
            random.random_range(-0.5 * room.length..0.5 * room.length),
        );
        if p.x.hypot(p.y) < room.radius {
            return p;
        }
    };
    let position: Vec<DVec3> = (0..grains.len()).map(|_| place()).collect();
    let orientation = if grains.are_clumps() {
        (0..grains.len()).map(|_| direction(&mut random)).collect()
    } else {
        vec![DQuat::IDENTITY; grains.len()]
    };
    let mut crowd = Crowd::new(grains, room, top, position, &orientation);
    let mut overlap = f64::INFINITY;
    // More solid than any packing of equal spheres: no use in pushing.
    if solid / room.volume() < 0.74 {
        for _ in 0..ROUNDS {
            overlap = crowd.push_apart();
            if overlap < APART {
                return Ok(Start { position: crowd.position, orientation });
            }
        }
    }
    Err(Error::DoesNotFit {
        count: grains.len(),
        solid_m3: solid,
        drum_m3: room.volume(),
        rounds: if overlap.is_finite() { ROUNDS } else { 0 },
        overlap: if overlap.is_finite() { overlap } else { 1.0 },
    })
}

/// A uniformly random turn, by the subgroup algorithm (Shoemake, Graphics Gems III, 1992).
fn direction(random: &mut impl RngExt) -> DQuat {
    let [u, v, w] = [0; 3].map(|_| random.random_range(0.0..1.0f64));
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    let (s, t) = (std::f64::consts::TAU * v, std::f64::consts::TAU * w);
    DQuat::from_xyzw(a * s.sin(), a * s.cos(), b * t.sin(), b * t.cos()).normalize()
}

/// Particles that push each other apart.
struct Crowd<'a> {
    room: &'a Room,
    top: f64,
    position: Vec<DVec3>,
    /// Spheres: particle, arm from its centre, enlarged radius.
    spheres: Vec<(u32, DVec3, f64)>,
    /// Spheres by cell.
    head: Vec<u32>,
    next: Vec<u32>,
    cells: [usize; 3],
}

const NONE: u32 = u32::MAX;

impl<'a> Crowd<'a> {
    fn new(
        grains: &Grains,
        room: &'a Room,
        top: f64,
        position: Vec<DVec3>,
        orientation: &[DQuat],
    ) -> Self {
        let balls = (0..grains.len()).flat_map(|k| grains.balls(k, DVec3::ZERO, orientation[k]));
        let spheres: Vec<_> = balls.map(|b| (b.particle, b.centre, b.radius * ENLARGED)).collect();
        let largest = spheres.iter().map(|s| s.2).fold(0.0, f64::max);
        let count = |length: f64| ((length / (2.0 * largest)).floor() as usize).clamp(1, 400);
        let across = count(2.0 * room.radius);
        let cells = [across, across, count(room.length)];
        let head = vec![NONE; cells.iter().product()];
        let next = vec![NONE; spheres.len()];
        Self { room, top, position, spheres, head, next, cells }
    }

    fn cell(&self, p: DVec3) -> [usize; 3] {
        let size = [2.0 * self.room.radius, 2.0 * self.room.radius, self.room.length];
        std::array::from_fn(|k| {
            let u = p[k] / size[k] + 0.5;
            let u = if k == 2 && self.room.periodic { u.rem_euclid(1.0) } else { u };
            ((u * self.cells[k] as f64) as usize).min(self.cells[k] - 1)
        })
    }

    fn number(&self, c: [usize; 3]) -> usize {
        (c[2] * self.cells[1] + c[1]) * self.cells[0] + c[0]
    }

    /// One round; returns the deepest overlap met, over the smaller enlarged radius.
    fn push_apart(&mut self) -> f64 {
        self.head.fill(NONE);
        for s in 0..self.spheres.len() {
            let (body, arm, _) = self.spheres[s];
            let cell = self.number(self.cell(self.position[body as usize] + arm));
            self.next[s] = self.head[cell];
            self.head[cell] = s as u32;
        }
        let mut deepest = 0.0f64;
        for s in 0..self.spheres.len() {
            let (body, arm, _) = self.spheres[s];
            let around = self.neighbours(self.cell(self.position[body as usize] + arm));
            for cell in around.into_iter().flatten() {
                let mut t = self.head[cell];
                while t != NONE {
                    if (t as usize) < s {
                        deepest = deepest.max(self.push_pair(s, t as usize));
                    }
                    t = self.next[t as usize];
                }
            }
        }
        for s in 0..self.spheres.len() {
            deepest = deepest.max(self.push_off_walls(s));
        }
        deepest
    }

    /// Cells around one, each once.
    fn neighbours(&self, c: [usize; 3]) -> [Option<usize>; 27] {
        let mut list = [None; 27];
        let mut used = 0;
        for k in 0..27usize {
            let step = [k % 3, k / 3 % 3, k / 9];
            let mut d = [0usize; 3];
            let mut inside = true;
            for axis in 0..3 {
                let n = self.cells[axis];
                let wide = c[axis] + step[axis];
                if axis == 2 && self.room.periodic {
                    d[axis] = (wide + n - 1) % n;
                } else if (1..=n).contains(&wide) {
                    d[axis] = wide - 1;
                } else {
                    inside = false;
                }
            }
            if inside {
                let number = Some(self.number(d));
                // With one or two cells along the period, neighbours repeat.
                if !list[..used].contains(&number) {
                    list[used] = number;
                    used += 1;
                }
            }
        }
        list
    }

    fn push_pair(&mut self, s: usize, t: usize) -> f64 {
        let ((i, arm_i, ri), (j, arm_j, rj)) = (self.spheres[s], self.spheres[t]);
        if i == j {
            return 0.0;
        }
        let (i, j) = (i as usize, j as usize);
        let mut d = self.position[j] + arm_j - self.position[i] - arm_i;
        if self.room.periodic {
            d.z -= (d.z / self.room.length).round() * self.room.length;
        }
        let distance = d.length();
        let overlap = ri + rj - distance;
        if overlap <= 0.0 {
            return 0.0;
        }
        // Two at the very same place part along the axis.
        let n = if distance > 0.0 { d / distance } else { DVec3::Z };
        let push = n * (0.5 * overlap);
        self.position[i] -= push;
        self.position[j] += push;
        overlap / ri.min(rj)
    }

    fn push_off_walls(&mut self, s: usize) -> f64 {
        let (body, arm, r) = self.spheres[s];
        let p = &mut self.position[body as usize];
        let mut deepest = 0.0f64;
        let x = *p + arm;
        let rho = x.x.hypot(x.y);
        let beyond = rho + r - self.room.radius;
        if beyond > 0.0 {
            deepest = deepest.max(beyond / r);
            let inward = DVec3::new(-x.x / rho, -x.y / rho, 0.0);
            *p += inward * beyond;
        }
        let above = p.y + arm.y + r - self.top;
        if above > 0.0 && self.top < self.room.radius {
            // Only a hint to stay low: not an overlap.
            p.y -= 0.2 * above;
        }
        let half = 0.5 * self.room.length;
        if self.room.periodic {
            if p.z.abs() > half {
                p.z -= (p.z / self.room.length).round() * self.room.length;
            }
        } else {
            let z = p.z + arm.z;
            let beyond = z.abs() + r - half;
            if beyond > 0.0 {
                deepest = deepest.max(beyond / r);
                p.z -= z.signum() * beyond;
            }
        }
        deepest
    }
}
