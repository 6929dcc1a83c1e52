//! Text of a [`Table`]: headings and cells, for pages and terminals alike.

use pinwheel_timeseries::table::{Column, Mark, Shown, Table, Values};

use crate::format;

/// Returns a column's heading with its unit.
pub fn heading(column: &Column) -> String {
    named(&column.label, &column.unit)
}

/// Returns a name with its unit, which may be empty.
pub fn named(label: &str, unit: &str) -> String {
    match unit {
        "" => label.to_owned(),
        unit => format!("{label} ({unit})"),
    }
}

/// Returns the text of a cell: the text that replaces the value, or the value with no digit beyond its uncertainty.
pub fn words(column: &Column, row: usize) -> String {
    if let Some(text) = of_row(&column.display, row) {
        return text;
    }
    match &column.values {
        Values::Text(_) => column.values.words(row).unwrap_or_default().to_owned(),
        Values::Integers(_) => column.values.text(row),
        Values::Number(_) => column.values.number(row).map_or_else(
            || format::NONE.to_owned(),
            |value| number(value, of_row(&column.uncertainty, row), column.shown),
        ),
    }
}

/// Formats a number with its uncertainty.
pub fn number(value: f64, uncertainty: Option<f64>, shown: Shown) -> String {
    if let (Some(u), Shown::Digits(_) | Shown::Decimals(_) | Shown::Percent) = (uncertainty, shown)
    {
        let factor = if shown == Shown::Percent { 100.0 } else { 1.0 };
        let (value, bound) = format::bounded(factor * value, Some(factor * u));
        return format!("{value} {bound}").trim_end().to_owned();
    }
    match shown {
        Shown::Digits(digits) => format::significant(value, usize::from(digits)),
        Shown::Decimals(decimals) => format::minus(&format!("{value:.*}", usize::from(decimals))),
        Shown::Relative => format::relative(value),
        Shown::Percent => format::minus(&format!("{:.2}", 100.0 * value)),
        Shown::Seconds => format::seconds(value),
        Shown::Metres => format::metres(value),
        Shown::Setting => format::plain(value),
    }
}

/// Returns the visible columns.
pub(crate) fn shown(table: &Table) -> impl Iterator<Item = &Column> + Clone {
    let columns = table.columns.iter();
    columns.filter(|column| !column.label.is_empty())
}

/// Returns the entry for a row in a list beside the values.
pub(crate) fn of_row<T: Clone>(list: &[Option<T>], row: usize) -> Option<T> {
    list.get(row).cloned().flatten()
}

/// Returns the mark of a cell.
pub(crate) fn mark(column: &Column, row: usize) -> Mark {
    column.marks.get(row).copied().unwrap_or_default()
}
