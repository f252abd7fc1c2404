//! All settings of the chain in one value, with stated defaults.

use crate::error::VisionError;
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

macro_rules! settings {
    ($(#[$meta:meta])* pub struct $name:ident { $($(#[$fmeta:meta])* pub $field:ident: $ty:ty = $default:expr,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
        #[cfg_attr(feature = "serde", serde(deny_unknown_fields, default))]
        pub struct $name { $($(#[$fmeta])* pub $field: $ty,)* }
        impl Default for $name {
            fn default() -> Self { Self { $($field: $default,)* } }
        }
    };
}

macro_rules! choice {
    ($(#[$meta:meta])* pub enum $name:ident { $($body:tt)* }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, Default, PartialEq)]
        #[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
        #[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", deny_unknown_fields))]
        pub enum $name { $($body)* }
    };
}

settings! {
    /// Everything that decides how a frame becomes responses.
    ///
    /// Defaults measure a photograph or rendered frame without a word from the user;
    /// [`VisionConfig::thesis`] gives the chain of the MATLAB scripts.
    pub struct VisionConfig {
        /// Limits of the decoder.
        pub decode: DecodeConfig = DecodeConfig::default(),
        /// Limits of the exposure.
        pub exposure: ExposureConfig = ExposureConfig::default(),
        /// How the drum is found.
        pub drum: DrumConfig = DrumConfig::default(),
        /// How the bed is told from the background.
        pub bed: BedConfig = BedConfig::default(),
        /// How the free surface is traced.
        pub surface: SurfaceConfig = SurfaceConfig::default(),
        /// How the responses are defined.
        pub response: ResponseConfig = ResponseConfig::default(),
        /// Known biases of the measurement, applied to the results.
        pub measure: MeasureConfig = MeasureConfig::default(),
        /// What is known about the experiment.
        pub rig: RigConfig = RigConfig::default(),
        /// How a series of frames is judged.
        pub series: SeriesConfig = SeriesConfig::default(),
    }
}

settings! {
    /// Limits of the decoder.
    pub struct DecodeConfig {
        /// Largest number of pixels accepted; 40 million by default. A frame takes 3 bytes a pixel.
        pub max_pixels: u64 = 40_000_000,
    }
}

settings! {
    /// When a frame counts as black or saturated.
    pub struct ExposureConfig {
        /// The 99th percentile of grey must exceed this level.
        pub black_level: f64 = 16.0,
        /// Grey level from which a pixel counts as saturated.
        pub saturated_level: u8 = 254,
        /// Largest accepted fraction of saturated pixels within the drum.
        pub saturated_fraction: f64 = 0.9,
    }
}

settings! {
    /// How the drum is found.
    pub struct DrumConfig {
        /// Where the circle comes from.
        pub source: CircleSource = CircleSource::Auto,
        /// Which pixels belong to the red ring.
        pub red: RedConfig = RedConfig::default(),
        /// Range of the radius searched, pixels; by default 0.2 to 0.55 of the shorter side.
        pub radius_range_px: Option<[f64; 2]> = None,
        /// Whether the drum is darker or lighter than what surrounds it (used without a ring).
        pub polarity: Polarity = Polarity::Both,
        /// Least fraction of the circumference that must show an edge.
        pub min_support: f64 = 0.4,
        /// Difference of the half axes over the radius from which a tilted camera is reported.
        pub max_ellipticity: f64 = 0.01,
    }
}

choice! {
    /// Where the drum's circle comes from.
    pub enum CircleSource {
        /// The red ring where there is one, else the outline.
        #[default]
        Auto,
        /// The inner edge of the red ring.
        Ring,
        /// The drum's outline in grey.
        Outline,
        /// The outline in another frame taken with the same camera, as for EDEM's pictures.
        Reference {
            /// File of the reference frame.
            path: std::path::PathBuf,
        },
        /// A circle given by hand.
        Circle {
            /// Centre column, pixels.
            x_px: f64,
            /// Centre row, pixels.
            y_px: f64,
            /// Inner radius of the drum, pixels.
            radius_px: f64,
        },
    }
}

settings! {
    /// Which pixels count as red: `R > red_above`, `G < green_below` and `B < blue_below`.
    pub struct RedConfig {
        /// Red must exceed this; 100 in the thesis.
        pub red_above: u8 = 100,
        /// Green must lie below this; 100 in the thesis.
        pub green_below: u8 = 100,
        /// Blue must lie below this; 100 in the thesis.
        pub blue_below: u8 = 100,
        /// Side of the median window that cleans the mask, pixels; by default 10 at a radius range
        /// whose upper end is 550 px (the thesis's), scaled with it, at least 3.
        pub median_px: Option<usize> = None,
    }
}

choice! {
    /// Contrast of the drum against its surroundings.
    #[derive(Copy, Eq)]
    pub enum Polarity {
        /// Either; the one with more support is taken.
        #[default]
        Both,
        /// The drum is darker than its surroundings.
        DarkOnLight,
        /// The drum is lighter than its surroundings.
        LightOnDark,
    }
}

settings! {
    /// How the bed is told from the background.
    pub struct BedConfig {
        /// Side of the median window, pixels; by default the odd number next to radius/100, at least 3. 1: none.
        pub median_px: Option<usize> = None,
        /// Side of the Wiener window, pixels; by default as the median's. 1: none.
        pub wiener_px: Option<usize> = None,
        /// Fraction of the pixels saturated at either end of the contrast stretch.
        pub saturate: f64 = 0.01,
        /// The grey level that parts bed and background.
        pub threshold: Threshold = Threshold::LocalContrast,
        /// Whether the bed is brighter or darker than the background.
        pub tone: Tone = Tone::Auto,
        /// Radius of the hub that is masked, fraction of the drum's; 1/7 in the thesis. 0: no hub.
        pub hub: f64 = 1.0 / 7.0,
        /// Least contrast of bed and background over the scatter within them.
        pub min_contrast: f64 = 1.5,
        /// Least contrast of bed and background, grey levels of the frame.
        pub min_contrast_levels: f64 = 12.0,
    }
}

choice! {
    /// The grey level that parts bed and background.
    pub enum Threshold {
        /// Half-way between the grey levels found on the two sides of each piece of the surface.
        #[default]
        LocalContrast,
        /// One level for the frame by Otsu's rule.
        Otsu,
        /// One given level of the stretched frame, 0 to 255 (the thesis's "handmade": 170 or 180).
        Fixed {
            /// The level.
            level: f64,
        },
    }
}

choice! {
    /// Tone of the bed against the background.
    #[derive(Copy, Eq)]
    pub enum Tone {
        /// Found from the frame: the bed lies lower.
        #[default]
        Auto,
        /// The bed is brighter.
        Bright,
        /// The bed is darker.
        Dark,
    }
}

settings! {
    /// How the free surface is traced.
    pub struct SurfaceConfig {
        /// The method.
        pub method: SurfaceMethod = SurfaceMethod::SubPixel,
        /// Distance of the scanned columns, pixels (`columns` only); 10 in the thesis.
        pub column_step_px: usize = 1,
        /// Pieces of the smoothing spline over the drum's diameter.
        pub spline_pieces: usize = 20,
        /// Least visible fraction of the surface.
        pub min_visible: f64 = 0.5,
        /// Largest robust scatter about the spline, fraction of the radius.
        pub max_scatter: f64 = 0.05,
    }
}

choice! {
    /// How the free surface is traced.
    #[derive(Copy, Eq)]
    pub enum SurfaceMethod {
        /// Level crossing across the surface, between pixels, with robust smoothing.
        #[default]
        SubPixel,
        /// First transition of a thresholded picture, column by column; the third of four, the fifth of six.
        Columns,
    }
}

settings! {
    /// How the responses are defined.
    pub struct ResponseConfig {
        /// The named definition of the two angles.
        pub definition: Definition = Definition::Photograph,
        /// Which side the drum raises.
        pub rotation: Rotation = Rotation::Auto,
        /// Whether the part of the bed behind the hub counts for the centre of area.
        pub hub_in_area: bool = true,
    }
}

choice! {
    /// The two definitions of the angles in use.
    #[derive(Copy, Eq)]
    pub enum Definition {
        /// `aor_lin` over the free surface from wall to wall, `aor_mid` over its second and third quarter;
        /// columns in which the first transition is the drum's wall are dropped.
        #[default]
        Photograph,
        /// `aor_lin` over all columns that hold bed, those whose first transition is the drum's wall
        /// included; `aor_mid` from one fifth to four fifths of them.
        Edem,
    }
}

choice! {
    /// Sense of rotation as the camera sees it.
    #[derive(Copy, Eq)]
    pub enum Rotation {
        /// Found from the frame: the raised side is where the surface is higher.
        #[default]
        Auto,
        /// Clockwise: the left side is raised.
        Clockwise,
        /// Counter-clockwise: the right side is raised.
        CounterClockwise,
    }
}

settings! {
    /// Known biases of the measurement; each is declared in [`crate::parameters::parameters`].
    pub struct MeasureConfig {
        /// Added to `cen_x`, percent of the radius: the image's offset towards the raised side.
        pub offset_x_pct: f64 = 0.0,
        /// Added to `cen_y`, percent of the radius: the image's offset downwards.
        pub offset_y_pct: f64 = 0.0,
        /// Added to `aor_lin`, degrees: a difference of definition.
        pub bias_lin_deg: f64 = 0.0,
        /// Added to `aor_mid`, degrees: a difference of definition.
        pub bias_mid_deg: f64 = 0.0,
        /// Shift of the threshold towards the bed's grey level, fraction of the contrast.
        pub threshold_bias: f64 = 0.0,
        /// Factor on the radius found: the drum's inner radius over that of the circle.
        pub scale: f64 = 1.0,
    }
}

settings! {
    /// What is known about the experiment.
    pub struct RigConfig {
        /// Speed of rotation, revolutions per minute.
        pub speed_rpm: Option<f64> = None,
        /// Inner radius of the drum, metres.
        pub drum_radius_m: Option<f64> = None,
        /// Diameter of the particles, metres; with the drum's radius it bounds the roughness of the surface.
        pub particle_diameter_m: Option<f64> = None,
    }
}

settings! {
    /// How a series of frames is judged.
    pub struct SeriesConfig {
        /// Distance from the median, in robust standard deviations, from which a frame is an outlier.
        pub outlier_sd: f64 = 5.0,
        /// Spread of the radius over the series that is still accepted, pixels (the thesis saw at most 1).
        pub radius_spread_px: f64 = 1.0,
    }
}

impl MeasureConfig {
    /// The value at a path of the namespace, such as `measure.scale`.
    #[must_use]
    pub fn get(&self, path: &str) -> Option<f64> {
        Some(match path {
            "measure.offset_x_pct" => self.offset_x_pct,
            "measure.offset_y_pct" => self.offset_y_pct,
            "measure.bias_lin_deg" => self.bias_lin_deg,
            "measure.bias_mid_deg" => self.bias_mid_deg,
            "measure.threshold_bias" => self.threshold_bias,
            "measure.scale" => self.scale,
            _ => return None,
        })
    }

    /// Sets the value at a path; `false` when there is no such path.
    pub fn set(&mut self, path: &str, value: f64) -> bool {
        let field = match path {
            "measure.offset_x_pct" => &mut self.offset_x_pct,
            "measure.offset_y_pct" => &mut self.offset_y_pct,
            "measure.bias_lin_deg" => &mut self.bias_lin_deg,
            "measure.bias_mid_deg" => &mut self.bias_mid_deg,
            "measure.threshold_bias" => &mut self.threshold_bias,
            "measure.scale" => &mut self.scale,
            _ => return false,
        };
        *field = value;
        true
    }
}

impl VisionConfig {
    /// The chain of the thesis's script for photographs: 40 px median, fixed level 170, every tenth column, hub cut.
    ///
    /// Windows and step are those of 1936 x 1296 frames.
    #[must_use]
    pub fn thesis() -> Self {
        let mut c = Self::default();
        c.bed.median_px = Some(40);
        c.bed.wiener_px = Some(1);
        c.bed.threshold = Threshold::Fixed { level: 170.0 };
        c.surface.method = SurfaceMethod::Columns;
        c.surface.column_step_px = 10;
        c.response.hub_in_area = false;
        c
    }

    /// Checks every number for its range.
    ///
    /// # Errors
    /// [`VisionError::Invalid`] names the first setting out of range.
    pub fn check(&self) -> Result<(), VisionError> {
        let range = |what, v: f64, lo: f64, hi: f64| {
            if v.is_finite() && (lo..=hi).contains(&v) {
                Ok(())
            } else {
                Err(VisionError::Invalid { what, detail: format!("{v}, expected {lo} to {hi}") })
            }
        };
        range("decode.max_pixels", self.decode.max_pixels as f64, 1.0, 1e9)?;
        range("exposure.black_level", self.exposure.black_level, 0.0, 255.0)?;
        range("exposure.saturated_fraction", self.exposure.saturated_fraction, 0.0, 1.0)?;
        range("drum.min_support", self.drum.min_support, 0.05, 1.0)?;
        range("drum.max_ellipticity", self.drum.max_ellipticity, 0.0, 1.0)?;
        if let Some([lo, hi]) = self.drum.radius_range_px {
            range("drum.radius_range_px", lo, 8.0, 1e5)?;
            range("drum.radius_range_px", hi, lo * 1.01, 1e5)?;
        }
        if let CircleSource::Circle { x_px, y_px, radius_px } = self.drum.source {
            range("drum.source.circle.x_px", x_px, -1e6, 1e6)?;
            range("drum.source.circle.y_px", y_px, -1e6, 1e6)?;
            range("drum.source.circle.radius_px", radius_px, 8.0, 1e6)?;
        }
        range("bed.median_px", self.bed.median_px.unwrap_or(1) as f64, 1.0, 255.0)?;
        range("bed.wiener_px", self.bed.wiener_px.unwrap_or(1) as f64, 1.0, 255.0)?;
        range("drum.red.median_px", self.drum.red.median_px.unwrap_or(1) as f64, 1.0, 255.0)?;
        range("bed.saturate", self.bed.saturate, 0.0, 0.4)?;
        if let Threshold::Fixed { level } = self.bed.threshold {
            range("bed.threshold.fixed.level", level, 0.0, 255.0)?;
        }
        range("bed.hub", self.bed.hub, 0.0, 0.9)?;
        range("bed.min_contrast", self.bed.min_contrast, 0.0, 100.0)?;
        range("bed.min_contrast_levels", self.bed.min_contrast_levels, 0.0, 255.0)?;
        range("surface.column_step_px", self.surface.column_step_px as f64, 1.0, 1000.0)?;
        range("surface.spline_pieces", self.surface.spline_pieces as f64, 4.0, 200.0)?;
        range("surface.min_visible", self.surface.min_visible, 0.0, 1.0)?;
        range("surface.max_scatter", self.surface.max_scatter, 0.0, 1.0)?;
        for p in crate::parameters::parameters() {
            if let Some(v) = self.measure.get(p.path) {
                range(p.path, v, p.range.0, p.range.1)?;
            }
        }
        range("rig.speed_rpm", self.rig.speed_rpm.unwrap_or(1.0), 0.0, 1e5)?;
        range("rig.drum_radius_m", self.rig.drum_radius_m.unwrap_or(1.0), 1e-6, 1e3)?;
        range("rig.particle_diameter_m", self.rig.particle_diameter_m.unwrap_or(1.0), 0.0, 1e3)?;
        range("series.outlier_sd", self.series.outlier_sd, 1.0, 1e6)?;
        range("series.radius_spread_px", self.series.radius_spread_px, 0.0, 1e6)
    }

    /// Reads a TOML document; unknown keys are errors with line and column.
    ///
    /// # Errors
    /// [`VisionError::Parse`] with the parser's message, [`VisionError::Invalid`] from [`VisionConfig::check`].
    #[cfg(feature = "serde")]
    pub fn from_toml(text: &str) -> Result<Self, VisionError> {
        let config: Self = toml::from_str(text).map_err(|e| VisionError::Parse {
            what: "vision configuration".into(),
            detail: e.to_string(),
        })?;
        config.check()?;
        Ok(config)
    }
}
