//! Dotted keys of a TOML table.

use pinwheel_files::{Entries, Item};

/// Returns the dotted keys of a table with their values, in the file's order; a table with one of the `words` is a value.
pub(super) fn leaves<'d, 't>(
    entries: &'d [(String, Item<'t>)],
    words: &[&str],
) -> Vec<(String, &'d Item<'t>)> {
    let mut list = Vec::new();
    for (name, item) in entries {
        let is_value =
            |inner: &&Entries<'_>| inner.iter().any(|(key, _)| words.contains(&key.as_str()));
        match item.node.as_table().filter(|inner| !is_value(inner)) {
            Some(inner) => {
                let inner = leaves(inner, words).into_iter();
                list.extend(inner.map(|(key, item)| (format!("{name}.{key}"), item)));
            }
            None => list.push((name.clone(), item)),
        }
    }
    list
}
