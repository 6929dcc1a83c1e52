//! Where a baseline is recorded, and what it replaces.

use std::path::{Path, PathBuf};

use super::error::BaselineError;
use super::file::{Acceptance, Baseline, HEAD, Made};

/// A baseline's folder, with what was accepted there before.
#[derive(Debug)]
pub struct Place {
    /// The folder.
    pub folder: PathBuf,
    /// What it holds.
    pub earlier: Option<Baseline>,
}

impl Place {
    /// The place of `name` below `dir`.
    ///
    /// # Errors
    /// A name that is no folder's, or a baseline there that cannot be read.
    pub fn of(dir: &Path, name: &str) -> Result<Self, BaselineError> {
        let folder = Baseline::folder(dir, name)?;
        let exists = folder.join(HEAD).is_file();
        let earlier = exists.then(|| Baseline::open(dir, name)).transpose()?;
        Ok(Self { folder, earlier })
    }

    /// Files of the earlier baseline, which a new one replaces.
    #[must_use]
    pub fn files(&self) -> Vec<String> {
        self.earlier.as_ref().map_or_else(Vec::new, Baseline::files)
    }

    /// Every acceptance with this one, oldest first.
    #[must_use]
    pub fn accepted(&self, made: &Made, reason: Option<&str>) -> Vec<Acceptance> {
        let earlier = self.earlier.as_ref();
        let mut accepted = earlier.map_or_else(Vec::new, |earlier| earlier.head.accepted.clone());
        accepted.push(Acceptance {
            date: made.date.clone(),
            commit: made.commit.clone(),
            reason: reason.unwrap_or("first record").to_owned(),
        });
        accepted
    }
}
