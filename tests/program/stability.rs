//! `pinwheel stability` in use: files, continuation, endings.

use std::path::Path;

use pinwheel_tests::{Outcome, names_in, run_in};
use serde_json::Value;

/// Writes two scenes of 2 ms: a frictionless gear and one too stiff for Heun's step.
fn scenes(dir: &Path) {
    let file = |name: &str, keys: &str| {
        let text =
            format!("name = \"{name}\"\nbase = \"paper\"\n{keys}\n[solver]\nduration_s = 0.002\n");
        std::fs::write(dir.join(format!("{name}.toml")), text).unwrap();
    };
    file("soft", "");
    file("stiff", "[contact]\nstiffness_multiplier = 4.0");
}

const STUDY: [&str; 5] = [
    "stability",
    "soft.toml",
    "stiff.toml",
    "--quick",
    "--jobs=2",
];

fn summary(dir: &Path) -> Value {
    let text = std::fs::read_to_string(dir.join("out/stability/summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn done(outcome: Outcome) -> String {
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    assert_eq!(outcome.stderr, "", "progress belongs on terminals only");
    outcome.stdout
}

#[test]
fn stability_writes_a_page_a_table_and_everything_and_goes_on() {
    let dir = tempfile::tempdir().unwrap();
    scenes(dir.path());
    let shown = done(run_in(dir.path(), STUDY));
    assert!(shown.contains("stiff") && shown.contains("µs"), "{shown}");
    let out = dir.path().join("out/stability");
    assert_eq!(
        names_in(&out),
        ["index.html", "stability.csv", "summary.json"]
    );

    let first = summary(dir.path());
    assert_eq!(first["finished"], true);
    let rows = first["atlas"]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    // Heun at 1e-5 s: right on the soft gear, diverged on the stiff one.
    assert!(rows[0]["cells"][0]["failure"].is_null());
    assert_eq!(rows[1]["cells"][0]["failure"]["kind"], "blow-up");
    assert!(rows[1]["cells"][0]["largest_step_s"].as_f64().unwrap() < 1e-5);

    let csv = std::fs::read_to_string(out.join("stability.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 2 * 9, "{csv}");
    assert!(csv.starts_with("scene,formulation,integrator"), "{csv}");
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    for part in ["Largest step", "What fails first", "Energy", "soft"] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("src=\"http"), "nothing from elsewhere");

    // State after a stop with one scene missing: the other scenes are not repeated.
    let mut stopped = first.clone();
    stopped["atlas"]["rows"][1] = Value::Null;
    stopped["atlas"]["rows"][0]["why"] = "kept".into();
    std::fs::write(out.join("summary.json"), stopped.to_string()).unwrap();
    done(run_in(
        dir.path(),
        STUDY.iter().chain(&["--resume", "--force"]),
    ));
    let again = summary(dir.path());
    assert_eq!(again["atlas"]["rows"][0]["why"], "kept");
    assert_eq!(
        again["atlas"]["rows"][1]["scene"],
        first["atlas"]["rows"][1]["scene"]
    );
    assert_eq!(again["finished"], true);

    // An output of another plan is not continued.
    let other = run_in(
        dir.path(),
        ["stability", "soft.toml", "--quick", "--resume"],
    );
    assert_eq!(other.code, Some(2), "{other:?}");
    assert!(other.stderr.contains("--resume"), "{other:?}");
}

#[test]
fn bad_input_to_stability_is_one_line() {
    let dir = tempfile::tempdir().unwrap();
    scenes(dir.path());
    for (words, part) in [
        (&["stability", "hard-stel"][..], "hard-steel"),
        (&["stability", "soft.toml", "soft.toml"], "twice"),
        (&["stability", "soft.toml", "--resume"], "--resume"),
        (&["stability", "--jobs", "0"], "--jobs"),
    ] {
        let outcome = run_in(dir.path(), words);
        assert_eq!(outcome.code, Some(2), "{words:?} {outcome:?}");
        assert_eq!(outcome.stderr.lines().count(), 1, "{outcome:?}");
        assert!(outcome.stderr.contains(part), "{outcome:?}");
        assert_eq!(names_in(dir.path()), ["soft.toml", "stiff.toml"]);
    }
}

/// A run whose step does not resolve its scene ends with status 4 and its time series; without the check with 0.
#[test]
fn hard_unresolved_run_ends_with_status_one() {
    let dir = tempfile::tempdir().unwrap();
    let words = ["run", "hard-all-open", "--set", "solver.duration_s=0.02"];
    let outcome = run_in(dir.path(), words);
    assert_eq!(outcome.code, Some(4), "{outcome:?}");
    assert!(outcome.stderr.contains("does not resolve"), "{outcome:?}");
    let record = dir.path().join("out/hard-all-open-run/run.json");
    let record: Value = serde_json::from_str(&std::fs::read_to_string(record).unwrap()).unwrap();
    let moved = ["forces", "driver_torque"]
        .map(|what| record["resolution"]["moved"][what].as_f64().unwrap());
    assert!(moved[0].max(moved[1]) > 0.3, "{moved:?}");
    let words = words.iter().chain(&["--unchecked"]);
    assert_eq!(run_in(dir.path(), words).code, Some(0));
}

/// Explicit friction on very light pins: an error that names the energy, not numbers.
#[test]
fn hard_explicit_friction_ends_with_status_three() {
    let dir = tempfile::tempdir().unwrap();
    let sets = [
        "run",
        "hard-feather-sleeves",
        "--set",
        "solver.integrator=\"rk2\"",
    ];
    let outcome = run_in(dir.path(), sets);
    assert_eq!(outcome.code, Some(3), "{outcome:?}");
    assert!(outcome.stderr.contains("J of energy"), "{outcome:?}");
}
