//! Manifest of an output folder: all files written by this program, with size and hash.
//!
//! File names prove nothing: other tools write a `summary.json`, too, and users edit output. A folder is this program's if its
//! manifest lists everything in it, and unchanged if every file has the listed size and hash.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read as _, Write as _};
use std::path::Path;

use serde::{Deserialize, Serialize};
use twox_hash::XxHash3_128;

use crate::draft::{open_plain, sync};

/// File name of the manifest.
pub const MANIFEST: &str = ".pinwheel";
const PROGRAM: &str = "pinwheel";
/// Version of the manifest's layout.
const FORMAT: u32 = 2;
/// Largest number of bytes of a manifest; one of 10 000 files has 1.5 MB.
const MOST_BYTES: u64 = 1 << 26;
/// Number of files from which a single wait for the disk is cheaper, as each file takes milliseconds.
const MANY: usize = 64;

/// Manifest of an output folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    program: String,
    format: u32,
    /// Command that wrote the folder.
    pub command: String,
    /// Scene or other subject of the results; empty if unknown.
    pub of: String,
    /// False if the command was stopped with partial results.
    pub complete: bool,
    /// Files by path below the folder, with `/` between parts; the path of an empty folder ends in `/`.
    files: BTreeMap<String, Written>,
}

/// Size and hash of a file.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Written {
    bytes: u64,
    /// XXH3 of 128 bits in hexadecimal digits; empty for a folder. It detects edits, not forgery.
    xxh3: String,
}

/// Entry of a folder that pinwheel did not leave in this form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Stranger {
    /// Entry that the manifest does not list, or of a kind that it never lists.
    Foreign(String),
    /// Listed entry with another size or hash.
    Changed(String),
}

impl Manifest {
    pub(crate) fn new(command: &str, of: &str, complete: bool) -> Self {
        Self {
            program: PROGRAM.to_owned(),
            format: FORMAT,
            command: command.to_owned(),
            of: of.to_owned(),
            complete,
            files: BTreeMap::new(),
        }
    }

    /// Reads the manifest of a folder; `None` if there is none of this program.
    pub fn of(folder: &Path) -> Option<Self> {
        let mut text = Vec::new();
        let file = open_plain(&folder.join(MANIFEST), File::options().read(true)).ok()?;
        if file.metadata().ok()?.len() > MOST_BYTES {
            return None;
        }
        file.take(MOST_BYTES).read_to_end(&mut text).ok()?;
        let read: Self = serde_json::from_slice(&text).ok()?;
        (read.program == PROGRAM && read.format == FORMAT).then_some(read)
    }

    /// Lists the folder's content, writes the manifest there, and waits until all of it is on disk.
    pub(crate) fn seal(mut self, folder: &Path) -> io::Result<()> {
        let names = below(folder)?;
        let at_once = names.len() >= MANY && sync_all(folder);
        for (name, plain) in names {
            let written = match plain {
                true => Written::of(&folder.join(&name), !at_once)?,
                false => Written::default(),
            };
            self.files.insert(name, written);
        }
        let mut text = serde_json::to_vec_pretty(&self)?;
        text.push(b'\n');
        let mut file = File::create_new(folder.join(MANIFEST))?;
        file.write_all(&text)?;
        file.sync_all()?;
        sync(folder)
    }
}

/// Returns the entry that prevents replacement of a folder: the first foreign file, or else the first changed one. Missing
/// files do not prevent it.
pub(crate) fn stranger(folder: &Path) -> io::Result<Option<Stranger>> {
    let manifest = Manifest::of(folder);
    let mut changed = None;
    for (name, plain) in below(folder)? {
        let listed = manifest.as_ref().and_then(|known| known.files.get(&name));
        match listed {
            None if manifest.is_some() && name == MANIFEST => {}
            Some(_) if name.split('/').any(|part| part == ".git") => {
                return Ok(Some(Stranger::Foreign(name)));
            }
            Some(written) if plain => {
                let now = || Written::of(&folder.join(&name), false);
                let same = changed.is_some() || now()? == *written;
                if !same {
                    changed = Some(Stranger::Changed(name));
                }
            }
            Some(_) if name.ends_with('/') => {}
            _ => return Ok(Some(Stranger::Foreign(name))),
        }
    }
    Ok(changed)
}

/// Lists everything below a folder, sorted: regular files (true), and links, pipes and empty folders (false, the last with a
/// final `/`).
fn below(folder: &Path) -> io::Result<BTreeMap<String, bool>> {
    let mut names = BTreeMap::new();
    let mut open = vec![(folder.to_owned(), String::new())];
    while let Some((place, prefix)) = open.pop() {
        let mut empty = true;
        for entry in fs::read_dir(&place)? {
            let entry = entry?;
            empty = false;
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            let kind = entry.file_type()?;
            if kind.is_dir() {
                open.push((entry.path(), format!("{name}/")));
            } else {
                names.insert(name, kind.is_file());
            }
        }
        if empty && !prefix.is_empty() {
            names.insert(prefix, false);
        }
    }
    Ok(names)
}

impl Written {
    /// Reads and hashes a regular file; waits until it is on disk if `synced`.
    fn of(path: &Path, synced: bool) -> io::Result<Self> {
        // Windows flushes only files that are open for writing.
        let write = synced && !cfg!(unix);
        let mut file = open_plain(path, File::options().read(true).write(write))?;
        let (mut bytes, mut block) = (0, vec![0; 1 << 16]);
        let mut hash = XxHash3_128::new();
        while let read @ 1.. = file.read(&mut block)? {
            hash.write(&block[..read]);
            bytes += read as u64;
        }
        if synced {
            file.sync_all()?;
        }
        let xxh3 = format!("{:032x}", hash.finish_128());
        Ok(Self { bytes, xxh3 })
    }
}

/// Waits until an entire file system is on disk; false if the system cannot do that.
fn sync_all(folder: &Path) -> bool {
    #[cfg(target_os = "linux")]
    return File::open(folder).is_ok_and(|folder| rustix::fs::syncfs(folder).is_ok());
    #[cfg(not(target_os = "linux"))]
    {
        let _ = folder;
        false
    }
}
