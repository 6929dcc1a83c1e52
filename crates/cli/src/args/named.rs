//! Options with named values.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Name, description and value.
pub(crate) type Named<T> = (&'static str, &'static str, T);

/// Returns a parser of one of `rows` by its name.
pub(crate) fn named<T: Copy + Send + Sync>(
    rows: &'static [Named<T>],
) -> impl TypedValueParser<Value = T> {
    let names = rows.iter();
    let names = names.map(|&(name, help, _)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(names).try_map(|typed| {
        let row = rows.iter().find(|(name, ..)| *name == typed);
        row.map(|&(.., value)| value).ok_or("no such name")
    })
}
