//! The drum: mantle, end plates, lifters, liner, and how they move.
//!
//! Axis along z through the origin, y up, drum from `-length/2` to `length/2`; it turns
//! counter-clockwise as seen from positive z, so the bed rises on the side of positive x. An inclined
//! axis is a tilted gravity: a positive inclination lifts the end at positive z.

use dem_core::geometry::{Mesh, Motion, Rotation, Vibration, Wall};
use dem_core::glam::{DQuat, DVec3};
use dem_core::material::MaterialId;
use rig_schema::{Drum, Ends, Lifters, Rig};

use crate::GRAVITY;
use crate::error::Error;
use crate::fill::Room;
use crate::parameters::Physics;

/// A wall, and whether it turns with the drum.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    pub(crate) wall: Wall,
    pub(crate) turns: bool,
}

/// The drum as built.
#[derive(Debug, Clone)]
pub(crate) struct Built {
    pub(crate) parts: Vec<Part>,
    /// Room for particles at the start.
    pub(crate) room: Room,
    /// Radius inside the wall layer, m.
    pub(crate) radius: f64,
    /// Largest distance of a wall from the axis, m.
    pub(crate) outer: f64,
    pub(crate) length: f64,
    pub(crate) ends: Ends,
}

/// Gravity as seen along the drum, m/s2.
pub(crate) fn gravity(inclination_rad: f64) -> DVec3 {
    GRAVITY * up(inclination_rad) * -1.0
}

/// Angle by which gravity is tilted while the bed settles, degrees.
///
/// The bed then starts near its angle of repose. From a level start it rises as a solid, fails
/// late, and swings for several turns.
const SETTLING_TILT_DEG: f64 = 25.0;

/// Gravity while the bed settles, m/s2: the raised side is at positive x, as when the drum turns.
pub(crate) fn settling_gravity(inclination_rad: f64) -> DVec3 {
    settling_tilt() * gravity(inclination_rad)
}

/// Turn of the bed and of gravity while it settles.
pub(crate) fn settling_tilt() -> DQuat {
    DQuat::from_rotation_z(SETTLING_TILT_DEG.to_radians())
}

/// The vertical.
pub(crate) fn up(inclination_rad: f64) -> DVec3 {
    DVec3::new(0.0, inclination_rad.cos(), inclination_rad.sin())
}

/// Build the drum of a rig; `largest` is the radius of the largest particle, m.
pub(crate) fn build(
    rig: &Rig,
    physics: &Physics,
    liner: Option<&[u8]>,
    largest: f64,
    mantle: MaterialId,
    end_plate: MaterialId,
) -> Result<Built, Error> {
    let Drum { radius_m, length_m, ends, .. } = rig.drum;
    let radius = radius_m - physics.wall_layer;
    let room = |what, size_m, room_m| Err(Error::NoRoom { what, size_m, room_m });
    if !(radius > 0.0) {
        return room("a wall layer", physics.wall_layer, radius_m);
    }
    if radius < largest {
        return room("a particle", 2.0 * largest, 2.0 * radius);
    }
    if length_m < 2.0 * largest {
        return room("a particle", 2.0 * largest, length_m);
    }
    let (mut inner, mut outer) = (radius, radius);
    let mut parts = Vec::new();
    match (&rig.drum.liner, liner) {
        (None, None) => {
            parts.push(Part {
                wall: Wall::drum(DVec3::ZERO, DVec3::Z, radius, mantle),
                turns: true,
            });
        }
        (Some(_), Some(bytes)) => {
            let surface = crate::liner::read(bytes, length_m, ends)?;
            (inner, outer) = (surface.inner, surface.outer);
            parts.push(Part { wall: Wall::mesh(surface.mesh, mantle), turns: true });
        }
        (Some(name), None) => {
            let problem =
                format!("the rig names the liner `{name}`: expected its STL bytes in the options");
            return Err(Error::Liner { problem });
        }
        (None, Some(_)) => {
            let problem =
                "a liner was handed in, but the rig names none: expected drum.liner".into();
            return Err(Error::Liner { problem });
        }
    }
    if let Some(lifters) = &rig.drum.lifters {
        if !(lifters.height_m < radius - largest) {
            return room("a lifter", lifters.height_m, radius);
        }
        inner -= lifters.height_m;
        let mesh = lifter_mesh(lifters, radius, length_m + 4.0 * largest)?;
        parts.push(Part { wall: Wall::mesh(mesh, mantle), turns: true });
    }
    if ends != Ends::Periodic {
        for side in [-1.0, 1.0] {
            let wall = Wall::plane(DVec3::Z * (0.5 * length_m * side), DVec3::Z * -side, end_plate);
            parts.push(Part { wall, turns: ends == Ends::Turning });
        }
    }
    let room = Room { radius: inner, length: length_m, periodic: ends == Ends::Periodic };
    Ok(Built { parts, room, radius, outer, length: length_m, ends })
}

/// Bars of rectangular section along the whole drum, their feet inside the mantle.
fn lifter_mesh(lifters: &Lifters, radius: f64, length: f64) -> Result<Mesh, Error> {
    let half = 0.5 * lifters.width_m;
    if !(half < radius - lifters.height_m) {
        return Err(Error::NoRoom { what: "a lifter", size_m: lifters.width_m, room_m: radius });
    }
    let (top, foot) = (radius - lifters.height_m, radius);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for k in 0..lifters.count {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(lifters.count);
        let (out, along) =
            (DVec3::new(angle.cos(), angle.sin(), 0.0), DVec3::new(-angle.sin(), angle.cos(), 0.0));
        let first = vertices.len() as u32;
        for z in [-0.5 * length, 0.5 * length] {
            for (height, side) in [(foot, -half), (top, -half), (top, half), (foot, half)] {
                vertices.push(out * height + along * side + DVec3::Z * z);
            }
        }
        for edge in 0..3 {
            let (a, b) = (first + edge, first + edge + 1);
            triangles.push([a, b, b + 4]);
            triangles.push([a, b + 4, a + 4]);
        }
    }
    Ok(Mesh::new(&vertices, &triangles)?)
}

/// Motion of the drum's parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    pub(crate) amplitude: f64,
    pub(crate) frequency_hz: f64,
    pub(crate) up: DVec3,
}

impl Drive {
    /// Motion from `since_s` after the vibration began on, at `rate` rad/s.
    ///
    /// The vibration goes on in phase, and the axis is where the vibration has carried it.
    pub(crate) fn motion(&self, rate: f64, since_s: f64) -> Motion {
        let phase_rad = std::f64::consts::TAU * self.frequency_hz * since_s;
        let amplitude = self.up * self.amplitude;
        let vibration = (self.amplitude > 0.0).then_some(Vibration {
            amplitude,
            frequency_hz: self.frequency_hz,
            phase_rad,
        });
        let point = if self.amplitude > 0.0 { amplitude * phase_rad.sin() } else { DVec3::ZERO };
        let rotation = (rate != 0.0).then_some(Rotation { point, axis: DVec3::Z, rate });
        Motion { velocity: DVec3::ZERO, rotation, vibration }
    }
}
