//! Walls: their shapes, materials and motions.

mod cylinder;
mod disc;
#[cfg(feature = "mesh")]
pub mod mesh;
mod motion;
mod plane;

use glam::DVec3;

pub use cylinder::{Cylinder, Side};
pub use disc::Disc;
#[cfg(feature = "mesh")]
pub use mesh::Mesh;
pub use motion::{Motion, MotionState, Pose, RigidVelocity, Rotation, Vibration};
pub use plane::Plane;

use crate::error::{Error, direction, finite, not_negative, positive};
use crate::material::MaterialId;

/// Where a wall is nearest to the centre of a sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Unit vector from the centre to the wall.
    pub normal_to_wall: DVec3,
    /// Distance of the centre from the surface, m; negative behind it.
    pub distance: f64,
    /// Radius of the sphere that has the wall's mean curvature, m: infinite if flat, negative if
    /// hollow.
    pub wall_radius: f64,
}

/// Shape of a wall, as it is at time zero.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Unbounded plane.
    Plane(Plane),
    /// Cylinder mantle.
    Cylinder(Cylinder),
    /// Flat disc or ring.
    Disc(Disc),
    /// Triangle mesh.
    #[cfg(feature = "mesh")]
    Mesh(Mesh),
}

/// A wall: shape, material, motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    /// Its shape at time zero.
    pub shape: Shape,
    /// Its material.
    pub material: MaterialId,
    /// Its motion from time zero on.
    pub motion: Motion,
}

impl Wall {
    /// A plane through `point` that keeps particles on the side of `normal`.
    pub fn plane(point: DVec3, normal: DVec3, material: MaterialId) -> Self {
        Self { shape: Shape::Plane(Plane { point, normal }), material, motion: Motion::default() }
    }

    /// An unbounded hollow cylinder: the mantle of a drum.
    pub fn drum(point: DVec3, axis: DVec3, radius: f64, material: MaterialId) -> Self {
        let shape = Cylinder { point, axis, radius, side: Side::Inside, length: None };
        Self { shape: Shape::Cylinder(shape), material, motion: Motion::default() }
    }

    /// A flat disc: the end plate of a drum.
    pub fn disc(centre: DVec3, normal: DVec3, radius: f64, material: MaterialId) -> Self {
        let shape = Disc { centre, normal, radius, hole_radius: 0.0 };
        Self { shape: Shape::Disc(shape), material, motion: Motion::default() }
    }

    /// A triangle mesh.
    #[cfg(feature = "mesh")]
    pub fn mesh(mesh: Mesh, material: MaterialId) -> Self {
        Self { shape: Shape::Mesh(mesh), material, motion: Motion::default() }
    }

    /// The same wall with a motion.
    #[must_use]
    pub fn with_motion(mut self, motion: Motion) -> Self {
        self.motion = motion;
        self
    }

    /// Check the numbers and bring directions to length one.
    pub(crate) fn checked(mut self) -> Result<Self, Error> {
        self.motion.check()?;
        match &mut self.shape {
            Shape::Plane(p) => {
                finite("plane point (m)", p.point)?;
                p.normal = direction("plane normal", p.normal)?;
            }
            Shape::Cylinder(c) => {
                finite("cylinder point (m)", c.point)?;
                c.axis = direction("cylinder axis", c.axis)?;
                positive("cylinder radius (m)", c.radius)?;
                if let Some(length) = c.length {
                    positive("cylinder length (m)", length)?;
                }
            }
            Shape::Disc(d) => {
                finite("disc centre (m)", d.centre)?;
                d.normal = direction("disc normal", d.normal)?;
                positive("disc radius (m)", d.radius)?;
                not_negative("disc hole radius (m)", d.hole_radius)?;
                if d.hole_radius >= d.radius {
                    return Err(Error::Parameter {
                        name: "disc hole radius (m)",
                        value: d.hole_radius,
                        expected: "less than the disc's radius",
                    });
                }
            }
            #[cfg(feature = "mesh")]
            Shape::Mesh(_) => {}
        }
        Ok(self)
    }
}

/// A wall as it stands at the present step.
#[derive(Debug, Clone)]
pub(crate) struct PlacedWall {
    /// Shape in the laboratory frame (meshes stay in their own frame).
    pub(crate) shape: PlacedShape,
    pub(crate) material: MaterialId,
    /// Pose now.
    pub(crate) pose: Pose,
    /// Velocity field now.
    pub(crate) velocity: RigidVelocity,
    /// Velocity field in the middle of the step that led here.
    pub(crate) mean_velocity: RigidVelocity,
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum PlacedShape {
    Plane(Plane),
    Cylinder(Cylinder),
    Disc(Disc),
    #[cfg(feature = "mesh")]
    Mesh,
}

impl PlacedWall {
    pub(crate) fn new(wall: &Wall, motion: &MotionState, time: f64, dt: f64) -> Self {
        let mut placed = Self {
            shape: PlacedShape::Plane(Plane { point: DVec3::ZERO, normal: DVec3::Z }),
            material: wall.material,
            pose: Pose::default(),
            velocity: RigidVelocity::default(),
            mean_velocity: RigidVelocity::default(),
        };
        placed.update(wall, motion, time, dt);
        placed
    }

