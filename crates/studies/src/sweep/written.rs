//! Evidence that a file is unchanged since it was written.

use std::path::Path;
use std::{fs, io};

use pinwheel_files::fnv;
use serde::{Deserialize, Serialize};

/// Size and hash of a file when it was written; a different size or hash indicates damage.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Written {
    bytes: u64,
    /// Hash FNV-1a, 64 bits, in hexadecimal.
    fnv: String,
}

impl Written {
    pub(super) fn of(path: &Path) -> io::Result<Self> {
        let content = fs::read(path)?;
        Ok(Self {
            bytes: content.len() as u64,
            fnv: format!("{:016x}", fnv(content)),
        })
    }
}
