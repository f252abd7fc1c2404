//! Tests of the public interface against independent oracles.

mod strd;
