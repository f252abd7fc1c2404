//! Coordinates of a model.

use crate::scale::Scale;

/// One coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Path of the parameter.
    pub path: String,
    /// Its coordinate.
    pub scale: Scale,
    /// Change of the coordinate that counts as one.
    pub unit: f64,
    /// How fast responses bend over a unit: 1 is what surfaces expect, less is for what acts evenly. It stretches the
    /// coordinate of the surface, not the distances between points.
    pub roughness: f64,
}

/// Squared distance of two points.
pub(crate) fn distance_squared(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// Coordinates in units, however rough the axes are.
pub(super) fn place(axes: &[Axis], at: &[f64]) -> Vec<f64> {
    axes.iter().zip(at).map(|(a, x)| a.scale.forth(*x) / a.unit).collect()
}

/// Coordinates of the surfaces: units from the origin, longer where responses bend faster.
pub(super) fn code(axes: &[Axis], origin: &[f64], at: &[f64]) -> Vec<f64> {
    axes.iter()
        .zip(origin)
        .zip(at)
        .map(|((a, o), x)| (a.scale.forth(*x) - a.scale.forth(*o)) / a.unit * a.roughness)
        .collect()
}
