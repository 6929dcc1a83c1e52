//! Checks of every built-in crate: origin, licence, and no duplicate versions except those in `deny.toml`. `cargo deny
//! check` reads the same file and also checks advisories; these checks need no tool. Also the version of this project,
//! which must be equal everywhere.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use pinwheel_tests::repository;
use toml::Table;

/// Built-in crate.
struct Package {
    name: String,
    version: String,
    /// True if the crate is from neither the public index nor this repository.
    elsewhere: bool,
    licence: String,
}

/// Returns the lines of `cargo tree` on a build, a crate a line in the given format; its message if it fails.
fn tree(of: &[&str], format: &str) -> Result<BTreeSet<String>, String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut command = Command::new(&cargo);
    command.current_dir(repository("."));
    command.args(["tree", "--locked", "--edges", "normal,build"]);
    command
        .args(["--prefix", "none", "--format", format])
        .args(of);
    let output = command.output().expect("cargo runs");
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let lines = String::from_utf8_lossy(&output.stdout).into_owned();
    let lines = lines.lines().map(|line| line.trim_end_matches(" (*)"));
    Ok(lines.map(str::to_owned).collect())
}

/// Returns the packages of a build on this kind of machine, with all features whose crates are available.
fn packages() -> Vec<Package> {
    let of = |features| tree(&["--workspace", features], "{p}|{l}");
    let lines = of("--all-features").or_else(|_| of("--offline"));
    let lines = lines.unwrap_or_else(|error| panic!("cargo tree fails: {error}"));
    lines.iter().filter_map(|line| package(line)).collect()
}

/// The wheel has the program inside the module: no package is compiled twice, with other features.
#[test]
fn nothing_of_the_wheel_is_compiled_twice() {
    let lines = tree(&["-p", "pinwheel-python"], "{p}|{f}");
    let lines = lines.unwrap_or_else(|error| panic!("cargo tree fails: {error}"));
    let mut features: BTreeMap<&str, &str> = BTreeMap::new();
    for (package, own) in lines.iter().filter_map(|line| line.split_once('|')) {
        let before = features.insert(package, own).unwrap_or(own);
        assert_eq!(before, own, "{package}");
    }
    let is_there = |name: &str| features.keys().any(|package| package.starts_with(name));
    assert!(is_there("pinwheel-cli v") && is_there("pinwheel-engines v"));
}

/// Parses `name v1.2.3 (where from)|licence`; a folder and `proc-macro` are in brackets too.
fn package(line: &str) -> Option<Package> {
    let (what, licence) = line.split_once('|')?;
    let mut words = what.splitn(3, ' ');
    let (name, version) = (words.next()?, words.next()?.strip_prefix('v')?);
    Some(Package {
        name: name.to_owned(),
        version: version.to_owned(),
        elsewhere: words
            .next()
            .is_some_and(|rest| rest.contains("://") || rest.contains("registry")),
        licence: licence.to_owned(),
    })
}

/// True if the allowed licences satisfy an SPDX expression (or the older `A/B`).
fn satisfied(expression: &str, allowed: &dyn Fn(&str) -> bool) -> bool {
    let spaced = expression
        .replace('(', " ( ")
        .replace(')', " ) ")
        .replace('/', " OR ")
        .replace(" WITH ", "+WITH+");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut at = 0;
    any(&words, &mut at, allowed) && at == words.len()
}

fn any(words: &[&str], at: &mut usize, allowed: &dyn Fn(&str) -> bool) -> bool {
    let mut accepted = all(words, at, allowed);
    while words.get(*at) == Some(&"OR") {
        *at += 1;
        accepted |= all(words, at, allowed);
    }
    accepted
}

fn all(words: &[&str], at: &mut usize, allowed: &dyn Fn(&str) -> bool) -> bool {
    let mut accepted = one(words, at, allowed);
    while words.get(*at) == Some(&"AND") {
        *at += 1;
        accepted &= one(words, at, allowed);
    }
    accepted
}

