//! Units as `pinwheel fmu` writes them, in the program and in fmpy.
//!
//! `PINWHEEL_FMPY` names a Python that has fmpy; without one that part says that it is skipped, unless `PINWHEEL_REQUIRE_FMPY` is
//! set.

use std::fs;
use std::process::Command;

use pinwheel_tests::{Outcome, repository, run_in};

const SETS: [&str; 8] = [
    "--set",
    "solver.integrator=etd-adams",
    "--set",
    "solver.tolerance=1e-9",
    "--set",
    "solver.duration_s=0.02",
    "--set",
    "solver.sample_s=1e-4",
];

#[test]
fn crossval_a_unit_in_fmpy_is_the_native_run() {
    let python = std::env::var("PINWHEEL_FMPY").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&python).args(["-c", "import fmpy"]).output();
    if !has.is_ok_and(|output| output.status.success()) {
        let what = "no fmpy here; name a Python that has it by PINWHEEL_FMPY";
        assert!(std::env::var_os("PINWHEEL_REQUIRE_FMPY").is_none(), "{what}");
        println!("skipped: {what}");
        return;
    }
    let folder = tempfile::tempdir().expect("folder");
    for (scene, set) in [
        ("paper", "solver.integrator=etd-adams"),
        ("paper-friction", "solver.integrator=rodas5p"),
    ] {
        let mut sets = SETS;
        sets[1] = set;
        let words = |command: &str, out: &str| {
            let mut words = vec![command.to_owned(), scene.to_owned()];
            words.extend(sets.map(str::to_owned));
            words.extend(["--out".to_owned(), out.to_owned()]);
            if command == "run" {
                words.push("--unchecked".to_owned());
            }
            run_in(folder.path(), words)
        };
        let unit = format!("{scene}.fmu");
        for outcome in [words("run", scene), words("fmu", &unit)] {
            assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        }
        let measured: Outcome = Command::new(&python)
            .arg(repository("tests/fmu.py"))
            .arg(folder.path().join(&unit))
            .arg(folder.path().join(scene).join("courses.csv"))
            .output()
            .expect("Python starts")
            .into();
        println!("{scene}\n{}", measured.stdout);
        assert_eq!(measured.code, Some(0), "{}", measured.stderr);
    }
}

/// The same bytes again, and the description escapes what a scene's name and words may hold.
#[test]
fn a_unit_is_written_whole_and_the_same() {
    let folder = tempfile::tempdir().expect("folder");
    let dir = folder.path();
    let scene = "base = \"paper\"\nname = \"a <b> & \\\"c\\\"\"\ndescription = \"1 < 2 & 'so'\"\n";
    fs::write(dir.join("mine.toml"), scene).expect("scene");
    let make = |out: &str| run_in(dir, ["fmu", "mine.toml", "--out", out]);
    for out in ["one.fmu", "deep/two.fmu"] {
        let made = make(out);
        assert_eq!(made.code, Some(0), "{}", made.stderr);
        assert!(made.stdout.contains(out), "{}", made.stdout);
    }
    let bytes = |out: &str| fs::read(dir.join(out)).expect(out);
    assert_eq!(bytes("one.fmu"), bytes("deep/two.fmu"));
    let told = run_in(dir, ["fmu", "paper", "--json"]);
    assert!(told.stdout.contains("\"file\": \"out/paper.fmu\""), "{}", told.stdout);
    assert!(dir.join("out/paper.fmu").is_file());
}

#[test]
fn bad_input_of_units() {
    let folder = tempfile::tempdir().expect("folder");
    for (words, code, says) in [
        (&["fmu", "paper", "--out", "mine.toml"][..], 2, ".fmu"),
        (&["fmu", "papre"], 2, "paper"),
        (&["fmu", "paper", "--set", "gear.backlash_mm=1"], 2, "gear.backlash_m"),
        (&["fmu", "paper", "--set", "solver.integrator=euler"], 2, "euler"),
    ] {
        let outcome = run_in(folder.path(), words);
        assert_eq!(outcome.code, Some(code), "{words:?}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(says), "{words:?}: {}", outcome.stderr);
        assert_eq!(outcome.stderr.trim_end().lines().count(), 1, "{}", outcome.stderr);
    }
    assert!(fs::read_dir(folder.path()).expect("folder").next().is_none());
}
