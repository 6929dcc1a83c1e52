//! TOML with the position of every key.

use pinwheel_files::{Document, Entries, read};
use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "only its reading is of interest")]
struct Gear {
    wheels: usize,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "only its reading is of interest")]
struct File {
    gear: Gear,
}

#[test]
fn faults_name_line_key_and_what_was_meant() {
    for (text, line) in [
        (
            "\n[gear]\nwheel = 1",
            "f, line 3: `gear.wheel` is no key here; did you mean `wheels`?",
        ),
        (
            "[gear]\nwheels = \"a\"",
            "f, line 2: `gear.wheels`: invalid type: string \"a\", expected usize; see",
        ),
        ("[gear]\n", "f, line 1: `gear`: missing field `wheels`; see"),
        (
            "gear = [",
            "f, line 1: not valid TOML: unclosed array, expected `]`; see",
        ),
    ] {
        let error = read::<File>(text, "f", "see").unwrap_err();
        assert_eq!(error.to_string(), line);
    }
}

#[test]
fn keys_keep_the_order_and_the_lines_of_the_file() {
    let text = "z = [1,\n 2]\na.y = { q = 1e-6, b = 2 }\nc = 1979-05-27\na.x = 'x'\n";
    let document = Document::parse(text, "f", "").unwrap();
    let order = |entries: &Entries| {
        let names = entries.iter().map(|(key, item)| (key.clone(), item.line));
        names.collect::<Vec<_>>()
    };
    let named = |keys: &[(&str, usize)]| {
        keys.iter()
            .map(|(key, line)| ((*key).to_owned(), *line))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        order(&document.root),
        named(&[("z", 1), ("a", 3), ("c", 4)])
    );
    let a = document.get("a").unwrap().node.as_table().unwrap();
    assert_eq!(order(a), named(&[("y", 3), ("x", 5)]));
    assert_eq!(a[0].1.text, "{ q = 1e-6, b = 2 }");
    assert_eq!(document.get("z").unwrap().text, "[1,\n 2]");
    assert_eq!(document.get("c").unwrap().node.words(), "a date");
}
