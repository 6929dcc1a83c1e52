//! Origin of a run's numbers: a hash of all sources that its figures depend on, of the locked versions of libraries,
//! and of the compiler and machine.
//!
//! The program and the Python package, built from the same sources, know each other's runs by it; the file of the program
//! itself would tell them apart.

use std::hash::{DefaultHasher, Hasher as _};
use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// Crates that show or drive and compute nothing.
const SHOWN: [&str; 5] = ["benches", "cli", "pinwheel", "python", "report"];

fn main() -> io::Result<()> {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let root = here.join("../..");
    // A package holds copies of what the links lead to. A checkout without links (Windows) has small files instead.
    let shipped =
        Some(here.join("shipped")).filter(|shipped| shipped.join("reference/published").is_dir());
    let shipped = shipped.unwrap_or_else(|| root.clone());
    println!("cargo:rustc-env=PINWHEEL_SHIPPED={}", shipped.display());
    let mut hasher = DefaultHasher::new();
    let mut places = Vec::new();
    // A packaged crate is never changed and takes its siblings in its own version: that version says all.
    if root.join("crates/studies").is_dir() {
        places.push(root.join("Cargo.lock"));
        let engines = [
            "python/pinwheel_engines",
            "python/requirements.in",
            "solvers",
        ];
        places.extend(engines.map(|place| root.join(place)));
        for entry in fs::read_dir(root.join("crates"))? {
            let entry = entry?;
            if !SHOWN.iter().any(|name| entry.file_name() == *name) {
                places.push(entry.path().join("src"));
            }
        }
    } else {
        hasher.write(env::var("CARGO_PKG_VERSION").unwrap_or_default().as_bytes());
    }
    let mut files = Vec::new();
    for place in places {
        // A folder's own time changes when files come and go.
        println!("cargo:rerun-if-changed={}", place.display());
        walk(&place, &mut files)?;
    }
    files.sort();
    for file in &files {
        let name = file.strip_prefix(&root).unwrap_or(file);
        hasher.write(name.to_string_lossy().as_bytes());
        hasher.write(&fs::read(file)?);
    }
    let compiler = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let version = std::process::Command::new(compiler).arg("-V").output()?;
    hasher.write(&version.stdout);
    hasher.write(env::var("TARGET").unwrap_or_default().as_bytes());
    println!("cargo:rustc-env=PINWHEEL_SOURCES={:016x}", hasher.finish());
    Ok(())
}

fn walk(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if path.is_file() {
        let ending = path.extension().and_then(|ending| ending.to_str());
        if matches!(ending, Some("rs" | "py" | "cpp" | "in" | "toml" | "lock")) {
            files.push(path.to_owned());
        }
    } else if path.is_dir() {
        for entry in fs::read_dir(path)? {
            walk(&entry?.path(), files)?;
        }
    }
    Ok(())
}
