//! `[uncertain]`: uncertainty of a scene's values.
//!
//! ```toml
//! [uncertain]
//! gear.backlash_m = { plus_minus = 5e-6 }
//! contact.young_pa = { plus_minus = 1e10 }
//! ```
//! The value is distributed uniformly within `plus_minus` of the scene's value. Its standard uncertainty is the half-width
//! over the root of three (type B of the Guide to the Expression of Uncertainty in Measurement, JCGM 100:2008, 4.3.7).

use toml::{Table, Value};

use crate::error::Fault;
use crate::keys::{self, Kind};
use crate::model::Scene;
use crate::number::short;
use crate::table::lookup;

/// Name of the table.
pub(crate) const UNCERTAIN: &str = "uncertain";
/// Example of an entry.
pub(crate) const EXAMPLE: &str = "write it like gear.backlash_m = { plus_minus = 5e-6 }";
/// Sections whose numbers are inputs of the model.
const SECTIONS: [&str; 8] = [
    "gear",
    "mass",
    "drive",
    "contact",
    "bearings",
    "structure",
    "temperature",
    "cranks",
];

/// Refuses entries that are no inputs of the model, and intervals that leave the range of the key.
pub(crate) fn check(scene: &Scene) -> Result<(), Fault> {
    if scene.uncertain.is_empty() {
        return Ok(());
    }
    let table = Table::try_from(scene).unwrap_or_default();
    for (key, half) in &scene.uncertain {
        let half = half.plus_minus;
        let number = lookup(&table, key).and_then(Value::as_float);
        let range = keys::key(key).and_then(|row| match row.kind {
            Kind::Number(range) => Some(range),
            _ => None,
        });
        let section = key.split('.').next().unwrap_or_default();
        let (what, remedy) = if let Some((value, range)) = number.zip(range) {
            let ends = [value - half, value + half];
            if !SECTIONS.contains(&section) {
                (
                    "is a setting and no input of the model".to_owned(),
                    "what settings do to the numbers is found by the comparison itself; leave it out",
                )
            } else if !(half > 0.0 && half.is_finite()) {
                (format!("is {}, but must be above 0", short(half)), EXAMPLE)
            } else if let Some(&end) = ends.iter().find(|end| !range.holds(**end)) {
                let (end, range) = (short(end), range.words());
                (
                    format!("reaches {end}, but {key} must be {range}"),
                    "make it smaller, or write the middle of the interval as the value",
                )
            } else {
                continue;
            }
        } else {
            (
                "is no number of this scene".to_owned(),
                "only lengths, masses, loads and properties of the contact are uncertain; leave it out",
            )
        };
        return Err(Fault {
            keys: vec![format!("{UNCERTAIN}.{key}").into()],
            what,
            remedy: remedy.to_owned(),
        });
    }
    Ok(())
}
