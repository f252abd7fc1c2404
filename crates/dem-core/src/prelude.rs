//! What most programs need: `use dem_core::prelude::*`.

pub use crate::body_force::{Drag, Gravity};
pub use crate::builder::{Axis, Kernels, WorldBuilder};
pub use crate::contact::cohesion::Cohesionless;
pub use crate::contact::friction::{Friction, FrictionSpec};
pub use crate::contact::model::{ContactLaw, ContactModel};
pub use crate::contact::normal::{Hertz, HertzSpec, HertzTailCut, HertzTailKept};
pub use crate::contact::rolling::{
    ConstantTorque, ConstantTorqueSpec, FreeRolling, RollingArm, RollingCoefficient,
};
pub use crate::contact::tangential::{Frictionless, Mindlin, MindlinSpec};
pub use crate::energy::{Dissipation, Energy};
pub use crate::error::Error;
pub use crate::geometry::{Cylinder, Disc, Motion, Plane, Shape, Side, Wall};
pub use crate::integrate::{
    Beeman, ForwardEuler, Integrator, Leapfrog, StoermerVerlet, VelocityVerlet,
};
pub use crate::material::{Material, MaterialId};
pub use crate::particles::{ParticleId, Sphere};
pub use crate::rigid::{Clump, ClumpSpec, ClumpSphere, PlacedClump};
pub use crate::world::{WallLoad, World};
pub use glam::{DMat3, DQuat, DVec3};
