//! What makes a record: date, commit, program, machine.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use pinwheel_gearbox::contacts::Kernel;

use super::{Made, no_instructions};
use crate::provenance::Provenance;

/// This program, on this machine, today; the commit is that of the repository that holds `dir`.
#[must_use]
pub fn made(dir: &Path) -> Made {
    let here = Provenance::here("");
    Made {
        date: here.date,
        commit: commit(dir).unwrap_or_else(|| "unknown".to_owned()),
        version: here.version.to_owned(),
        build: here.machine.build.to_owned(),
        vectors: Kernel::Lanes.vectors().to_owned(),
        processor: here.machine.processor,
        no_instructions: no_instructions(),
    }
}

/// A repository, read as files: its configuration may name programs, which git would start.
struct Repository {
    /// Root of the sources.
    root: PathBuf,
    /// HEAD and index.
    folder: PathBuf,
    /// References and objects; another folder where `folder` is of a further working tree.
    common: PathBuf,
}

/// The commit at which the sources stand, `+changes` if they were changed since; `None` outside a repository.
fn commit(dir: &Path) -> Option<String> {
    let repository = Repository::around(dir)?;
    let head = repository.head()?;
    let short = head.get(..12)?;
    Some(if repository.is_changed(&head) == Some(false) {
        short.to_owned()
    } else {
        format!("{short}+changes")
    })
}

impl Repository {
    /// The repository that holds `dir`.
    fn around(dir: &Path) -> Option<Self> {
        let place = dir.ancestors().find(|part| part.is_dir());
        let place = fs::canonicalize(place.unwrap_or(Path::new("."))).ok()?;
        let root = place.ancestors().find(|part| part.join(".git").exists())?;
        let git = root.join(".git");
        let folder = if git.is_dir() {
            git
        } else {
            root.join(text(&git)?.strip_prefix("gitdir:")?.trim())
        };
        let common = match text(&folder.join("commondir")) {
            Some(path) => folder.join(path.trim()),
            None => folder.clone(),
        };
        Some(Self {
            root: root.to_owned(),
            folder,
            common,
        })
    }

    /// The commit of HEAD.
    fn head(&self) -> Option<String> {
        let head = text(&self.folder.join("HEAD"))?;
        let commit = match head.strip_prefix("ref:").map(str::trim) {
            None => head.trim().to_owned(),
            Some(name) if name.starts_with("refs/") && !name.contains("..") => {
                text(&self.common.join(name)).or_else(|| {
                    let packed = text(&self.common.join("packed-refs"))?;
                    let line = packed.lines().find_map(|line| line.strip_suffix(name));
                    line.map(str::to_owned)
                })?
            }
            Some(_) => return None,
        };
        let commit = commit.trim();
        let sound = commit.len() >= 40 && commit.bytes().all(|byte| byte.is_ascii_hexdigit());
        sound.then(|| commit.to_owned())
    }

    /// Whether the sources differ from the commit `head`; `None` where git does not tell.
    ///
    /// Git sees the repository's objects and a copy of its index through a folder of our own, so that neither its
    /// configuration nor its hooks and attributes count.
    fn is_changed(&self, head: &str) -> Option<bool> {
        let ours = tempfile::tempdir().ok()?;
        let folder = ours.path();
        fs::create_dir_all(folder.join("objects/info")).ok()?;
        fs::create_dir(folder.join("refs")).ok()?;
        fs::write(folder.join("HEAD"), format!("{head}\n")).ok()?;
        fs::copy(self.folder.join("index"), folder.join("index")).ok()?;
        let objects = fs::canonicalize(self.common.join("objects")).ok()?;
        let objects = format!("{}\n", objects.to_str()?);
        fs::write(folder.join("objects/info/alternates"), objects).ok()?;
        let output = Command::new("git")
            .current_dir(&self.root)
            .env("GIT_DIR", folder)
            .env("GIT_WORK_TREE", &self.root)
            .env("GIT_OPTIONAL_LOCKS", "0")
            .env_remove("GIT_INDEX_FILE")
            .env_remove("GIT_COMMON_DIR")
            .env_remove("GIT_OBJECT_DIRECTORY")
            .args([
                "-c",
                "core.fsmonitor=false",
                "-c",
                "core.hooksPath=/dev/null",
            ])
            .args(["status", "--porcelain", "--untracked-files=no"])
            // Each of those is a repository with a configuration of its own.
            .arg("--ignore-submodules=all")
            // The baselines themselves are no part of what made them.
            .args(["--", ":/crates", ":/Cargo.lock"])
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .output()
            .ok()?;
        let changed = !output.stdout.is_empty();
        output.status.success().then_some(changed)
    }
}

