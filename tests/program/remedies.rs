//! Follows every remedy of the program to the letter. `tests/data/remedies` lists for each a failing command, the printed remedy
//! and the commands that obey it. A remedy in the sources without a case is a fault of the list.

use std::collections::BTreeMap;
use std::path::Path;

use pinwheel_scene::{Override, Scene};
use pinwheel_tests::{pinwheel, repository};

/// Values read from the program's output, by the names in the pattern.
type Read = BTreeMap<String, String>;

fn list(name: &str) -> String {
    let place = repository("tests/data/remedies").join(name);
    std::fs::read_to_string(place).unwrap()
}

/// Splits a pattern such as `give at most {a} m` into texts and names in turn, beginning with a text.
fn pieces(pattern: &str) -> Vec<&str> {
    let mut pieces = Vec::new();
    let mut rest = pattern;
    let is_name = |name: &str| name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    let mut from = 0;
    while let Some(open) = rest[from..].find('{').map(|at| from + at) {
        let name = rest[open + 1..].split('}').next().unwrap();
        if name.is_empty() || !is_name(name) {
            from = open + 1;
            continue;
        }
        pieces.extend([&rest[..open], name]);
        (rest, from) = (&rest[open + name.len() + 2..], 0);
    }
    pieces.push(rest);
    pieces
}

/// Returns true if the pattern occurs in `output`, and stores the values of its names in `read`.
fn stands(pattern: &str, output: &str, read: &mut Read) -> bool {
    let pieces = pieces(pattern);
    let Some(at) = output.find(pieces[0]) else {
        return false;
    };
    let mut rest = &output[at + pieces[0].len()..];
    for pair in pieces[1..].chunks(2) {
        let end = match pair[1] {
            "" => rest.find(' ').or(Some(rest.len())),
            text => rest.find(text),
        };
        let Some(end) = end else {
            return false;
        };
        let value = match pair[1] {
            "" => rest[..end].trim_end_matches([',', ';', ':', '?', '.', ')', '`']),
            _ => &rest[..end],
        };
        read.insert(pair[0].to_owned(), value.to_owned());
        rest = &rest[end + pair[1].len()..];
    }
    true
}

/// Replaces names in braces by their values; names without a value stay.
fn filled(text: &str, read: &Read) -> String {
    let put = |text: String, (name, value): (&String, &String)| {
        text.replace(&format!("{{{name}}}"), value)
    };
    read.iter().fold(text.to_owned(), put)
}

