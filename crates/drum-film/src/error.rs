//! The one error type of the crate.

/// What can be wrong with a request for a frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A parameter lies outside the range in which it means something.
    #[error("{path} = {value} {unit}: expected {expected}")]
    OutOfRange {
        /// Path of the parameter, e.g. `camera.distance_m`.
        path: &'static str,
        /// The value given.
        value: f64,
        /// Unit of the value (empty for a pure number).
        unit: &'static str,
        /// What would have been accepted.
        expected: &'static str,
    },
    /// A parameter lies outside the range that its declaration states.
    #[error("{path} = {value} {unit}: expected a value from {low} to {high}")]
    OutsideDeclaredRange {
        /// Path of the parameter.
        path: &'static str,
        /// The value given.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// Lowest value accepted.
        low: f64,
        /// Highest value accepted.
        high: f64,
    },
    /// No parameter has this path.
    #[error("unknown parameter `{path}`; the nearest known one is `{nearest}`")]
    UnknownParameter {
        /// The path asked for.
        path: String,
        /// The known path with the smallest edit distance.
        nearest: &'static str,
    },
    /// The surface asked for crosses the drum's wall between its two ends.
    #[error(
        "the bed surface leaves the drum at x = {x:.3} R (fill {fill}, whole {aor_lin_deg} deg, \
         S-shape {s_shape_deg} deg, curvature {curvature}): lower the S-shape or the curvature"
    )]
    SurfaceLeavesDrum {
        /// Where it crosses, in drum radii.
        x: f64,
        /// Fill asked for.
        fill: f64,
        /// Angle of the whole surface asked for.
        aor_lin_deg: f64,
        /// S-shape asked for.
        s_shape_deg: f64,
        /// Curvature asked for.
        curvature: f64,
    },
    /// The surface is too steep or falls towards its raised side.
    #[error(
        "the bed surface has slopes from {min_slope:.3} to {max_slope:.3}: a surface between -0.5 \
         (where the wall begins by the column rule) and 11.4 (85 deg) was expected"
    )]
    SurfaceTooSteep {
        /// Least slope `dy/dx` of the surface, x towards the raised side.
        min_slope: f64,
        /// Largest slope.
        max_slope: f64,
    },
    /// A column of the picture meets the surface more than once, so that a column scan has no answer.
    #[error(
        "the surface folds over in the picture near column {column_px:.1}: no line can be fitted over columns"
    )]
    SurfaceFolds {
        /// Column at which the surface turns back.
        column_px: f64,
    },
    /// The camera looks so much from the side that the outline of a bed reaching to the rear wall is not its front face swept inwards.
    #[error(
        "the camera's foot on the front plate is {foot_radii:.2} R from the axis, or its rays are parallel and oblique: for a bed that \
         reaches to the rear wall the pinhole must stand in front of the drum (lower camera.pitch_deg or camera.yaw_deg)"
    )]
    PinholeBesideDrum {
        /// Distance of the pinhole's foot from the axis in drum radii.
        foot_radii: f64,
    },
    /// A sphere that cannot be drawn.
    #[error(
        "sphere {index}: centre {center:?} m, radius {radius_m} m: expected finite numbers and a radius above 0"
    )]
    BadSphere {
        /// Its place in the slice.
        index: usize,
        /// Its centre.
        center: [f64; 3],
        /// Its radius.
        radius_m: f64,
    },
    /// A sphere reaches the plane of the camera's pinhole.
    #[error(
        "sphere {index} comes within {depth_m:.4} m of the camera: move the camera away (camera.distance_m)"
    )]
    SphereAtCamera {
        /// Its place in the slice.
        index: usize,
        /// Distance of its nearest point, along the optical axis.
        depth_m: f64,
    },
    /// Rows of one frame come in two places.
    #[error(
        "rows of frame {frame} come again after those of another frame: sort the rows by frame"
    )]
    FrameReturns {
        /// Number of the frame.
        frame: u64,
    },
    /// Frames that were to be joined differ in size.
    #[error("frame {index} is {found:?} pixels, the first one {expected:?}")]
    FrameSize {
        /// Place of the frame in the series.
        index: usize,
        /// Its width and height.
        found: (u32, u32),
        /// Width and height of the first frame.
        expected: (u32, u32),
    },
    /// There is nothing to film.
    #[error("no frame given: {what}")]
    NoFrame {
        /// What was expected.
        what: &'static str,
    },
    /// An encoder failed.
    #[error("encoding {format} failed: {reason}")]
    Encode {
        /// The file format.
        format: &'static str,
        /// The encoder's words.
        reason: String,
    },
}

/// Checks that a value is finite and inside a closed range.
pub(crate) fn check(
    path: &'static str,
    value: f64,
    unit: &'static str,
    range: (f64, f64),
    expected: &'static str,
) -> Result<(), Error> {
    if value.is_finite() && value >= range.0 && value <= range.1 {
        Ok(())
    } else {
        Err(Error::OutOfRange { path, value, unit, expected })
    }
}
