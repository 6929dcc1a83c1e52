//! TOML files that users write.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use serde::de::{DeserializeOwned, IntoDeserializer as _};
use serde_path_to_error::{Path as KeyPath, Segment};
use toml::de::{DeTable, DeValue, Error};
use toml::{Spanned, Value};

use crate::error::{FileError, quoted};
use crate::suggest::did_you_mean;

/// Largest number of bytes of a file; a full scene with comments has about 5000.
pub const MOST_BYTES: usize = 1 << 20;

/// Reads the text of a file; `remedy` names the required kind of file.
///
/// # Errors
/// The file cannot be read, is too long, or is no text.
pub fn read_text(path: &Path, remedy: &str) -> Result<String, FileError> {
    let name = path.display().to_string();
    let unreadable = |error| FileError::new(&name, format!("cannot be read: {error}"), remedy);
    // The size is not queried in advance: a pipe or a device has none and may never end.
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    let mut file = file.take(MOST_BYTES as u64 + 1);
    file.read_to_end(&mut bytes).map_err(unreadable)?;
    too_long(bytes.len(), &name, remedy)?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        FileError::new(&name, "not UTF-8 text", "save it as UTF-8").in_line(line_of(valid))
    })
}

fn too_long(bytes: usize, name: &str, remedy: &str) -> Result<(), FileError> {
    if bytes > MOST_BYTES {
        let what = format!("longer than {MOST_BYTES} bytes");
        return Err(FileError::new(name, what, remedy));
    }
    Ok(())
}

/// Returns the line number after `head`, from 1.
fn line_of(head: &[u8]) -> usize {
    1 + head.iter().filter(|&&byte| byte == b'\n').count()
}

/// Reads TOML that a program wrote or that is embedded, without places for faults. It passes through a [`Value`], so that only one
/// deserialiser of each type is compiled.
///
/// # Errors
/// First fault.
pub fn parse<T: DeserializeOwned>(text: &str) -> Result<T, Error> {
    toml::from_str::<Value>(text)?.try_into()
}

/// Deserializes a TOML text; `file` is its name in messages, `remedy` the place of an example.
///
/// # Errors
/// First fault with line and key, and a suggestion for a mistyped name.
pub fn read<T: DeserializeOwned>(text: &str, file: &str, remedy: &str) -> Result<T, FileError> {
    let document = Document::parse(text, file, remedy)?;
    let root = Item {
        line: 1,
        text,
        node: Node::Table(document.root),
    };
    let value = root.node.value();
    serde_path_to_error::deserialize(value).map_err(|error| {
        let key = error.path().to_string();
        let line = root.at(error.path()).line;
        misread(&key, error.inner().message(), file, remedy).in_line(line)
    })
}

/// Returns the fault of a text that is not TOML.
fn broken(error: &Error, text: &str, file: &str, remedy: &str) -> FileError {
    let at = error.span().map_or(0, |span| span.start).min(text.len());
    let what = format!("not valid TOML: {}", error.message().trim());
    let begin = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let line = text[begin..].lines().next().unwrap_or_default();
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    let remedy = if !value.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
        remedy.to_owned()
    } else if value.contains(',') {
        let number = value.split('#').next().unwrap_or_default();
        let point = number.trim().replacen(',', ".", 1);
        match point.strip_suffix('.') {
            Some(number) => format!("leave the comma out: {number}"),
            None => format!("write a decimal point: {point}"),
        }
    } else {
        "write the number alone: its unit is the one that ends the key".to_owned()
    };
    FileError::new(file, what, remedy).in_line(line_of(&text.as_bytes()[..at]))
}

/// Returns the fault of a value that a type refuses, from serde's message.
fn misread(key: &str, message: &str, file: &str, remedy: &str) -> FileError {
    let mut names = message.split('`').skip(1).step_by(2);
    let first = names.next();
    let (what, remedy) = match first.filter(|_| message.starts_with("unknown ")) {
        Some(typed) => {
            let what = match message.starts_with("unknown field") {
                true => format!("`{key}` is no key here"),
                false => format!("`{key}` cannot be {}", quoted(typed)),
            };
            (what, did_you_mean(typed, &names.collect::<Vec<_>>()))
        }
        None if key == "." => (message.trim().to_owned(), remedy.to_owned()),
        None => (format!("`{key}`: {}", message.trim()), remedy.to_owned()),
    };
    FileError::new(file, what, remedy)
}

/// Keys of a table with their items, in the order of the file.
pub type Entries<'t> = Vec<(String, Item<'t>)>;

/// Parsed TOML text: each value with the line of its key.
#[derive(Debug, Clone)]
pub struct Document<'t> {
    /// Name of the file in messages.
    pub file: &'t str,
    /// Top-level table.
    pub root: Entries<'t>,
}

/// Value at a key, with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Item<'t> {
    /// Line of the key, from 1.
    pub line: usize,
    /// Text of the value in the file.
    pub text: &'t str,
    /// Parsed value.
    pub node: Node<'t>,
}

