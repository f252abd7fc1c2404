//! Loops closed on a tiny drum.

mod tiny;
