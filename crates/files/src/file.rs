//! Single files: written beside their place and renamed into it, replacing only earlier files of this program.

use std::fs::{self, File};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, PersistError};

use crate::draft::{self, open_plain};
use crate::output::OutputError;

/// Largest size of a file that is checked, bytes; a larger file is foreign. A unit with a library of a debug build has 20 MB.
const MOST_BYTES: u64 = 1 << 28;

/// Predicate on a file's content: true if this program may replace it.
pub type Ours<'a> = &'a dyn Fn(&[u8]) -> bool;

/// Kind of a file's destination.
enum Place {
    /// Free place.
    Free,
    /// Earlier file of this program, with its mode.
    Earlier(fs::Permissions),
    /// Pipe or terminal, which is written directly.
    Stream,
}

/// Writes a complete file or nothing. An earlier one is replaced if it is empty or `ours`, and keeps its mode; any other file,
/// links and read-only files stay. Missing folders are created.
///
/// # Errors
/// The file cannot be written, or must stay.
pub fn replace(path: &Path, bytes: &[u8], ours: Ours<'_>) -> Result<(), OutputError> {
    replace_all(&[(path.to_owned(), bytes)], ours)
}

/// Writes related files as [`replace`] does: all are on disk before the first takes its place.
///
/// # Errors
/// Errors of [`replace`].
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
        // Only now, so that an earlier failure leaves no folder.
        fs::create_dir_all(above.unwrap_or(Path::new("."))).map_err(failed)?;
        let over = |draft: NamedTempFile, mode| {
            draft.as_file().set_permissions(mode).map_err(failed)?;
            draft.persist(path).map_err(|error| failed(error.error))
        };
        if let Place::Earlier(mode) = place {
            over(draft, mode)?;
        } else if let Err(PersistError { error, file }) = draft.persist_noclobber(path) {
            // Another process of this program may have written it meanwhile.
            match self::place(path, ours)? {
                Place::Earlier(mode) => over(file, mode)?,
                _ => return Err(failed(error)),
            };
        }
    }
    Ok(())
}

/// Checks that [`replace`] may write a file, before a long run.
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
        // `/dev/stdout` may be a link to one.
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
