//! Materials and the table of contact laws between them.

use crate::error::{Error, positive};

/// Number of a material, in the order of declaration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MaterialId(pub u16);

impl std::fmt::Display for MaterialId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// Elastic constants and density of one material.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Material {
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio, -1 to 0.5.
    pub poisson_ratio: f64,
    /// Density, kg/m3.
    pub density: f64,
}

impl Material {
    /// Shear modulus `E / (2 (1 + nu))`, Pa.
    ///
    /// ```
    /// # use dem_core::material::Material;
    /// let glass = Material { youngs_modulus: 65.016e6, poisson_ratio: 0.29, density: 2500.0 };
    /// assert!((glass.shear_modulus() - 2.52e7).abs() < 1.0);
    /// ```
    pub fn shear_modulus(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// The material with these shear modulus (Pa), Poisson's ratio and density (kg/m3).
    pub fn from_shear_modulus(shear_modulus: f64, poisson_ratio: f64, density: f64) -> Self {
        Self { youngs_modulus: 2.0 * (1.0 + poisson_ratio) * shear_modulus, poisson_ratio, density }
    }

    /// Check the constants.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a modulus or density that is not positive and a Poisson's ratio
    /// outside -1 to 0.5.
    pub fn check(&self) -> Result<(), Error> {
        positive("youngs_modulus (Pa)", self.youngs_modulus)?;
        positive("density (kg/m3)", self.density)?;
        if !(self.poisson_ratio > -1.0 && self.poisson_ratio <= 0.5) {
            return Err(Error::Parameter {
                name: "poisson_ratio",
                value: self.poisson_ratio,
                expected: "above -1 and at most 0.5",
            });
        }
        Ok(())
    }
}

/// A law for every pair of materials, symmetric.
#[derive(Debug, Clone, PartialEq)]
pub struct PairTable<M> {
    materials: usize,
    laws: Vec<Option<M>>,
}

impl<M: Copy> PairTable<M> {
    /// A table for `materials` materials in which no law is set yet.
    pub fn new(materials: usize) -> Self {
        Self { materials, laws: vec![None; materials * materials] }
    }

    /// Number of materials.
    pub fn materials(&self) -> usize {
        self.materials
    }

    /// Set the law between `a` and `b`, in both orders.
    ///
    /// # Errors
    /// [`Error::UnknownMaterial`] when one of them is not in the table.
    pub fn set(&mut self, a: MaterialId, b: MaterialId, law: M) -> Result<(), Error> {
        for m in [a, b] {
            if usize::from(m.0) >= self.materials {
                return Err(Error::UnknownMaterial { material: m.0, declared: self.materials });
            }
        }
        let (a, b) = (usize::from(a.0), usize::from(b.0));
        self.laws[a * self.materials + b] = Some(law);
        self.laws[b * self.materials + a] = Some(law);
        Ok(())
    }

    /// The law between `a` and `b`, if one was set.
    pub fn get(&self, a: MaterialId, b: MaterialId) -> Option<&M> {
        let (a, b) = (usize::from(a.0), usize::from(b.0));
        if a >= self.materials || b >= self.materials {
            return None;
        }
        self.laws[a * self.materials + b].as_ref()
    }
}
