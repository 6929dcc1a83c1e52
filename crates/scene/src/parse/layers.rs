//! Table under construction from a base, a file and overrides, each value with its place.

use std::collections::HashMap;
use std::path::Path;

use pinwheel_files::{Document, Entries, FileError, Node, did_you_mean, quoted};
use serde::Deserialize as _;
use toml::{Table, Value};

use super::overrides::Override;
use super::unknown::{BASE, unknown};
use super::values::scalar;
use crate::check;
use crate::checked::{CheckedScene, Origin, Source};
use crate::error::{Fault, Location, SceneError};
use crate::fill::{Gap, PITCH, SHORTENING, fill};
use crate::json;
use crate::keys::{DefaultValue, KEYS, Key, Kind};
use crate::load;
use crate::model::{PlusMinus, Scene};
use crate::table::{insert, lookup, usual};
use crate::uncertain::{EXAMPLE, UNCERTAIN};

/// Largest depth of nested bases.
const DEEPEST: usize = 8;
/// Forms of a scene file, for messages.
pub(super) const FORM: &str =
    "a scene consists of `key = value` lines under [gear], [mass], [drive], [contact] and [solver]";

/// Function from a line number to a place.
type Places<'a> = &'a dyn Fn(usize) -> Location;

/// Table under construction, with the place of each value.
#[derive(Debug, Clone)]
pub(super) struct Layers {
    source: String,
    table: Table,
    places: HashMap<String, Location>,
    /// Base of each inherited key that the file itself does not write.
    inherited: HashMap<String, String>,
}

impl Layers {
    /// Reads a text with its base and overrides.
    pub(super) fn read(
        text: &str,
        source: &str,
        overrides: &[Override],
    ) -> Result<Self, SceneError> {
        let mut layers = Self {
            source: source.to_owned(),
            table: Table::new(),
            places: HashMap::new(),
            inherited: HashMap::new(),
        };
        layers.file(text, source, overrides, 0)?;
        for set in overrides.iter().filter(|set| set.key() != BASE) {
            layers.set(set)?;
        }
        Ok(layers)
    }

    /// Merges a file into the values so far, after its base.
    fn file(
        &mut self,
        text: &str,
        source: &str,
        overrides: &[Override],
        depth: usize,
    ) -> Result<(), SceneError> {
        let is_json = json::is_json(text);
        let converted;
        let text = if is_json {
            converted = json::as_toml(text).map_err(|(line, what)| {
                let what = format!("not valid JSON: {}", what.trim());
                FileError::new(source, what, FORM).in_line(line)
            })?;
            &converted
        } else {
            text
        };
        let mut document = Document::parse(text, source, FORM)?;
        let place_at = |line: usize| {
            let source = source.to_owned();
            // Programs write JSON, and its line numbers are not those of the converted text.
            match is_json {
                true => Location::File { source },
                false => Location::Line { source, line },
            }
        };
        let named = overrides.iter().rev().find(|set| set.key == BASE);
        if let Some(set) = named {
            self.base(set.value.trim_matches('"'), &set.place(), source, depth)?;
        } else if let Some(item) = document.get(BASE) {
            let place = place_at(item.line);
            let Node::Plain(Value::String(name)) = &item.node else {
                let what = format!("is {}, but must be text", item.node.words());
                let remedy = "write base = \"paper\", or the path of a scene file";
                return Err(SceneError::key(&place, BASE, what, remedy));
            };
            self.base(name, &place, source, depth)?;
        }
        document.root.retain(|(key, _)| key != BASE);
        self.overlay(&document.root, &place_at)
    }

    /// Merges the scene named by `source` as base.
    fn base(
        &mut self,
        base: &str,
        place: &Location,
        source: &str,
        depth: usize,
    ) -> Result<(), SceneError> {
        if depth >= DEEPEST {
            let what = format!("is {}, more than {DEEPEST} bases deep", quoted(base));
            let remedy = "a scene must not be its own base; name a preset or a file without base";
            return Err(SceneError::key(place, BASE, what, remedy));
        }
        let (text, name) = if let Some(text) = crate::preset(base) {
            (text.to_owned(), base.to_owned())
        } else {
            // The path is relative to the naming file.
            let beside = Path::new(source).parent().unwrap_or(Path::new(""));
            let path = beside.join(base).display().to_string();
            (load::read(&path)?, path)
        };
        self.file(&text, &name, &[], depth + 1)?;
        // Name and description are not inherited from a base.
        for own in ["name", "description"] {
            self.table.remove(own);
            self.places.remove(own);
        }
        for key in self.places.keys() {
            self.inherited.insert(key.clone(), base.to_owned());
        }
        Ok(())
    }

