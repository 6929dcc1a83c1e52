//! Embeds the Python package and the recorded time series; with `crossval`, locates the Python to embed.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    // Packages have copies of the links' targets. A checkout without links (Windows) has small files instead.
    let root =
        Some(here.join("shipped")).filter(|shipped| shipped.join("reference/recorded").is_dir());
    let root = root.unwrap_or_else(|| here.join("../.."));
    println!("cargo:rustc-env=PINWHEEL_SHIPPED={}", root.display());
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    embed(
        &root.join("reference/recorded"),
        &["toml", "csv"],
        &out.join("recorded.rs"),
    )?;
    #[cfg(feature = "crossval")]
    {
        embed(
            &root.join("python/pinwheel_engines"),
            &["py", "typed"],
            &out.join("sources.rs"),
        )?;
        python::find();
    }
    Ok(())
}

/// Writes a list of (path below `folder`, text) of all files with one of the `endings`.
fn embed(folder: &Path, endings: &[&str], list: &Path) -> io::Result<()> {
    println!("cargo:rerun-if-changed={}", folder.display());
    let mut files = Vec::new();
    walk(folder, endings, &mut files)?;
    files.sort();
    let mut text = String::from("&[\n");
    for file in &files {
        let name: Vec<String> = file
            .strip_prefix(folder)
            .unwrap_or(file)
            .iter()
            .map(|part| part.to_string_lossy().into_owned())
            .collect();
        let file = fs::canonicalize(file)?;
        let _ = writeln!(text, "    ({:?}, include_str!({file:?})),", name.join("/"));
    }
    text.push_str("]\n");
    fs::write(list, text)
}

fn walk(folder: &Path, endings: &[&str], files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let ending = path.extension().and_then(|ending| ending.to_str());
        if path.is_dir() {
            walk(&path, endings, files)?;
        } else if ending.is_some_and(|ending| endings.contains(&ending)) {
            files.push(path);
        }
    }
    Ok(())
}

#[cfg(feature = "crossval")]
mod python {
    /// Oldest Python supported by the pinned packages.
    const OLDEST: (u8, u8) = (3, 11);

    /// Links the embedded interpreter so that it is located at run time, and checks its version.
    ///
    /// # Panics
    /// Message with the remedy, the usual error of a build script, if Python is too old or has no shared library.
    pub(super) fn find() {
        println!("cargo:rerun-if-env-changed=PYO3_PYTHON");
        let config = pyo3_build_config::get();
        let (major, minor) = (config.version().major, config.version().minor);
        let remedy =
            "name another with PYO3_PYTHON=/path/to/python3, or build without --features crossval";
        assert!(
            (major, minor) >= OLDEST,
            "feature crossval needs Python {}.{} or newer, found {major}.{minor}; {remedy}",
            OLDEST.0,
            OLDEST.1
        );
        assert!(
            config.shared(),
            "feature crossval needs a Python with a shared library (configured with --enable-shared), and {} has none; {remedy}",
            config.executable().unwrap_or("the one found")
        );
        println!(
            "cargo:rustc-env=PINWHEEL_PYTHON_AT_BUILD={}",
            config.executable().unwrap_or_default()
        );
        pyo3_build_config::add_libpython_rpath_link_args();
    }
}
