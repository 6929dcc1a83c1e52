//! Changes of single keys in the text of a scene file; every other key, comment and blank line is unchanged.

use std::path::Path;

use toml_edit::{DocumentMut, InlineTable, Item, Key, TableLike, Value};

use super::Override;
use super::unknown::BASE;
use crate::presets::preset;

/// Returns a scene file without the `removed` keys and with those of `sets`, each at its old place or below the last key of
/// its table. A `base` path relative to the folder `beside` becomes one relative to the working folder. `None` if the text
/// is no TOML or a key is invalid.
pub fn edited(text: &str, sets: &[Override], removed: &[&str], beside: &Path) -> Option<String> {
    let mut document: DocumentMut = text.parse().ok()?;
    for key in removed {
        let path = Key::parse(key).ok()?;
        let (last, tables) = path.split_last()?;
        let root: &mut dyn TableLike = document.as_table_mut();
        let mut parent = tables.iter().try_fold(root, |table, key| {
            table.get_mut(key.get())?.as_table_like_mut()
        });
        parent.as_mut().map(|table| table.remove(last.get()));
    }
    for set in sets {
        let path = Key::parse(&set.key).ok()?;
        let (last, tables) = path.split_last()?;
        let mut table: &mut dyn TableLike = document.as_table_mut();
        for key in tables {
            if !table.contains_key(key.get()) {
                // Written as `modification.radial_m = 1e-5`, which is valid at any place of its parent.
                let mut dotted = InlineTable::new();
                dotted.set_dotted(true);
                table.insert(key.get(), Item::Value(dotted.into()));
            }
            table = table.get_mut(key.get())?.as_table_like_mut()?;
        }
        let mut value: Value = set.toml().parse().ok()?;
        match table.get_mut(last.get()) {
            Some(Item::Value(old)) => {
                // The comment behind a value is its decor.
                *value.decor_mut() = old.decor().clone();
                *old = value;
            }
            _ => drop(table.insert(last.get(), Item::Value(value))),
        }
    }
    let base = document.get(BASE).and_then(Item::as_str);
    let path = base.filter(|base| preset(base).is_none() && beside != Path::new(""));
    if let Some(path) = path.map(|base| beside.join(base).display().to_string()) {
        document.insert(BASE, Item::Value(path.into()));
    }
    Some(document.to_string())
}
