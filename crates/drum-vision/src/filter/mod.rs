//! Image filters of the chain, each with its border rule and its counterpart in scikit-image or SciPy.

pub mod gradient;
pub mod median;
pub mod stretch;
pub mod threshold;
pub mod wiener;
