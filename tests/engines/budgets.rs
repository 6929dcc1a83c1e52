//! Counts with limits: lines, compiled and linked units of the tests, and doc comments without a subject.

use std::path::{Path, PathBuf};

use pinwheel_tests::repository;

use crate::loops::sources;

/// Lines of the crates without blanks, comments and tests.
const CODE: usize = 69_774;
/// Lines of all tests without blanks and comments.
const TESTS: usize = 44_118;
/// Packages of the workspace.
const PACKAGES: usize = 19;
/// Programs linked by `cargo test`: those of tests, and a library once more for each crate with tests inside.
const PROGRAMS: usize = 22;
/// Doc comments that begin with an adverb, which may omit the subject.
const ADVERBIAL: usize = 20;

/// Returns the names of the folders of crates that fulfil a condition.
fn crates(holds: impl Fn(&Path) -> bool) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(repository("crates")).expect("crates");
    let places = entries.map(|entry| entry.expect("an entry").path());
    places.filter(|place| holds(place)).collect()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    if folder.is_dir() {
        sources(folder, &mut files);
    }
    files
}

/// Returns lines without blanks and comments: of the code, and of the tests inside.
fn lines(file: &Path) -> [usize; 2] {
    let text = std::fs::read_to_string(file).expect("text");
    let marks = ["mod tests {", "pub(crate) mod tests {"];
    let inside = marks.map(|mark| text.find(&format!("#[cfg(test)]\n{mark}")));
    let inside = inside.into_iter().flatten().next().unwrap_or(text.len());
    let (code, tests) = match file.ends_with("tests.rs") {
        true => ("", text.as_str()),
        false => text.split_at(inside),
    };
    let count = |text: &str| {
        let lines = text.lines().map(str::trim);
        lines
            .filter(|line| !line.is_empty() && !line.starts_with("//"))
            .count()
    };
    [count(code), count(tests)]
}

fn manifest(place: &Path) -> toml::Table {
    let text = std::fs::read_to_string(place.join("Cargo.toml")).expect("a manifest");
    text.parse().expect("TOML")
}

/// Returns the number of programs for the tests of a package.
fn programs(place: &Path) -> usize {
    let manifest = manifest(place);
    let listed = manifest.get("test").and_then(toml::Value::as_array);
    let library = manifest
        .get("lib")
        .and_then(|lib| lib.get("test")?.as_bool());
    let own = std::fs::read_dir(place.join("tests"))
        .into_iter()
        .flatten()
        .flatten();
    let own = own.filter(|entry| {
        let path = entry.path();
        path.join("main.rs").is_file() || path.extension().is_some_and(|end| end == "rs")
    });
    let is_library = place.join("src/lib.rs").is_file() || place.join("lib.rs").is_file();
    listed.map_or_else(|| own.count(), Vec::len) + usize::from(is_library && library != Some(false))
}

/// Returns doc comments of the crates that begin with one of some words.
fn beginning(words: &[&str]) -> Vec<String> {
    let mut list = Vec::new();
    for file in crates(|_| true)
        .iter()
        .flat_map(|place| files(&place.join("src")))
    {
        let text = std::fs::read_to_string(&file).expect("text");
        let mut inside = false;
        for (number, line) in text.lines().enumerate() {
            let line = line.trim_start();
            let comment = line.strip_prefix("/// ").or(line.strip_prefix("//! "));
            let begins = comment.filter(|_| !inside).is_some_and(|comment| {
                let rest = words.iter().find_map(|word| comment.strip_prefix(word));
                rest.is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
            });
            inside = comment.is_some();
            if begins {
                list.push(format!("{}:{}: {line}", file.display(), number + 1));
            }
        }
    }
    list
}

#[test]
fn regress_lines_and_links_only_fall() {
    let counted = crates(|place| !place.ends_with("benches"));
    let of_crates = counted.iter().flat_map(|place| files(&place.join("src")));
    let [mut code, mut tests] = [0, 0];
    for [outside, inside] in of_crates.map(|file| lines(&file)) {
        code += outside;
        tests += inside;
    }
    let folders = counted.iter().map(|place| place.join("tests"));
    let folders = folders.chain([repository("tests")]);
    let of_tests = folders.flat_map(|folder| files(&folder));
    tests += of_tests
        .map(|file| lines(&file).iter().sum::<usize>())
        .sum::<usize>();
    let mut packages = crates(|place| place.join("Cargo.toml").is_file());
    packages.extend(["tests", "fuzz"].map(repository));
    let linked: usize = packages.iter().map(|place| programs(place)).sum();
    let counts = [
        ("lines of code", code, CODE),
        ("lines of tests", tests, TESTS),
        ("packages", packages.len(), PACKAGES),
        ("programs of tests", linked, PROGRAMS),
    ];
    println!("{counts:?}");
    for (what, count, limit) in counts {
        assert!(count <= limit, "{count} {what}, {limit} at most");
    }
}

#[test]
fn regress_doc_comments_name_their_subject() {
    let nameless = beginning(&["The same", "Those", "What", "Whether", "Of"]);
    assert!(nameless.is_empty(), "{}", nameless.join("\n"));
    let adverbial = beginning(&["How", "Where", "That", "As", "By", "In"]);
    let count = adverbial.len();
    assert!(count <= ADVERBIAL, "{count}: {}", adverbial.join("\n"));
}
