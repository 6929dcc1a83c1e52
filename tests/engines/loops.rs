//! Modules of a crate import each other without loops: each file can be read after its imports.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use pinwheel_tests::repository;

/// Path of a module below its crate; the root's is empty.
type Module = Vec<String>;

/// Collects the Rust files below a folder.
pub(crate) fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// Returns the text of a file without comments and its test module.
pub(crate) fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).expect("text");
    let lines = text.lines().map(|line| line.split("//").next());
    let code: Vec<&str> = lines.map(Option::unwrap_or_default).collect();
    let tests = code
        .windows(2)
        .position(|two| two[0] == "#[cfg(test)]" && two[1].starts_with("mod "));
    code[..tests.unwrap_or(code.len())].join("\n")
}

/// Appends the paths of a tree of imports, `a::{b, c::d}` as `a::b` and `a::c::d`.
fn expand(before: &str, tree: &str, paths: &mut Vec<String>) {
    let Some((head, rest)) = tree.split_once('{') else {
        let path = tree.split(" as ").next().unwrap_or_default();
        paths.push(format!("{before}{}", path.trim()));
        return;
    };
    let before = format!("{before}{}", head.trim());
    let (mut depth, mut begin) = (0, 0);
    let body = &rest[..rest.rfind('}').unwrap_or(rest.len())];
    for (at, sign) in body.char_indices().chain([(body.len(), ',')]) {
        depth += i32::from(sign == '{') - i32::from(sign == '}');
        if sign == ',' && depth == 0 {
            let branch = body[begin..at].trim();
            begin = at + 1;
            if !branch.is_empty() {
                expand(&before, branch, paths);
            }
        }
    }
}

/// Returns the paths in a file; `true` marks the paths of a `pub use`.
fn named(code: &str) -> Vec<(bool, String)> {
    let (mut named, mut rest, mut body) = (Vec::new(), code, String::new());
    while let Some(at) = rest.find("use ") {
        let before = &rest[..at];
        let line = before.rsplit('\n').next().unwrap_or_default().trim();
        let is_import = line.is_empty() || (line.starts_with("pub") && !line.contains(' '));
        let end = rest[at..].find(';').map_or(rest.len(), |end| at + end + 1);
        body.push_str(before);
        if is_import {
            let mut paths = Vec::new();
            let tree = rest[at + 4..end].trim_end_matches(';');
            expand("", &tree.replace('\n', " "), &mut paths);
            named.extend(paths.into_iter().map(|path| (!line.is_empty(), path)));
            rest = &rest[end..];
        } else {
            rest = &rest[at + 4..];
        }
    }
    body.push_str(rest);
    for start in ["crate::", "super::"] {
        let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
        for (at, _) in body.match_indices(start) {
            if !body[..at].ends_with(is_part) {
                let path = body[at..].split(|c| !is_part(c)).next();
                let path = path.unwrap_or_default().trim_end_matches(':');
                named.push((false, path.to_owned()));
            }
        }
    }
    named
}

/// Returns the module of a path in `own`, if it is another one of the crate.
fn target<'a>(
    own: &Module,
    path: &str,
    modules: &'a BTreeMap<Module, PathBuf>,
) -> Option<&'a Module> {
    let mut parts: Vec<String> = path
        .split("::")
        .map(|part| part.trim().to_owned())
        .collect();
    let mut place = match parts[0].as_str() {
        "crate" => Module::new(),
        _ => own.clone(),
    };
    match parts[0].as_str() {
        "crate" | "self" => drop(parts.remove(0)),
        "super" => {
            while parts.first().is_some_and(|part| part == "super") {
                parts.remove(0);
                place.pop();
            }
        }
        child => {
            place.push(child.to_owned());
            modules.get(&place)?;
            parts.remove(0);
        }
    }
    for part in parts {
        place.push(part);
        if !modules.contains_key(&place) {
            place.pop();
            break;
        }
    }
    let (module, _) = modules.get_key_value(&place)?;
    (module != own).then_some(module)
}

