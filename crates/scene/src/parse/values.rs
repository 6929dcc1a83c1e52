//! Items of a TOML file as values of the kind that their key has.

use toml::Value;
use toml_edit::Item;

use crate::error::quoted;
use crate::keys::{Key, Kind};

/// The item as a value of the row's kind, or what is wrong and the remedy.
pub(super) fn scalar(row: &Key, item: &Item) -> Result<Value, (String, String)> {
    let wrong = |wanted: &str, remedy: &str| {
        Err((
            format!("is {}, but must be {wanted}", kind(item)),
            remedy.to_owned(),
        ))
    };
    match row.kind {
        Kind::Number(_) => match (item.as_float(), item.as_integer()) {
            (Some(number), _) => Ok(Value::Float(number)),
            (None, Some(whole)) => Ok(Value::Float(whole as f64)),
            _ => wrong(
                "a number",
                "write it without quotes and unit, for example 0.006",
            ),
        },
        Kind::Count(..) => match item.as_integer() {
            Some(whole) if whole >= 0 => Ok(Value::Integer(whole)),
            _ => wrong(
                "a whole number, not negative",
                "write it like 16, without point or quotes",
            ),
        },
        Kind::Texts => {
            let texts: Option<Vec<&str>> = match (item.as_array(), item.as_str()) {
                (Some(list), _) => list.iter().map(toml_edit::Value::as_str).collect(),
                // One name needs no brackets.
                (None, Some(text)) => Some(vec![text]),
                (None, None) => None,
            };
            match texts {
                Some(texts) => {
                    let texts = texts.into_iter().map(|text| Value::String(text.to_owned()));
                    Ok(Value::Array(texts.collect()))
                }
                None => wrong("a list of texts", row.hint),
            }
        }
        Kind::Numbers(_) => {
            let number = |value: &toml_edit::Value| {
                let whole = || value.as_integer().map(|whole| whole as f64);
                value.as_float().or_else(whole).map(Value::Float)
            };
            let numbers: Option<Vec<Value>> = item
                .as_array()
                .and_then(|list| list.iter().map(number).collect());
            match numbers {
                Some(numbers) => Ok(Value::Array(numbers)),
                None => wrong("a list of numbers", row.hint),
            }
        }
        Kind::Text | Kind::Choice(..) | Kind::Tables(_) => match item.as_str() {
            Some(text) => Ok(Value::String(text.to_owned())),
            None => wrong("text", "write it in quotes"),
        },
    }
}

/// What stands there, in words.
pub(super) fn kind(item: &Item) -> String {
    if let Some(text) = item.as_str() {
        return format!("the text {}", quoted(text));
    }
    if let Some(whole) = item.as_integer() {
        return whole.to_string();
    }
    if let Some(number) = item.as_float() {
        return number.to_string();
    }
    if let Some(truth) = item.as_bool() {
        return truth.to_string();
    }
    match item.type_name() {
        "datetime" => "a date".to_owned(),
        "array" => "a list".to_owned(),
        "array of tables" => "a list of tables ([[...]])".to_owned(),
        _ => "a table".to_owned(),
    }
}
