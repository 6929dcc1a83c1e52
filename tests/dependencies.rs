//! Every crate that is built in: where it comes from, its licence, and no version beside another but those that
//! `deny.toml` names. `cargo deny check` reads the same file and looks for advisories too; this needs no tool.

use std::collections::BTreeMap;
use std::process::Command;

use pinwheel_tests::repository;
use serde_json::Value;
use toml::Table;

const INDEX: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// The packages of this machine's kind, with all features where they are at hand.
fn packages() -> Vec<Value> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let version = Command::new("rustc")
        .arg("-vV")
        .output()
        .expect("rustc runs");
    let version = String::from_utf8_lossy(&version.stdout).into_owned();
    let host = version
        .lines()
        .find_map(|line| line.strip_prefix("host: "))
        .expect("a host")
        .to_owned();
    let mut said = String::new();
    for features in [&["--all-features"][..], &["--offline"]] {
        let mut command = Command::new(&cargo);
        command.current_dir(repository(".")).args([
            "metadata",
            "--format-version",
            "1",
            "--locked",
        ]);
        let output = command
            .args(["--filter-platform", &host])
            .args(features)
            .output()
            .expect("cargo runs");
        if output.status.success() {
            let all: Value = serde_json::from_slice(&output.stdout).expect("JSON");
            return all["packages"].as_array().expect("packages").clone();
        }
        said = String::from_utf8_lossy(&output.stderr).into_owned();
    }
    panic!("cargo metadata fails: {said}");
}

/// Whether an SPDX expression (or the older `A/B`) can be satisfied by licences that are allowed.
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
    let mut found = all(words, at, allowed);
    while words.get(*at) == Some(&"OR") {
        *at += 1;
        found |= all(words, at, allowed);
    }
    found
}

fn all(words: &[&str], at: &mut usize, allowed: &dyn Fn(&str) -> bool) -> bool {
    let mut found = one(words, at, allowed);
    while words.get(*at) == Some(&"AND") {
        *at += 1;
        found &= one(words, at, allowed);
    }
    found
}

fn one(words: &[&str], at: &mut usize, allowed: &dyn Fn(&str) -> bool) -> bool {
    let Some(word) = words.get(*at) else {
        return false;
    };
    *at += 1;
    if *word == "(" {
        let found = any(words, at, allowed);
        let closed = words.get(*at) == Some(&")");
        *at += 1;
        return found && closed;
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
    for package in &packages {
        let text = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
        let (name, version, licence) = (text("name"), text("version"), text("license"));
        let own = package["source"].is_null();
        if !own && text("source") != INDEX {
            faults.push(format!("{name} comes from {}", text("source")));
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
    println!("{} packages", packages.len());
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
