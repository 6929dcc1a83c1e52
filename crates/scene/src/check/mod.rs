//! Checks of a scene's values, first each alone, then together.
//!
//! Order matters: geometry is computed only from finite numbers within bounds, and no check allocates in proportion to a
//! value of the scene.

mod believable;
mod budget;
mod combinations;
mod geometry;
mod load;
mod ranges;
mod remedy;
mod units;

use toml::{Table, Value};

use crate::error::Fault;
use crate::model::{Gear, Scene};

/// Refuses a scene that cannot be run or makes no sense.
///
/// # Errors
/// The first fault.
pub(crate) fn check(scene: &Scene) -> Result<(), Fault> {
    ranges::check(&Table::try_from(scene).map_err(unwritten)?)?;
    together(scene, false)
}

/// Refuses solver settings that do not fit a scene whose other values are checked.
pub(crate) fn solver(scene: &Scene) -> Result<(), Fault> {
    let solver = Value::try_from(&scene.solver).map_err(unwritten)?;
    ranges::check(&Table::from_iter([("solver".to_owned(), solver)]))?;
    combinations::check(scene)?;
    budget::check(scene)
}

fn unwritten(error: toml::ser::Error) -> Fault {
    let what = format!("cannot be written: {error}");
    Fault::new(&["scene"], what, "change it")
}

/// Refuses combinations of values that cannot be run or make no sense. Single values are in range; `gives_circle`: R is
/// written and not m.
pub(crate) fn together(scene: &Scene, gives_circle: bool) -> Result<(), Fault> {
    combinations::check(scene)?;
    crate::bearings::check(scene)?;
    crate::cranks::check(scene)?;
    load::check(scene)?;
    gear(&scene.gear, gives_circle)?;
    crate::structure::check(scene)?;
    crate::temperature::check(scene, geometry::outside)?;
    crate::uncertain::check(scene)?;
    budget::check(scene)
}

/// Checks that a gear with single values in range can be built.
pub(crate) fn gear(gear: &Gear, gives_circle: bool) -> Result<(), Fault> {
    let tried = |fault| remedy::tried(gear, gives_circle, fault);
    geometry::entire(gear).map_err(|fault| units::guess(gear).unwrap_or_else(|| tried(fault)))
}

pub use believable::doubts;
pub use geometry::{external_sleeves, holes_inside_the_wheel, profile};
pub(crate) use ranges::check as ranges;
