//! From TOML text and overrides to a checked scene.
//!
//! The defaults are laid out as a table first; the file and then the overrides are laid over it,
//! key by key, each remembered with its place. So a key that does not exist is caught where it
//! stands, a wrong type too, and a check that fails later still knows the line to name.

use std::collections::HashMap;
use std::str::FromStr;

use toml::{Table, Value};
use toml_edit::{Document, Item, TableLike};

use super::changes;
use super::checked::CheckedScene;
use super::error::{Fault, Place, SceneError, quoted};
use super::model::Scene;
use super::suggest::nearest;

/// Bytes of a scene file at most; a full one with comments has about 5000.
pub const MOST_BYTES: usize = 1 << 20;

/// One `--set key=value`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Override {
    key: String,
    value: String,
}

impl Override {
    /// Replaces `key` (`gear.backlash_m`) by `value`, a TOML value or a bare word.
    #[must_use]
    pub fn new(key: impl Into<String>, value: impl Into<String>) -> Self {
        Self {
            key: key.into(),
            value: value.into(),
        }
    }

    fn place(&self) -> Place {
        Place::Set(format!("{}={}", self.key, self.value))
    }
}

impl FromStr for Override {
    type Err = SceneError;

    fn from_str(text: &str) -> Result<Self, SceneError> {
        let fault = |what| SceneError::Override {
            text: text.to_owned(),
            what,
        };
        if text.len() > MOST_BYTES {
            return Err(SceneError::Override {
                text: String::new(),
                what: "is far too long",
            });
        }
        let (key, value) = text.split_once('=').ok_or_else(|| fault("has no `=`"))?;
        let (key, value) = (key.trim(), value.trim());
        if key.is_empty() {
            return Err(fault("has no key"));
        }
        if value.is_empty() {
            return Err(fault("has no value"));
        }
        Ok(Self::new(key, value))
    }
}

impl Scene {
    /// Reads a scene from TOML text, applies the overrides in their order, and checks the result.
    ///
    /// `source_name` is the file's or preset's name for messages. A scene without `name` takes the
    /// file's (`gears/mine.toml` gives `mine`).
    ///
    /// # Errors
    /// The first fault found, with its key, line and remedy.
    pub fn from_toml(
        text: &str,
        source_name: &str,
        overrides: &[Override],
    ) -> Result<CheckedScene, SceneError> {
        if text.len() > MOST_BYTES {
            return Err(SceneError::TooLong {
                source_name: source_name.to_owned(),
                limit: MOST_BYTES,
            });
        }
        let document = Document::parse(text).map_err(|error| SceneError::Syntax {
            source_name: source_name.to_owned(),
            line: line_of(text, error.span().map_or(0, |span| span.start)),
            what: error.message().trim().to_owned(),
        })?;

        let mut layers = Layers::new(text, source_name);
        layers.file(document.as_table())?;
        for set in overrides {
            layers.set(set)?;
        }
        layers.finish()
    }

    /// The scene as TOML with every key written out.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Tables of numbers and strings always serialise; floats print with all their digits.
        toml::to_string(self).unwrap_or_default()
    }
}

/// The table being built, and where each of its values came from.
struct Layers<'a> {
    text: &'a str,
    source: &'a str,
    table: Table,
    places: HashMap<String, Place>,
}

impl<'a> Layers<'a> {
    fn new(text: &'a str, source: &'a str) -> Self {
        let stem = std::path::Path::new(source)
            .file_stem()
            .and_then(|stem| stem.to_str());
        Self {
            text,
            source,
            table: defaults(stem),
            places: HashMap::new(),
        }
    }

    fn file(&mut self, root: &dyn TableLike) -> Result<(), SceneError> {
        let (text, source) = (self.text, self.source);
        let place = |offset: usize| Place::Line {
            source: source.to_owned(),
            line: line_of(text, offset),
        };
        overlay(&mut self.table, &mut self.places, "", root, &place)
    }

