//! What stands still in front of the camera: drum, red ring, hub with nut, background.

use crate::canvas::Color;
use crate::error::{Error, check};

/// The drum: a tube between a transparent front plate and a rear wall.
///
/// The default is the thesis's Plexiglas drum, 250 mm wide inside and 150 mm long.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Drum {
    /// Inner radius, m.
    pub radius_m: f64,
    /// Inner length, m.
    pub length_m: f64,
}

impl Default for Drum {
    fn default() -> Self {
        Self { radius_m: 0.125, length_m: 0.15 }
    }
}

impl Drum {
    /// Height of the front plate's inner face on the axis, m.
    #[must_use]
    pub fn front_z(&self) -> f64 {
        self.length_m / 2.0
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        check("drum.radius_m", self.radius_m, "m", (1e-6, 1e3), "a radius above 0")?;
        check("drum.length_m", self.length_m, "m", (0.0, 1e3), "a length of at least 0")
    }
}

/// The red ring round the drum, from which a picture's scale and centre are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Ring {
    /// Whether it is there.
    pub visible: bool,
    /// Width of the ring, m; its inner edge is the drum's inner radius.
    pub width_m: f64,
    /// Its colour.
    pub color: Color,
    /// How far it lies in front of the plate's inner face, m: a ring glued on the outside of the plate stands
    /// nearer to the camera than the bed and looks larger.
    pub standoff_m: f64,
    /// Number of separate marks; 0 is a closed ring.
    pub marks: u32,
    /// Share of the round that the marks cover.
    pub marks_share: f64,
}

impl Default for Ring {
    fn default() -> Self {
        Self {
            visible: true,
            width_m: 0.005,
            color: [0.80, 0.10, 0.09],
            standoff_m: 0.0,
            marks: 0,
            marks_share: 0.6,
        }
    }
}

impl Ring {
    /// Whether the ring covers a point of its plane, m.
    pub(crate) fn covers(&self, drum: &Drum, x: f64, y: f64) -> bool {
        let r2 = x * x + y * y;
        let outer = drum.radius_m + self.width_m;
        if !self.visible || r2 < drum.radius_m * drum.radius_m || r2 >= outer * outer {
            return false;
        }
        if self.marks == 0 {
            return true;
        }
        let turn = y.atan2(x) / std::f64::consts::TAU * f64::from(self.marks);
        turn - turn.floor() < self.marks_share
    }
}

/// The hub in the middle of the front plate, with a hexagonal nut on it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Hub {
    /// Whether it is there.
    pub visible: bool,
    /// Radius of the washer, m.
    pub radius_m: f64,
    /// Colour of the washer.
    pub color: Color,
    /// Half the distance between opposite corners of the nut, m.
    pub nut_radius_m: f64,
    /// Colour of the nut.
    pub nut_color: Color,
}

impl Default for Hub {
    fn default() -> Self {
        Self {
            visible: true,
            radius_m: 0.013,
            color: [0.30, 0.30, 0.31],
            nut_radius_m: 0.008,
            nut_color: [0.62, 0.61, 0.58],
        }
    }
}

/// Part of the hub under a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum HubPart {
    Washer,
    Nut,
    Bolt,
}

impl Hub {
    /// The part of the hub at a point of the front plane, m.
    pub(crate) fn part(&self, x: f64, y: f64) -> Option<HubPart> {
        let r2 = x * x + y * y;
        if !self.visible || r2 >= self.radius_m * self.radius_m {
            return None;
        }
        // Hexagon: inside when the projections on three normals stay below the apothem.
        let apothem = self.nut_radius_m * 0.75_f64.sqrt();
        let (s, c) = (0.5, 0.75_f64.sqrt());
        let inside =
            x.abs() < apothem && (x * s + y * c).abs() < apothem && (x * s - y * c).abs() < apothem;
        Some(if r2 < (0.45 * self.nut_radius_m).powi(2) {
            HubPart::Bolt
        } else if inside {
            HubPart::Nut
        } else {
            HubPart::Washer
        })
    }
}

/// Everything that stands still: drum, ring, hub and the colours of what lies behind.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Scene {
    /// The drum.
    pub drum: Drum,
    /// The red ring.
    pub ring: Ring,
    /// Hub and nut.
    pub hub: Hub,
    /// Colour of the rear wall inside the drum.
    pub rear_wall: Color,
    /// Colour of the inner side of the tube between front plate and rear wall.
    pub tube: Color,
    /// Radius of the front plate, m; outside the ring the plate is a little lighter than the background.
    pub plate_radius_m: f64,
    /// Colour of the plate outside the ring.
    pub plate: Color,
    /// Colour of everything else.
    pub background: Color,
}

impl Scene {
    /// The usual scene about a drum of another size.
    ///
    /// Everything keeps its share of the radius: a hub of one size, which readers of pictures leave out, would hide the bed of a small drum, and a ring of one width
    /// is two edges in its small picture, of which either may be taken for the drum's.
    ///
    /// ```
    /// use drum_film::{Drum, Scene};
    ///
    /// let small = Scene::about(Drum { radius_m: 0.05, ..Drum::default() });
    /// assert!((small.hub.radius_m - 0.0052).abs() < 1e-12);
    /// assert!((small.ring.width_m - 0.002).abs() < 1e-12);
    /// ```
    pub fn about(drum: Drum) -> Self {
        let usual = Self::default();
        let share = drum.radius_m / usual.drum.radius_m;
        let hub = Hub {
            radius_m: share * usual.hub.radius_m,
            nut_radius_m: share * usual.hub.nut_radius_m,
            ..usual.hub
        };
        let ring = Ring { width_m: share * usual.ring.width_m, ..usual.ring };
        Self { drum, ring, hub, plate_radius_m: share * usual.plate_radius_m, ..usual }
    }
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            drum: Drum::default(),
            ring: Ring::default(),
            hub: Hub::default(),
            rear_wall: [0.085, 0.085, 0.095],
            tube: [0.13, 0.13, 0.14],
            plate_radius_m: 0.15,
            plate: [0.10, 0.10, 0.105],
            background: [0.055, 0.055, 0.06],
        }
    }
}

impl Scene {
    /// A bare scene in the manner of EDEM's pictures: nothing but a light background.
    #[must_use]
    pub fn bare(drum: Drum, background: Color) -> Self {
        Self {
            drum,
            ring: Ring { visible: false, ..Ring::default() },
            hub: Hub { visible: false, ..Hub::default() },
            rear_wall: background,
            tube: background,
            plate_radius_m: 0.0,
            plate: background,
            background,
        }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        self.drum.check()?;
        check("ring.width_m", self.ring.width_m, "m", (0.0, 1e3), "a width of at least 0")?;
        check("ring.standoff_m", self.ring.standoff_m, "m", (-1.0, 1.0), "-1 to 1")?;
        check("ring.marks_share", self.ring.marks_share, "", (0.0, 1.0), "a share from 0 to 1")?;
        check("hub.radius_m", self.hub.radius_m, "m", (0.0, 1e3), "a radius of at least 0")?;
        check(
            "hub.nut_radius_m",
            self.hub.nut_radius_m,
            "m",
            (0.0, 1e3),
            "a radius of at least 0",
        )?;
        check(
            "scene.plate_radius_m",
            self.plate_radius_m,
            "m",
            (0.0, 1e3),
            "a radius of at least 0",
        )
    }
}
