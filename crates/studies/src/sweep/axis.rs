//! Axes of a sweep: the varied keys and their values.

use std::fmt;

use pinwheel_files::{Document, FileError, Item, Node};
use serde::{Deserialize, Serialize};
use toml::Value as Toml;

/// Largest number of values of one axis.
const MOST_VALUES: usize = 100_000;

/// Value of a key, as in a scene file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number.
    Number(f64),
    /// An integer.
    Whole(i64),
    /// A word.
    Text(String),
    /// Any other value, as TOML.
    Other(String),
}

impl Value {
    fn of(item: &Item<'_>) -> Self {
        match &item.node {
            Node::Plain(Toml::Float(x)) => Self::Number(*x),
            Node::Plain(Toml::Integer(x)) => Self::Whole(*x),
            Node::Plain(Toml::String(x)) => Self::Text(x.clone()),
            _ => Self::Other(item.text.to_owned()),
        }
    }

    /// Returns the value as TOML.
    pub fn to_toml(&self) -> String {
        match self {
            Self::Number(x) => Toml::from(*x).to_string(),
            Self::Whole(x) => x.to_string(),
            Self::Text(x) => Toml::from(x.as_str()).to_string(),
            Self::Other(x) => x.clone(),
        }
    }

    /// Returns the value as a number; `None` for other types.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(x) => Some(*x),
            Self::Whole(x) => Some(*x as f64),
            Self::Text(_) | Self::Other(_) => None,
        }
    }

    /// Returns the numbers of the value: one, those of a list, or none.
    pub fn numbers(&self) -> Vec<f64> {
        let of = |value: &Toml| {
            let integer = || value.as_integer().map(|x| x as f64);
            value.as_float().or_else(integer)
        };
        match self {
            Self::Other(text) => match text.parse() {
                Ok(Toml::Array(list)) => list.iter().filter_map(of).collect(),
                _ => Vec::new(),
            },
            one => one.number().into_iter().collect(),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(x) => {
                // Twelve digits: the arithmetic of a range turns 1e-6 into 1.0000000000000002e-6.
                let meant: f64 = format!("{x:.12e}").parse().unwrap_or(*x);
                // An exponent instead of many zeros.
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

/// Keys that vary together: point k gives each key its k-th value.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Scene keys with their values; all lists have the same length, at least 1.
    pub keys: Vec<(String, Vec<Value>)>,
}

impl Axis {
    /// Returns the number of points along the axis.
    pub fn len(&self) -> usize {
        self.keys.first().map_or(0, |(_, values)| values.len())
    }

    /// True for an axis without points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the first point that repeats an earlier one, among the first 2000 points.
    pub(super) fn repeated(&self) -> Option<usize> {
        let same = |a: usize, b: usize| self.keys.iter().all(|(_, values)| values[a] == values[b]);
        (0..self.len()).find(|&k| (0..k.min(2000)).any(|earlier| same(earlier, k)))
    }
}

/// Keys of a range.
pub(super) const RANGE: [&str; 5] = ["from", "to", "points", "step", "spacing"];

/// Range of numbers, both ends included.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Range {
    from: f64,
    to: f64,
    points: Option<usize>,
    step: Option<f64>,
    #[serde(default)]
    spacing: Spacing,
}

#[derive(Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Spacing {
    #[default]
    Linear,
    Log,
}

/// Returns the values of a list `[1, 2]`, or of a range `{ from, to, points | step, spacing }`, at a key of the scene.
///
/// # Errors
/// A list or range without valid values of the key, with the remedy.
pub fn values(
    document: &Document<'_>,
    key: &str,
    item: &Item<'_>,
) -> Result<Vec<Value>, FileError> {
    const RANGES: &str = "write { from = 1.0, to = 8.0, points = 8 }, with step = 1.0 instead of points, or with spacing = \"log\"";
    let wrong =
        |what: &str, remedy: &str| document.fault(item.line, format!("`{key}`: {what}"), remedy);
    let list = match &item.node {
        Node::List(list) => list.iter().map(Value::of).collect(),
        Node::Table(entries) => {
            let range: Range = document.read(key, item, RANGES)?;
            let float = |item: &Item<'_>| matches!(item.node, Node::Plain(Toml::Float(_)));
            let integer = !entries.iter().any(|(_, item)| float(item));
            let numbers = range.numbers().map_err(|what| wrong(&what, RANGES))?;
            tidy(&numbers, integer)
        }
        Node::Plain(_) => vec![Value::of(item)],
    };
    if list.is_empty() {
        return Err(wrong("the list is empty", "give at least one value"));
    }
    if list.len() > MOST_VALUES {
        let what = format!("{} values are more than {MOST_VALUES}", list.len());
        return Err(wrong(&what, "give fewer"));
    }
    Ok(list)
}

impl Range {
    fn numbers(&self) -> Result<Vec<f64>, String> {
        let &Self {
            from, to, spacing, ..
        } = self;
        let log = spacing == Spacing::Log;
        let ends = [Some(from), Some(to), self.step];
        if !ends.iter().flatten().all(|x| x.is_finite()) {
            return Err("the numbers of a range must be finite".to_owned());
        }
        if log && !(from * to > 0.0) {
            return Err(
                "a range with spacing = \"log\" needs ends of one sign, neither 0".to_owned(),
            );
        }
        let points = match (self.points, self.step) {
            (Some(points), None) if (1..=MOST_VALUES).contains(&points) => points,
            (Some(_), None) => {
                let text = "`points` must be a whole number from 1 to";
                return Err(format!("{text} {MOST_VALUES}"));
            }
            (None, Some(step)) if !log && (to - from) / step >= 0.0 => {
                let steps = (to - from) / step * (1.0 + 1e-12);
                if !(steps < MOST_VALUES as f64) {
                    return Err(format!("the range has more than {MOST_VALUES} values"));
                }
                let count = steps.floor() as usize + 1;
                return Ok((0..count).map(|k| from + k as f64 * step).collect());
            }
            (None, Some(_)) => return Err("`step` does not lead from `from` to `to`".to_owned()),
            (Some(_), Some(_)) => return Err("the range has both `points` and `step`".to_owned()),
            (None, None) => return Err("the range has neither `points` nor `step`".to_owned()),
        };
        if points == 1 && from != to {
            return Err("one point cannot be at both ends".to_owned());
        }
        let last = (points - 1).max(1) as f64;
        let at = |k: usize| {
            let share = k as f64 / last;
            match spacing {
                _ if k + 1 == points => to,
                Spacing::Log => from * (to / from).powf(share),
                Spacing::Linear => from + (to - from) * share,
            }
        };
        Ok((0..points).map(at).collect())
    }
}

/// Returns integers if the file states integer ends (`integer`) and all values between are integers; otherwise numbers of twelve
/// digits, so that 0.1 + 0.2 is 0.3.
fn tidy(list: &[f64], integer: bool) -> Vec<Value> {
    let is_whole = |x: &f64| (x - x.round()).abs() < 1e-9 * x.abs().max(1.0);
    let integer = integer && list.iter().all(is_whole);
    let number = |&x: &f64| match integer {
        true => Value::Whole(x.round() as i64),
        false => Value::Number(format!("{x:.11e}").parse().unwrap_or(x)),
    };
    list.iter().map(number).collect()
}
