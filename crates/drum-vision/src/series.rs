//! A series of frames of one experiment: parallel measurement, means, scatter, outliers.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::config::{CircleSource, VisionConfig};
use crate::decode::decode_file;
use crate::drum::circle_fit::Circle;
use crate::drum::detect::{Drum, detect_drum};
use crate::error::{Stage, VisionError};
use crate::frame::Frame;
use crate::measure::{Context, FrameMeasurement, Measured, Warning, measure_frame};
use crate::regime::{Regime, Signs, froude, guess};
use crate::sidecar::RegionSidecar;
use crate::statistics::{covariance, effective_number, mean, median, standard_deviation};
use crate::surface::RaisedSide;

/// Names of the four responses, in the order of the covariance.
pub const RESPONSES: [&str; 4] = ["aor_lin_deg", "aor_mid_deg", "cen_x_pct", "cen_y_pct"];

/// One measured frame of a series, as it is reported.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FrameReport {
    /// Name of the frame.
    pub frame: String,
    /// Angle of the line through the whole surface, degrees.
    pub aor_lin_deg: Measured,
    /// Angle of the line through its middle, degrees.
    pub aor_mid_deg: Measured,
    /// Centre of area towards the raised side, percent of the radius.
    pub cen_x_pct: Measured,
    /// Centre of area downwards, percent of the radius.
    pub cen_y_pct: Measured,
    /// Apparent fill.
    pub fill: Measured,
    /// Angle of the middle less that of the whole, degrees.
    pub s_shape_deg: Measured,
    /// Second derivative of the least-squares parabola times the radius.
    pub curvature: Measured,
    /// Centre and radius of the drum, pixels.
    pub drum: DrumReport,
    /// The raised side.
    pub raised: RaisedSide,
    /// Fraction of the surface that was seen.
    pub visible: f64,
    /// Why the frame is an outlier of its series, if it is.
    pub outlier: Option<String>,
    /// What a reader should know.
    pub warnings: Vec<Warning>,
}

/// Centre and radius of a drum.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct DrumReport {
    /// Column and row of the centre, pixels (centres at whole numbers).
    pub center_px: [f64; 2],
    /// Inner radius, pixels.
    pub radius_px: f64,
}

impl From<Circle> for DrumReport {
    fn from(c: Circle) -> Self {
        Self { center_px: [c.x_px, c.y_px], radius_px: c.radius_px }
    }
}

/// A frame that gave no responses.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Rejected {
    /// Name of the frame.
    pub frame: String,
    /// How far the chain came.
    pub stage: Stage,
    /// What went wrong and what to try.
    pub reason: String,
}

/// Mean of a response over the frames.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ResponseSummary {
    /// Mean over the frames.
    pub mean: f64,
    /// Standard deviation over the frames (not of the mean); `None` for one frame.
    pub sd: Option<f64>,
    /// Effective number of independent frames.
    pub n_eff: f64,
    /// Autocorrelation from one frame to the next.
    pub lag_one: f64,
    /// Median standard uncertainty of a single frame.
    pub frame_sd: f64,
}

/// The four responses of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ResponseSummaries {
    /// Angle of the line through the whole surface, degrees.
    pub aor_lin_deg: ResponseSummary,
    /// Angle of the line through its middle, degrees.
    pub aor_mid_deg: ResponseSummary,
    /// Centre of area towards the raised side, percent of the radius.
    pub cen_x_pct: ResponseSummary,
    /// Centre of area downwards, percent of the radius.
    pub cen_y_pct: ResponseSummary,
}

