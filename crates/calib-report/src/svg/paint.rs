//! Paints, strokes and markers: each a class name for the page and a colour for the file.

/// What a thing is painted with: its role, of which the page knows the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Paint {
    /// Text and marks that carry the message.
    Ink,
    /// Secondary text and axes.
    Muted,
    /// Grid lines.
    Grid,
    /// Background.
    Paper,
    /// A neutral filling for given ranges.
    Neutral,
    /// Something out of limits.
    Alarm,
    /// Lines and fillings of the i-th series.
    Series(usize),
    /// Text about the i-th series: its colour, dark enough to be read.
    SeriesText(usize),
}

/// Series colours after Okabe and Ito, in the order in which they are told apart best.
const SERIES: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5c00", "#5b5b5b"];

/// The same hues with a contrast of at least 4.5 to 1 on white.
const SERIES_TEXT: [&str; 8] =
    ["#00629b", "#b34700", "#007352", "#a1457a", "#8a6000", "#1b6fa3", "#6b5100", "#4d4d4d"];

/// How many series colours there are before they repeat.
pub(crate) const SERIES_COLOURS: usize = SERIES.len();

impl Paint {
    /// The colour on light ground.
    pub(crate) fn colour(self) -> &'static str {
        match self {
            Paint::Ink => "#1b1b1b",
            Paint::Muted => "#555555",
            Paint::Grid => "#dddddd",
            Paint::Paper => "#ffffff",
            Paint::Neutral => "#9a9a9a",
            Paint::Alarm => "#b00020",
            Paint::Series(i) => SERIES[i % SERIES_COLOURS],
            Paint::SeriesText(i) => SERIES_TEXT[i % SERIES_COLOURS],
        }
    }

    /// Class suffix: `f-` before it for a filling, `s-` for a stroke.
    pub(crate) fn class(self) -> String {
        match self {
            Paint::Ink => "ink".into(),
            Paint::Muted => "muted".into(),
            Paint::Grid => "grid".into(),
            Paint::Paper => "paper".into(),
            Paint::Neutral => "neutral".into(),
            Paint::Alarm => "alarm".into(),
            Paint::Series(i) => (i % SERIES_COLOURS).to_string(),
            Paint::SeriesText(i) => format!("t{}", i % SERIES_COLOURS),
        }
    }
}

/// Dash of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Dash {
    #[default]
    Solid,
    Long,
    Short,
    Dot,
    Mixed,
}

impl Dash {
    /// The dash that goes with the i-th series.
    pub(crate) fn of_series(i: usize) -> Self {
        [Dash::Solid, Dash::Long, Dash::Mixed, Dash::Short, Dash::Dot][i % 5]
    }

    pub(crate) fn array(self) -> Option<&'static str> {
        match self {
            Dash::Solid => None,
            Dash::Long => Some("9 4"),
            Dash::Short => Some("4 3"),
            Dash::Dot => Some("1.5 3"),
            Dash::Mixed => Some("8 3 1.5 3"),
        }
    }
}

/// A line's paint, width, dash and opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) paint: Paint,
    pub(crate) width: f64,
    pub(crate) dash: Dash,
    pub(crate) opacity: f64,
}

impl Stroke {
    pub(crate) fn new(paint: Paint, width: f64) -> Self {
        Self { paint, width, dash: Dash::Solid, opacity: 1.0 }
    }

    pub(crate) fn dashed(self, dash: Dash) -> Self {
        Self { dash, ..self }
    }

    pub(crate) fn opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// Shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    Cross,
}

impl Marker {
    /// The shape that goes with the i-th series.
    pub(crate) fn of_series(i: usize) -> Self {
        [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Cross][i % 5]
    }
}
