//! Unknown keys, and suggestions for them.

use pinwheel_files::{Node, nearest};
use toml::{Table, Value};

use crate::error::{Location, SceneError};
use crate::keys::{KEYS, Key};
use crate::number::short;
use crate::quantity;
use crate::table::number;

/// Key of the base of a scene.
pub(super) const BASE: &str = "base";

/// Returns the error of an unknown key, with a suggestion from its table, else with its name in another table.
pub(super) fn unknown(
    place: Location,
    key: String,
    prefix: &str,
    node: &Node<'_>,
    table: &Table,
) -> SceneError {
    let name = key.rsplit('.').next().unwrap_or(&key);
    let mut siblings: Vec<&str> = Vec::new();
    for row in KEYS {
        let Some(rest) = row.name.strip_prefix(prefix) else {
            continue;
        };
        let here = rest.split('.').next().unwrap_or(rest);
        if !siblings.contains(&here) {
            siblings.push(here);
        }
    }
    if prefix.is_empty() {
        siblings.push(BASE);
    }
    let elsewhere = || {
        let leaf = |row: &Key| row.name.rsplit('.').next().unwrap_or(row.name);
        let near = nearest(name, KEYS.iter().map(leaf))?;
        KEYS.iter().find(|row| leaf(row) == near)
    };
    let elsewhere_a_table = || {
        let mut tables = KEYS.iter().filter_map(|row| row.name.split_once('.'));
        !prefix.starts_with(&format!("{name}.")) && tables.any(|(table, _)| table == name)
    };
    let out_of_scope = OUT_OF_SCOPE.iter().find(|(part, _)| name.contains(part));
    let remedy = if let Some((_, remedy)) = out_of_scope {
        (*remedy).to_owned()
    } else if !prefix.is_empty() && elsewhere_a_table() {
        format!(
            "`{name}` is a table of its own: write it above [{}], or as [{name}]",
            prefix.trim_end_matches('.')
        )
    } else if let Some((near, factor)) = quantity::of_another_unit(&key) {
        let number = match node.value() {
            Value::Integer(n) => Some(n as f64),
            Value::Float(number) => Some(number),
            _ => None,
        };
        let meant = number.map(|number| format!(" {} there", short(factor * number)));
        format!("did you mean `{near}`?{}", meant.unwrap_or_default())
    } else if is_pitch(name) {
        pitch_remedy(table)
    } else if let Some(near) = nearest(name, siblings.iter().copied()) {
        format!("did you mean `{prefix}{near}`?")
    } else if let Some(row) = elsewhere() {
        format!("did you mean `{}`?", row.name)
    } else {
        format!("known here: {}", siblings.join(", "))
    };
    SceneError::key(&place, &key, "is no key of a scene", remedy)
}

/// Parts of names of features beyond the model, with the feature that replaces each.
const OUT_OF_SCOPE: &[(&str, &str)] = &[
    (
        "lobes",
        "a disc has one lobe less than there are ring pins, give these as gear.external_sleeves; two lobes less are not modelled",
    ),
    (
        "scene",
        "a sweep names a scene; `pinwheel sweep FILE` runs it, and a scene begins with base = \"paper\"",
    ),
    (
        "hypo",
        "ring pins on an epitrochoid disc are modelled, not a ring with a hypotrochoid for its edge; give gear.external_sleeves",
    ),
    (
        "stage",
        "one stage is modelled, and the first one of an RV gear as [cranks]; make each stage of a housing a scene of its own",
    ),
    (
        "involute",
        "the sun and planets of an RV gear are modelled, as cranks.sun_teeth and cranks.planet_teeth; no involute stage of few teeth is",
    ),
    (
        "teeth",
        "lobes follow from gear.external_sleeves, teeth of an RV gear are cranks.sun_teeth and cranks.planet_teeth; no involute stage of few teeth is modelled",
    ),
];

/// True if a word means the circle of the ring pins, which has many names in the literature.
fn is_pitch(name: &str) -> bool {
    [
        "pitch_",
        "pin_circle",
        "pin_radius",
        "ring_",
        "roller_circle",
        "external_circle",
    ]
    .iter()
    .any(|word| name.starts_with(word))
}

/// Returns the remedy for R, which is seldom needed as a key: e zk/m gives it.
fn pitch_remedy(table: &Table) -> String {
    let product = number(table, "gear.eccentricity_m")
        .zip(number(table, "gear.external_sleeves"))
        .map(|(e, zk)| format!(", here {:.6} over that radius", e * zk));
    format!(
        "the circle of the ring pins is `gear.pin_circle_radius_m` (m), or gear.shortening = e zk/R{}",
        product.unwrap_or_default()
    )
}
