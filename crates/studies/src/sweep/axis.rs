//! Axes: the keys a sweep varies and their values.

use std::fmt;

use serde::Serialize;
use toml_edit::{InlineTable, Value as Toml};

/// Values of one axis at most.
const MOST_VALUES: usize = 100_000;

/// A value of a key as a scene file would write it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A whole number.
    Whole(i64),
    /// A word.
    Text(String),
    /// Anything else, as TOML.
    Other(String),
}

impl Value {
    fn of(value: &Toml) -> Self {
        match value {
            Toml::Float(x) => Self::Number(*x.value()),
            Toml::Integer(x) => Self::Whole(*x.value()),
            Toml::String(x) => Self::Text(x.value().clone()),
            other => Self::Other(other.to_string().trim().to_owned()),
        }
    }

    /// As TOML.
    #[must_use]
    pub fn to_toml(&self) -> String {
        match self {
            Self::Number(x) => Toml::from(*x).to_string(),
            Self::Whole(x) => x.to_string(),
            Self::Text(x) => Toml::from(x.as_str()).to_string(),
            Self::Other(x) => x.clone(),
        }
    }

    /// As a number, where it is one.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(x) => Some(*x),
            Self::Whole(x) => Some(*x as f64),
            Self::Text(_) | Self::Other(_) => None,
        }
    }
}

impl Value {
    /// Its numbers: one, or those of a list; none of what holds none.
    #[must_use]
    pub fn numbers(&self) -> Vec<f64> {
        let of = |value: &Toml| Self::of(value).number();
        match self {
            Self::Other(text) => {
                let list: Option<Toml> = text.parse().ok();
                let list = list.as_ref().and_then(Toml::as_array);
                list.map(|list| list.iter().filter_map(of).collect())
                    .unwrap_or_default()
            }
            one => one.number().into_iter().collect(),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(x) => {
                // As it was meant: a range's arithmetic makes 1.0000000000000002e-6 of 1e-6.
                let meant: f64 = format!("{x:.12e}").parse().unwrap_or(*x);
                // Not with all the zeros of 1e-12.
                if meant != 0.0 && !(1e-3..1e6).contains(&meant.abs()) {
                    write!(f, "{meant:e}")
                } else {
                    write!(f, "{meant}")
                }
            }
            Self::Whole(x) => write!(f, "{x}"),
            Self::Text(x) | Self::Other(x) => f.write_str(x),
        }
    }
}

/// Keys that are varied together: at each point every key has the value of the same place.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Scene keys with their values; all lists have the same length, at least 1.
    pub keys: Vec<(String, Vec<Value>)>,
}

impl Axis {
    /// Points along the axis.
    #[must_use]
    pub fn len(&self) -> usize {
        self.keys.first().map_or(0, |(_, values)| values.len())
    }

