//! Tests of the public interface: independent oracles, properties, refusals.

#![expect(clippy::unwrap_used, reason = "helpers of tests stop a test as its body would")]

mod bad_input;
mod properties;
mod response_surfaces;
mod statsmodels;
#[cfg(feature = "serde")]
mod stored;
mod strd;
mod thesis_surfaces;
