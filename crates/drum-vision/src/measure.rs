//! One frame from pixels to responses.

use std::fmt;

use crate::bed::boundary::{Boundary, trace};
use crate::bed::columns::trace_columns;
use crate::bed::edge::{Curve, trace_edges};
use crate::bed::prepare::{Prepared, prepare};
use crate::bed::region::trace_region;
use crate::bed::split::split_line;
use crate::config::{CircleSource, SurfaceMethod, VisionConfig};
use crate::drum::detect::{CircleOrigin, Drum, detect_drum};
use crate::error::VisionError;
use crate::filter::stretch::histogram;
use crate::frame::Frame;
use crate::response::{Responses, responses};
use crate::sidecar::RegionSidecar;
use crate::surface::{RaisedSide, Surface};
use crate::uncertainty::{Budget, Weights, budget};

/// A value with its standard uncertainty (value ± 2 `sd` is meant to hold the truth in 90 to 99 % of frames).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// Standard uncertainty.
    pub sd: f64,
}

/// Something about a frame that a reader of its figures should know.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", tag = "kind"))]
pub enum Warning {
    /// The rim is elliptic: the camera is tilted against the drum's axis.
    TiltedCamera {
        /// Difference of the half axes over the radius.
        ellipticity: f64,
        /// Tilt that explains it, degrees.
        tilt_deg: f64,
    },
    /// A good part of the interior is saturated.
    Saturated {
        /// Fraction of the interior.
        fraction: f64,
    },
    /// The surface overhangs in some columns; the upper branch was kept.
    SurfaceFolds,
    /// Part of the surface was not visible and is bridged by the spline.
    PartlyHidden {
        /// Fraction that was visible.
        visible: f64,
    },
    /// A reflex lies on the surface; what it hides is bridged, its flanks may have been taken for the bed.
    GlareOnSurface {
        /// Fraction of the surface that it touches.
        fraction: f64,
    },
    /// The surface meets the wall at so small an angle that its end is not seen but continued.
    EndContinued {
        /// Continued length at one end over the length of the surface.
        fraction: f64,
    },
    /// The surface bends strongly at an end, along the wall: what is bed and what is wall there decides on the
    /// line, by more than the stated uncertainty.
    EndTurns {
        /// Standard uncertainty of the whole line's angle from the ends' bend alone, degrees.
        sd_deg: f64,
    },
    /// The stated uncertainty of a response is large.
    LargeUncertainty {
        /// Largest standard uncertainty of the four responses, degrees or percent of the radius.
        sd: f64,
    },
    /// The edge is blurred over many pixels.
    BlurredEdge {
        /// Width from 20 to 80 % of the contrast, pixels.
        width_px: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TiltedCamera { ellipticity, tilt_deg } => write!(
                f,
                "the rim is elliptic by {:.1} %: the camera seems tilted by {tilt_deg:.0} deg",
                100.0 * ellipticity
            ),
            Self::Saturated { fraction } => {
                write!(f, "{:.0} % of the drum is saturated", 100.0 * fraction)
            }
            Self::SurfaceFolds => f.write_str("the surface overhangs; its upper branch was kept"),
            Self::PartlyHidden { visible } => {
                write!(
                    f,
                    "only {:.0} % of the surface is visible, the rest is bridged",
                    100.0 * visible
                )
            }
            Self::GlareOnSurface { fraction } => {
                write!(f, "a reflex touches {:.0} % of the surface", 100.0 * fraction)
            }
            Self::EndContinued { fraction } => write!(
                f,
                "the last {:.0} % of the surface at one end are too thin to be seen and are continued",
                100.0 * fraction
            ),
            Self::EndTurns { sd_deg } => write!(
                f,
                "the surface bends along the wall at an end: the whole line may be off by several times {sd_deg:.2} deg"
            ),
            Self::LargeUncertainty { sd } => {
                write!(f, "the uncertainty of a response is {sd:.2} deg or % of the radius")
            }
            Self::BlurredEdge { width_px } => {
                write!(f, "the edge of the bed is blurred over {width_px:.1} px")
            }
        }
    }
}

/// Everything that was measured in one frame.
#[derive(Clone, Debug)]
pub struct FrameMeasurement {
    /// The drum, in pixels of the frame.
    pub drum: Drum,
    /// The free surface, relative to the drum's centre, y up.
    pub surface: Surface,
    /// The raised side.
    pub raised: RaisedSide,
    /// The responses.
    pub responses: Responses,
    /// Standard uncertainties, by component.
    pub budget: Budget,
    /// Whether the bed is brighter than the background.
    pub bright_bed: bool,
    /// Fraction of the surface on which an edge was accepted.
    pub visible: f64,
    /// Robust scatter of the edge about the smooth surface, pixels.
    pub scatter_px: f64,
    /// Width of the edge from 20 to 80 % of the contrast, pixels.
    pub edge_width_px: f64,
    /// Share of the surface between its outermost edge point and the wall, at the worse end.
    pub continued: f64,
    /// What a reader should know.
    pub warnings: Vec<Warning>,
}

