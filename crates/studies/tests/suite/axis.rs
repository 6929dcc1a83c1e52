//! Values of the keys that a sweep varies.

use pinwheel_files::{Document, FileError};
use pinwheel_studies::internals::values;
use pinwheel_studies::sweep::Value;

fn read(text: &str) -> Result<Vec<Value>, FileError> {
    let text = format!("x = {text}");
    let document = Document::parse(&text, "f", "").unwrap();
    values(&document, "x", document.get("x").unwrap())
}

fn of(text: &str) -> Vec<Value> {
    read(text).unwrap()
}

fn fault(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

#[test]
fn lists_and_ranges() {
    let numbers = |list: &[f64]| list.iter().copied().map(Value::Number).collect::<Vec<_>>();
    assert_eq!(of("[0.0, 1e-4]"), numbers(&[0.0, 1e-4]));
    assert_eq!(of("0.3"), numbers(&[0.3]));
    assert_eq!(of("[\"a\", 3]"), [Value::Text("a".into()), Value::Whole(3)]);
    assert_eq!(
        of("{ from = 0.0, to = 0.3, step = 0.1 }"),
        numbers(&[0.0, 0.1, 0.2, 0.3])
    );
    assert_eq!(
        of("{ from = 1.0, to = 100.0, points = 3, spacing = \"log\" }"),
        numbers(&[1.0, 10.0, 100.0])
    );
    assert_eq!(
        of("{ from = 8, to = 2, step = -3 }"),
        [8, 5, 2].map(Value::Whole)
    );
    assert_eq!(
        of("{ from = 1, to = 2, points = 3 }"),
        numbers(&[1.0, 1.5, 2.0])
    );
    assert_eq!(of("{ from = 5, to = 5, points = 1 }"), [Value::Whole(5)]);
}

#[test]
fn faults() {
    for (text, part) in [
        ("[]", "empty"),
        ("{ from = 1.0 }", "missing field `to`"),
        ("{ from = 1.0, to = 2.0 }", "neither"),
        ("{ from = 1.0, to = 2.0, points = 2, step = 1.0 }", "both"),
        ("{ from = 1.0, to = 2.0, step = -1.0 }", "does not lead"),
        ("{ from = 1.0, to = 2.0, step = 0.0 }", "more than"),
        ("{ from = 1.0, to = 2.0, points = 0 }", "whole number"),
        ("{ from = 1.0, to = 2.0, points = 1 }", "both ends"),
        (
            "{ from = 0.0, to = 2.0, points = 3, spacing = \"log\" }",
            "one sign",
        ),
        (
            "{ from = 1.0, to = 2.0, points = 3, spacing = \"cubic\" }",
            "linear",
        ),
        ("{ from = nan, to = 2.0, points = 3 }", "finite"),
        ("{ form = 1.0 }", "did you mean `from`?"),
        ("{ from = 0.0, to = 1.0, step = 1e-9 }", "more than"),
    ] {
        assert!(fault(text).contains(part), "{text}: {}", fault(text));
    }
}

#[test]
fn words_and_numbers_survive_toml() {
    for text in ["0.1", "3", "1e-12", "\"paper \\\"x\\\"\"", "[1, 2]"] {
        let values = of(&format!("[{text}]"));
        assert_eq!(of(&format!("[{}]", values[0].to_toml())), values, "{text}");
    }
    assert_eq!(Value::Number(1e-5).to_string(), "1e-5");
    assert_eq!(Value::Number(0.25).to_string(), "0.25");
}
