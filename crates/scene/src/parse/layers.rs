//! The table being built: a base, the file over it, the overrides over both, each value with its place.

use std::collections::HashMap;
use std::path::Path;
use std::str::FromStr as _;

use toml::{Table, Value};
use toml_edit::{Document, Item, TableLike};

use super::overrides::Override;
use super::unknown::{BASE, unknown};
use super::values::{kind, scalar};
use crate::check;
use crate::checked::{CheckedScene, Origin, Source};
use crate::error::{Fault, Place, SceneError, quoted};
use crate::fill::{Gap, fill};
use crate::json;
use crate::keys::{KEYS, Key, Kind, Otherwise};
use crate::load::{self, MOST_BYTES, line_of};
use crate::model::Scene;
use crate::suggest::nearest;
use crate::table::{insert, lookup, usual};
use crate::uncertain::{EXAMPLE, UNCERTAIN};

/// Bases of bases at most.
const DEEPEST: usize = 8;

/// The table being built, and where each of its values came from.
#[derive(Debug, Clone)]
pub(super) struct Layers {
    source: String,
    table: Table,
    places: HashMap<String, Place>,
    /// Which base each key came from, for those that the file itself does not write.
    inherited: HashMap<String, String>,
}

impl Layers {
    fn new(source: &str) -> Self {
        Self {
            source: source.to_owned(),
            table: Table::new(),
            places: HashMap::new(),
            inherited: HashMap::new(),
        }
    }

    /// A text with its base and overrides.
    pub(super) fn read(
        text: &str,
        source: &str,
        overrides: &[Override],
    ) -> Result<Self, SceneError> {
        let mut layers = Self::new(source);
        layers.file(text, source, overrides, 0)?;
        for set in overrides.iter().filter(|set| set.key() != BASE) {
            layers.set(set)?;
        }
        Ok(layers)
    }

