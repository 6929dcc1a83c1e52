//! Checks of a scene's values: each alone, then together.
//!
//! Order matters: geometry is only computed from numbers that are finite and within bounds, and
//! nothing here allocates in proportion to a value of the scene.

mod budget;
mod geometry;
mod load;
mod number;
mod output;
mod ranges;

use super::error::Fault;
use super::model::Scene;

/// Refuses a scene that cannot be run or makes no sense.
///
/// # Errors
/// The first fault found.
pub(crate) fn check(scene: &Scene) -> Result<(), Fault> {
    ranges::check(scene)?;
    load::check(scene)?;
    budget::check(scene)?;
    geometry::check(&scene.gear)
}
