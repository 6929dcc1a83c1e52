//! Conversion of a file's values to the kind of their key.

use pinwheel_files::Node;
use toml::Value;

use crate::keys::{Key, Kind};
use crate::quantity;

/// Reads a value of the row's kind; an error is the fault and the remedy.
pub(super) fn scalar(row: &Key, node: &Node<'_>) -> Result<Value, (String, String)> {
    let number = |value: &Value| match value {
        Value::Integer(n) => Some(Value::Float(*n as f64)),
        Value::Float(_) => Some(value.clone()),
        _ => None,
    };
    let text = |value: &Value| value.is_str().then(|| value.clone());
    let list = |of: &dyn Fn(&Value) -> Option<Value>| match node.value() {
        Value::Array(list) => list.iter().map(of).collect::<Option<_>>().map(Value::Array),
        _ => None,
    };
    let value = node.value();
    let (read, wanted, remedy) = match row.kind {
        Kind::Number(_) => (
            number(&value),
            "a number",
            "write it without quotes and unit, for example 0.006",
        ),
        Kind::Count(..) => (
            value.as_integer().filter(|&n| n >= 0).map(Value::Integer),
            "a whole number, not negative",
            "write it like 16, without point or quotes",
        ),
        Kind::Flag => (
            value.as_bool().map(Value::Boolean),
            "true or false",
            row.hint,
        ),
        // One name needs no brackets.
        Kind::Texts | Kind::Choices(..) => (
            list(&text).or_else(|| Some(Value::Array(vec![text(&value)?]))),
            "a list of texts",
            row.hint,
        ),
        Kind::Numbers(_) => (list(&number), "a list of numbers", row.hint),
        Kind::Text | Kind::Choice(..) | Kind::Tables(_) => {
            (text(&value), "text", "write it in quotes")
        }
    };
    read.ok_or_else(|| {
        let what = format!("is {}, but must be {wanted}", node.words());
        let typed = value
            .as_str()
            .filter(|_| matches!(row.kind, Kind::Number(_)));
        let meant = typed.and_then(|typed| quantity::read(typed, &quantity::ending(row.unit())));
        let remedy = match meant {
            Some(meant) => format!("did you mean {meant}? write the number alone, with a point"),
            None => remedy.to_owned(),
        };
        (what, remedy)
    })
}