/// The text of a file of reasonable size; `None` for anything else, pipes included.
fn text(path: &Path) -> Option<String> {
    const LONGEST: u64 = 64 << 20;
    let data = fs::metadata(path).ok()?;
    if !data.is_file() || data.len() > LONGEST {
        return None;
    }
    fs::read_to_string(path).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn git(dir: &Path, words: &[&str]) -> String {
        let output = Command::new("git")
            .current_dir(dir)
            .args(["-c", "user.name=a", "-c", "user.email=a@b"])
            .args(words)
            .output()
            .unwrap();
        assert!(output.status.success(), "{words:?}: {output:?}");
        String::from_utf8(output.stdout).unwrap().trim().to_owned()
    }

    #[test]
    fn the_commit_is_gits_own() {
        let dir = tempfile::tempdir().unwrap();
        let root = dir.path().join("a");
        fs::create_dir_all(root.join("crates/deep")).unwrap();
        assert_eq!(commit(&root), None);
        git(&root, &["init", "-q"]);
        fs::write(root.join("crates/x"), "x").unwrap();
        git(&root, &["add", "."]);
        git(&root, &["commit", "-q", "-m", "one"]);
        let head = git(&root, &["rev-parse", "--short=12", "HEAD"]);
        let at = |place: &str| commit(&root.join(place)).unwrap();
        assert_eq!(at("crates/deep/not/there"), head);
        fs::write(root.join("crates/x"), "y").unwrap();
        assert_eq!(at("crates"), format!("{head}+changes"));
        git(&root, &["add", "."]);
        assert_eq!(at("."), format!("{head}+changes"), "in the index alone");
        git(&root, &["commit", "-q", "-m", "two"]);
        git(&root, &["pack-refs", "--all"]);
        let second = git(&root, &["rev-parse", "--short=12", "HEAD"]);
        assert_eq!(at("."), second);
        git(
            &root,
            &["worktree", "add", "-q", "--detach", "../b", "HEAD~1"],
        );
        assert_eq!(commit(&dir.path().join("b")), Some(head));
    }

    /// Of all that a repository's configuration can start, nothing is.
    #[cfg(unix)]
    #[test]
    fn regress_no_program_of_the_repository_is_run() {
        use std::os::unix::fs::PermissionsExt as _;
        let dir = tempfile::tempdir().unwrap();
        let (root, ran) = (dir.path(), dir.path().join("ran"));
        let script = root.join("evil");
        fs::write(
            &script,
            format!("#!/bin/sh\ntouch '{}'\ncat\n", ran.display()),
        )
        .unwrap();
        fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
        git(root, &["init", "-q"]);
        fs::create_dir(root.join("crates")).unwrap();
        fs::write(root.join("crates/x"), "x").unwrap();
        git(root, &["add", "."]);
        git(root, &["commit", "-q", "-m", "one"]);
        let script = script.display().to_string();
        for key in ["core.fsmonitor", "filter.evil.clean", "filter.evil.process"] {
            git(root, &["config", key, &script]);
        }
        for place in [".gitattributes", ".git/info/attributes"] {
            fs::write(root.join(place), "* filter=evil\n").unwrap();
        }
        // Of another time, so that contents are compared.
        fs::write(root.join("crates/x"), "y").unwrap();
        assert!(commit(root).unwrap().ends_with("+changes"));
        assert!(!ran.exists());
    }
}
