//! `drive.load_changes` as it is written: a list of tables, in line or each under `[[drive.load_changes]]`.
//!
//! ```toml
//! load_changes = [{ time_s = 0.3, output_torque_n_m = -22.0 }, { time_s = 0.4, output_torque_n_m = 0.0, ramp_s = 0.01 }]
//! ```
//! Every value is remembered with its line under `drive.load_changes[0].time_s`, so that a check that fails later
//! names the change and not only the list.

use std::collections::HashMap;

use toml::{Table, Value};
use toml_edit::{Item, TableLike};

use super::error::{Place, SceneError};
use super::parse::{kind, overlay};

/// The list's key.
pub(super) const KEY: &str = "drive.load_changes";

/// What every change must say.
const NEEDED: [&str; 2] = ["time_s", "output_torque_n_m"];

/// The key of a value of change `number`, counted from 0.
pub(super) fn key(number: usize, name: &str) -> String {
    format!("{KEY}[{number}].{name}")
}

/// The list as it is given by `item`, which stands at `place`.
///
/// # Errors
/// It is no list of tables, a key of one is unknown, missing or of the wrong kind.
pub(super) fn read(
    places: &mut HashMap<String, Place>,
    item: &Item,
    place: &Place,
    place_at: &dyn Fn(usize) -> Place,
) -> Result<Value, SceneError> {
    let fault = |key: String, what: String, remedy: &str| SceneError::Key {
        place: place.clone(),
        key,
        what,
        remedy: remedy.to_owned(),
    };
    let entries = tables(item).ok_or_else(|| {
        let what = format!("is {}, but must be a list of tables", kind(item));
        let remedy = "write it like [{ time_s = 0.3, output_torque_n_m = -22.0 }]";
        fault(KEY.to_owned(), what, remedy)
    })?;
    // A list replaces the one before it.
    places.retain(|key, _| !key.starts_with("drive.load_changes["));
    let mut list = Vec::with_capacity(entries.len());
    for (number, entry) in entries.into_iter().enumerate() {
        let mut table = Table::new();
        for name in ["time_s", "output_torque_n_m", "ramp_s"] {
            table.insert(name.to_owned(), Value::Float(0.0));
        }
        overlay(&mut table, places, &key(number, ""), entry, place_at)?;
        if let Some(missing) = NEEDED.iter().find(|&&name| !entry.contains_key(name)) {
            return Err(fault(
                key(number, missing),
                "is missing".to_owned(),
                "a change says when (time_s) and what the load becomes (output_torque_n_m)",
            ));
        }
        list.push(Value::Table(table));
    }
    Ok(Value::Array(list))
}

/// The tables of a list; `None` if it is none.
fn tables(item: &Item) -> Option<Vec<&dyn TableLike>> {
    if let Some(list) = item.as_array_of_tables() {
        return Some(list.iter().map(|table| table as &dyn TableLike).collect());
    }
    item.as_array()?
        .iter()
        .map(|value| value.as_inline_table().map(|t| t as &dyn TableLike))
        .collect()
}
