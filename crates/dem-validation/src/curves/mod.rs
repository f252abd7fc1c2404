//! Curves of the report: what is drawn beside the numbers of a group.

mod engine;
mod impact;
mod motion;
mod oblique;

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A line.
    Line,
    /// Points.
    Points,
}

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name in the legend.
    pub name: String,
    /// How it is drawn.
    pub style: Style,
    /// Points in order.
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    pub(crate) fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), style: Style::Line, points }
    }

    pub(crate) fn points(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), style: Style::Points, points }
    }
}

/// An axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Axis {
    /// Label with unit.
    pub label: &'static str,
    /// Whether it is logarithmic.
    pub logarithmic: bool,
}

impl Axis {
    pub(crate) const fn linear(label: &'static str) -> Self {
        Self { label, logarithmic: false }
    }

    pub(crate) const fn logarithmic(label: &'static str) -> Self {
        Self { label, logarithmic: true }
    }
}

/// A plot of curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Name of the group ([`crate::Group::name`]) beside which it stands.
    pub group: &'static str,
    /// Name of its file, without extension.
    pub file: &'static str,
    /// Title.
    pub title: &'static str,
    /// What it shows.
    pub caption: &'static str,
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// Curves.
    pub curves: Vec<Curve>,
}

/// Every plot, in the order of the groups.
pub fn all() -> Vec<Plot> {
    [impact::plots(), oblique::plots(), motion::plots(), engine::plots()].concat()
}

/// `n + 1` numbers from `low` to `high`.
fn spread(low: f64, high: f64, n: u32) -> impl Iterator<Item = f64> {
    (0..=n).map(move |k| low + (high - low) * f64::from(k) / f64::from(n))
}
