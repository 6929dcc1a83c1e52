//! The program with Python in it: what it leaves behind, how it stops, and what it does without a Python.

use std::process::{Child, Command, Stdio};
use std::time::Duration;

use pinwheel_tests::{Outcome, names_in, pinwheel, run_in, words};

use super::ALL;

#[test]
fn crossval_python_program_leaves_only_its_output() {
    let dir = tempfile::tempdir().unwrap();
    let engines = ALL.join(",");
    let outcome = run_in(
        dir.path(),
        [
            "compare",
            "paper",
            "--set",
            "solver.duration_s=0.003",
            "--engines",
            &format!("native,{engines}"),
            "--out",
            "out",
        ],
    );
    assert!(matches!(outcome.code, Some(0 | 1)), "{outcome:?}");
    assert_eq!(names_in(dir.path()), ["out"]);
    assert_eq!(outcome.stderr, "", "a peer printed");
    let page = std::fs::read_to_string(dir.path().join("out/index.html")).unwrap();
    for engine in ALL {
        assert!(page.contains(engine), "{engine} is not in the report");
        assert!(
            dir.path()
                .join("out")
                .join(engine)
                .join("courses.csv")
                .exists()
        );
    }
    assert!(
        !page.contains("Recorded on"),
        "live engines need no recording"
    );
}

#[cfg(unix)]
#[test]
fn crossval_python_program_stops_when_asked() {
    for engine in ["mujoco-shared-law", "exudyn-shared-law-constrained"] {
        let dir = tempfile::tempdir().unwrap();
        let mut child = pinwheel()
            .args(["run", "paper", "--engine", engine, "--out", "out"])
            .args(words(
                "--set solver.duration_s=1000 --set solver.sample_s=0.01",
            ))
            .current_dir(dir.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        while names_in(dir.path()).is_empty() {
            assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
            std::thread::sleep(Duration::from_millis(5));
        }
        // Python is being loaded, or steps already: both must end.
        std::thread::sleep(Duration::from_secs(2));
        interrupt(&child);
        let outcome = Outcome::from(child.wait_with_output().unwrap());
        assert_eq!(outcome.code, Some(130), "{engine}: {outcome:?}");
        assert_eq!(outcome.stderr, "error: stopped; nothing was written\n");
        assert!(names_in(dir.path()).is_empty());
    }
}

#[cfg(unix)]
fn interrupt(child: &Child) {
    let sent = Command::new("kill")
        .args(["-s", "INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
}

/// No environment, no network: the error names the remedies, and `compare` shows the recordings, saying so.
#[test]
fn crossval_python_program_without_packages_falls_back_on_recordings() {
    let dir = tempfile::tempdir().unwrap();
    let wheels = tempfile::tempdir().unwrap();
    let cache = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| -> Outcome {
        pinwheel()
            .args(arguments)
            .env("PINWHEEL_CACHE", cache.path())
            .env("PINWHEEL_WHEELS", wheels.path())
            .env_remove("PINWHEEL_PYTHON_ENV")
            .env_remove("PIP_FIND_LINKS")
            .current_dir(dir.path())
            .stdin(Stdio::null())
            .output()
            .unwrap()
            .into()
    };
    let outcome = run(&words(
        "compare paper --engines native-resolved,mujoco-shared-law,exudyn-own-contact \
         --out out",
    ));
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    assert!(outcome.stdout.contains("recorded"), "{}", outcome.stdout);
    let page = std::fs::read_to_string(dir.path().join("out/index.html")).unwrap();
    assert!(page.contains("Recorded on") && page.contains("because"));
    assert!(page.contains("PINWHEEL_WHEELS"), "the reason is told");
    // A scene that nothing was recorded of: an error with the remedies.
    let outcome = run(&words(
        "run one-wheel --engine mujoco-shared-law --out other",
    ));
    assert_eq!(outcome.code, Some(3), "{outcome:?}");
    for word in ["PINWHEEL_WHEELS", "PINWHEEL_PYTHON_ENV"] {
        assert!(outcome.stderr.contains(word), "{}", outcome.stderr);
    }
    assert_eq!(names_in(dir.path()), ["out"]);
    let left = names_in(cache.path());
    assert!(
        left.iter().all(|name| name.ends_with(".lock")),
        "half an environment: {left:?}"
    );
    // Nobody asked for these by name: what is here is compared, and why the others are not is said.
    let outcome = run(&words(
        "compare one-wheel --set solver.duration_s=0.002 --longest 1 --out own",
    ));
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let page = std::fs::read_to_string(dir.path().join("own/index.html")).unwrap();
    assert!(page.contains("not on this machine"), "{}", outcome.stdout);
}