/// Returns the shortest chain of imports from a module back to itself.
fn chain(from: &Module, imports: &BTreeMap<Module, BTreeSet<Module>>) -> Option<Vec<Module>> {
    let mut chains = vec![vec![from.clone()]];
    let mut known = BTreeSet::new();
    while !chains.is_empty() {
        let mut longer = Vec::new();
        for chain in chains {
            for next in &imports[chain.last()?] {
                let chain = [chain.clone(), vec![next.clone()]].concat();
                if next == from {
                    return Some(chain);
                }
                if known.insert(next.clone()) {
                    longer.push(chain);
                }
            }
        }
        chains = longer;
    }
    None
}

/// Returns the loops of imports in a source folder, a line each.
fn loops(folder: &Path) -> BTreeSet<String> {
    let mut files = Vec::new();
    sources(folder, &mut files);
    files.retain(|file| !file.ends_with("tests.rs"));
    let modules: BTreeMap<Module, PathBuf> = files
        .into_iter()
        .map(|file| {
            let place = file
                .strip_prefix(folder)
                .expect("below it")
                .with_extension("");
            let mut module: Module = place
                .iter()
                .map(|part| part.to_string_lossy().into_owned())
                .collect();
            if module
                .last()
                .is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str()))
            {
                module.pop();
            }
            (module, file)
        })
        .collect();
    let mut imports = BTreeMap::new();
    for (module, file) in &modules {
        let mut targets = BTreeSet::new();
        for (is_public, path) in named(&code(file)) {
            let to = target(module, &path, &modules);
            // A re-export of a child is no use of it.
            targets.extend(
                to.filter(|to| !(is_public && to.starts_with(module)))
                    .cloned(),
            );
        }
        imports.insert(module.clone(), targets);
    }
    let to_text = |chain: Vec<Module>| {
        let files = chain
            .iter()
            .map(|module| modules[module].strip_prefix(folder));
        let files = files.map(|file| file.expect("below it").display().to_string());
        files.collect::<Vec<_>>().join(" -> ")
    };
    let chains = imports.keys().filter_map(|module| chain(module, &imports));
    // A loop appears at each of its files; it is reported once, at the first of them.
    let first = |chain: &Vec<Module>| chain.iter().min() == chain.first();
    chains.filter(first).map(to_text).collect()
}

#[test]
fn regress_no_file_imports_itself_through_others() {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(repository("crates")).expect("crates") {
        let place = entry.expect("an entry").path();
        let name = place.file_name().expect("a name").to_string_lossy();
        let folder = place.join("src");
        if folder.is_dir() {
            let lines = loops(&folder).into_iter();
            all.extend(lines.map(|line| format!("{name}: {line}")));
        }
    }
    assert!(all.is_empty(), "{all:#?}");
}

/// Each kind of import is an edge, except a re-export of a child.
#[test]
fn loops_of_imports_are_named() {
    let of = |first: &str, second: &str| {
        let dir = tempfile::tempdir().expect("a folder");
        for (name, text) in [
            ("lib", "pub mod a;\npub mod b;\npub use a::A;\n"),
            ("a", first),
            ("b", second),
        ] {
            std::fs::write(dir.path().join(format!("{name}.rs")), text).expect("written");
        }
        loops(dir.path()).into_iter().collect::<Vec<_>>()
    };
    let both = ["a.rs -> b.rs -> a.rs"];
    assert_eq!(
        of(
            "use crate::{b::{B as C, D}};\n",
            "fn f(a: crate::a::A) {}\n"
        ),
        both
    );
    assert_eq!(of("use super::b;\n", "pub use crate::a::A;\n"), both);
    assert_eq!(of("use super::b;\n", "// use crate::a;\n"), [""; 0]);
    assert_eq!(
        of(
            "use super::b;\n",
            "#[cfg(test)]\nmod tests {\nuse crate::a;\n}\n"
        ),
        [""; 0]
    );
    assert_eq!(of("use crate::b;\n", "use crate::A;\n"), [""; 0]);
}
