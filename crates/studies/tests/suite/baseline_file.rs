//! Faults of a baseline's file.

use std::fs;
use std::path::Path;

use pinwheel_studies::baseline::{Baseline, FILE};

#[test]
fn regress_numbers_that_are_not_finite_are_refused() {
    let accepted = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../reference/baselines/accepted/baseline.toml"
    );
    let text = fs::read_to_string(accepted).unwrap();
    let read = |text: &str| Baseline::parse(Path::new(FILE), text);
    read(&text).unwrap();
    for key in ["scale", "own_error", "error", "rounding", "count_spread"] {
        let start = text.find(&format!("\n{key} = ")).unwrap() + 1;
        let end = start + text[start..].find('\n').unwrap();
        for value in ["inf", "-inf", "nan"] {
            let spoiled = format!("{}{key} = {value}{}", &text[..start], &text[end..]);
            let error = read(&spoiled).unwrap_err().to_string();
            assert!(error.contains("finite"), "{key} = {value}: {error}");
        }
        for value in ["-1.0", "1e300"] {
            let spoiled = format!("{}{key} = {value}{}", &text[..start], &text[end..]);
            let error = read(&spoiled)
                .map(|_| ())
                .map_err(|error| error.to_string());
            let large_scale = (key, value) == ("scale", "1e300");
            let named = if large_scale {
                "is not that of its figures"
            } else {
                key
            };
            assert!(
                error.clone().unwrap_err().contains(named),
                "{key} = {value}: {error:?}"
            );
        }
    }
    let scene = text.find("[[scene]]").unwrap();
    let case = scene + text[scene..].find("[[scene.case]]").unwrap();
    let next = case + 1 + text[case + 1..].find("[[scene.case]]").unwrap();
    for (twice, from) in [("the scene `paper` twice", scene), ("twice", case)] {
        let doubled = format!("{}{}{}", &text[..next], &text[from..next], &text[next..]);
        let error = read(&doubled).unwrap_err().to_string();
        assert!(error.contains(twice), "{error}");
    }
}
