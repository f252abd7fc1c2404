//! Campaigns as a caller meets them: interrupted, altered, repeated.

mod cameras;
mod export;
mod faults;
mod killed;
mod sizes;
mod small;
mod vtk;