    /// Lays a file over what there is, its base below it.
    fn file(
        &mut self,
        text: &str,
        source: &str,
        overrides: &[Override],
        depth: usize,
    ) -> Result<(), SceneError> {
        if text.len() > MOST_BYTES {
            return Err(SceneError::TooLong {
                source_name: source.to_owned(),
                limit: MOST_BYTES,
            });
        }
        let syntax = |line: usize, language: &'static str, what: &str| SceneError::Syntax {
            source_name: source.to_owned(),
            line,
            language,
            what: what.trim().to_owned(),
        };
        let is_json = json::is_json(text);
        let converted;
        let text = if is_json {
            converted = json::as_toml(text).map_err(|(line, what)| syntax(line, "JSON", &what))?;
            &converted
        } else {
            text
        };
        let document = Document::parse(text).map_err(|error| {
            let line = line_of(text, error.span().map_or(0, |span| span.start));
            syntax(line, "TOML", error.message())
        })?;
        let mut root = document.as_table().clone();
        // Counted once: a file may have many values on many lines.
        let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
        let place_at = |offset: usize| {
            let source = source.to_owned();
            if is_json {
                // Programs write JSON, and its lines are not the converted text's.
                return Place::File { source };
            }
            Place::Line {
                source,
                line: 1 + ends.partition_point(|&end| end < offset),
            }
        };
        let base = root.remove(BASE);
        let named = overrides.iter().rev().find(|set| set.key == BASE);
        let base = match (named, base) {
            (Some(set), _) => Some((set.value.trim_matches('"').to_owned(), set.place())),
            (None, Some(item)) => {
                let place = place_at(item.span().map_or(0, |span| span.start));
                let Some(name) = item.as_str() else {
                    return Err(SceneError::Key {
                        place,
                        key: BASE.to_owned(),
                        what: format!("is {}, but must be text", kind(&item)),
                        remedy: "write base = \"paper\", or the path of a scene file".to_owned(),
                    });
                };
                Some((name.to_owned(), place))
            }
            (None, None) => None,
        };
        if let Some((base, place)) = base {
            self.base(&base, &place, source, depth)?;
        }
        self.overlay("", &root, &place_at)
    }

    /// Lays the scene that `source` names as its base.
    fn base(
        &mut self,
        base: &str,
        place: &Place,
        source: &str,
        depth: usize,
    ) -> Result<(), SceneError> {
        let fault = |what: String, remedy: &str| SceneError::Key {
            place: place.clone(),
            key: BASE.to_owned(),
            what,
            remedy: remedy.to_owned(),
        };
        if depth >= DEEPEST {
            return Err(fault(
                format!("is {}, more than {DEEPEST} bases deep", quoted(base)),
                "a scene must not be its own base; name a preset or a file without base",
            ));
        }
        let (text, name) = if let Some(text) = crate::preset(base) {
            (text.to_owned(), base.to_owned())
        } else {
            // A path is one from the file that names it.
            let beside = Path::new(source).parent().unwrap_or(Path::new(""));
            let path = beside.join(base).display().to_string();
            (load::read(&path)?, path)
        };
        self.file(&text, &name, &[], depth + 1)?;
        // What a scene is called and why it exists is its own.
        for own in ["name", "description"] {
            self.table.remove(own);
            self.places.remove(own);
        }
        for key in self.places.keys() {
            self.inherited.insert(key.clone(), base.to_owned());
        }
        Ok(())
    }

    /// An override is a document of one key, whose place is the command line.
    pub(super) fn set(&mut self, set: &Override) -> Result<(), SceneError> {
        let place = set.place();
        let wrong = |what: &'static str| SceneError::Override {
            text: format!("{}={}", set.key, set.value),
            what,
        };
        let path =
            toml_edit::Key::parse(&set.key).map_err(|_| wrong("the part before `=` is no key"))?;
        let path: Vec<&str> = path.iter().map(toml_edit::Key::get).collect();

        // A word without quotes is a string; so is anything given for a key that holds text.
        let row = crate::keys::key(&path.join("."));
        let holds_text = row.is_some_and(|row| matches!(row.kind, Kind::Text | Kind::Choice(..)));
        let value = match toml_edit::Value::from_str(&set.value) {
            Ok(value) if !holds_text || value.is_str() => value,
            _ => toml_edit::Value::from(set.value.as_str()),
        };

        let mut item = Item::Value(value);
        for key in path.iter().skip(1).rev() {
            let mut table = toml_edit::Table::new();
            table.insert(key, item);
            item = Item::Table(table);
        }
        let mut root = toml_edit::Table::new();
        root.insert(path.first().copied().unwrap_or_default(), item);
        self.overlay("", &root, &|_| place.clone())
    }

    /// Lays `from` over what there is: only keys that have a row, only values of their kind.
    fn overlay(
        &mut self,
        prefix: &str,
        from: &dyn TableLike,
        place_at: &dyn Fn(usize) -> Place,
    ) -> Result<(), SceneError> {
        for (name, item) in from.iter() {
            let key = format!("{prefix}{name}");
            let place = place_at(start(from, name, item));
            if key == UNCERTAIN {
                self.uncertain("", item, &place, place_at)?;
                continue;
            }
            if let Some(row) = crate::keys::key(&key) {
                let value = self.value(row, &key, item, &place, place_at)?;
                insert(&mut self.table, &row.path(), value);
                self.inherited.remove(&key);
                self.places.insert(key, place);
                continue;
            }
            let inner = format!("{key}.");
            let Some(first) = KEYS.iter().find(|row| row.name.starts_with(&inner)) else {
                return Err(unknown(place, key, prefix, &self.table));
            };
            let Some(table) = item.as_table_like() else {
                let example = first.name[inner.len()..].to_owned();
                return Err(SceneError::Key {
                    place,
                    what: format!("is {}, but must be a table", kind(item)),
                    remedy: format!("write [{key}] on its own line, then {example} = ... below it"),
                    key,
                });
            };
            self.overlay(&inner, table, place_at)?;
        }
        Ok(())
    }

    /// Half-widths of intervals, each in a table at the place of its key below `[uncertain]`.
    fn uncertain(
        &mut self,
        prefix: &str,
        item: &Item,
        place: &Place,
        place_at: &dyn Fn(usize) -> Place,
    ) -> Result<(), SceneError> {
        let fault = |key: &str, place: &Place, what: String, remedy: &str| SceneError::Key {
            place: place.clone(),
            key: format!("{UNCERTAIN}{}{key}", if key.is_empty() { "" } else { "." }),
            what,
            remedy: remedy.to_owned(),
        };
        let Some(table) = item.as_table_like() else {
            let what = format!("is {}, but must be a table", kind(item));
            return Err(fault(prefix.trim_end_matches('.'), place, what, EXAMPLE));
        };
        for (name, item) in table.iter() {
            let key = format!("{prefix}{name}");
            let place = place_at(start(table, name, item));
            if crate::keys::key(&key).is_none() {
                let inner = format!("{key}.");
                if KEYS.iter().any(|row| row.name.starts_with(&inner)) {
                    self.uncertain(&inner, item, &place, place_at)?;
                    continue;
                }
                let known: Vec<&str> = KEYS.iter().map(|row| row.name).collect();
                let remedy = crate::did_you_mean(&key, &known);
                return Err(fault(
                    &key,
                    &place,
                    "is no key of a scene".to_owned(),
                    &remedy,
                ));
            }
            let stated = item.as_table_like().filter(|inner| inner.len() == 1);
            let number = stated
                .and_then(|inner| inner.get("plus_minus"))
                .and_then(|half| {
                    half.as_float()
                        .or_else(|| half.as_integer().map(|whole| whole as f64))
                });
            let Some(number) = number else {
                let what = "says not by how much".to_owned();
                return Err(fault(&key, &place, what, EXAMPLE));
            };
            insert(
                &mut self.table,
                &[UNCERTAIN, &key, "plus_minus"],
                Value::Float(number),
            );
            self.places.insert(format!("{UNCERTAIN}.{key}"), place);
        }
        Ok(())
    }

    /// The item as a value of the row's kind.
    fn value(
        &mut self,
        row: &Key,
        key: &str,
        item: &Item,
        place: &Place,
        place_at: &dyn Fn(usize) -> Place,
    ) -> Result<Value, SceneError> {
        let Kind::Tables(rows) = row.kind else {
            return scalar(row, item).map_err(|(what, remedy)| SceneError::Key {
                place: place.clone(),
                key: key.to_owned(),
                what,
                remedy,
            });
        };
        let fault = |key: String, what: String, remedy: String| SceneError::Key {
            place: place.clone(),
            key,
            what,
            remedy,
        };
        let entries = tables(item).ok_or_else(|| {
            let what = format!("is {}, but must be a list of tables", kind(item));
            fault(key.to_owned(), what, row.hint.to_owned())
        })?;
        // A list replaces the one before it.
        let list_prefix = format!("{key}[");
        self.places
            .retain(|name, _| !name.starts_with(&list_prefix));
        let mut list = Vec::with_capacity(entries.len());
        for (number, entry) in entries.into_iter().enumerate() {
            let named = |name: &str| format!("{key}[{number}].{name}");
            let mut table = Table::new();
            for (name, item) in entry.iter() {
                let full = named(name);
                let place = place_at(start(entry, name, item));
                let Some(inner) = rows.iter().find(|row| row.name == name) else {
                    let remedy = match nearest(name, rows.iter().map(|row| row.name)) {
                        Some(near) => format!("did you mean `{}`?", named(near)),
                        None => {
                            let names: Vec<&str> = rows.iter().map(|row| row.name).collect();
                            format!("known here: {}", names.join(", "))
                        }
                    };
                    return Err(SceneError::Key {
                        place,
                        key: full,
                        what: "is no key of a scene".to_owned(),
                        remedy,
                    });
                };
                let value = self.value(inner, &full, item, &place, place_at)?;
                table.insert(name.to_owned(), value);
                self.places.insert(full, place);
            }
            for inner in rows {
                match inner.otherwise {
                    _ if table.contains_key(inner.name) => {}
                    Otherwise::Required => {
                        let needed = rows
                            .iter()
                            .filter(|row| matches!(row.otherwise, Otherwise::Required));
                        let needed: Vec<String> = needed
                            .map(|row| format!("{} ({})", row.about, row.name))
                            .collect();
                        return Err(fault(
                            named(inner.name),
                            "is missing".to_owned(),
                            format!("every entry gives {}", needed.join(" and ")),
                        ));
                    }
                    Otherwise::Usual(text, _) => {
                        insert(&mut table, &[inner.name], usual(text));
                    }
                    Otherwise::Nothing | Otherwise::Follows(..) => {}
                }
            }
            list.push(Value::Table(table));
        }
        Ok(Value::Array(list))
    }

    pub(super) fn finish(mut self) -> Result<CheckedScene, SceneError> {
        let located =
            |fault: Fault, places: &HashMap<String, Place>| located(fault, places, &self.source);
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
        let mut origins: Vec<Origin> = KEYS
            .iter()
            .filter_map(|row| {
                let base = self.inherited.get(row.name)?;
                Some(Origin {
                    key: row.name,
                    value: lookup(&self.table, row.name)?.clone(),
                    source: Source::Base(base.clone()),
                })
            })
            .collect();
        origins.extend(filled);
        // Formulas may leave the ranges.
        check::ranges(&self.table).map_err(|fault| located(fault, &self.places))?;
        let scene: Scene =
            serde_path_to_error::deserialize(Value::Table(self.table)).map_err(|error| {
                let key = error.path().to_string();
                let what = error.inner().message().trim().to_owned();
                SceneError::Key {
                    place: self.places.get(&key).cloned().unwrap_or(Place::Default {
                        source: self.source.clone(),
                    }),
                    what: format!("is not understood: {what}"),
                    remedy: "write one of the listed values".to_owned(),
                    key,
                }
            })?;
        CheckedScene::together(scene, origins).map_err(|fault| located(fault, &self.places))
    }
}

