//! Check of each value against its row of [`crate::keys`].

use std::borrow::Cow;

use pinwheel_files::{did_you_mean, one_line, quoted};
use toml::{Table, Value};

use crate::error::Fault;
use crate::keys::{self, Key, Kind, Range};
use crate::number::short;

/// Smallest magnitude of a gear's quantity. Powers and quotients of smaller numbers are zero or infinite.
const SMALLEST: f64 = 1e-30;

/// Checks the range of each given value; missing values are not checked.
pub(crate) fn check(table: &Table) -> Result<(), Fault> {
    for (row, value) in keys::values(table) {
        if let Some(value) = value {
            one(row, row.name.into(), value)?;
        }
    }
    Ok(())
}

fn one(row: &Key, key: Cow<'static, str>, value: &Value) -> Result<(), Fault> {
    let fault = |what: String, remedy: String| Fault {
        keys: vec![key.clone()],
        what,
        remedy,
    };
    match (row.kind, value) {
        (Kind::Number(range), Value::Float(number))
            if range.holds(*number) && *number != 0.0 && number.abs() < SMALLEST =>
        {
            let remedy = if range.holds(0.0) {
                "write 0, or a value that means something"
            } else {
                row.hint
            };
            let what = format!(
                "is {}, below the roundings of everything it meets",
                short(*number)
            );
            Err(fault(what, remedy.to_owned()))
        }
        (Kind::Number(range), Value::Float(number)) if !range.holds(*number) => {
            let unit = match row.unit() {
                "" => String::new(),
                unit => format!(" {unit}"),
            };
            let what = format!(
                "is {}{unit}, but must be {}{unit}",
                short(*number),
                range.words()
            );
            Err(fault(what, meant(row, range, *number)))
        }
        (Kind::Count(low, high), Value::Integer(n)) => {
            let inside = usize::try_from(*n).is_ok_and(|n| (low..=high).contains(&n));
            if inside {
                return Ok(());
            }
            let what = format!("is {n}, but must be from {low} to {high}");
            Err(fault(what, row.hint.to_owned()))
        }
        (Kind::Choice(what, names) | Kind::Choices(what, names), value) => {
            let names = names();
            let (verb, typed) = match value {
                Value::Array(list) => ("names", list.as_slice()),
                one => ("is", std::slice::from_ref(one)),
            };
            let typed: Vec<&str> = typed.iter().filter_map(Value::as_str).collect();
            let Some(typed) = typed.iter().find(|typed| !names.contains(typed)) else {
                // A repeated entry costs time and adds no result.
                let mut before = typed.iter().enumerate();
                let twice = before.find(|(k, one)| typed[..*k].contains(one));
                return twice.map_or(Ok(()), |(_, one)| {
                    let what = format!("names {} twice", quoted(one));
                    Err(fault(what, "name each once".to_owned()))
                });
            };
            let what = format!("{verb} {}, which is no {what}", quoted(typed));
            Err(fault(what, did_you_mean(typed, &names)))
        }
        (Kind::Text, Value::String(text)) if row.name == "name" => {
            let fits = !text.trim().is_empty()
                && text.chars().count() <= 100
                && !text.chars().any(char::is_control);
            if fits {
                return Ok(());
            }
            let what = format!("is {}, which names no report", quoted(&one_line(text)));
            Err(fault(what, row.hint.to_owned()))
        }
        (Kind::Numbers(range), Value::Array(list)) => {
            let outside = |value: &Value| value.as_float().is_some_and(|x| !range.holds(x));
            let Some(number) = list.iter().position(outside) else {
                return Ok(());
            };
            let actual = list[number].as_float().unwrap_or_default();
            let what = format!(
                "holds {} as entry {number}, but entries must be {}",
                short(actual),
                range.words()
            );
            Err(fault(what, row.hint.to_owned()))
        }
        (Kind::Tables(rows), Value::Array(list)) => {
            for (number, entry) in list.iter().enumerate() {
                for inner in rows {
                    if let Some(value) = entry.get(inner.name) {
                        let full = format!("{key}[{number}].{}", inner.name);
                        let named = |mut fault: Fault| {
                            fault.keys.push(key.clone());
                            fault
                        };
                        one(inner, full.into(), value).map_err(named)?;
                    }
                }
            }
            Ok(())
        }
        _ => Ok(()),
    }
}

/// Young's moduli of gear materials, Pa.
const SOLID_PA: std::ops::RangeInclusive<f64> = 1e9..=1.3e12;

/// Returns the row's hint, with the probable meaning if another unit fits: a length in millimetres, a modulus in GPa or MPa.
fn meant(row: &Key, range: Range, number: f64) -> String {
    let factors: &[f64] = match row.unit() {
        "m" => &[1e-3],
        "Pa" => &[1e9, 1e6],
        _ => &[],
    };
    let fits = |meant: &f64| {
        let is_likely = row.unit() == "m" || SOLID_PA.contains(meant);
        *meant > 0.0 && range.holds(*meant) && is_likely
    };
    let meant = factors.iter().map(|factor| factor * number).find(fits);
    meant.map_or_else(
        || row.hint.to_owned(),
        |meant| format!("did you mean {}? {}", short(meant), row.hint),
    )
}
