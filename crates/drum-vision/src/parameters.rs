//! The measuring parameters that this crate owns, as data.

use rig_schema::Parameter;

/// Every parameter of the `measure` group that [`crate::config::MeasureConfig`] holds, with unit, nominal value, range and sign.
///
/// ```
/// let scale = drum_vision::parameters::parameters().iter().find(|p| p.path == "measure.scale");
/// assert_eq!(scale.expect("is declared").nominal, Some(1.0));
/// ```
#[must_use]
pub fn parameters() -> &'static [Parameter] {
    rig_schema::namespace::MEASUREMENT
}
