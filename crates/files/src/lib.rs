//! Files: what users write, read with line, key and remedy; what the program writes, whole or not at all.
//!
//! * [`read`]: a TOML file as a type of serde: maps of foreign data, manifests of solvers, the head of a sweep.
//! * [`Document`]: a TOML file whose keys are in a table of data and not in a type: scenes, and what sweeps vary.
//! * [`FileError`]: what is wrong, on one line, with its remedy; [`did_you_mean`] for mistyped names.
//! * [`folder`]: outputs that take their place in one step and replace nothing of others; [`Manifest`]: how they are known.
//! * [`output`]: the files in them; [`mod@file`]: a file by itself.
//! * [`Lock`]: a folder that one process at a time writes.

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

pub use document::{Document, Entries, Item, MOST_BYTES, Node, read, read_text};
pub use error::{Broken, FileError, cut, one_line, quoted, require};
pub use fnv::{Fnv, fnv};
pub use lock::Lock;
pub use manifest::{MANIFEST, Manifest};
pub use suggest::{did_you_mean, fits, nearest};
