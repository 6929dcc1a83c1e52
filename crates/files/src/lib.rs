//! Files: user files, read with line, key and remedy; output, written completely or not at all.
//!
//! * [`read`]: a TOML file as a serde type: maps of foreign data, manifests of solvers, the head of a sweep.
//! * [`Document`]: a TOML file with keys from a table of data instead of a type: scenes, variations of sweeps.
//! * [`FileError`]: one-line messages with remedies; [`did_you_mean`] for mistyped names.
//! * [`folder`]: outputs that take their place in one step and replace no foreign files; [`Manifest`]: their identification.
//! * [`output`]: files in them; [`mod@file`]: single files.
//! * [`Lock`]: a folder for one process at a time.

mod document;
mod draft;
mod error;
pub mod file;
mod fnv;
pub mod folder;
mod lock;
mod manifest;
pub mod output;
mod suggest;

pub use document::{Document, Entries, Item, MOST_BYTES, Node, parse, read, read_text};
pub use error::{Broken, FileError, cut, one_line, quoted, require};
pub use fnv::{Fnv, fnv};
pub use lock::Lock;
pub use manifest::{MANIFEST, Manifest};
pub use suggest::{did_you_mean, fits, nearest};
