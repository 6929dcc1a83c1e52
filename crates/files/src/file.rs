//! Single files: written beside their place and renamed into it, over nothing but earlier ones of ours.

use std::fs::{self, File};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, PersistError};

use crate::draft::{self, open_plain};
use crate::output::OutputError;

/// Most bytes of a file that is checked; a larger file is not ours. A unit with a library of a debug build has 20 MB.
const MOST_BYTES: u64 = 1 << 28;

/// Says of a file's content that it is ours to replace.
pub type Ours<'a> = &'a dyn Fn(&[u8]) -> bool;

/// Kind of place that a file goes to.
enum Place {
    /// Nothing is there.
    Free,
    /// An earlier file of ours, with its mode.
    Earlier(fs::Permissions),
    /// A pipe or a terminal, which is written to.
    Stream,
}

/// Writes a file: all of it or nothing. An earlier one is replaced if it is empty or `ours`, and keeps its mode; any other stays,
/// and so do links and files that may only be read. Folders above it are made.
///
/// # Errors
/// The file cannot be written, or must stay.
pub fn replace(path: &Path, bytes: &[u8], ours: Ours<'_>) -> Result<(), OutputError> {
    replace_all(&[(path.to_owned(), bytes)], ours)
}

/// Writes files that belong together, as [`replace`] does: all are on the disk before the first takes its place.
///
/// # Errors
/// As of [`replace`].
pub fn replace_all(
    files: &[(PathBuf, impl AsRef<[u8]>)],
    ours: Ours<'_>,
) -> Result<(), OutputError> {
    let mut drafts = Vec::new();
    for (path, bytes) in files {
        let failed = |error: io::Error| OutputError::new(path, &error);
        let place = place(path, ours)?;
        if matches!(place, Place::Stream) {
            fs::write(path, bytes).map_err(failed)?;
            continue;
        }
        let mut draft = draft::file(path).map_err(failed)?;
        let file = draft.as_file_mut();
        file.write_all(bytes.as_ref()).map_err(failed)?;
        file.sync_all().map_err(failed)?;
        drafts.push((draft, path, place));
    }
    for (draft, path, place) in drafts {
        let failed = |error: io::Error| OutputError::new(path, &error);
        let above = path.parent().filter(|above| !above.as_os_str().is_empty());
        // Only now: a failure before leaves no folder.
        fs::create_dir_all(above.unwrap_or(Path::new("."))).map_err(failed)?;
        let over = |draft: NamedTempFile, mode| {
            draft.as_file().set_permissions(mode).map_err(failed)?;
            draft.persist(path).map_err(|error| failed(error.error))
        };
        if let Place::Earlier(mode) = place {
            over(draft, mode)?;
        } else if let Err(PersistError { error, file }) = draft.persist_noclobber(path) {
            // Another one of ours may have come meanwhile.
            match self::place(path, ours)? {
                Place::Earlier(mode) => over(file, mode)?,
                _ => return Err(failed(error)),
            };
        }
    }
    Ok(())
}

/// Checks that [`replace`] may write a file, before anything long is run.
///
/// # Errors
/// The file cannot be written, or must stay.
pub fn check(path: &Path, ours: Ours<'_>) -> Result<(), OutputError> {
    if !matches!(place(path, ours)?, Place::Stream) {
        draft::file(path).map_err(|error| OutputError::new(path, &error))?;
    }
    Ok(())
}

fn place(path: &Path, ours: Ours<'_>) -> Result<Place, OutputError> {
    let failed = |error: io::Error| OutputError::new(path, &error);
    let refused = |reason: &str| Err(OutputError::new(path, &reason));
    let at = match fs::symlink_metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Place::Free),
        Err(error) => return Err(failed(error)),
        Ok(at) => at,
    };
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        // `/dev/stdout` is a link to one.
        let kind = fs::metadata(path).map_err(failed)?.file_type();
        if kind.is_fifo() || kind.is_char_device() {
            return Ok(Place::Stream);
        }
    }
    if at.is_symlink() {
        return refused("it is a link, which is not followed");
    }
    if !at.is_file() {
        return refused("it is no plain file");
    }
    let mut mode = at.permissions();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        mode = fs::Permissions::from_mode(mode.mode() & 0o777);
        if rustix::fs::access(path, rustix::fs::Access::WRITE_OK).is_err() {
            return refused("it may only be read");
        }
    }
    if mode.readonly() {
        return refused("it may only be read");
    }
    let mut content = Vec::new();
    let file = open_plain(path, File::options().read(true)).map_err(failed)?;
    let mut file = file.take(MOST_BYTES);
    if at.len() <= MOST_BYTES {
        file.read_to_end(&mut content).map_err(failed)?;
    }
    if at.len() > 0 && !ours(&content) {
        return refused("the file that is there is not one that this command wrote");
    }
    Ok(Place::Earlier(mode))
}