    /// An override is a document of one key, whose place is the command line.
    fn set(&mut self, set: &Override) -> Result<(), SceneError> {
        let place = set.place();
        let wrong = |what: &'static str| SceneError::Override {
            text: format!("{}={}", set.key, set.value),
            what,
        };
        let path =
            toml_edit::Key::parse(&set.key).map_err(|_| wrong("the part before `=` is no key"))?;
        let path: Vec<&str> = path.iter().map(toml_edit::Key::get).collect();

        // A word without quotes is a string; so is anything given for a key that holds text.
        let holds_text = lookup(&self.table, &path).is_some_and(Value::is_str);
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
        overlay(&mut self.table, &mut self.places, "", &root, &|_| {
            place.clone()
        })
    }

    fn finish(self) -> Result<CheckedScene, SceneError> {
        let Self {
            source,
            table,
            places,
            ..
        } = self;
        let default = || Place::Default {
            source: source.to_owned(),
        };
        let scene: Scene =
            serde_path_to_error::deserialize(Value::Table(table)).map_err(|error| {
                let key = error.path().to_string();
                let what = error.inner().message().trim().to_owned();
                SceneError::Key {
                    place: places.get(&key).cloned().unwrap_or_else(default),
                    what: format!("is not understood: {what}"),
                    remedy: "write one of the listed values".to_owned(),
                    key,
                }
            })?;
        scene
            .check()
            .map_err(|fault| located(fault, &places, default))
    }
}

/// Names the key the user can change: one given with `--set` before one in the file before a default.
fn located(
    fault: Fault,
    places: &HashMap<String, Place>,
    default: impl Fn() -> Place,
) -> SceneError {
    let first = fault.keys.first().map_or("scene", AsRef::as_ref);
    let place_of = |wanted: fn(&Place) -> bool| {
        let keys = fault.keys.iter();
        keys.filter_map(|key| places.get(key.as_ref()))
            .find(|place| wanted(place))
    };
    let place = place_of(|place| matches!(place, Place::Set(_)))
        .or_else(|| place_of(|place| matches!(place, Place::Line { .. })))
        .cloned()
        .unwrap_or_else(default);
    SceneError::Key {
        place,
        key: first.to_owned(),
        what: fault.what,
        remedy: fault.remedy,
    }
}

/// The default scene as a table: at once the defaults and the list of keys that exist.
fn defaults(name: Option<&str>) -> Table {
    let mut scene = Scene::default();
    if let Some(name) = name {
        name.clone_into(&mut scene.name);
    }
    let mut table = Table::try_from(&scene).unwrap_or_default();
    // Left out when empty, but a known key all the same.
    table
        .entry("description")
        .or_insert_with(|| Value::String(String::new()));
    if let Ok(output) = Value::try_from(&scene.output) {
        table.entry("output").or_insert(output);
    }
    if let Some(Value::Table(drive)) = table.get_mut("drive") {
        let none = || Value::Array(Vec::new());
        drive.entry("load_changes").or_insert_with(none);
    }
    table
}

fn lookup<'t>(table: &'t Table, path: &[&str]) -> Option<&'t Value> {
    let (last, tables) = path.split_last()?;
    let mut table = table;
    for key in tables {
        table = table.get(*key)?.as_table()?;
    }
    table.get(*last)
}

