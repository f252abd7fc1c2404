//! Contact laws of a rig: from names and parameters to constants, and to one static product.
//!
//! The default, Hertz with Mindlin and the constant torque, becomes a product of its own for which
//! the engine has a vector kernel. Every other combination runs one of two products whose members
//! are enums: one with shear springs and one with micro-slip, whose contacts remember more.

mod any;
mod pair;

pub(crate) use any::{AnyCohesion, AnyNormal, AnyRolling, PartialSlipShear, SpringShear};
pub(crate) use pair::{Constants, Kind, friction};