fn one(words: &[&str], at: &mut usize, allowed: &dyn Fn(&str) -> bool) -> bool {
    let Some(word) = words.get(*at) else {
        return false;
    };
    *at += 1;
    if *word == "(" {
        let accepted = any(words, at, allowed);
        let closed = words.get(*at) == Some(&")");
        *at += 1;
        return accepted && closed;
    }
    allowed(&word.replace("+WITH+", " WITH "))
}

fn strings(value: Option<&toml::Value>) -> Vec<String> {
    let list = value.and_then(toml::Value::as_array).into_iter().flatten();
    list.filter_map(|text| Some(text.as_str()?.to_owned()))
        .collect()
}

#[test]
fn regress_dependencies_are_those_that_were_judged() {
    let rules: Table = std::fs::read_to_string(repository("deny.toml"))
        .unwrap()
        .parse()
        .unwrap();
    let licences = rules["licenses"].as_table().unwrap();
    let everywhere = strings(licences.get("allow"));
    let list = |value: &toml::Value, key: &str| -> Vec<Table> {
        let entries = value
            .get(key)
            .and_then(toml::Value::as_array)
            .cloned()
            .unwrap_or_default();
        entries
            .into_iter()
            .filter_map(|entry| entry.as_table().cloned())
            .collect()
    };
    let exceptions = list(&rules["licenses"], "exceptions");
    let skipped = list(&rules["bans"], "skip");
    assert!(skipped.iter().all(|entry| entry.contains_key("reason")));
    let packages = packages();
    assert!(packages.len() > 50, "{}", packages.len());
    let mut faults = Vec::new();
    let mut versions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in packages {
        let Package {
            name,
            version,
            elsewhere,
            licence,
        } = package;
        if elsewhere {
            faults.push(format!("{name} does not come from the public index"));
        }
        let named = exceptions
            .iter()
            .filter(|entry| entry["crate"].as_str() == Some(&name));
        let named: Vec<String> = named
            .flat_map(|entry| strings(entry.get("allow")))
            .collect();
        let allowed = |id: &str| everywhere.iter().chain(&named).any(|known| known == id);
        if !satisfied(&licence, &allowed) {
            faults.push(format!("{name} {version}: licence `{licence}`"));
        }
        let known = skipped
            .iter()
            .filter_map(|entry| entry["crate"].as_str()?.split_once('@'));
        let mut known = known.filter(|(of, _)| *of == name);
        if !known.any(|(_, begin)| version.starts_with(&format!("{begin}."))) {
            versions.entry(name).or_default().push(version);
        }
    }
    let twice = versions.iter().filter(|(_, versions)| versions.len() > 1);
    faults.extend(
        twice.map(|(name, versions)| format!("{name} in versions {}", versions.join(", "))),
    );
    assert!(
        faults.is_empty(),
        "deny.toml says nothing of\n{}",
        faults.join("\n")
    );
}

#[test]
fn licences_are_read_as_they_are_meant() {
    let allowed = |id: &str| ["MIT", "Zlib", "Apache-2.0 WITH LLVM-exception"].contains(&id);
    for (expression, wanted) in [
        ("MIT", true),
        ("GPL-3.0", false),
        ("GPL-3.0 OR MIT", true),
        ("GPL-3.0/MIT", true),
        ("GPL-3.0 AND MIT", false),
        ("(GPL-3.0 OR Zlib) AND MIT", true),
        ("MIT OR GPL-3.0 AND LGPL-3.0", true),
        ("Apache-2.0 WITH LLVM-exception", true),
        ("Apache-2.0", false),
        ("(MIT", false),
        ("", false),
    ] {
        assert_eq!(satisfied(expression, &allowed), wanted, "{expression}");
    }
}

/// `cargo run` is the first command of a newcomer; it fails if several packages have programs and none is the default.
#[test]
fn regress_cargo_run_is_the_program() {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut command = Command::new(cargo);
    let what = ["metadata", "--no-deps", "--offline", "--locked"];
    command
        .current_dir(repository("."))
        .args(what)
        .args(["--format-version", "1"]);
    let output = command.output().expect("cargo runs");
    assert!(output.status.success(), "cargo metadata fails");
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let built = metadata["workspace_default_members"]
        .as_array()
        .expect("members");
    let packages = metadata["packages"].as_array().expect("packages");
    let to_run: Vec<_> = packages
        .iter()
        .filter(|package| built.contains(&package["id"]))
        .filter_map(|package| package["default_run"].as_str())
        .collect();
    assert_eq!(to_run, ["pinwheel"]);
}

