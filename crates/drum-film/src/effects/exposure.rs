//! Exposure: the shutter stays open while the bed moves, and the picture is the mean over that time.
//!
//! Sphere positions are averaged as frames ([`crate::Studio::exposed_frame`]). An analytic bed has a still outline, in which
//! only its texture moves: a passive layer turns with the drum at rate w, and a flowing layer runs down the surface. Over the
//! shutter's time the beads are smeared along these paths. The flowing layer's depth is a share of the
//! radius and its speed at the surface a multiple of w R; both follow the two-layer picture of rolling beds
//! (Rajchenbach 1990, doi:10.1103/PhysRevLett.65.2221), not a solution of the flow.

use glam::DVec2;

use crate::bed::BedShape;
use crate::canvas::Color;
use crate::error::{Error, check};

/// Shutter time and motion.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Exposure {
    /// Time that the shutter is open, s; 0 freezes the picture.
    pub seconds: f64,
    /// Speed of the drum, revolutions per minute (only for the texture of analytic beds).
    pub speed_rpm: f64,
    /// Moments over which the picture is averaged.
    pub sub_frames: u32,
    /// Depth of the flowing layer, drum radii.
    pub flowing_depth: f64,
    /// Speed of the free surface over that of the drum's wall.
    pub flowing_speed: f64,
}

impl Default for Exposure {
    fn default() -> Self {
        Self {
            seconds: 0.0,
            speed_rpm: 0.0,
            sub_frames: 16,
            flowing_depth: 0.15,
            flowing_speed: 4.0,
        }
    }
}

impl Exposure {
    pub(crate) fn check(&self) -> Result<(), Error> {
        check("exposure.seconds", self.seconds, "s", (0.0, 3600.0), "a time of at least 0")?;
        check("exposure.speed_rpm", self.speed_rpm, "1/min", (0.0, 1e4), "a speed of at least 0")?;
        check("exposure.sub_frames", self.sub_frames.into(), "", (1.0, 10_000.0), "1 to 10000")?;
        check(
            "exposure.flowing_depth",
            self.flowing_depth,
            "R",
            (1e-6, 2.0),
            "above 0, at most 2",
        )?;
        check("exposure.flowing_speed", self.flowing_speed, "", (0.0, 1e3), "at least 0")
    }

    /// Whether anything moves while the shutter is open.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.seconds > 0.0 && self.speed_rpm > 0.0 && self.sub_frames > 1
    }

    /// Mean of a colour over the shutter's time, at moments shifted by `phase` (0 to 1) of a step.
    ///
    /// A phase of its own for each pixel turns the copies of a bead that equal moments would leave into grain.
    pub(crate) fn mean(&self, phase: f64, color: impl Fn(f64) -> Color) -> Color {
        if !self.moves() {
            return color(0.0);
        }
        let mut sum = [0.0_f32; 3];
        for i in 0..self.sub_frames {
            let share = (f64::from(i) + phase) / f64::from(self.sub_frames);
            let c = color((share - 0.5) * self.seconds);
            for k in 0..3 {
                sum[k] += c[k];
            }
        }
        sum.map(|v| v / self.sub_frames as f32)
    }

    /// Where, at time 0, the piece of texture was that lies at `p` at `seconds`; radii, x towards the raised side.
    pub(crate) fn texture_origin(&self, shape: &BedShape, p: DVec2, seconds: f64) -> DVec2 {
        if seconds == 0.0 {
            return p;
        }
        let turn = self.speed_rpm * std::f64::consts::TAU / 60.0 * seconds;
        let slope = shape.slope(0.0);
        let depth = shape.depth_below_surface(p) / slope.hypot(1.0);
        if depth >= self.flowing_depth {
            // The drum turns counter-clockwise where the bed is raised to the right.
            return DVec2::from_angle(-turn).rotate(p);
        }
        // Speed from that of the surface (down the slope) to the drum's at the layer's lower bound, linear in depth.
        let share = depth / self.flowing_depth;
        let down = -DVec2::new(1.0, slope).normalize();
        let flowing = down * self.flowing_speed;
        let carried = DVec2::new(-p.y, p.x);
        p - (flowing * (1.0 - share) + carried * share) * turn
    }
}
