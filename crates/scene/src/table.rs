//! TOML tables by dotted names.

use std::str::FromStr as _;

use toml::{Table, Value};

/// Returns the value at a dotted name.
pub(crate) fn lookup<'t>(table: &'t Table, name: &str) -> Option<&'t Value> {
    let mut parts = name.split('.');
    let last = parts.next_back()?;
    let mut table = table;
    for part in parts {
        table = table.get(part)?.as_table()?;
    }
    table.get(last)
}

/// Returns the number at a dotted name, integer or float.
pub(crate) fn number(table: &Table, name: &str) -> Option<f64> {
    match lookup(table, name)? {
        Value::Float(number) => Some(*number),
        Value::Integer(n) => Some(*n as f64),
        _ => None,
    }
}

/// Stores a value at a path, with the tables on the way.
pub(crate) fn insert(table: &mut Table, path: &[&str], value: Value) {
    let Some((last, tables)) = path.split_last() else {
        return;
    };
    let mut table = table;
    for part in tables {
        let inner = table.entry(*part);
        let inner = inner.or_insert_with(|| Value::Table(Table::new()));
        let Value::Table(inner) = inner else { return };
        table = inner;
    }
    table.insert((*last).to_owned(), value);
}

/// Parses a usual value of [`crate::keys`], which tests check.
pub(crate) fn usual(text: &str) -> Value {
    Value::from_str(text).unwrap_or(Value::Boolean(false))
}
