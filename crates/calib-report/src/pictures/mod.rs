//! The pictures of a calibration, each a struct of plain data that draws itself.
//!
//! Texts may carry sub- and superscripts as `μ_{pp}` and `R^{2}`. Units stand in the labels.

mod bars;
mod calibration_map;
mod coefficients;
mod effects;
mod fit_summary;
mod friction_speed;
mod heat_map;
mod histogram;
mod likelihood;
mod line_chart;
mod normal_probability;
mod observed_predicted;
mod overlap;
mod replicates;
mod residual_speed;

pub use bars::{BarGroup, GroupedBars};
pub use calibration_map::{CalibrationMap, MappedResponse};
pub use coefficients::{Coefficient, CoefficientPlot};
pub use effects::{EffectPlot, EffectPoint, InteractionLine, InteractionPlot};
pub use fit_summary::{FitQuality, FitSummary};
pub use friction_speed::{FrictionAtSpeed, FrictionSpeed, PrintedRange};
pub use heat_map::{HeatMap, Shading};
pub use histogram::ResponseHistogram;
pub use likelihood::{PosteriorDensity, ProfileLikelihood};
pub use line_chart::{AxisSpacing, ChartAxis, ChartPoint, ChartSeries, LineChart, SeriesStyle};
pub use normal_probability::{NormalProbability, StudentisedResidual};
pub use observed_predicted::{ObservedPredicted, ObservedPrediction};
pub use overlap::Overlap;
pub use replicates::{ReplicatePlot, ReplicatePoint};
pub use residual_speed::{ResidualAtSpeed, ResidualSpeed, ResponseResiduals};
