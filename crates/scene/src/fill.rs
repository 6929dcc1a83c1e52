//! Values for omitted keys, from the table of keys.

use pinwheel_contact::laws::law_info;
use toml::{Table, Value};

use crate::check;
use crate::checked::{Origin, Source};
use crate::error::Fault;
use crate::formulas::Inputs;
use crate::keys::{self, DefaultValue, Key, Kind};
use crate::model::Scene;
use crate::scales;
use crate::table::{insert, lookup, usual};

/// Reason why a scene cannot be completed.
pub(crate) enum Gap {
    /// Missing keys without a default.
    Missing(Vec<&'static str>),
    /// Fault of a gear that cannot exist, so no value follows from it.
    Fault(Fault),
}

/// Fills in the missing values, row by row, and returns the origin of each.
pub(crate) fn fill(table: &mut Table) -> Result<Vec<Origin>, Gap> {
    let mut origins = Vec::new();
    let mut missing = Vec::new();
    if lookup(table, PITCH).is_some() && lookup(table, SHORTENING).is_some() {
        return Err(Gap::Fault(Fault::new(
            &[PITCH, SHORTENING],
            "and gear.shortening are both given, and each follows from the other",
            "leave one out, or override the one that is written",
        )));
    }
    let mut scene = Scene::paper();
    // The placeholder must not be taken for a value of the scene.
    scene.solver.duration_s = f64::MAX;
    let (mut part, mut sound) = ("", false);
    let gives_circle = lookup(table, PITCH).is_some();
    // Later formulas may depend on parameters of the law.
    let mut stale = false;
    let gaps: Vec<&Key> = keys::values(table)
        .filter_map(|(row, value)| value.is_none().then_some(row))
        .collect();
    for row in gaps {
        let new_part = row.name.split('.').next().unwrap_or_default();
        let (value, source) = match row.otherwise {
            DefaultValue::Required => {
                missing.push(row.name);
                continue;
            }
            DefaultValue::Needed if lookup(table, new_part).is_some() => {
                missing.push(row.name);
                continue;
            }
            DefaultValue::Nothing | DefaultValue::Needed => continue,
            DefaultValue::Constant(text, why) => (usual(text), Source::Constant(why)),
            DefaultValue::Formula(formula, words) => {
                if new_part != part || stale {
                    (part, stale) = (new_part, false);
                    refresh(&mut scene, table);
                    if part != "gear" && missing.is_empty() && !sound {
                        check::gear(&scene.gear, gives_circle).map_err(Gap::Fault)?;
                        sound = true;
                        scales::state_depth(&mut scene);
                    }
                }
                let inputs = Inputs {
                    table,
                    scene: &scene,
                    gear_is_sound: sound,
                };
                let Some(number) = formula(&inputs) else {
                    if missing.is_empty() || new_part == "gear" {
                        missing.push(row.name);
                    }
                    continue;
                };
                let value = match row.kind {
                    Kind::Count(..) => Value::Integer(number as i64),
                    _ => Value::Float(number),
                };
                (value, Source::Formula(words))
            }
        };
        insert(table, &row.path(), value.clone());
        stale |= law_info(&scene.contact.law).is_some_and(|law| law.keys.contains(&row.name));
        origins.push(Origin {
            key: row.name,
            value,
            source,
        });
    }
    // The model has no field for this key.
    if let Some(Value::Table(gear)) = table.get_mut("gear") {
        gear.remove("pin_circle_radius_m");
    }
    if missing.is_empty() {
        Ok(origins)
    } else {
        Err(Gap::Missing(missing))
    }
}

/// Circle of the ring pins, from which the shortening coefficient follows.
pub(crate) const PITCH: &str = "gear.pin_circle_radius_m";
/// Shortening coefficient, from which the circle of the ring pins follows.
pub(crate) const SHORTENING: &str = "gear.shortening";

/// Rebuilds the scene so far: the known values, laid over placeholders.
fn refresh(scene: &mut Scene, table: &Table) {
    fn lay(onto: &mut Table, from: &Table) {
        for (name, value) in from {
            match (onto.get_mut(name), value) {
                (Some(Value::Table(onto)), Value::Table(from)) => lay(onto, from),
                _ => {
                    onto.insert(name.clone(), value.clone());
                }
            }
        }
    }
    let Ok(mut document) = Table::try_from(&*scene) else {
        return;
    };
    lay(&mut document, table);
    if let Some(Value::Table(gear)) = document.get_mut("gear") {
        gear.remove("pin_circle_radius_m");
    }
    if let Ok(filled) = document.try_into() {
        *scene = filled;
    }
}
