//! A rigid clump: its spheres in the principal frame, with mass and moments of inertia.

use glam::{DMat3, DQuat, DVec3};

use crate::error::{ShapeError, positive};
use crate::principal::principal_axes;
use crate::sphere::Sphere;
use crate::union::{UnionProperties, union_properties};

/// What fixes the mass of a clump.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum ClumpMass {
    /// Density of the material, kg/m3: the mass is that of the union.
    Density(f64),
    /// Mass of the whole clump, kg, whatever the volume of its union.
    Total(f64),
}

/// A rigid clump of spheres, described in its principal frame.
///
/// The centre of mass is the origin and the axes are the principal axes of the union at uniform
/// density; `axes` and `centroid` lead back to the frame in which the spheres were given:
/// `given = axes * body + centroid`. Serialisation is one-way: a clump is built, not read.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ClumpShape {
    /// Spheres relative to the centre of mass in principal axes, m, in the order they were given;
    /// without those that lie in another one, which would only double its contacts.
    pub spheres: Vec<Sphere>,
    /// Mass, kg.
    pub mass: f64,
    /// Volume of the union, m3.
    pub volume: f64,
    /// Free surface of the union, m2.
    pub surface_area: f64,
    /// Principal moments of inertia about the x, y and z axis of the body, kg m2.
    pub principal_moments: DVec3,
    /// Rotation from the principal frame to the frame in which the spheres were given; as small as
    /// the choice of axes allows.
    pub axes: DQuat,
    /// Centre of mass in the frame in which the spheres were given, m.
    pub centroid: DVec3,
}

impl ClumpShape {
    /// The clump of the union of `spheres`, its moments to `relative_tolerance`.
    ///
    /// # Errors
    /// Those of [`union_properties`], and a mass or density that is not above zero.
    ///
    /// # Example
    /// ```
    /// use dem_shapes::{glam::DVec3, ClumpMass, ClumpShape, Sphere};
    ///
    /// // A steel dumbbell of two touching balls, off the origin.
    /// let balls = [
    ///     Sphere::new(DVec3::new(0.0, 0.0, 0.0), 1e-3),
    ///     Sphere::new(DVec3::new(2e-3, 0.0, 0.0), 1e-3),
    /// ];
    /// let clump = ClumpShape::from_spheres(&balls, ClumpMass::Density(7850.0), 1e-10)?;
    /// let ball = 4.0 / 3.0 * std::f64::consts::PI * 1e-9 * 7850.0;
    /// // Along the axis 2 (2/5 m r^2); across it m r^2 more for each ball.
    /// let moments = clump.principal_moments / (ball * 1e-6);
    /// assert!((moments - DVec3::new(0.8, 2.8, 2.8)).length() < 1e-8);
    /// assert!((clump.centroid.x - 1e-3).abs() < 1e-12);
    /// # Ok::<(), dem_shapes::ShapeError>(())
    /// ```
    pub fn from_spheres(
        spheres: &[Sphere],
        mass: ClumpMass,
        relative_tolerance: f64,
    ) -> Result<Self, ShapeError> {
        let union = union_properties(spheres, relative_tolerance)?;
        Self::from_union(spheres, &union, mass)
    }

    /// As [`Self::from_spheres`] for a union that is known already.
    ///
    /// # Errors
    /// A mass or density that is not above zero.
    pub fn from_union(
        spheres: &[Sphere],
        union: &UnionProperties,
        mass: ClumpMass,
    ) -> Result<Self, ShapeError> {
        let mass = match mass {
            ClumpMass::Density(density) => positive("density (kg/m3)", density)? * union.volume,
            ClumpMass::Total(mass) => positive("mass (kg)", mass)?,
        };
        let density = mass / union.volume;
        let (moments, axes) = principal_axes(&union.inertia);
        let to_body = axes.conjugate();
        let spheres = without_hidden(spheres)
            .map(|s| Sphere::new(to_body * (s.center - union.centroid), s.radius))
            .collect();
        Ok(Self {
            spheres,
            mass,
            volume: union.volume,
            surface_area: union.surface_area,
            principal_moments: moments * density,
            axes,
            centroid: union.centroid,
        })
    }

    /// Mass over volume of the union, kg/m3.
    #[must_use]
    pub fn density(&self) -> f64 {
        self.mass / self.volume
    }

    /// Radius about the centre of mass that holds the whole clump, m.
    #[must_use]
    pub fn bounding_radius(&self) -> f64 {
        self.spheres.iter().map(|s| s.center.length() + s.radius).fold(0.0, f64::max)
    }

    /// Radius of the ball of equal volume, m.
    #[must_use]
    pub fn equivalent_radius(&self) -> f64 {
        (self.volume * 0.75 / std::f64::consts::PI).cbrt()
    }

    /// Inertia tensor about the centre of mass in the frame in which the spheres were given, kg m2.
    #[must_use]
    pub fn inertia_tensor(&self) -> DMat3 {
        let r = DMat3::from_quat(self.axes);
        r * DMat3::from_diagonal(self.principal_moments) * r.transpose()
    }

    /// The same clump `factor` times as large, at equal density.
    ///
    /// # Errors
    /// A factor that is not above zero.
    pub fn scaled(&self, factor: f64) -> Result<Self, ShapeError> {
        let f = positive("scale factor (1)", factor)?;
        Ok(Self {
            spheres: self.spheres.iter().map(|s| Sphere::new(s.center * f, s.radius * f)).collect(),
            mass: self.mass * f.powi(3),
            volume: self.volume * f.powi(3),
            surface_area: self.surface_area * f.powi(2),
            principal_moments: self.principal_moments * f.powi(5),
            axes: self.axes,
            centroid: self.centroid * f,
        })
    }
}

/// The spheres that are not wholly in another one, of equal ones the first.
fn without_hidden(spheres: &[Sphere]) -> impl Iterator<Item = &Sphere> {
    let hides = |big: &Sphere, small: &Sphere| {
        big.center.distance(small.center) + small.radius <= big.radius * (1.0 + 1e-13)
    };
    spheres.iter().enumerate().filter_map(move |(i, s)| {
        let hidden = spheres
            .iter()
            .enumerate()
            .any(|(j, t)| j != i && hides(t, s) && (j < i || !hides(s, t)));
        (!hidden).then_some(s)
    })
}
