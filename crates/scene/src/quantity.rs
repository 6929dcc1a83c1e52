//! Typed numbers with a unit, with a comma or as a ratio. Scenes use SI without units.

use std::f64::consts::PI;

use crate::keys::KEYS;
use crate::number::nearest;
pub use crate::number::short;

/// Units: as typed, in lower case with `_` for blanks; the base unit at the end of names of keys; and the typed unit in
/// base units.
const UNITS: [(&str, &str, f64); 29] = [
    ("m", "m", 1.0),
    ("mm", "m", 1e-3),
    ("cm", "m", 1e-2),
    ("um", "m", 1e-6),
    ("in", "m", 0.0254),
    ("rad_s", "rad_s", 1.0),
    ("rpm", "rad_s", PI / 30.0),
    ("rad", "rad", 1.0),
    ("deg", "rad", PI / 180.0),
    ("arcmin", "rad", PI / 10_800.0),
    ("n_m", "n_m", 1.0),
    ("nm", "n_m", 1.0),
    ("kn_m", "n_m", 1e3),
    ("knm", "n_m", 1e3),
    ("pa", "pa", 1.0),
    ("mpa", "pa", 1e6),
    ("gpa", "pa", 1e9),
    ("kg", "kg", 1.0),
    ("g", "kg", 1e-3),
    ("kg_m2", "kg_m2", 1.0),
    ("kg_mm2", "kg_m2", 1e-6),
    ("kg_m3", "kg_m3", 1.0),
    ("g_cm3", "kg_m3", 1e3),
    ("s", "s", 1.0),
    ("ms", "s", 1e-3),
    ("us", "s", 1e-6),
    ("m_s", "m_s", 1.0),
    ("mm_s", "m_s", 1e-3),
    ("n_s_m", "n_s_m", 1.0),
];

/// Converts a typed number with a unit to the unit `wanted`, both as in `UNITS`; a number without a unit is returned as it is.
/// `None` if the text is no number, or its unit is unknown or of another dimension.
pub fn read(typed: &str, wanted: &str) -> Option<f64> {
    let typed = typed.trim();
    let is_number = |c: char| c.is_ascii_digit() || "+-.,eE".contains(c);
    let mut end = typed.find(|c| !is_number(c)).unwrap_or(typed.len());
    // A unit may begin with `e`.
    while end > 0 && !typed[..end].ends_with(|c: char| c.is_ascii_digit() || c == '.') {
        end -= 1;
    }
    let (number, unit) = typed.split_at(end);
    let number: f64 = number.replacen(',', ".", 1).parse().ok()?;
    let unit = unit
        .trim()
        .to_lowercase()
        .replace([' ', '/', '*', '\u{b7}'], "_");
    if unit.is_empty() {
        return Some(number);
    }
    let row = |name: &str| UNITS.iter().find(|(typed, ..)| *typed == name);
    let ((_, base, factor), (_, same, target)) = (row(&unit)?, row(wanted)?);
    (base == same).then(|| nearest(number * factor / target, 12))
}

/// Returns the unit as the end of a key's name: `m`, `rad_s`.
pub(crate) fn ending(unit: &str) -> String {
    unit.to_lowercase()
        .replace([' ', '/'], "_")
        .replace('^', "")
}

/// Returns the key intended by one with another unit, e.g. `drive.input_speed_rpm`, and the factor from the typed unit to
/// the key's.
pub(crate) fn of_another_unit(key: &str) -> Option<(&'static str, f64)> {
    UNITS.iter().find_map(|(unit, base, factor)| {
        let stem = key.strip_suffix(unit)?.strip_suffix('_')?;
        let row = KEYS.iter().find(|row| {
            row.name
                .strip_prefix(stem)
                .and_then(|rest| rest.strip_prefix('_'))
                == Some(base)
        })?;
        (unit != base).then_some((row.name, *factor))
    })
}

/// Returns a text with some units replaced, each given as `(unit, (other, its number in one unit))`: a unit is that of the number
/// before it, and of those that `to` or `and` joins with that number.
pub fn in_units(text: &str, units: &[(&str, (&str, f64))]) -> String {
    let number = |word: &str| word.trim_start_matches('(').parse::<f64>().ok();
    let old: Vec<&str> = text.split(' ').collect();
    let (mut scale, mut words) = (None, Vec::new());
    for (place, word) in old.iter().enumerate().rev() {
        let bare = word.trim_end_matches([',', ';', ':', ')']);
        let before = place.checked_sub(1).and_then(|before| number(old[before]));
        let unit = units
            .iter()
            .find(|(unit, _)| before.is_some() && *unit == bare);
        words.push(match (unit, number(bare), scale) {
            (Some((_, (other, factor))), ..) => {
                scale = Some(factor);
                word.replacen(bare, other, 1)
            }
            (None, Some(value), Some(factor)) => {
                word.replacen(bare.trim_start_matches('('), &short(factor * value), 1)
            }
            _ => {
                scale = scale.filter(|_| ["to", "and"].contains(word));
                (*word).to_owned()
            }
        });
    }
    words.reverse();
    words.join(" ")
}
