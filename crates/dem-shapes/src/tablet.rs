//! A tablet of glued spheres: n spheres on a ring and, if asked for, one in the middle.
//!
//! The ring lies in the plane `z = 0` about the origin and its first sphere on the x axis:
//! `c_k = ring_radius (cos(2 pi k/n), sin(2 pi k/n), 0)`, `k = 0 .. n-1`. It is the construction by
//! which users of discrete-element codes enter tablets by hand; the ring radius is then the
//! tablet's radius less that of the spheres ([`RingTabletSpec::from_outer_radius`]), or whatever
//! gives the tablet's volume ([`RingTabletSpec::with_union_volume`]).

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::clump::{ClumpMass, ClumpShape};
use crate::error::{ShapeError, positive};
use crate::sphere::Sphere;
use crate::union::{DEFAULT_RELATIVE_TOLERANCE, UnionProperties, union_properties};

/// Fewest spheres that enclose a middle.
const MINIMUM_RING: usize = 3;

/// Dimensions of a tablet of glued spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct RingTabletSpec {
    /// Number of spheres on the ring, at least three.
    pub ring_spheres: usize,
    /// Radius of the circle that carries their centres, m.
    pub ring_radius: f64,
    /// Radius of the spheres on the ring, m.
    pub sphere_radius: f64,
    /// Radius of the sphere in the middle, m; none for an open ring.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub middle_radius: Option<f64>,
}

/// A tablet of glued spheres that holds together.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RingTabletSpec", into = "RingTabletSpec"))]
pub struct RingTablet {
    spec: RingTabletSpec,
}

impl RingTabletSpec {
    /// The tablet whose ring spheres reach out to `outer_radius`, m.
    #[must_use]
    pub fn from_outer_radius(
        ring_spheres: usize,
        outer_radius: f64,
        sphere_radius: f64,
        middle_radius: Option<f64>,
    ) -> Self {
        let ring_radius = outer_radius - sphere_radius;
        Self { ring_spheres, ring_radius, sphere_radius, middle_radius }
    }