    /// Applies an override, a document of one key from the command line.
    pub(super) fn set(&mut self, set: &Override) -> Result<(), SceneError> {
        let text = format!("{} = {}", set.key, set.toml());
        let document = Document::parse(&text, "--set", FORM);
        match document.ok().filter(|_| !set.key.contains(['\n', '#'])) {
            Some(document) => self.overlay(&document.root, &|_| set.place()),
            None => Err(SceneError::Override {
                text: format!("{}={}", set.key, set.value),
                what: "the part before `=` is no key",
            }),
        }
    }

    /// Merges `from` into the values so far. Accepts only keys of the key table, with values of the key's kind.
    fn overlay(&mut self, from: &Entries<'_>, place_at: Places<'_>) -> Result<(), SceneError> {
        self.within("", "", from, place_at)
    }

    /// Merges the table `from` at `prefix`, below `root`, into the values so far. The root is empty for values and
    /// [`UNCERTAIN`] for their uncertainties.
    fn within(
        &mut self,
        root: &str,
        prefix: &str,
        from: &Entries<'_>,
        place_at: Places<'_>,
    ) -> Result<(), SceneError> {
        for (name, item) in from {
            let key = format!("{prefix}{name}");
            let full = format!("{root}{key}");
            let place = place_at(item.line);
            if let Some(row) = crate::keys::key(&key) {
                if root.is_empty() {
                    let value = self.value(row, &key, &item.node, &place, place_at)?;
                    insert(&mut self.table, &row.path(), value);
                    self.inherited.remove(&key);
                    self.drop_earlier_twin(&key, &place);
                } else {
                    let half = PlusMinus::deserialize(item.node.value()).map_err(|_| {
                        SceneError::key(&place, &full, "says not by how much", EXAMPLE)
                    })?;
                    let half = Value::Float(half.plus_minus);
                    insert(&mut self.table, &[UNCERTAIN, &key, "plus_minus"], half);
                }
                self.places.insert(full, place);
                continue;
            }
            let (root, inner) = match full == UNCERTAIN {
                true => (format!("{UNCERTAIN}."), String::new()),
                false => (root.to_owned(), format!("{key}.")),
            };
            let Some(first) = KEYS.iter().find(|row| row.name.starts_with(&inner)) else {
                return Err(unknown(place, full, prefix, &item.node, &self.table));
            };
            let Some(table) = item.node.as_table() else {
                let what = format!("is {}, but must be a table", item.node.words());
                let example = &first.name[inner.len()..];
                let remedy = match root.is_empty() {
                    true => {
                        format!("write [{full}] on its own line, then {example} = ... below it")
                    }
                    false => EXAMPLE.to_owned(),
                };
                return Err(SceneError::key(&place, &full, what, remedy));
            };
            self.within(&root, &inner, table, place_at)?;
        }
        Ok(())
    }

    /// Removes the uncertainty of a key.
    pub(super) fn drop_uncertainty(&mut self, key: &str) {
        if let Some(Value::Table(table)) = self.table.get_mut(UNCERTAIN) {
            table.remove(key);
            self.places.remove(&format!("{UNCERTAIN}.{key}"));
        }
    }

    /// Removes the values from the base, or under an override from the file, for a key that follows from this one at `place`.
    fn drop_earlier_twin(&mut self, key: &str, place: &Location) {
        let twin = match key {
            PITCH => SHORTENING,
            SHORTENING => PITCH,
            _ => return,
        };
        let is_set = |place: Option<&Location>| matches!(place, Some(Location::Set(_)));
        let is_over = is_set(Some(place)) && !is_set(self.places.get(twin));
        if self.inherited.remove(twin).is_some() || is_over {
            self.places.remove(twin);
            if let Some(Value::Table(gear)) = self.table.get_mut("gear") {
                gear.remove(twin.trim_start_matches("gear."));
            }
        }
    }