    /// Bring the wall to `time`, which a step of `dt` has just reached.
    pub(crate) fn update(&mut self, wall: &Wall, motion: &MotionState, time: f64, dt: f64) {
        self.pose = motion.pose(time);
        self.velocity = motion.velocity(time);
        self.mean_velocity = motion.velocity(time - 0.5 * dt);
        self.shape = match &wall.shape {
            Shape::Plane(p) => PlacedShape::Plane(p.placed(&self.pose)),
            Shape::Cylinder(c) => PlacedShape::Cylinder(c.placed(&self.pose)),
            Shape::Disc(d) => PlacedShape::Disc(d.placed(&self.pose)),
            #[cfg(feature = "mesh")]
            Shape::Mesh(_) => PlacedShape::Mesh,
        };
    }

    /// Whether the distance of a point from an analytic shape changes by no more than what the point moves: not where the inside of a
    /// cylinder ends.
    pub(crate) fn is_steady(&self) -> bool {
        match &self.shape {
            PlacedShape::Plane(_) | PlacedShape::Disc(_) => true,
            PlacedShape::Cylinder(c) => c.length.is_none(),
            #[cfg(feature = "mesh")]
            PlacedShape::Mesh => false,
        }
    }

    /// Whether a sphere of `radius` at `x` surely does not touch an analytic shape: no root.
    #[inline(always)]
    pub(crate) fn misses(&self, x: DVec3, radius: f64) -> bool {
        match &self.shape {
            PlacedShape::Plane(p) => (x - p.point).dot(p.normal) > radius,
            PlacedShape::Cylinder(c) => {
                let d = x - c.point;
                let along = d.dot(c.axis);
                let rho2 = d.length_squared() - along * along;
                match c.side {
                    // A margin of rounding: a cylinder's edge is decided by the exact distance.
                    Side::Inside => {
                        c.length.is_none()
                            && radius < c.radius
                            && rho2 < (c.radius - radius).powi(2) * (1.0 - 1e-12)
                    }
                    Side::Outside => rho2 > (c.radius + radius).powi(2) * (1.0 + 1e-12),
                }
            }
            PlacedShape::Disc(d) => (x - d.centre).dot(d.normal).abs() > radius,
            #[cfg(feature = "mesh")]
            PlacedShape::Mesh => false,
        }
    }

    /// Nearest point of an analytic shape; `None` for a mesh, which has its own search.
    #[inline]
    pub(crate) fn nearest(&self, x: DVec3) -> Option<Nearest> {
        match &self.shape {
            PlacedShape::Plane(p) => Some(p.nearest(x)),
            PlacedShape::Cylinder(c) => Some(c.nearest(x)),
            PlacedShape::Disc(d) => Some(d.nearest(x)),
            #[cfg(feature = "mesh")]
            PlacedShape::Mesh => None,
        }
    }

    /// Upper bound, m, of the distance by which the wall's surface has moved along its normal
    /// since `old`, for points within `extent` of `centre`.
    ///
    /// Rotation of a plane about its normal, and of cylinders and discs about their own axis,
    /// moves no surface.
    pub(crate) fn surface_shift(&self, old: &PlacedWall, centre: DVec3, extent: f64) -> f64 {
        match (&self.shape, &old.shape) {
            (PlacedShape::Plane(a), PlacedShape::Plane(b)) => {
                let turn = (a.normal - b.normal).length();
                (a.point - b.point).dot(a.normal).abs()
                    + turn * ((b.point - centre).length() + extent)
            }
            (PlacedShape::Cylinder(a), PlacedShape::Cylinder(b)) => {
                let turn = (a.axis - b.axis).length();
                let d = a.point - b.point;
                let shift = if a.length.is_some() { d } else { d - a.axis * d.dot(a.axis) };
                shift.length() + turn * ((b.point - centre).length() + extent)
            }
            (PlacedShape::Disc(a), PlacedShape::Disc(b)) => {
                (a.centre - b.centre).length() + (a.normal - b.normal).length() * a.radius
            }
            #[cfg(feature = "mesh")]
            _ => {
                let turn = (self.pose.rotation * old.pose.rotation.conjugate()).to_axis_angle().1;
                let origin = self.pose.point(DVec3::ZERO);
                (origin - old.pose.point(DVec3::ZERO)).length()
                    + turn.abs() * ((origin - centre).length() + extent)
            }
            #[cfg(not(feature = "mesh"))]
            _ => f64::INFINITY,
        }
    }
}
