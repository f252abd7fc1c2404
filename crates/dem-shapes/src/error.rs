//! What can be wrong with a shape.

use glam::DVec3;

/// Why a shape was refused or could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A length, mass or density that has to be above zero is not.
    #[error("{what} is {value}: expected a finite number above zero")]
    NotPositive {
        /// Name of the quantity with its unit.
        what: &'static str,
        /// Value that was given.
        value: f64,
    },
    /// A quantity that may be zero is below zero or not finite.
    #[error("{what} is {value}: expected a finite number, zero or above")]
    Negative {
        /// Name of the quantity with its unit.
        what: &'static str,
        /// Value that was given.
        value: f64,
    },
    /// A cap cannot span the tablet, because its sphere is smaller than the tablet.
    #[error(
        "crown radius {crown_radius} m is below the tablet's radius {radius} m: a cap of that \
         sphere cannot reach the band"
    )]
    CrownTooSmall {
        /// Radius of the sphere that the cap is cut from, m.
        crown_radius: f64,
        /// Radius of the tablet, m.
        radius: f64,
    },
    /// A clump without spheres.
    #[error("a clump needs at least one sphere: none was given")]
    NoSpheres,
    /// A sphere has a position that is not a number.
    #[error("sphere {index} has centre {center}: expected finite coordinates")]
    SphereCenter {
        /// Place of the sphere in the list, from zero.
        index: usize,
        /// Position that was given, m.
        center: DVec3,
    },
    /// A sphere has no size.
    #[error("sphere {index} has radius {radius} m: expected a finite number above zero")]
    SphereRadius {
        /// Place of the sphere in the list, from zero.
        index: usize,
        /// Radius that was given, m.
        radius: f64,
    },
    /// The spheres are so small, so large or so far apart that their moments are no numbers.
    #[error(
        "the spheres span {extent} m with a largest radius of {largest_radius} m: volume or inertia \
         leaves the range of numbers"
    )]
    OutOfRange {
        /// Largest distance of a sphere's surface from the middle of all spheres, m.
        extent: f64,
        /// Largest radius, m.
        largest_radius: f64,
    },
    /// A ring of too few spheres.
    #[error("a ring of {count} spheres is no tablet: expected at least {minimum}")]
    TooFewRingSpheres {
        /// Number that was given.
        count: usize,
        /// Smallest number that is accepted.
        minimum: usize,
    },
    /// The parts of a tablet hang in the air.
    #[error(
        "spheres of radius {sphere_radius} m on a ring of {ring_radius} m leave a gap of {gap} m to \
         each other and do not reach a middle sphere: the tablet falls apart"
    )]
    NotConnected {
        /// Radius of the ring that carries the centres, m.
        ring_radius: f64,
        /// Radius of the spheres on it, m.
        sphere_radius: f64,
        /// Smallest gap that would have to close, m.
        gap: f64,
    },
    /// A tolerance that cannot be met or means nothing.
    #[error("relative tolerance is {value}: expected a number from {minimum} to {maximum}")]
    Tolerance {
        /// Value that was given.
        value: f64,
        /// Smallest tolerance that double precision can meet.
        minimum: f64,
        /// Largest tolerance that is accepted.
        maximum: f64,
    },
    /// A quadrature did not reach its tolerance.
    #[error(
        "the quadrature near height {height} (of the extent) missed its tolerance by a factor of \
         {excess}: ask for a looser one"
    )]
    NotConverged {
        /// Height at which it failed, in units of the extent of the spheres.
        height: f64,
        /// Estimated error over the error that was allowed.
        excess: f64,
    },
    /// No ring radius gives the volume that was asked for.
    #[error(
        "no ring radius gives a union of {target} m3: these spheres reach from {minimum} m3 (all in \
         the middle) to {maximum} m3 (just connected)"
    )]
    VolumeOutOfReach {
        /// Volume that was asked for, m3.
        target: f64,
        /// Smallest volume, m3.
        minimum: f64,
        /// Largest volume, m3.
        maximum: f64,
    },
    /// An aspect ratio that the kind of clump cannot have.
    #[error("aspect ratio {value} of a {kind}: expected a number from 1 to {maximum}")]
    AspectRatio {
        /// Kind of clump.
        kind: &'static str,
        /// Value that was given.
        value: f64,
        /// Ratio at which the spheres just touch.
        maximum: f64,
    },
    /// A number of samples that cannot be used.
    #[error("{what} is {count}: expected {minimum} to {maximum}")]
    SampleCount {
        /// What is counted.
        what: &'static str,
        /// Number that was given.
        count: usize,
        /// Smallest number that is accepted.
        minimum: usize,
        /// Largest number that is accepted.
        maximum: usize,
    },
}

/// `value` if it is finite and above zero.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, ShapeError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(ShapeError::NotPositive { what, value })
    }
}

/// `value` if it is finite and not below zero.
pub(crate) fn not_negative(what: &'static str, value: f64) -> Result<f64, ShapeError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(ShapeError::Negative { what, value })
    }
}