#[test]
fn the_version_moves_everywhere_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let files = [
        "Cargo.toml",
        "Cargo.lock",
        "CHANGELOG.md",
        "CITATION.cff",
        "python/pyproject.toml",
        "tools/version",
    ];
    for file in files {
        let to = folder.path().join(file);
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(repository(file), to).unwrap();
    }
    let python = std::env::var_os("PYO3_PYTHON").unwrap_or_else(|| "python3".into());
    let version = |arguments: &[&str]| {
        let mut command = Command::new(&python);
        command
            .arg(folder.path().join("tools/version"))
            .args(arguments);
        let output = command.output().expect("Python");
        let printed = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        output.status.success().then_some(printed)
    };
    let text = |file: &str| std::fs::read_to_string(folder.path().join(file)).unwrap();
    assert_eq!(version(&[]).as_deref(), Some(env!("CARGO_PKG_VERSION")));
    assert_eq!(version(&["9.8"]), None);
    assert_eq!(version(&["9.8.7", "2031-02-03"]).as_deref(), Some("9.8.7"));
    assert!(text("CITATION.cff").contains("version: 9.8.7\ndate-released: 2031-02-03\n"));
    assert!(text("CHANGELOG.md").contains("## Unreleased\n\n## 9.8.7 (2031-02-03)\n"));
    // The check reports an outdated version.
    let project = text("python/pyproject.toml").replace("\"9.8.7\"", "\"9.8.6\"");
    std::fs::write(folder.path().join("python/pyproject.toml"), project).unwrap();
    assert_eq!(version(&[]), None);
}

/// A workflow uses only fixed versions: actions by commit, tools by version and hash; and it audits every lock file.
#[test]
fn regress_workflows_run_nothing_that_may_change_under_them() {
    let folder = repository(".github/workflows");
    let mut count = 0;
    for file in std::fs::read_dir(folder).expect("workflows") {
        let path = file.expect("a file").path();
        for line in std::fs::read_to_string(&path).expect("text").lines() {
            let sound = match line.split_once("uses: ") {
                Some((_, action)) => {
                    let (_, commit) = action.split_once('@').expect("a version");
                    commit.len() > 41 && commit[..40].bytes().all(|byte| byte.is_ascii_hexdigit())
                }
                None => {
                    let pip = !line.contains("pip install") || line.contains("--require-hashes");
                    let cargo = line.split_once("cargo install --locked ");
                    pip && !line.contains("pipx")
                        && cargo.is_none_or(|(_, what)| what.contains('@'))
                }
            };
            count += usize::from(line.contains("install") || line.contains("uses: "));
            assert!(sound, "{}: {line}", path.display());
        }
    }
    assert!(count > 20);
    let read = |file: &str| std::fs::read_to_string(repository(file)).expect(file);
    for line in read(".ci/run").lines() {
        let fetches = line.contains("pip\" install ") || line.contains("npm install ");
        assert!(!fetches || line.contains("--require-hashes"), "{line}");
    }
    assert!(read(".github/workflows/advisories.yml").contains("git ls-files '*requirements*.txt'"));
    assert!(read(".github/workflows/release.yml").contains("actions/attest-build-provenance@"));
    let lock = read(".github/tools/requirements.txt");
    let parts = ["pdoc==", "pip-audit==", "--hash=sha256:"];
    assert!(parts.iter().all(|part| lock.contains(part)));
    assert!(read(".ci/axe/package-lock.json").contains("\"integrity\": \"sha512-"));
    let commit = "0123456789".repeat(4);
    let mut install = Command::new("bash");
    install
        .arg(repository("tools/install"))
        .args(["a/b", &commit, "x"]);
    let output = install.output().expect("bash");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("by its input `version`"));
}