/// What a series of frames gives; outliers are named, not left out.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SeriesReport {
    /// Number of measured frames.
    pub n_frames: usize,
    /// Frames that gave nothing, with stage and reason.
    pub rejected: Vec<Rejected>,
    /// Median circle of the frames; `None` when no frame was measured.
    pub drum: Option<DrumReport>,
    /// Largest less least radius over the frames, pixels.
    pub radius_spread_px: f64,
    /// Means and scatter; `None` when no frame was measured.
    pub responses: Option<ResponseSummaries>,
    /// Covariance of the four means, in the order of [`RESPONSES`]; `None` with fewer than two frames.
    pub covariance: Option<[[f64; 4]; 4]>,
    /// Mean apparent fill.
    pub fill: Option<f64>,
    /// Mean S-shape, degrees.
    pub s_shape_deg: Option<f64>,
    /// Froude number, where speed and radius are known.
    pub froude: Option<f64>,
    /// Guess at the regime.
    pub regime: Option<Regime>,
    /// What a reader of the series should know.
    pub notes: Vec<String>,
    /// The measured frames, in order.
    pub frames: Vec<FrameReport>,
}

/// What the caller of [`measure_series`] hears after every frame.
#[derive(Debug)]
pub struct Progress<'a> {
    /// Place in the list of paths.
    pub index: usize,
    /// Frames in the list.
    pub total: usize,
    /// The file.
    pub path: &'a Path,
    /// The decoded frame, where it could be decoded.
    pub frame: Option<&'a Frame>,
    /// Its measurement or error.
    pub outcome: Result<&'a FrameMeasurement, &'a VisionError>,
}

/// Measures files in parallel; a bad frame never stops the others.
///
/// `progress` is called from the worker threads, once a frame, in the order in which they finish; it may write
/// overlays, for the frame is in memory then. Results do not depend on the number of threads. At
/// most one frame a thread is held in memory.
///
/// # Errors
/// [`VisionError::Invalid`] for a setting out of range, [`VisionError::Reference`] when the reference frame gives no
/// circle, [`VisionError::NoFrames`] for an empty list. Errors of single frames are in
/// [`SeriesReport::rejected`].
pub fn measure_series(
    paths: &[PathBuf],
    config: &VisionConfig,
    region: Option<&RegionSidecar>,
    progress: impl Fn(&Progress<'_>) + Sync,
) -> Result<SeriesReport, VisionError> {
    config.check()?;
    if paths.is_empty() {
        return Err(VisionError::NoFrames { what: "the list of frames".into() });
    }
    let reference = reference_drum(config)?;
    let total = paths.len();
    let outcomes: Vec<Result<FrameMeasurement, VisionError>> = paths
        .par_iter()
        .enumerate()
        .map(|(index, path)| {
            let decoded = guarded(|| decode_file(path, &config.decode));
            let (frame, outcome) = match decoded {
                Ok(frame) => {
                    let context = Context { reference: reference.as_ref(), region };
                    let outcome = guarded(|| measure_frame(&frame, config, context));
                    (Some(frame), outcome)
                }
                Err(e) => (None, Err(e)),
            };
            progress(&Progress {
                index,
                total,
                path,
                frame: frame.as_ref(),
                outcome: outcome.as_ref(),
            });
            outcome
        })
        .collect();
    let named = paths
        .iter()
        .map(|p| {
            p.file_name()
                .map_or_else(|| p.display().to_string(), |n| n.to_string_lossy().into_owned())
        })
        .zip(outcomes);
    Ok(summarise(named, config))
}

/// The drum of the configured reference frame, where there is one.
///
/// # Errors
/// [`VisionError::Reference`] with the frame's own error inside.
pub fn reference_drum(config: &VisionConfig) -> Result<Option<Drum>, VisionError> {
    let CircleSource::Reference { path } = &config.drum.source else {
        return Ok(None);
    };
    guarded(|| decode_file(path, &config.decode).and_then(|f| detect_drum(&f, &config.drum, None)))
        .map(Some)
        .map_err(|e| VisionError::Reference { path: path.clone(), source: Box::new(e) })
}

/// Turns a panic below into an error, so that a fault in one frame leaves the others alone.
fn guarded<T>(run: impl FnOnce() -> Result<T, VisionError>) -> Result<T, VisionError> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).unwrap_or_else(|cause| {
        let detail = cause
            .downcast_ref::<String>()
            .cloned()
            .or_else(|| cause.downcast_ref::<&str>().map(|s| (*s).to_owned()))
            .unwrap_or_else(|| "no message".into());
        Err(VisionError::Fault { detail })
    })
}