/// Parsed value of an item.
#[derive(Debug, Clone, PartialEq)]
pub enum Node<'t> {
    /// Table of items.
    Table(Entries<'t>),
    /// List; each value has its own line and text.
    List(Vec<Item<'t>>),
    /// Value that is neither a table nor a list.
    Plain(Value),
}

impl<'t> Document<'t> {
    /// Parses a text; `file` and `remedy` as for [`read`].
    ///
    /// # Errors
    /// The text is too long, or not TOML.
    pub fn parse(text: &'t str, file: &'t str, remedy: &str) -> Result<Self, FileError> {
        too_long(text.len(), file, remedy)?;
        // Counted once, because a file may have many values on many lines.
        let lines: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
        let root = DeTable::parse(text).and_then(|root| entries(text, &lines, root.into_inner()));
        let root = root.map_err(|error| broken(&error, text, file, remedy))?;
        Ok(Self { file, root })
    }

    /// Returns the item at a top-level key.
    pub fn get(&self, key: &str) -> Option<&Item<'t>> {
        let entry = self.root.iter().find(|(name, _)| name == key);
        entry.map(|(_, item)| item)
    }

    /// Returns a fault in a line.
    pub fn fault(
        &self,
        line: usize,
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) -> FileError {
        FileError::new(self.file, what, remedy).in_line(line)
    }

    /// Deserializes an item; `key` is its full name, `remedy` its correct form.
    ///
    /// # Errors
    /// Errors of [`read`].
    pub fn read<T: DeserializeOwned>(
        &self,
        key: &str,
        item: &Item<'_>,
        remedy: &str,
    ) -> Result<T, FileError> {
        serde_path_to_error::deserialize(item.node.value()).map_err(|error| {
            let key = match error.path().to_string().as_str() {
                "." => key.to_owned(),
                inner => format!("{key}.{inner}"),
            };
            misread(&key, error.inner().message(), self.file, remedy).in_line(item.line)
        })
    }
}

impl Item<'_> {
    /// Returns the innermost item on a path.
    fn at(&self, path: &KeyPath) -> &Self {
        path.iter().fold(self, |item, segment| {
            let inner = match (segment, &item.node) {
                (Segment::Map { key }, Node::Table(entries)) => {
                    let entry = entries.iter().find(|(name, _)| name == key);
                    entry.map(|(_, item)| item)
                }
                (Segment::Seq { index }, Node::List(list)) => list.get(*index),
                _ => None,
            };
            inner.unwrap_or(item)
        })
    }
}

impl<'t> Node<'t> {
    /// Returns the keys, if the value is a table.
    pub fn as_table(&self) -> Option<&Entries<'t>> {
        match self {
            Self::Table(entries) => Some(entries),
            _ => None,
        }
    }

    /// Returns the tables, if the value is a list of tables.
    pub fn as_tables(&self) -> Option<Vec<&Entries<'t>>> {
        match self {
            Self::List(list) => list.iter().map(|item| item.node.as_table()).collect(),
            _ => None,
        }
    }

    /// Returns the value without places.
    pub fn value(&self) -> Value {
        match self {
            Self::Table(entries) => {
                let entries = entries.iter();
                let values = entries.map(|(key, item)| (key.clone(), item.node.value()));
                Value::Table(values.collect())
            }
            Self::List(list) => Value::Array(list.iter().map(|item| item.node.value()).collect()),
            Self::Plain(value) => value.clone(),
        }
    }

    /// Describes the kind of the node, or its value.
    pub fn words(&self) -> String {
        match self {
            Self::Table(_) => "a table".to_owned(),
            Self::List(list) if list.iter().any(|item| item.node.as_table().is_some()) => {
                "a list of tables ([[...]])".to_owned()
            }
            Self::List(_) => "a list".to_owned(),
            Self::Plain(Value::String(text)) => format!("the text {}", quoted(text)),
            Self::Plain(Value::Float(number)) => number.to_string(),
            Self::Plain(Value::Datetime(_)) => "a date".to_owned(),
            Self::Plain(value) => value.to_string(),
        }
    }
}

fn entries<'t>(text: &'t str, lines: &[usize], table: DeTable<'t>) -> Result<Entries<'t>, Error> {
    let mut entries = Vec::with_capacity(table.len());
    for (key, value) in table {
        let at = key.span().start;
        let name = key.into_inner().into_owned();
        entries.push((at, name, item(text, lines, at, value)?));
    }
    entries.sort_by_key(|(at, ..)| *at);
    let sorted = entries.into_iter().map(|(_, key, item)| (key, item));
    Ok(sorted.collect())
}

/// Builds the item at the byte range `at` of the text.
fn item<'t>(
    text: &'t str,
    lines: &[usize],
    at: usize,
    value: Spanned<DeValue<'t>>,
) -> Result<Item<'t>, Error> {
    let span = value.span();
    let own = text.get(span.clone()).unwrap_or_default();
    let node = match value.into_inner() {
        DeValue::Table(table) => Node::Table(entries(text, lines, table)?),
        DeValue::Array(list) => {
            let each = list.into_iter();
            let each = each.map(|value| item(text, lines, value.span().start, value));
            Node::List(each.collect::<Result<_, _>>()?)
        }
        plain => {
            let value = Spanned::new(span, plain).into_deserializer();
            Node::Plain(serde::Deserialize::deserialize(value)?)
        }
    };
    Ok(Item {
        line: 1 + lines.partition_point(|&end| end < at),
        text: own,
        node,
    })
}