/// Splits a command into words; words with blanks are in single quotes.
fn typed(command: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    for c in command.trim().chars() {
        match c {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            c => words.last_mut().unwrap().push(c),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Runs a command; returns status and output on one line. `scene FILE --set ...` reads a scene within this process.
fn ran(dir: &Path, command: &str) -> (i32, String) {
    let words = typed(command);
    if words.first().is_some_and(|word| word == "scene") {
        let sets = words.iter().skip(2).filter(|word| *word != "--set");
        let sets: Result<Vec<Override>, _> = sets.map(|set| set.parse()).collect();
        let file = dir.join(&words[1]);
        let is_path = words[1].contains(['.', '/']);
        let spec = is_path.then(|| file.to_str().unwrap());
        let scene = sets.and_then(|sets| Scene::load(spec.unwrap_or(&words[1]), &sets));
        let message = scene.err().map(|fault| fault.to_string());
        let here = format!("{}/", dir.display());
        return (
            message.as_ref().map_or(0, |_| 2),
            message.unwrap_or_default().replace(&here, ""),
        );
    }
    let mut program = pinwheel();
    let output = program.args(words).current_dir(dir).output().unwrap();
    let printed =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    let printed = printed.join(" ");
    let printed: Vec<&str> = printed.split_whitespace().collect();
    (output.status.code().unwrap_or(-1), printed.join(" "))
}

/// Follows the cases of a list; returns its faults, each with its line.
fn follow(name: &str) -> Vec<String> {
    let text = list(name);
    let (mut common, mut wrong) = (Vec::new(), Vec::new());
    let mut lines: Vec<(usize, &str)> = text.lines().enumerate().collect();
    lines.retain(|(_, line)| !line.starts_with('#'));
    for case in lines.split(|(_, line)| line.is_empty()) {
        if case.first().is_some_and(|(_, line)| line.starts_with('@')) {
            common.extend_from_slice(case);
            continue;
        }
        let dir = tempfile::tempdir().unwrap();
        let (mut read, mut output) = (Read::new(), String::new());
        let mut lines = common.iter().chain(case).peekable();
        while let Some((number, line)) = lines.next() {
            let fault = |what: &str| format!("{name}:{}: {what}: {line}", number + 1);
            let rest = &line[1..];
            match &line[..1] {
                "+" | "@" => {
                    let (file, text) = rest.trim().split_once(": ").unwrap();
                    let place = dir.path().join(file);
                    std::fs::create_dir_all(place.parent().unwrap()).unwrap();
                    let text = filled(text, &read).replace("\\n", "\n");
                    std::fs::write(place, text + "\n").unwrap();
                }
                ">" => {
                    let (allowed, command) = rest.split_once(' ').unwrap();
                    let command = filled(command, &read);
                    let status;
                    (status, output) = ran(dir.path(), &command);
                    let fails = lines.peek().is_some_and(|(_, next)| next.starts_with('!'));
                    let allowed = if allowed.is_empty() { "0" } else { allowed };
                    if !fails && allowed.split(',').all(|code| code != status.to_string()) {
                        wrong.push(fault(&format!("status {status}, {output}")));
                    }
                }
                "!" if !stands(rest.trim(), &output, &mut read) => {
                    wrong.push(fault(&format!("not in {output}")));
                }
                _ => {}
            }
        }
    }
    wrong
}

macro_rules! lists {
    ($($test:ident $file:literal)*) => {
        const LISTS: &[&str] = &[$($file),*];
        $(#[test] fn $test() {
            let wrong = follow($file);
            assert!(wrong.is_empty(), "{}", wrong.join("\n"));
        })*
    };
}

lists!(
    bad_input_remedies_of_scenes "scene.txt"
    bad_input_remedies_of_designs "design.txt"
    bad_input_remedies_of_sweeps "sweep.txt"
    bad_input_remedies_of_data "foreign.txt"
    bad_input_remedies_of_solvers "solver.txt"
    bad_input_remedies_of_engines "engines.txt"
    bad_input_remedies_of_commands "program.txt"
);

/// Runs every example in the help of the quick commands as printed.
#[test]
fn program_examples_run() {
    let dir = tempfile::tempdir().unwrap();
    let mine = "base = \"paper\"\n";
    std::fs::write(dir.path().join("my-gear.toml"), mine).unwrap();
    let mut count = 0;
    for command in [
        "engines",
        "laws",
        "schema",
        "explain",
        "init",
        "solver new",
        "solver job",
    ] {
        let (_, help) = ran(dir.path(), &format!("{command} --help"));
        assert!(help.contains("Example"), "{command}");
        let mut program = pinwheel();
        let help = program.args(typed(command)).arg("--help").output().unwrap();
        let help = String::from_utf8(help.stdout)
            .unwrap()
            .replace("\\\n      ", "");
        for example in help
            .lines()
            .filter_map(|line| line.strip_prefix("  pinwheel "))
        {
            let words = example
                .split("   ")
                .next()
                .unwrap()
                .split(" > ")
                .next()
                .unwrap();
            let words = words.split("  #").next().unwrap();
            let (status, output) = ran(dir.path(), words);
            assert_eq!(status, 0, "{words}: {output}");
            count += 1;
        }
    }
    assert!(count > 11, "{count}");
}

/// Words with which a remedy may begin.
const VERBS: &str = "give use make write leave choose name did try see install build put take set add keep let list state look say \
                     open go begin map remove raise lower shorten check describe record call pip";

/// Returns the string literals of Rust code, without those of its in-file tests.
fn texts(code: &str) -> Vec<String> {
    let code = code.split("#[cfg(test)]\nmod ").next().unwrap();
    let lines = code.lines().filter(|line| !line.trim().starts_with("//"));
    let code = lines.collect::<Vec<_>>().join("\n").replace("'\"'", "");
    let (mut texts, mut rest) = (Vec::new(), code.chars());
    while rest.by_ref().any(|c| c == '"') {
        let mut text = String::new();
        while let Some(c) = rest.next().filter(|c| *c != '"') {
            match c {
                '\\' => match rest.next() {
                    Some('\n') => rest = rest.as_str().trim_start().chars(),
                    Some('n') => text.push(' '),
                    Some(c) => text.push(c),
                    None => {}
                },
                c => text.push(c),
            }
        }
        texts.push(text);
    }
    texts
}

/// Replaces every argument in a text of `format!` by `{x}`.
fn plain(text: &str) -> String {
    let text = text.replace("{{", "\0").replace("}}", "\u{1}");
    let mut parts = text.split('{');
    let mut plain = parts.next().unwrap().to_owned();
    for part in parts {
        match part.split_once('}').filter(|(name, _)| !name.contains(' ')) {
            Some((_, after)) => plain.extend(["{x}", after]),
            None => plain.extend(["{", part]),
        }
    }
    plain.replace('\0', "{").replace('\u{1}', "}")
}

/// Returns the end of a text from its first part, by semicolons, that begins with one of `VERBS`.
fn remedy(text: &str) -> Option<&str> {
    let begins = |part: &str| {
        let first = part.split([' ', ':', ',']).next().unwrap_or_default();
        part.contains(' ') && VERBS.split_whitespace().any(|verb| verb == first)
    };
    let mut ends = text.match_indices("; ").map(|(at, _)| at + 2);
    let at = std::iter::once(0)
        .chain(&mut ends)
        .find(|at| begins(&text[*at..]))?;
    Some(&text[at..])
}

/// True if another pattern contains all texts of a pattern, in order.
fn within(pattern: &str, other: &str) -> bool {
    let pieces = pieces(pattern);
    let mut texts = pieces.iter().step_by(2).map(|text| text.trim());
    let mut rest = other;
    texts.all(|text| match rest.find(text) {
        Some(at) => {
            rest = &rest[at + text.len()..];
            true
        }
        None => false,
    })
}

/// Checks that every remedy in the sources has a case, or an entry in `elsewhere.txt` with its test or the reason for none.
#[test]
fn every_remedy_of_the_sources_is_in_a_list() {
    fn files(folder: &Path, all: &mut Vec<std::path::PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => files(&path, all),
                false if path.extension().is_some_and(|end| end == "rs") => all.push(path),
                false => {}
            }
        }
    }
    let mut all = Vec::new();
    for entry in std::fs::read_dir(repository("crates")).unwrap() {
        files(&entry.unwrap().path().join("src"), &mut all);
    }
    let lists: Vec<String> = LISTS.iter().map(|name| list(name)).collect();
    let printed = lists.iter().flat_map(|text| text.lines());
    let printed: Vec<&str> = printed.filter_map(|line| line.strip_prefix("! ")).collect();
    let elsewhere = list("elsewhere.txt");
    let mut elsewhere: BTreeMap<&str, usize> = elsewhere
        .lines()
        .filter(|line| line.starts_with("- "))
        .map(|line| (line[2..].split(" | ").next().unwrap(), 0))
        .collect();
    let (mut missing, mut known) = (Vec::new(), 0);
    for path in all {
        for text in texts(&std::fs::read_to_string(&path).unwrap()) {
            let text = plain(&text);
            let Some(remedy) = remedy(&text) else {
                continue;
            };
            let is_read = |line: &&&str| within(remedy, line) || within(line, remedy);
            let place = format!("{}: {remedy}", path.display());
            let exempt = elsewhere
                .iter_mut()
                .find(|(part, _)| place.contains(**part));
            match exempt {
                Some((_, count)) => *count += 1,
                None if printed.iter().any(|line| is_read(&line)) => known += 1,
                None => missing.push(place),
            }
        }
    }
    let idle: Vec<_> = elsewhere.iter().filter(|(_, count)| **count == 0).collect();
    assert!(
        missing.is_empty() && idle.is_empty() && known > 150,
        "{known} in lists; without a case:\n{}\nof no text: {idle:?}",
        missing.join("\n")
    );
}