/// Sums up named outcomes in their order.
#[must_use]
pub fn summarise(
    outcomes: impl IntoIterator<Item = (String, Result<FrameMeasurement, VisionError>)>,
    config: &VisionConfig,
) -> SeriesReport {
    let mut frames = Vec::new();
    let mut rejected = Vec::new();
    for (frame, outcome) in outcomes {
        match outcome {
            Ok(m) => frames.push(report_of(frame, &m)),
            Err(e) => {
                rejected.push(Rejected { frame, stage: e.stage(), reason: e.to_string() });
            }
        }
    }
    let mut notes = Vec::new();
    let column = |pick: &dyn Fn(&FrameReport) -> f64| frames.iter().map(pick).collect::<Vec<f64>>();
    let series: [Vec<f64>; 4] = std::array::from_fn(|k| column(&|f| four(f)[k].value));
    let radii = column(&|f| f.drum.radius_px);
    let radius_spread_px = radii.iter().copied().fold(f64::NEG_INFINITY, f64::max)
        - radii.iter().copied().fold(f64::INFINITY, f64::min);
    let radius_spread_px = if radii.is_empty() { 0.0 } else { radius_spread_px };
    if radius_spread_px > config.series.radius_spread_px {
        notes.push(format!(
            "the drum's radius spreads over {radius_spread_px:.2} px, more than {:.2} px",
            config.series.radius_spread_px
        ));
    }
    name_outliers(&mut frames, &series, &radii, config);
    if !rejected.is_empty() {
        let total = rejected.len() + frames.len();
        notes.push(format!("{} of {total} frames gave no responses", rejected.len()));
    }
    let responses = summaries(&series, &frames);
    let fill = mean(&column_of(&frames, |f| f.fill.value));
    let s_shape_deg = mean(&column_of(&frames, |f| f.s_shape_deg.value));
    let fr = config.rig.speed_rpm.zip(config.rig.drum_radius_m).map(|(n, r)| froude(n, r));
    let regime = responses.zip(fill).zip(s_shape_deg).map(|((r, fill), s_shape_deg)| {
        guess(&Signs {
            aor_lin_deg: r.aor_lin_deg.mean,
            aor_lin_sd: r.aor_lin_deg.sd,
            s_shape_deg,
            fill,
            froude: fr,
        })
    });
    let drum = median_drum(&frames);
    SeriesReport {
        n_frames: frames.len(),
        rejected,
        drum,
        radius_spread_px,
        covariance: mean_covariance(&series),
        responses,
        fill,
        s_shape_deg,
        froude: fr,
        regime,
        notes,
        frames,
    }
}

impl SeriesReport {
    /// A row of the measured-responses table: `omega_rpm`, then mean and sd of the four responses.
    ///
    /// `None` when no frame was measured; an sd that one frame cannot give is left empty.
    #[must_use]
    pub fn csv_row(&self, omega_rpm: f64) -> Option<String> {
        let r = self.responses?;
        let cells = [r.aor_lin_deg, r.aor_mid_deg, r.cen_x_pct, r.cen_y_pct].map(|s| {
            let sd = s.sd.map(|v| format!("{v:.4}")).unwrap_or_default();
            format!("{:.4},{sd}", s.mean)
        });
        Some(format!("{omega_rpm},{}", cells.join(",")))
    }

    /// Header of the measured-responses table.
    pub const CSV_HEADER: &'static str = "omega_rpm,aor_lin_deg,aor_lin_sd,aor_mid_deg,aor_mid_sd,cen_x_pct,cen_x_sd,cen_y_pct,cen_y_sd";
}

fn four(f: &FrameReport) -> [Measured; 4] {
    [f.aor_lin_deg, f.aor_mid_deg, f.cen_x_pct, f.cen_y_pct]
}

fn column_of(frames: &[FrameReport], pick: impl Fn(&FrameReport) -> f64) -> Vec<f64> {
    frames.iter().map(pick).collect()
}