    /// The same spheres on the ring at which their union has `volume`, m3.
    ///
    /// The ring radius given in `self` is not used. The volume grows with the ring all the way
    /// (moving balls apart continuously never shrinks their union: Csikos, Discrete Comput. Geom.
    /// 20 (1998) 449), so the ring is the only one, or on a plateau (ring spheres still inside the
    /// middle one) the smallest. It is found by bisection to `1e-12` of its range.
    ///
    /// # Errors
    /// Bad dimensions, and a volume outside what these spheres reach while they are connected.
    ///
    /// # Example
    /// ```
    /// use dem_shapes::RingTabletSpec;
    ///
    /// let spec = RingTabletSpec {
    ///     ring_spheres: 9,
    ///     ring_radius: 2.5e-3, // not used
    ///     sphere_radius: 1.87e-3,
    ///     middle_radius: Some(2.3e-3),
    /// };
    /// let fitted = spec.with_union_volume(167.03e-9)?;
    /// assert!((fitted.ring_radius - 2.4179e-3).abs() < 1e-7);
    /// # Ok::<(), dem_shapes::ShapeError>(())
    /// ```
    pub fn with_union_volume(self, volume: f64) -> Result<Self, ShapeError> {
        positive("union volume (m3)", volume)?;
        self.check_sizes()?;
        let at = |ring_radius: f64| {
            let spheres = Self { ring_radius, ..self }.spheres();
            union_properties(&spheres, 1e-11).map(|u| u.volume)
        };
        let (mut low, mut high) = (0.0, self.largest_ring());
        let (minimum, maximum) = (at(low)?, at(high)?);
        if volume <= minimum || volume > maximum {
            return Err(ShapeError::VolumeOutOfReach { target: volume, minimum, maximum });
        }
        // 2^-40 is below 1e-12.
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if at(middle)? < volume {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(Self { ring_radius: high, ..self })
    }

    /// Checks the dimensions.
    ///
    /// # Errors
    /// Fewer than three ring spheres, a dimension that is not above zero, spheres that neither
    /// reach each other nor a middle sphere.
    pub fn build(self) -> Result<RingTablet, ShapeError> {
        self.check_sizes()?;
        positive("ring radius (m)", self.ring_radius)?;
        let to_neighbour = 2.0 * (self.ring_radius * self.half_step().sin() - self.sphere_radius);
        let to_middle = match self.middle_radius {
            Some(middle) => self.ring_radius - self.sphere_radius - middle,
            None => f64::INFINITY,
        };
        let gap = to_neighbour.min(to_middle);
        // Touching is connected, and rounding does not undo it.
        if gap > 1e-12 * self.ring_radius {
            return Err(ShapeError::NotConnected {
                ring_radius: self.ring_radius,
                sphere_radius: self.sphere_radius,
                gap,
            });
        }
        Ok(RingTablet { spec: self })
    }

    fn check_sizes(&self) -> Result<(), ShapeError> {
        if self.ring_spheres < MINIMUM_RING {
            return Err(ShapeError::TooFewRingSpheres {
                count: self.ring_spheres,
                minimum: MINIMUM_RING,
            });
        }
        positive("radius of the ring spheres (m)", self.sphere_radius)?;
        if let Some(middle) = self.middle_radius {
            positive("radius of the middle sphere (m)", middle)?;
        }
        Ok(())
    }

    /// Half the angle between neighbours, rad.
    fn half_step(&self) -> f64 {
        PI / self.ring_spheres as f64
    }

    /// Ring on which the spheres just hold together.
    fn largest_ring(&self) -> f64 {
        let by_neighbours = self.sphere_radius / self.half_step().sin();
        let by_middle = self.middle_radius.map_or(0.0, |m| m + self.sphere_radius);
        by_neighbours.max(by_middle)
    }

    fn spheres(&self) -> Vec<Sphere> {
        let ring = (0..self.ring_spheres).map(|k| {
            let angle = TAU * k as f64 / self.ring_spheres as f64;
            let center = self.ring_radius * DVec3::new(angle.cos(), angle.sin(), 0.0);
            Sphere::new(center, self.sphere_radius)
        });
        let middle = self.middle_radius.map(|radius| Sphere::new(DVec3::ZERO, radius));
        ring.chain(middle).collect()
    }
}

impl RingTablet {
    /// Dimensions.
    #[must_use]
    pub fn spec(&self) -> RingTabletSpec {
        self.spec
    }

    /// The spheres, ring first, then the middle one; m.
    #[must_use]
    pub fn spheres(&self) -> Vec<Sphere> {
        self.spec.spheres()
    }

    /// Volume, surface and moments of the union of the spheres, to the default tolerance.
    ///
    /// # Errors
    /// Dimensions so far apart that moments leave the range of numbers.
    pub fn union(&self) -> Result<UnionProperties, ShapeError> {
        union_properties(&self.spheres(), DEFAULT_RELATIVE_TOLERANCE)
    }

    /// The rigid clump of these spheres; its axes are those of the tablet.
    ///
    /// # Errors
    /// Those of [`ClumpShape::from_spheres`].
    pub fn clump(&self, mass: ClumpMass) -> Result<ClumpShape, ShapeError> {
        ClumpShape::from_spheres(&self.spheres(), mass, DEFAULT_RELATIVE_TOLERANCE)
    }

    /// Depth of the grooves between neighbours at the rim, m: outer radius at a sphere less that
    /// between two spheres, `R + r - (R cos a + sqrt(r^2 - R^2 sin^2 a))`, `a = pi/n`.
    ///
    /// None where the neighbours do not overlap.
    #[must_use]
    pub fn rim_groove_depth(&self) -> Option<f64> {
        let RingTabletSpec { ring_radius, sphere_radius, .. } = self.spec;
        let (sin, cos) = self.spec.half_step().sin_cos();
        let across = ring_radius * sin;
        (across <= sphere_radius).then(|| {
            let reach = ((sphere_radius - across) * (sphere_radius + across)).sqrt();
            ring_radius + sphere_radius - (ring_radius * cos + reach)
        })
    }
}

impl TryFrom<RingTabletSpec> for RingTablet {
    type Error = ShapeError;

    fn try_from(spec: RingTabletSpec) -> Result<Self, ShapeError> {
        spec.build()
    }
}

impl From<RingTablet> for RingTabletSpec {
    fn from(tablet: RingTablet) -> Self {
        tablet.spec
    }
}