impl FrameMeasurement {
    fn measured(&self, k: usize) -> Measured {
        Measured { value: self.responses.to_array()[k], sd: self.budget.total()[k] }
    }

    /// Angle of the line through the whole surface, degrees.
    #[must_use]
    pub fn aor_lin_deg(&self) -> Measured {
        self.measured(0)
    }

    /// Angle of the line through its middle, degrees.
    #[must_use]
    pub fn aor_mid_deg(&self) -> Measured {
        self.measured(1)
    }

    /// Centre of area towards the raised side, percent of the radius.
    #[must_use]
    pub fn cen_x_pct(&self) -> Measured {
        self.measured(2)
    }

    /// Centre of area downwards, percent of the radius.
    #[must_use]
    pub fn cen_y_pct(&self) -> Measured {
        self.measured(3)
    }

    /// Apparent fill, area over area.
    #[must_use]
    pub fn fill(&self) -> Measured {
        self.measured(4)
    }

    /// Bend of the surface, see [`Responses::curvature`].
    #[must_use]
    pub fn curvature(&self) -> Measured {
        self.measured(5)
    }

    /// S-shape: angle of the middle less that of the whole, degrees; the uncertainties are added in squares.
    #[must_use]
    pub fn s_shape_deg(&self) -> Measured {
        let sd = self.budget.total();
        Measured { value: self.responses.s_shape_deg(), sd: sd[0].hypot(sd[1]) }
    }

    /// The four responses of the thesis.
    #[must_use]
    pub fn four(&self) -> [Measured; 4] {
        std::array::from_fn(|k| self.measured(k))
    }
}

/// Least and largest apparent fill that still shows a free surface worth a line.
const FILL_RANGE: (f64, f64) = (0.015, 0.97);

/// Share of the surface that may be continued at an end without a word.
const CONTINUED: f64 = 0.04;

/// Standard uncertainty of the whole line's angle from the bend of its ends above which it is reported, degrees:
/// 2 to 4 % of clean frames, among them most of those that were off by more than 0.15 degrees unreported.
const TURNED: f64 = 0.05;

/// Standard uncertainty from which a frame carries a warning, degrees or percent of the radius: the error that a clean frame may
/// have.
const LARGE_SD: f64 = 0.15;

/// What a frame may need from outside of itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Context<'a> {
    /// Drum of the reference frame, where one is configured.
    pub reference: Option<&'a Drum>,
    /// Region pointed out by a person.
    pub region: Option<&'a RegionSidecar>,
}

/// Measures one frame.
///
/// # Errors
/// A [`VisionError`] whose [`VisionError::stage`] tells how far the chain came.
pub fn measure_frame(
    frame: &Frame,
    config: &VisionConfig,
    context: Context<'_>,
) -> Result<FrameMeasurement, VisionError> {
    config.check()?;
    check_exposure(frame, config)?;
    let mut drum_config = config.drum.clone();
    if let Some([x_px, y_px, radius_px]) = context.region.and_then(|r| r.circle_px) {
        drum_config.source = CircleSource::Circle { x_px, y_px, radius_px };
    }
    let drum = detect_drum(frame, &drum_config, context.reference)?;
    let prepared = prepare(frame, drum.fit.circle, config)?;
    let (curve, bright_bed) = match context.region {
        Some(region) => (trace_region(frame, &prepared, region, config)?, true),
        None => trace_bed(&prepared, config)?,
    };
    finish(&drum, &prepared, &curve, bright_bed, config)
}

fn trace_bed(prepared: &Prepared, config: &VisionConfig) -> Result<(Curve, bool), VisionError> {
    let line = split_line(prepared, config.bed.tone, config.bed.min_contrast)?;
    // In grey levels of the frame, before the stretch.
    let gain = 255.0 / f64::from(prepared.limits.1 - prepared.limits.0);
    let contrast = (line.below - line.above).abs() / gain;
    if contrast < config.bed.min_contrast_levels {
        return Err(VisionError::NoContrast { contrast, noise: line.scatter / gain });
    }
    let boundary = trace(prepared, &line);
    if boundary.fill < FILL_RANGE.0 {
        return Err(VisionError::EmptyDrum { fill: boundary.fill });
    }
    if boundary.fill > FILL_RANGE.1 {
        return Err(VisionError::FullDrum { fill: boundary.fill });
    }
    if follows_wall(&boundary, prepared.circle.radius_px) {
        return Err(if boundary.fill < 0.5 {
            VisionError::EmptyDrum { fill: boundary.fill }
        } else {
            VisionError::FullDrum { fill: boundary.fill }
        });
    }
    let curve = match config.surface.method {
        SurfaceMethod::SubPixel => trace_edges(prepared, &boundary, config)?,
        SurfaceMethod::Columns => trace_columns(prepared, &boundary, config)?,
    };
    Ok((curve, line.below > line.above))
}

