//! Parameters of measuring: they change what is read from a picture.

use crate::{Layer, Parameter, Sign};

/// Parameters of measuring: they change what is read from a picture.
pub const MEASUREMENT: &[Parameter] = &[
    Parameter {
        path: "measure.offset_x_pct",
        unit: "% R",
        nominal: Some(0.0),
        range: (-20.0, 20.0),
        sign: Sign::Either,
        layer: Layer::Measurement,
        meaning: "shift of the reference circle sideways: added to cen_x",
    },
    Parameter {
        path: "measure.offset_y_pct",
        unit: "% R",
        nominal: Some(0.0),
        range: (-20.0, 20.0),
        sign: Sign::Either,
        layer: Layer::Measurement,
        meaning: "shift of the reference circle downwards: added to cen_y",
    },
    Parameter {
        path: "measure.bias_lin_deg",
        unit: "deg",
        nominal: Some(0.0),
        range: (-20.0, 20.0),
        sign: Sign::Either,
        layer: Layer::Measurement,
        meaning: "definition of the whole line: added to aor_lin",
    },
    Parameter {
        path: "measure.bias_mid_deg",
        unit: "deg",
        nominal: Some(0.0),
        range: (-20.0, 20.0),
        sign: Sign::Either,
        layer: Layer::Measurement,
        meaning: "definition of the middle line: added to aor_mid",
    },
    Parameter {
        path: "measure.scale",
        unit: "1",
        nominal: Some(1.0),
        range: (0.8, 1.25),
        sign: Sign::Either,
        layer: Layer::Measurement,
        meaning: "error of the ring radius: factor on the measured radius",
    },
    Parameter {
        path: "measure.threshold_bias",
        unit: "1",
        nominal: Some(0.0),
        range: (-0.3, 0.3),
        sign: Sign::Either,
        layer: Layer::Measurement,
        meaning: "shift of the grey threshold between bed and background, of full scale",
    },
];
