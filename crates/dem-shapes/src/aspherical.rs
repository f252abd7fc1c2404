//! Slightly aspherical particles: clumps of two or three spheres with the volume of a ball.
//!
//! Real beads are not quite round, and a bed of them turns at a steeper angle than one of balls.
//! This family goes from the ball (aspect ratio one) continuously to touching spheres, at constant
//! volume, so that the effect of form can be told from that of mass. All spheres of a clump have
//! one radius `a`:
//!
//! | kind | spheres | aspect ratio |
//! |---|---|---|
//! | dumbbell | two, `L` apart along x | length over width, `1 + L/(2 a)`, up to 2 |
//! | rod | three in a row along x, `L` apart | `1 + L/a`, up to 3 |
//! | trefoil | three in the xy plane, each `c` from the middle | width of the round hull over thickness, `1 + c/a`, up to `1 + 2/sqrt(3)` |

use std::f64::consts::PI;

use glam::DVec3;

use crate::clump::{ClumpMass, ClumpShape};
use crate::error::{ShapeError, positive};
use crate::sphere::Sphere;
use crate::union::{DEFAULT_RELATIVE_TOLERANCE, union_properties};

/// How the spheres of an aspherical particle are placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum AsphericalKind {
    /// Two spheres along x: elongated.
    Dumbbell,
    /// Three spheres in a row along x: elongated.
    Rod,
    /// Three spheres at the corners of an equilateral triangle in the xy plane: flattened.
    Trefoil,
}

impl AsphericalKind {
    /// Name in messages and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dumbbell => "dumbbell",
            Self::Rod => "rod",
            Self::Trefoil => "trefoil",
        }
    }

    /// Aspect ratio at which the spheres just touch; beyond it the particle would fall apart.
    #[must_use]
    pub fn largest_aspect_ratio(self) -> f64 {
        match self {
            Self::Dumbbell => 2.0,
            Self::Rod => 3.0,
            Self::Trefoil => 1.0 + 2.0 / 3.0_f64.sqrt(),
        }
    }

    /// Centres of spheres of radius one.
    fn unit_centers(self, aspect_ratio: f64) -> Vec<DVec3> {
        let excess = aspect_ratio - 1.0;
        if excess == 0.0 {
            return vec![DVec3::ZERO];
        }
        match self {
            Self::Dumbbell => vec![-excess * DVec3::X, excess * DVec3::X],
            Self::Rod => vec![-excess * DVec3::X, DVec3::ZERO, excess * DVec3::X],
            Self::Trefoil => (0..3)
                .map(|k| {
                    let angle = PI * (0.5 + 2.0 / 3.0 * f64::from(k));
                    excess * DVec3::new(angle.cos(), angle.sin(), 0.0)
                })
                .collect(),
        }
    }
}

/// A clump of `kind` and `aspect_ratio` with the volume of a ball of `equivalent_radius`, m.
///
/// At an aspect ratio of one it is that ball, of one sphere.
///
/// # Errors
/// An aspect ratio outside 1 to [`AsphericalKind::largest_aspect_ratio`], a radius, mass or density
/// that is not above zero.
///
/// # Example
/// ```
/// use dem_shapes::{aspherical_clump, AsphericalKind, ClumpMass};
///
/// // A 6 mm glass bead, 5 % longer than wide.
/// let bead = aspherical_clump(AsphericalKind::Dumbbell, 1.05, 3e-3, ClumpMass::Density(2500.0))?;
/// assert!((bead.mass - 0.2827e-3).abs() < 1e-7); // as the ball
/// assert!((bead.bounding_radius() * 2.0 - 1.05 * 2.0 * bead.spheres[0].radius).abs() < 1e-12);
/// # Ok::<(), dem_shapes::ShapeError>(())
/// ```
pub fn aspherical_clump(
    kind: AsphericalKind,
    aspect_ratio: f64,
    equivalent_radius: f64,
    mass: ClumpMass,
) -> Result<ClumpShape, ShapeError> {
    positive("equivalent radius (m)", equivalent_radius)?;
    let maximum = kind.largest_aspect_ratio();
    if !(1.0..=maximum).contains(&aspect_ratio) {
        return Err(ShapeError::AspectRatio { kind: kind.name(), value: aspect_ratio, maximum });
    }
    let unit: Vec<Sphere> =
        kind.unit_centers(aspect_ratio).into_iter().map(|c| Sphere::new(c, 1.0)).collect();
    let volume = union_properties(&unit, DEFAULT_RELATIVE_TOLERANCE)?.volume;
    // Volume goes with the cube of the size.
    let radius = equivalent_radius / (volume * 0.75 / PI).cbrt();
    let spheres: Vec<Sphere> =
        unit.iter().map(|s| Sphere::new(radius * s.center, radius)).collect();
    ClumpShape::from_spheres(&spheres, mass, DEFAULT_RELATIVE_TOLERANCE)
}
