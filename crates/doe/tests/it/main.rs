//! Tests of the public interface against independent oracles.

mod response_surfaces;
mod statsmodels;
mod strd;
