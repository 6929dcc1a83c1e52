//! Reading of `reference/published/`.

pub(crate) type Table = toml::Table;

pub(crate) fn table(name: &str) -> Table {
    let path = format!(
        "{}/../../reference/published/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    text.parse().unwrap_or_else(|e| panic!("{path}: {e}"))
}

fn value(value: &toml::Value) -> f64 {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|k| k as f64))
        .expect("a number")
}

pub(crate) fn number(table: &Table, key: &str) -> f64 {
    value(table.get(key).unwrap_or_else(|| panic!("no key {key}")))
}

pub(crate) fn numbers(table: &Table, key: &str) -> Vec<f64> {
    let list = table.get(key).and_then(toml::Value::as_array);
    list.unwrap_or_else(|| panic!("no list {key}"))
        .iter()
        .map(value)
        .collect()
}

/// Returns the largest deviation.
pub(crate) fn worst(actual: &[f64], exact: &[f64]) -> f64 {
    assert_eq!(actual.len(), exact.len());
    let one = |(f, e): (&f64, &f64)| (f - e).abs();
    // Not `fold(max)`, which would ignore NaN.
    actual
        .iter()
        .zip(exact)
        .map(one)
        .fold(0.0, |a, b| if b <= a { a } else { b })
}
