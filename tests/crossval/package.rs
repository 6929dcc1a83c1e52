//! Tests, linters and command line of the Python package, in an environment of its own.

use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;

use pinwheel_engines::python::{Environment, Requirements, environment};
use pinwheel_tests::{pinwheel, run_in, words};

const DEVELOPMENT: Requirements = Requirements {
    name: "development",
    file: "python/requirements-dev.txt",
    only_listed: false,
    text: include_str!("../../python/requirements-dev.txt"),
};

fn tools() -> Environment {
    environment(DEVELOPMENT, &AtomicBool::new(false)).unwrap()
}

fn folder() -> PathBuf {
    pinwheel_tests::repository("python")
}

fn python(arguments: &[&str]) -> Command {
    let mut command = Command::new(tools().python);
    // The source tree stays unchanged.
    command
        .args(arguments)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .current_dir(folder());
    command
}

fn assert_fine(what: &str, output: &Output) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        output.status.success(),
        "{what}: {}\n{}\n{}",
        output.status,
        text(&output.stdout),
        text(&output.stderr)
    );
}

/// Tests of the engines under the law in numpy that repeat those of `crossval` under the compiled law.
const REPEATED: &str = "same_method or that_changes or second_order or solves_friction or loaded_start or load_ramp \
                        or cancel_and_repeat or repeat_to_the_bit or first_sample or progress_and_cancel \
                        or (shared_law and blow_up)";

fn assert_tests_pass(selected: &str) {
    let tests = python(&["-m", "pytest", "-q", "-p", "no:cacheprovider", "-k"])
        .arg(selected)
        .output()
        .unwrap();
    assert_fine("pytest", &tests);
}

#[test]
fn crossval_python_package_passes_its_own_tests() {
    assert_tests_pass(&format!("not ({REPEATED})"));
}

#[test]
#[ignore = "weekly: 50 s for what the tests under the compiled law show too"]
fn crossval_python_package_passes_its_slow_tests() {
    assert_tests_pass(REPEATED);
}

#[test]
fn crossval_python_package_is_clean() {
    let settings = ["--config", "pyproject.toml", ".", "../solvers"];
    let ruff = python(&["-m", "ruff", "check", "--no-cache"])
        .args(settings)
        .output()
        .unwrap();
    assert_fine("ruff", &ruff);
    // Beside its packages: a new clone does not read their types again.
    let mypy = python(&["-m", "mypy", "--cache-dir"])
        .arg(tools().folder.join("mypy"))
        .output()
        .unwrap();
    assert_fine("mypy", &mypy);
}

#[test]
fn crossval_python_package_runs_alone() {
    let dir = tempfile::tempdir().unwrap();
    let scene = dir.path().join("scene.toml");
    std::fs::write(&scene, pinwheel_scene::preset("paper").unwrap()).unwrap();
    for module in ["pinwheel_engines.mujoco", "pinwheel_engines.exudyn"] {
        let run = Command::new(tools().python)
            .args([
                "-m",
                module,
                "scene.toml",
                "--duration",
                "2e-4",
                "--out",
                "out.csv",
            ])
            .env("PYTHONPATH", folder())
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .current_dir(dir.path())
            .output()
            .unwrap();
        assert_fine(module, &run);
        let time_series =
            pinwheel_timeseries::TimeSeries::load_csv(&dir.path().join("out.csv")).unwrap();
        assert_eq!(time_series.len(), 3);
    }
    assert_eq!(
        pinwheel_tests::names_in(dir.path()),
        ["out.csv", "scene.toml"]
    );
}

/// The template that computes its own contacts gives the native figures.
#[test]
fn crossval_numpy_contacts_agree() {
    let dir = tempfile::tempdir().unwrap();
    let new = ["solver", "new", "--language", "numpy", "mine"];
    assert_eq!(run_in(dir.path(), new).code, Some(0));
    let compare = "compare paper --engines native-resolved --solver mine/solver.toml --set solver.duration_s=0.001 \
                   --set contact.friction_coefficient=0.1 --set contact.friction_ramp_m_s=5e-3";
    let ran = pinwheel()
        .args(words(compare))
        .env("PINWHEEL_PYTHON", tools().python)
        .current_dir(dir.path())
        .output()
        .unwrap();
    assert_fine(compare, &ran);
    let stdout = String::from_utf8_lossy(&ran.stdout);
    let words: Vec<&str> = stdout.split_whitespace().collect();
    assert!(words.join(" ").contains("mine agrees to "), "{stdout}");
}