/// Whether the boundary keeps one distance from the axis over more than half the diameter: then it is the tube's or
/// the rear wall's edge in an empty or full drum, no free surface.
fn follows_wall(boundary: &Boundary, radius_px: f64) -> bool {
    let distances: Vec<f64> = boundary
        .v_px
        .iter()
        .enumerate()
        .filter_map(|(k, v)| v.map(|v| boundary.u_px(k).hypot(v) / radius_px))
        .collect();
    let quantile = |p| crate::statistics::quantile(&distances, p).unwrap_or(0.0);
    let wide = distances.len() as f64 * boundary.step_px > radius_px;
    wide && quantile(0.5) > 0.6 && quantile(0.9) - quantile(0.1) < 0.1
}

fn finish(
    drum: &Drum,
    prepared: &Prepared,
    curve: &Curve,
    bright_bed: bool,
    config: &VisionConfig,
) -> Result<FrameMeasurement, VisionError> {
    let local = prepared.circle;
    let surface = Surface::from_curve(curve, local, |_| 0.0)?;
    let raised = surface.raised(config.response.rotation);
    let values = responses(&surface, local, prepared.hub_px, raised, config);
    if let Some(bad) = values.to_array().iter().find(|v| !v.is_finite()) {
        return Err(VisionError::Fault { detail: format!("a response is {bad}") });
    }
    let weights = Weights::default();
    let budget =
        budget(curve, local, &drum.fit, prepared.hub_px, raised, &values, config, &weights);
    let mut warnings = Vec::new();
    let fit = &drum.fit;
    if fit.ellipticity > config.drum.max_ellipticity
        && fit.ellipticity > 4.0 * fit.ellipticity_sd
        && drum.origin != CircleOrigin::Hand
    {
        warnings
            .push(Warning::TiltedCamera { ellipticity: fit.ellipticity, tilt_deg: fit.tilt_deg() });
    }
    if prepared.saturated > 0.25 {
        warnings.push(Warning::Saturated { fraction: prepared.saturated });
    }
    if surface.folds {
        warnings.push(Warning::SurfaceFolds);
    }
    if curve.visible < 0.75 {
        warnings.push(Warning::PartlyHidden { visible: curve.visible });
    }
    if curve.glare > 0.0 {
        warnings.push(Warning::GlareOnSurface { fraction: curve.glare });
    }
    let continued = continued_share(curve, &surface);
    if continued > CONTINUED {
        warnings.push(Warning::EndContinued { fraction: continued });
    }
    let turned = budget.turned[0];
    if turned > TURNED {
        warnings.push(Warning::EndTurns { sd_deg: turned });
    }
    let sd = budget.total()[..4].iter().copied().fold(0.0, f64::max);
    if sd > LARGE_SD {
        warnings.push(Warning::LargeUncertainty { sd });
    }
    if curve.edge_width_px > (0.06 * local.radius_px).max(6.0) {
        warnings.push(Warning::BlurredEdge { width_px: curve.edge_width_px });
    }
    Ok(FrameMeasurement {
        drum: *drum,
        surface,
        raised,
        responses: values,
        budget,
        bright_bed,
        visible: curve.visible,
        scatter_px: curve.smoothed.scatter,
        edge_width_px: curve.edge_width_px,
        continued,
        warnings,
    })
}

/// Length from the outermost believed edge to the wall at the worse end, over the length of the surface.
fn continued_share(curve: &Curve, surface: &Surface) -> f64 {
    let held = |(_, w): &(&f64, &f64)| **w > 0.05;
    let mut points = curve.u_px.iter().zip(&curve.smoothed.weights).filter(held).map(|(u, _)| *u);
    let Some(first) = points.next() else { return 1.0 };
    let last = points.next_back().unwrap_or(first);
    let (cos, sin) = curve.axes.turn;
    let ends = [surface.points[0], surface.points[surface.points.len() - 1]]
        .map(|(x, y)| x * cos + y * sin);
    let span = (ends[1] - ends[0]).abs().max(1.0);
    (first - ends[0]).max(ends[1] - last) / span
}

/// Refuses a black frame, by the 99th percentile of every seventh pixel.
fn check_exposure(frame: &Frame, config: &VisionConfig) -> Result<(), VisionError> {
    let counts = histogram(frame.rgb().as_chunks::<3>().0.iter().step_by(7).map(|p| {
        ((u32::from(p[0]) * 299 + u32::from(p[1]) * 587 + u32::from(p[2]) * 114) / 1000) as u8
    }));
    let total: u64 = counts.iter().sum();
    let mut sum = 0;
    let p99 = counts
        .iter()
        .position(|n| {
            sum += n;
            sum as f64 >= 0.99 * total as f64
        })
        .unwrap_or(0) as f64;
    if p99 < config.exposure.black_level {
        return Err(VisionError::Black { p99 });
    }
    let level = config.exposure.saturated_level;
    let over: u64 = counts[usize::from(level)..].iter().sum();
    let fraction = over as f64 / total.max(1) as f64;
    if fraction > 0.98 {
        return Err(VisionError::Saturated { fraction, level });
    }
    Ok(())
}