fn report_of(frame: String, m: &FrameMeasurement) -> FrameReport {
    FrameReport {
        frame,
        aor_lin_deg: m.aor_lin_deg(),
        aor_mid_deg: m.aor_mid_deg(),
        cen_x_pct: m.cen_x_pct(),
        cen_y_pct: m.cen_y_pct(),
        fill: m.fill(),
        s_shape_deg: m.s_shape_deg(),
        curvature: m.curvature(),
        drum: m.drum.fit.circle.into(),
        raised: m.raised,
        visible: m.visible,
        outlier: None,
        warnings: m.warnings.clone(),
    }
}

fn median_drum(frames: &[FrameReport]) -> Option<DrumReport> {
    Some(DrumReport {
        center_px: [
            median(&column_of(frames, |f| f.drum.center_px[0]))?,
            median(&column_of(frames, |f| f.drum.center_px[1]))?,
        ],
        radius_px: median(&column_of(frames, |f| f.drum.radius_px))?,
    })
}

fn summaries(series: &[Vec<f64>; 4], frames: &[FrameReport]) -> Option<ResponseSummaries> {
    let one = |k: usize| -> Option<ResponseSummary> {
        Some(ResponseSummary {
            mean: mean(&series[k])?,
            sd: standard_deviation(&series[k]),
            n_eff: effective_number(&series[k]),
            lag_one: crate::statistics::autocorrelation(&series[k], 1)
                .get(1)
                .copied()
                .unwrap_or(0.0),
            frame_sd: median(&column_of(frames, |f| four(f)[k].sd))?,
        })
    };
    Some(ResponseSummaries {
        aor_lin_deg: one(0)?,
        aor_mid_deg: one(1)?,
        cen_x_pct: one(2)?,
        cen_y_pct: one(3)?,
    })
}

/// `cov(a, b) / sqrt(n_a n_b)` with the effective numbers of frames: positive semi-definite as the covariance is.
fn mean_covariance(series: &[Vec<f64>; 4]) -> Option<[[f64; 4]; 4]> {
    let n: [f64; 4] = std::array::from_fn(|k| effective_number(&series[k]));
    let mut out = [[0.0; 4]; 4];
    for (i, row) in out.iter_mut().enumerate() {
        for (j, v) in row.iter_mut().enumerate() {
            *v = covariance(&series[i], &series[j])? / (n[i] * n[j]).sqrt();
        }
    }
    Some(out)
}

/// Names frames that lie far from the median in a response, or whose radius does.
///
/// The distance is judged against the larger of the robust scatter of the series and the
/// frames' own median uncertainty; a series needs five frames to have outliers.
fn name_outliers(
    frames: &mut [FrameReport],
    series: &[Vec<f64>; 4],
    radii: &[f64],
    config: &VisionConfig,
) {
    if frames.len() < 5 {
        return;
    }
    let limit = config.series.outlier_sd;
    let far = |values: &[f64], own: f64| -> Vec<Option<f64>> {
        let centre = median(values).unwrap_or(0.0);
        let moduli: Vec<f64> = values.iter().map(|v| (v - centre).abs()).collect();
        let sd = (1.4826 * median(&moduli).unwrap_or(0.0)).max(own);
        values
            .iter()
            .map(|v| {
                let d = v - centre;
                (sd > 0.0 && d.abs() > limit * sd).then_some(d)
            })
            .collect()
    };
    let mut marks: Vec<Vec<String>> = vec![Vec::new(); frames.len()];
    for (k, values) in series.iter().enumerate() {
        let own = median(&column_of(frames, |f| four(f)[k].sd)).unwrap_or(0.0);
        for (m, d) in marks.iter_mut().zip(far(values, own)) {
            if let Some(d) = d {
                m.push(format!("{} is {d:+.2} from the median", RESPONSES[k]));
            }
        }
    }
    let own = config.series.radius_spread_px / limit;
    for (m, d) in marks.iter_mut().zip(far(radii, own)) {
        if let Some(d) = d {
            m.push(format!("the drum's radius is {d:+.2} px from the median"));
        }
    }
    for (f, m) in frames.iter_mut().zip(marks) {
        if !m.is_empty() {
            f.outlier = Some(m.join("; "));
        }
    }
}