    /// True without any point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The values of a list `[1, 2]` or a range `{ from, to, points | step, spacing }`.
///
/// # Errors
/// What is wrong and the remedy.
pub(crate) fn values(value: &Toml) -> Result<Vec<Value>, (String, String)> {
    let list = match value {
        Toml::Array(list) => list.iter().map(Value::of).collect(),
        Toml::InlineTable(table) => range(table)?,
        single => vec![Value::of(single)],
    };
    if list.is_empty() {
        return Err((
            "the list is empty".to_owned(),
            "give at least one value".to_owned(),
        ));
    }
    if list.len() > MOST_VALUES {
        return Err((
            format!("{} values are more than {MOST_VALUES}", list.len()),
            "give fewer".to_owned(),
        ));
    }
    for (k, value) in list.iter().enumerate() {
        if list[..k.min(2000)].contains(value) {
            return Err((
                format!("{value} stands in the list twice"),
                "give each value once".to_owned(),
            ));
        }
    }
    Ok(list)
}

fn range(table: &InlineTable) -> Result<Vec<Value>, (String, String)> {
    const REMEDY: &str = "write { from = 1.0, to = 8.0, points = 8 }, with step = 1.0 instead of points, or with spacing = \"log\"";
    let wrong = |what: String| (what, REMEDY.to_owned());
    for (key, _) in table {
        if !["from", "to", "points", "step", "spacing"].contains(&key) {
            return Err(wrong(format!("`{key}` is no key of a range")));
        }
    }
    let number = |key: &str| match table.get(key) {
        None => Ok(None),
        Some(value) => match (value.as_float(), value.as_integer()) {
            (Some(x), _) if x.is_finite() => Ok(Some(x)),
            (None, Some(x)) => Ok(Some(x as f64)),
            _ => Err(wrong(format!("`{key}` of a range must be a finite number"))),
        },
    };
    let need = |key: &str| number(key)?.ok_or_else(|| wrong(format!("the range has no `{key}`")));
    let (from, to) = (need("from")?, need("to")?);
    let log = match table.get("spacing").map(Toml::as_str) {
        None | Some(Some("linear")) => false,
        Some(Some("log")) => true,
        Some(_) => return Err(wrong("`spacing` must be \"linear\" or \"log\"".to_owned())),
    };
    if log && !(from * to > 0.0) {
        return Err(wrong(
            "a range with spacing = \"log\" needs ends of one sign, neither 0".to_owned(),
        ));
    }
    let points = match (table.get("points"), number("step")?) {
        (Some(points), None) => match points.as_integer() {
            Some(points) if (1..=MOST_VALUES as i64).contains(&points) => points as usize,
            _ => {
                return Err(wrong(format!(
                    "`points` must be a whole number from 1 to {MOST_VALUES}"
                )));
            }
        },
        (None, Some(step)) if !log && (to - from) / step >= 0.0 => {
            let steps = (to - from) / step * (1.0 + 1e-12);
            if !(steps < MOST_VALUES as f64) {
                return Err(wrong(format!(
                    "the range has more than {MOST_VALUES} values"
                )));
            }
            let count = steps.floor() as usize + 1;
            return Ok(numbers(table, count, |k| from + k as f64 * step));
        }
        (None, Some(_)) => {
            return Err(wrong("`step` does not lead from `from` to `to`".to_owned()));
        }
        (Some(_), Some(_)) => {
            return Err(wrong("the range has both `points` and `step`".to_owned()));
        }
        (None, None) => {
            return Err(wrong(
                "the range has neither `points` nor `step`".to_owned(),
            ));
        }
    };
    if points == 1 && from != to {
        return Err(wrong("one point cannot be at both ends".to_owned()));
    }
    let last = (points - 1).max(1) as f64;
    Ok(numbers(table, points, |k| {
        let share = k as f64 / last;
        if k + 1 == points {
            to
        } else if log {
            from * (to / from).powf(share)
        } else {
            from + (to - from) * share
        }
    }))
}

/// Whole numbers where the file gives whole ends and nothing between is broken; otherwise numbers of
/// twelve digits, so that 0.1 + 0.2 is 0.3.
fn numbers(table: &InlineTable, count: usize, at: impl Fn(usize) -> f64) -> Vec<Value> {
    let given_whole = ["from", "to", "step"].iter().all(|key| {
        table
            .get(key)
            .is_none_or(|value| value.as_integer().is_some())
    });
    let list: Vec<f64> = (0..count).map(at).collect();
    if given_whole
        && list
            .iter()
            .all(|x| (x - x.round()).abs() < 1e-9 * x.abs().max(1.0))
    {
        return list
            .iter()
            .map(|x| Value::Whole(x.round() as i64))
            .collect();
    }
    let tidy = |x: f64| format!("{x:.11e}").parse().unwrap_or(x);
    list.into_iter().map(|x| Value::Number(tidy(x))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Vec<Value> {
        values(&text.parse().unwrap()).unwrap()
    }

    fn fault(text: &str) -> String {
        values(&text.parse().unwrap()).unwrap_err().0
    }

    #[test]
    fn lists_and_ranges() {
        let numbers = |list: &[f64]| list.iter().copied().map(Value::Number).collect::<Vec<_>>();
        assert_eq!(of("[0.0, 1e-4]"), numbers(&[0.0, 1e-4]));
        assert_eq!(of("0.3"), numbers(&[0.3]));
        assert_eq!(of("[\"a\", 3]"), [Value::Text("a".into()), Value::Whole(3)]);
        assert_eq!(
            of("{ from = 0.0, to = 0.3, step = 0.1 }"),
            numbers(&[0.0, 0.1, 0.2, 0.3])
        );
        assert_eq!(
            of("{ from = 1.0, to = 100.0, points = 3, spacing = \"log\" }"),
            numbers(&[1.0, 10.0, 100.0])
        );
        assert_eq!(
            of("{ from = 8, to = 2, step = -3 }"),
            [8, 5, 2].map(Value::Whole)
        );
        assert_eq!(
            of("{ from = 1, to = 2, points = 3 }"),
            numbers(&[1.0, 1.5, 2.0])
        );
        assert_eq!(of("{ from = 5, to = 5, points = 1 }"), [Value::Whole(5)]);
    }

    #[test]
    fn faults() {
        for (text, part) in [
            ("[]", "empty"),
            ("[1, 2, 1]", "twice"),
            ("{ from = 1.0 }", "no `to`"),
            ("{ from = 1.0, to = 2.0 }", "neither"),
            ("{ from = 1.0, to = 2.0, points = 2, step = 1.0 }", "both"),
            ("{ from = 1.0, to = 2.0, step = -1.0 }", "does not lead"),
            ("{ from = 1.0, to = 2.0, step = 0.0 }", "more than"),
            ("{ from = 1.0, to = 2.0, points = 0 }", "whole number"),
            ("{ from = 1.0, to = 2.0, points = 1 }", "both ends"),
            (
                "{ from = 0.0, to = 2.0, points = 3, spacing = \"log\" }",
                "one sign",
            ),
            (
                "{ from = 1.0, to = 2.0, points = 3, spacing = \"cubic\" }",
                "linear",
            ),
            ("{ from = nan, to = 2.0, points = 3 }", "finite"),
            ("{ form = 1.0 }", "no key"),
            ("{ from = 0.0, to = 1.0, step = 1e-9 }", "more than"),
        ] {
            assert!(fault(text).contains(part), "{text}: {}", fault(text));
        }
    }

    #[test]
    fn words_and_numbers_survive_toml() {
        for text in ["0.1", "3", "1e-12", "\"paper \\\"x\\\"\"", "[1, 2]"] {
            let value = Value::of(&text.parse().unwrap());
            assert_eq!(
                Value::of(&value.to_toml().parse().unwrap()),
                value,
                "{text}"
            );
        }
        assert_eq!(Value::Number(1e-5).to_string(), "1e-5");
        assert_eq!(Value::Number(0.25).to_string(), "0.25");
    }
}
