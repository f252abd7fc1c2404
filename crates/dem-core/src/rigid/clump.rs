//! Rigid clumps: several spheres that move as one body.

use glam::{DMat3, DQuat, DVec3};

use crate::error::{Error, finite, positive};
use crate::material::MaterialId;

/// One sphere of a clump, in the frame in which the clump is described.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ClumpSphere {
    /// Centre, m.
    pub centre: DVec3,
    /// Radius, m.
    pub radius: f64,
}

/// What describes a rigid clump: mass and inertia are *given*, so overlapping spheres do not
/// count their common volume twice.
#[derive(Debug, Clone, PartialEq)]
pub struct ClumpSpec {
    /// The spheres that touch other bodies.
    pub spheres: Vec<ClumpSphere>,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass, m, in the frame of the spheres.
    pub centre_of_mass: DVec3,
    /// Inertia tensor about the centre of mass, kg m2, in the directions of that frame.
    pub inertia: DMat3,
    /// Material of the surface.
    pub material: MaterialId,
}

/// A clump that was checked, brought to its centre of mass and principal axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Clump {
    /// Spheres, relative to the centre of mass in principal axes.
    pub(crate) spheres: Vec<ClumpSphere>,
    pub(crate) mass: f64,
    pub(crate) moments: DVec3,
    /// Turns the principal axes into the frame of description.
    pub(crate) principal: DQuat,
    pub(crate) centre_of_mass: DVec3,
    pub(crate) bounding_radius: f64,
    /// Distance from the centre of mass to that of the farthest sphere, m.
    pub(crate) reach: f64,
    pub(crate) material: MaterialId,
}

impl Clump {
    /// Mass, kg.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Principal moments of inertia, kg m2.
    pub fn moments(&self) -> DVec3 {
        self.moments
    }

    /// Rotation from principal axes to the frame in which the clump was described.
    pub fn principal_axes(&self) -> DQuat {
        self.principal
    }

    /// Radius of the sphere about the centre of mass that holds the whole clump, m.
    pub fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }

    /// The spheres about the centre of mass, in principal axes.
    pub fn spheres(&self) -> &[ClumpSphere] {
        &self.spheres
    }

    /// Centre of mass in the frame of description, m.
    pub fn centre_of_mass(&self) -> DVec3 {
        self.centre_of_mass
    }
}

impl TryFrom<ClumpSpec> for Clump {
    type Error = Error;

    fn try_from(spec: ClumpSpec) -> Result<Self, Error> {
        positive("clump mass (kg)", spec.mass)?;
        finite("clump centre of mass (m)", spec.centre_of_mass)?;
        if spec.spheres.is_empty() {
            return Err(Error::Parameter {
                name: "spheres of a clump",
                value: 0.0,
                expected: "at least one sphere",
            });
        }
        for s in &spec.spheres {
            positive("clump sphere radius (m)", s.radius)?;
            finite("clump sphere centre (m)", s.centre)?;
        }
        let (moments, axes) = principal_axes(spec.inertia);
        let largest = moments.max_element();
        let triangle = 2.0 * largest <= moments.element_sum() * (1.0 + 1e-9);
        if !(moments.is_finite() && moments.min_element() > 0.0 && triangle) {
            return Err(Error::Inertia { moments });
        }
        let principal = DQuat::from_mat3(&axes).normalize();
        let spheres: Vec<_> = spec
            .spheres
            .iter()
            .map(|s| ClumpSphere {
                centre: principal.conjugate() * (s.centre - spec.centre_of_mass),
                radius: s.radius,
            })
            .collect();
        let bounding_radius =
            spheres.iter().map(|s| s.centre.length() + s.radius).fold(0.0, f64::max);
        let reach = spheres.iter().map(|s| s.centre.length()).fold(0.0, f64::max);
        Ok(Self {
            spheres,
            mass: spec.mass,
            moments,
            principal,
            centre_of_mass: spec.centre_of_mass,
            bounding_radius,
            reach,
            material: spec.material,
        })
    }
}

/// A clump to be added to a world.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedClump {
    /// Number of the clump's shape among those declared.
    pub shape: usize,
    /// Centre of mass, m.
    pub position: DVec3,
    /// Turn from the frame of description to the laboratory.
    pub orientation: DQuat,
    /// Velocity of the centre of mass, m/s.
    pub velocity: DVec3,
    /// Angular velocity, rad/s, laboratory frame.
    pub spin: DVec3,
}

/// Principal moments and axes (columns, right-handed) of a symmetric tensor, by Jacobi's method.
///
/// Golub & Van Loan, Matrix Computations, 8.5: quadratic convergence, ten sweeps are ample.
pub(crate) fn principal_axes(tensor: DMat3) -> (DVec3, DMat3) {
    let mut a = [[0.0; 3]; 3];
    for (r, row) in a.iter_mut().enumerate() {
        for (c, value) in row.iter_mut().enumerate() {
            *value = 0.5 * (tensor.col(c)[r] + tensor.col(r)[c]);
        }
    }
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..10 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta: f64 = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            for row in &mut a {
                let (x, y) = (row[p], row[q]);
                row[p] = c * x - s * y;
                row[q] = s * x + c * y;
            }
            let (x, y) = (DVec3::from_array(a[p]), DVec3::from_array(a[q]));
            a[p] = (x * c - y * s).to_array();
            a[q] = (x * s + y * c).to_array();
            for row in &mut v {
                let (x, y) = (row[p], row[q]);
                row[p] = c * x - s * y;
                row[q] = s * x + c * y;
            }
        }
    }
    let column = |k: usize| DVec3::new(v[0][k], v[1][k], v[2][k]);
    let (x, y) = (column(0), column(1));
    (DVec3::new(a[0][0], a[1][1], a[2][2]), DMat3::from_cols(x, y, x.cross(y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_axes_rebuild_the_tensor() {
        let q = DQuat::from_xyzw(0.3, -0.2, 0.5, 0.8).normalize();
        let r = DMat3::from_quat(q);
        let tensor = r * DMat3::from_diagonal(DVec3::new(1.0, 2.0, 2.5)) * r.transpose();
        let (m, axes) = principal_axes(tensor);
        let back = axes * DMat3::from_diagonal(m) * axes.transpose();
        // Jacobi rotations are orthogonal: a few roundings of numbers of order one.
        assert!(back.abs_diff_eq(tensor, 1e-14));
        assert!((axes.determinant() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn inertia_that_no_body_can_have_is_refused() {
        let spec = ClumpSpec {
            spheres: vec![ClumpSphere { centre: DVec3::ZERO, radius: 1.0 }],
            mass: 1.0,
            centre_of_mass: DVec3::ZERO,
            inertia: DMat3::from_diagonal(DVec3::new(1.0, 1.0, 3.0)),
            material: MaterialId(0),
        };
        assert!(matches!(Clump::try_from(spec), Err(Error::Inertia { .. })));
    }
}
