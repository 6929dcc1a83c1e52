//! Least, mean and largest value over the poses of a mesh, and arc minutes.

use std::f64::consts::PI;

pub use pinwheel_timeseries::figure::Spread;

/// Arc minutes in a radian.
pub(crate) const ARCMIN: f64 = 10_800.0 / PI;
