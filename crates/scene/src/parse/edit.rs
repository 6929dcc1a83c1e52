//! Changes of single keys in the text of a scene file: every other key, comment and blank line stays as its author wrote it.

use std::path::Path;

use toml_edit::{DocumentMut, InlineTable, Item, Key, TableLike, Value};

use super::Override;
use super::unknown::BASE;
use crate::presets::preset;

/// Returns a scene file with `removed` keys taken away and then those of `sets` written, each where it stands or else below the
/// last key of its table. A `base` that is a path from the folder `beside` becomes one from the working folder. `None` where the
/// text is no TOML or a key is none.
#[must_use]
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
                // Written as `modification.radial_m = 1e-5`, which is valid wherever its parent stands.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_one_key_changes_and_all_else_stays() {
        let own = "# mine\n[gear] # dimensions\nbacklash_m = 1e-5 # as measured\n\n# the drive\n[drive]\noutput_torque_n_m = 200\n\
                   [bearings.eccentric]\nrollers = 16 # needles\nclearance_m = 5e-6\n";
        let changed = |sets: &[(&str, &str)], removed: &[&str]| {
            let sets = sets.iter().map(|&(key, value)| Override::new(key, value));
            edited(own, &sets.collect::<Vec<_>>(), removed, Path::new("")).unwrap()
        };
        let loose = changed(&[("gear.backlash_m", "36e-6")], &[]);
        assert_eq!(loose, own.replace("1e-5 #", "36e-6 #"));
        let added = changed(
            &[
                ("gear.modification.radial_m", "1e-6"),
                ("contact.law", "paper"),
            ],
            &[],
        );
        let expected = own.replace("measured\n", "measured\nmodification.radial_m = 1e-6\n");
        assert_eq!(added, format!("contact.law = \"paper\"\n{expected}"));
        let plain = changed(
            &[("bearings.eccentric.stiffness_n_m", "3e8")],
            &["bearings.eccentric.rollers"],
        );
        assert_eq!(
            plain,
            own.replace("rollers = 16 # needles\n", "") + "stiffness_n_m = 3e8\n"
        );
        let rigid = changed(&[], &["bearings.eccentric", "cranks.none"]);
        assert_eq!(rigid, own.split("[bearings").next().unwrap());
        let on = |base: &str| {
            edited(
                &format!("base = \"{base}\"\n"),
                &[],
                &[],
                Path::new("gears"),
            )
        };
        assert_eq!(on("paper").unwrap(), "base = \"paper\"\n");
        assert_eq!(on("own.toml").unwrap(), "base = \"gears/own.toml\"\n");
        assert_eq!(edited("{\"gear\": 1}", &[], &[], Path::new("")), None);
    }
}
