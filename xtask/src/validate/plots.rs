//! Curves drawn.

use calib_report::Picture as _;
use calib_report::pictures::{
    AxisSpacing, ChartAxis, ChartPoint, ChartSeries, LineChart, SeriesStyle,
};
use dem_validation::curves::{self, Axis, Curve, Style};

use super::Picture;

/// Every plot of the cases, with the name of its group.
pub(crate) fn all() -> Vec<(&'static str, Picture)> {
    curves::all()
        .into_iter()
        .map(|plot| {
            let chart = LineChart {
                title: plot.title.to_owned(),
                x: axis(plot.x),
                y: axis(plot.y),
                series: plot.curves.into_iter().map(series).collect(),
                ..LineChart::default()
            };
            (
                plot.group,
                Picture {
                    file: format!("{}.svg", plot.file),
                    title: plot.title.to_owned(),
                    caption: plot.caption.to_owned(),
                    svg: chart.svg(),
                },
            )
        })
        .collect()
}

fn axis(axis: Axis) -> ChartAxis {
    let spacing = if axis.logarithmic { AxisSpacing::Logarithmic } else { AxisSpacing::Linear };
    ChartAxis { label: axis.label.to_owned(), range: None, spacing }
}

fn series(curve: Curve) -> ChartSeries {
    ChartSeries {
        name: curve.name,
        style: match curve.style {
            Style::Line => SeriesStyle::Line,
            Style::Points => SeriesStyle::Points,
        },
        points: curve.points.into_iter().map(ChartPoint::from).collect(),
    }
}