/// Lays `from` over `onto`: only keys that exist there, only values of their kind.
pub(super) fn overlay(
    onto: &mut Table,
    places: &mut HashMap<String, Place>,
    prefix: &str,
    from: &dyn TableLike,
    place_at: &dyn Fn(usize) -> Place,
) -> Result<(), SceneError> {
    for (name, item) in from.iter() {
        let span = from
            .get_key_value(name)
            .and_then(|(key, _)| key.span())
            .or_else(|| item.span());
        let place = place_at(span.map_or(0, |span| span.start));
        let key = format!("{prefix}{name}");
        let Some(slot) = onto.get_mut(name) else {
            let remedy = remedy_for_unknown(&key, onto, prefix);
            return Err(SceneError::Key {
                place,
                key,
                what: "is no key of a scene".to_owned(),
                remedy,
            });
        };
        if let Value::Table(inner) = slot {
            let Some(table) = item.as_table_like() else {
                let example = inner.keys().next().cloned().unwrap_or_default();
                return Err(SceneError::Key {
                    place,
                    what: format!("is {}, but must be a table", kind(item)),
                    remedy: format!("write [{key}] on its own line, then {example} = ... below it"),
                    key,
                });
            };
            overlay(inner, places, &format!("{key}."), table, place_at)?;
        } else if key == changes::KEY {
            *slot = changes::read(places, item, &place, place_at)?;
        } else {
            *slot = scalar(slot, item).map_err(|(what, remedy)| SceneError::Key {
                place: place.clone(),
                key: key.clone(),
                what,
                remedy,
            })?;
        }
        places.insert(key, place);
    }
    Ok(())
}

/// The item as a value of the same kind as `like`, or what is wrong and the remedy.
fn scalar(like: &Value, item: &Item) -> Result<Value, (String, String)> {
    let wrong = |wanted: &str, remedy: &str| {
        Err((
            format!("is {}, but must be {wanted}", kind(item)),
            remedy.to_owned(),
        ))
    };
    match like {
        Value::Float(_) => match (item.as_float(), item.as_integer()) {
            (Some(number), _) => Ok(Value::Float(number)),
            (None, Some(whole)) => Ok(Value::Float(whole as f64)),
            _ => wrong(
                "a number",
                "write it without quotes and unit, for example 0.006",
            ),
        },
        Value::Integer(_) => match item.as_integer() {
            Some(whole) if whole >= 0 => Ok(Value::Integer(whole)),
            _ => wrong(
                "a whole number, not negative",
                "write it like 16, without point or quotes",
            ),
        },
        Value::Array(_) => {
            let texts = match (item.as_array(), item.as_str()) {
                (Some(list), _) => list.iter().map(toml_edit::Value::as_str).collect(),
                // One name needs no brackets.
                (None, Some(text)) => Some(vec![text]),
                (None, None) => None,
            };
            match texts {
                Some(texts) => Ok(Value::Array(
                    texts
                        .into_iter()
                        .map(|text| Value::String(text.to_owned()))
                        .collect(),
                )),
                None => wrong("a list of texts", "write it like [\"efficiency\"]"),
            }
        }
        _ => match item.as_str() {
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

/// "did you mean" for an unknown key: the same table's keys first, then the same name elsewhere.
fn remedy_for_unknown(key: &str, siblings: &Table, prefix: &str) -> String {
    let name = key.rsplit('.').next().unwrap_or(key);
    if let Some(near) = nearest(name, siblings.keys().map(String::as_str)) {
        return format!("did you mean `{prefix}{near}`?");
    }
    let mut all = Vec::new();
    collect_keys(&defaults(None), "", &mut all);
    let leaf = |full: &'_ String| full.rsplit('.').next().unwrap_or_default().to_owned();
    let leaves: Vec<String> = all.iter().map(leaf).collect();
    if let Some(near) = nearest(name, leaves.iter().map(String::as_str))
        && let Some(full) = all
            .iter()
            .find(|full| full.rsplit('.').next() == Some(near))
    {
        return format!("did you mean `{full}`?");
    }
    let known: Vec<&str> = siblings.keys().map(String::as_str).collect();
    format!("known here: {}", known.join(", "))
}

fn collect_keys(table: &Table, prefix: &str, all: &mut Vec<String>) {
    for (name, value) in table {
        let key = format!("{prefix}{name}");
        if let Value::Table(inner) = value {
            collect_keys(inner, &format!("{key}."), all);
        }
        all.push(key);
    }
}

/// Line number of a byte offset, the first being 1.
pub(super) fn line_of(text: &str, offset: usize) -> usize {
    let offset = offset.min(text.len());
    1 + text.as_bytes()[..offset]
        .iter()
        .filter(|&&byte| byte == b'\n')
        .count()
}
