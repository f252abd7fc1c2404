//! Finding the drum: red ring, outline, reference frame or a circle by hand.

pub mod circle_fit;
pub mod detect;
pub mod hough;
pub mod rim;
pub mod ring;
pub mod ring_model;