    /// Reads the value at a key as one of the row's kind.
    fn value(
        &mut self,
        row: &Key,
        key: &str,
        node: &Node<'_>,
        place: &Location,
        place_at: Places<'_>,
    ) -> Result<Value, SceneError> {
        let Kind::Tables(rows) = row.kind else {
            return scalar(row, node)
                .map_err(|(what, remedy)| SceneError::key(place, key, what, remedy));
        };
        let entries = node.as_tables().ok_or_else(|| {
            let what = format!("is {}, but must be a list of tables", node.words());
            SceneError::key(place, key, what, row.hint)
        })?;
        // A list replaces the previous one.
        let list_prefix = format!("{key}[");
        self.places
            .retain(|name, _| !name.starts_with(&list_prefix));
        let names: Vec<&str> = rows.iter().map(|row| row.name).collect();
        let mut list = Vec::with_capacity(entries.len());
        for (number, entry) in entries.into_iter().enumerate() {
            let named = |name: &str| format!("{key}[{number}].{name}");
            let mut table = Table::new();
            for (name, item) in entry {
                let full = named(name);
                let place = place_at(item.line);
                let Some(inner) = rows.iter().find(|row| row.name == name) else {
                    let remedy = did_you_mean(name, &names);
                    return Err(SceneError::key(
                        &place,
                        &full,
                        "is no key of a scene",
                        remedy,
                    ));
                };
                let value = self.value(inner, &full, &item.node, &place, place_at)?;
                table.insert(name.clone(), value);
                self.places.insert(full, place);
            }
            for inner in rows {
                let is_missing = !table.contains_key(inner.name);
                match inner.otherwise {
                    DefaultValue::Required if is_missing => {
                        let needed = rows.iter();
                        let needed =
                            needed.filter(|row| matches!(row.otherwise, DefaultValue::Required));
                        let needed = needed.map(|row| format!("{} ({})", row.about, row.name));
                        let needed: Vec<String> = needed.collect();
                        let remedy = format!("every entry gives {}", needed.join(" and "));
                        return Err(SceneError::key(
                            place,
                            &named(inner.name),
                            "is missing",
                            remedy,
                        ));
                    }
                    DefaultValue::Constant(text, _) if is_missing => {
                        insert(&mut table, &[inner.name], usual(text));
                    }
                    _ => {}
                }
            }
            list.push(Value::Table(table));
        }
        Ok(Value::Array(list))
    }

    /// Checks the given values, fills in the missing ones, and checks the complete scene.
    pub(super) fn finish(mut self) -> Result<CheckedScene, SceneError> {
        let located =
            |fault: Fault, places: &HashMap<String, Location>| located(fault, places, &self.source);
        if let Some(stem) = Path::new(&self.source).file_stem().and_then(|s| s.to_str()) {
            let name = self.table.entry("name");
            name.or_insert_with(|| Value::String(stem.to_owned()));
        }
        check::ranges(&self.table).map_err(|fault| located(fault, &self.places))?;
        let filled = fill(&mut self.table).map_err(|fault| match fault {
            Gap::Fault(fault) => located(fault, &self.places),
            Gap::Missing(keys) => SceneError::Missing {
                source_name: self.source.clone(),
                keys,
            },
        })?;
        let from_base = |row: &Key| {
            let base = self.inherited.get(row.name)?;
            Some(Origin {
                key: row.name,
                value: lookup(&self.table, row.name)?.clone(),
                source: Source::Base(base.clone()),
            })
        };
        let mut origins: Vec<Origin> = KEYS.iter().filter_map(from_base).collect();
        origins.extend(filled);
        // Formulas may give values out of range.
        check::ranges(&self.table).map_err(|fault| located(fault, &self.places))?;
        let scene: Scene =
            Value::Table(self.table)
                .try_into()
                .map_err(|error: toml::de::Error| {
                    FileError::new(&self.source, error.message(), FORM)
                })?;
        CheckedScene::together(scene, origins).map_err(|fault| located(fault, &self.places))
    }
}

/// Converts a fault to an error at the key that the user can change best: one from `--set`, then one of the file `source`,
/// then one of its base, then an omitted one.
pub(super) fn located(
    fault: Fault,
    places: &HashMap<String, Location>,
    source: &str,
) -> SceneError {
    let rank = |place: &&Location| match place {
        Location::Set(_) => 0,
        Location::Line { source: file, .. } | Location::File { source: file } if file == source => {
            1
        }
        Location::Line { .. } | Location::File { .. } => 2,
        Location::Default { .. } => 3,
    };
    let known = fault.keys.iter().filter_map(|key| places.get(key.as_ref()));
    let place = known
        .min_by_key(rank)
        .cloned()
        .unwrap_or_else(|| Location::Default {
            source: source.to_owned(),
        });
    let first = fault.keys.first().map_or("scene", AsRef::as_ref);
    SceneError::key(&place, first, fault.what, fault.remedy)
}
