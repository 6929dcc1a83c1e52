//! Layers of docs/architecture.md: permitted dependencies of each crate, and words reserved for one file.

use std::path::{Path, PathBuf};

use pinwheel_tests::repository;

use crate::loops::{code, sources};

/// Crates in the direction of data: each uses only earlier ones.
const ORDER: [&str; 16] = [
    "faults",
    "files",
    "timeseries",
    "mbs",
    "contact",
    "scene",
    "gearbox",
    "law",
    "fmu",
    "compare",
    "engines",
    "studies",
    "report",
    "pinwheel",
    "cli",
    "python",
];

/// Crates, words that their sources must not contain, the only file that may, and the reason.
const LEFT_TO_OTHERS: [(&[&str], &[&str], &str, &str); 3] = [
    (
        &["scene"],
        &["pinwheel_gearbox", "OdeSystem", "Mechanism"],
        "",
        "a scene is a file and moves nothing",
    ),
    (
        &["report"],
        &["Control", "Gearbox", "run_compiled", "pinwheel_mbs"],
        "",
        "a page shows what a study computed",
    ),
    (
        &["engines", "studies", "report", "cli"],
        &[
            "Native::new",
            "rapier::engine",
            "python::engine",
            "solvers::engine",
        ],
        "engines/src/registry.rs",
        "only the registry makes engines by their names",
    ),
];

/// Returns the crates of this repository among a crate's dependencies.
fn used(name: &str) -> Vec<String> {
    let manifest = repository("crates").join(name).join("Cargo.toml");
    let text = std::fs::read_to_string(manifest).expect("a manifest");
    let manifest: toml::Table = text.parse().expect("TOML");
    let dependencies = manifest.get("dependencies").and_then(|of| of.as_table());
    let names = dependencies.into_iter().flat_map(toml::Table::keys);
    let own = names.filter(|key| key.starts_with("pinwheel"));
    own.map(|key| key.trim_start_matches("pinwheel-").to_owned())
        .collect()
}

/// Returns the sources of a crate that contain a separate word.
fn holding(name: &str, word: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    sources(&repository("crates").join(name).join("src"), &mut files);
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let holds = |file: &PathBuf| {
        let text = code(file);
        let mut places = text.match_indices(word);
        places.any(|(at, _)| {
            !text[..at].ends_with(is_part) && !text[at + word.len()..].starts_with(is_part)
        })
    };
    files.retain(holds);
    files
}

#[test]
fn regress_no_crate_uses_a_later_one() {
    let place = |name: &str| ORDER.iter().position(|one| *one == name);
    for name in ORDER {
        for other in used(name) {
            assert!(place(&other) < place(name), "{name} uses {other}");
        }
    }
}

#[test]
fn regress_layers_leave_to_others_what_is_theirs() {
    for (crates, words, but, why) in LEFT_TO_OTHERS {
        for name in crates {
            for word in words {
                let holders = holding(name, word).into_iter();
                let holders: Vec<PathBuf> = holders
                    .filter(|file| but.is_empty() || !file.ends_with(Path::new(but)))
                    .collect();
                assert!(holders.is_empty(), "{why}, but {word} is in {holders:?}");
            }
        }
    }
    // A word in no file would forbid nothing.
    assert_eq!(holding("engines", "Native::new").len(), 1);
}
