//! `pinwheel fmu` in the program; `crates/fmu` tests the content of a unit.

use std::fs;
use std::path::Path;

use pinwheel_tests::{Outcome, pinwheel, run_in};

#[test]
fn a_unit_is_where_the_program_says() {
    let folder = tempfile::tempdir().expect("folder");
    let dir = folder.path();
    let scene = "base = \"paper\"\nname = \"a <b> & \\\"c\\\"\"\ndescription = \"1 < 2 & 'so'\"\n";
    fs::write(dir.join("mine.toml"), scene).expect("scene");
    let make = |out: &str| at("1767225600", dir, &["fmu", "mine.toml", "--out", out]);
    for out in ["one.fmu", "deep/two.fmu"] {
        let made = make(out);
        assert_eq!(made.code, Some(0), "{}", made.stderr);
        assert!(made.stdout.contains(out), "{}", made.stdout);
    }
    let bytes = |out: &str| fs::read(dir.join(out)).expect(out);
    assert_eq!(bytes("one.fmu"), bytes("deep/two.fmu"));
    let other = at("1767225601", dir, &["fmu", "mine.toml", "--out", "one.fmu"]);
    assert_eq!(other.code, Some(0), "{}", other.stderr);
    assert_ne!(
        bytes("one.fmu"),
        bytes("deep/two.fmu"),
        "the time stands in it"
    );
    let outcome = run_in(dir, ["fmu", "paper", "--json"]);
    assert!(
        outcome.stdout.contains("\"file\": \"out/paper.fmu\""),
        "{}",
        outcome.stdout
    );
    assert!(dir.join("out/paper.fmu").is_file());
}

/// Runs a command at the time given by `SOURCE_DATE_EPOCH`.
fn at(epoch: &str, dir: &Path, words: &[&str]) -> Outcome {
    let mut command = pinwheel();
    let command = command.current_dir(dir).args(words);
    let done = command.env("SOURCE_DATE_EPOCH", epoch).output();
    done.expect("starts").into()
}

#[test]
fn bad_input_of_units() {
    let folder = tempfile::tempdir().expect("folder");
    for (words, code, says) in [
        (&["fmu", "paper", "--out", "mine.toml"][..], 2, ".fmu"),
        (&["fmu", "papre"], 2, "paper"),
        (
            &["fmu", "paper", "--set", "gear.backlash_mm=1"],
            2,
            "gear.backlash_m",
        ),
        (
            &["fmu", "paper", "--set", "solver.integrator=euler"],
            2,
            "euler",
        ),
    ] {
        let outcome = run_in(folder.path(), words);
        assert_eq!(outcome.code, Some(code), "{words:?}: {}", outcome.stderr);
        assert!(
            outcome.stderr.contains(says),
            "{words:?}: {}",
            outcome.stderr
        );
        assert_eq!(
            outcome.stderr.trim_end().lines().count(),
            1,
            "{}",
            outcome.stderr
        );
    }
    for epoch in ["", "-1", "1e9", "253402300800"] {
        let outcome = at(epoch, folder.path(), &["fmu", "paper"]);
        assert_eq!(outcome.code, Some(2), "{epoch}: {}", outcome.stderr);
        assert!(
            outcome.stderr.contains("SOURCE_DATE_EPOCH"),
            "{}",
            outcome.stderr
        );
    }
    assert!(
        fs::read_dir(folder.path())
            .expect("folder")
            .next()
            .is_none()
    );
}