/// Where a key begins in the text, bytes.
fn start(table: &dyn TableLike, name: &str, item: &Item) -> usize {
    let key = table.get_key_value(name).and_then(|(key, _)| key.span());
    key.or_else(|| item.span()).map_or(0, |span| span.start)
}

/// The tables of a list; `None` if it is none.
fn tables(item: &Item) -> Option<Vec<&dyn TableLike>> {
    if let Some(list) = item.as_array_of_tables() {
        return Some(list.iter().map(|table| table as &dyn TableLike).collect());
    }
    item.as_array()?
        .iter()
        .map(|value| value.as_inline_table().map(|t| t as &dyn TableLike))
        .collect()
}

/// Names the key the user can change: one given with `--set` before one in the file `source` before one of its base
/// before one that nobody wrote.
pub(super) fn located(fault: Fault, places: &HashMap<String, Place>, source: &str) -> SceneError {
    let first = fault.keys.first().map_or("scene", AsRef::as_ref);
    let rank = |place: &&Place| match place {
        Place::Set(_) => 0,
        Place::Line { source: file, .. } | Place::File { source: file } if file == source => 1,
        Place::Line { .. } | Place::File { .. } => 2,
        Place::Default { .. } => 3,
    };
    let places = fault.keys.iter().filter_map(|key| places.get(key.as_ref()));
    let place = places.min_by_key(rank).cloned();
    let place = place.unwrap_or_else(|| Place::Default {
        source: source.to_owned(),
    });
    SceneError::Key {
        place,
        key: first.to_owned(),
        what: fault.what,
        remedy: fault.remedy,
    }
}
