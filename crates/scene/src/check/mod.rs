//! Checks of a scene's values: each alone, then together.
//!
//! Order matters: geometry is only computed from numbers that are finite and within bounds, and
//! nothing here allocates in proportion to a value of the scene.

mod budget;
mod combinations;
mod geometry;
mod load;
mod ranges;
mod remedy;
mod units;

use toml::Table;

use crate::error::Fault;
use crate::model::{Gear, Scene};

/// Refuses a scene that cannot be run or makes no sense.
///
/// # Errors
/// The first fault found.
pub(crate) fn check(scene: &Scene) -> Result<(), Fault> {
    let table = Table::try_from(scene).map_err(|error| {
        Fault::new(
            &["scene"],
            format!("cannot be written: {error}"),
            "change it",
        )
    })?;
    ranges::check(&table)?;
    together(scene)
}

/// The same where every single value is known to be in range.
pub(crate) fn together(scene: &Scene) -> Result<(), Fault> {
    combinations::check(scene)?;
    crate::bearings::check(scene)?;
    crate::cranks::check(scene)?;
    load::check(scene)?;
    gear(&scene.gear)?;
    crate::uncertain::check(scene)?;
    budget::check(scene)
}

/// Whether a gear whose single values are in range can be built.
pub(crate) fn gear(gear: &Gear) -> Result<(), Fault> {
    geometry::whole(gear)
        .map_err(|fault| units::guess(gear).unwrap_or_else(|| remedy::tried(gear, fault)))
}

pub(crate) use geometry::hole_to_profile_m;
pub(crate) use ranges::check as ranges;
