//! The program with Python: remains, stops, and behaviour without a Python.

use std::path::Path;
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
    let started = ["mujoco-shared-law", "exudyn-shared-law-constrained"].map(|engine| {
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
        (engine, dir, child)
    });
    // Python is loading, or already steps: both must end.
    std::thread::sleep(Duration::from_millis(700));
    for (engine, dir, child) in started {
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

/// Engines in Python that run in separate processes before the comparison give equal results to sequential runs in its own,
/// and the next comparison uses them.
#[test]
fn crossval_python_engines_side_by_side_change_no_bit() {
    let dir = tempfile::tempdir().unwrap();
    let runs = dir.path().join("runs");
    let compare = |jobs: &str, runs: &Path| -> Outcome {
        let typed = "compare paper --engines native,mujoco,exudyn-explicit --set solver.duration_s=0.004 \
            --set solver.step_s=1e-5 --out";
        let typed = format!("{typed} {jobs} --jobs {jobs}");
        let command = &mut pinwheel();
        let command = command.args(words(&typed)).current_dir(dir.path());
        let outcome = command
            .env("PINWHEEL_RUNS", runs)
            .stdin(Stdio::null())
            .output();
        outcome.unwrap().into()
    };
    let one = compare("1", Path::new(""));
    let two = compare("2", &runs);
    let kept = names_in(&runs).len();
    assert_eq!(
        (one.code, &*one.stderr, &*two.stderr),
        (two.code, "", ""),
        "{one:?}"
    );
    // Three levels each.
    assert_eq!(kept, 6);
    let again = compare("3", &runs);
    assert!(
        !two.stdout.contains("kept") && again.stdout.contains("kept"),
        "{again:?}"
    );
    assert_eq!(names_in(&runs).len(), kept);
    for engine in [
        "native-reduced",
        "mujoco-shared-law",
        "exudyn-shared-law-explicit",
    ] {
        let [one, two, three] = ["1", "2", "3"].map(|out| {
            std::fs::read(dir.path().join(out).join(engine).join("courses.csv")).unwrap()
        });
        assert!(one == two && two == three, "{engine}");
    }
}

/// Without environment, network and compiler `compare` states that it shows recordings; without these the error names the
/// remedies.
#[test]
fn crossval_python_program_without_packages_falls_back_on_recordings() {
    let dir = tempfile::tempdir().unwrap();
    let wheels = tempfile::tempdir().unwrap();
    let cache = tempfile::tempdir().unwrap();
    let run = |environment: Option<&str>, typed: &str| -> Outcome {
        pinwheel()
            .args(words(typed))
            .env("PINWHEEL_CACHE", cache.path())
            .env("PINWHEEL_WHEELS", wheels.path())
            .env("CXX", "no-such-compiler")
            .env_remove("PINWHEEL_PYTHON_ENV")
            .env_remove("PIP_FIND_LINKS")
            .envs(environment.map(|place| ("PINWHEEL_PYTHON_ENV", place)))
            .current_dir(dir.path())
            .stdin(Stdio::null())
            .output()
            .unwrap()
            .into()
    };
    let page =
        |name: &str| std::fs::read_to_string(dir.path().join(name).join("index.html")).unwrap();
    let outcome = run(
        None,
        "compare paper --engines native-resolved,mujoco-shared-law,exudyn-own-contact,simbody-shared-law,ida-shared-law \
         --set solver.duration_s=0.06 --out out",
    );
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    assert!(outcome.stdout.contains("recorded"), "{}", outcome.stdout);
    let shown = page("out");
    for word in [
        "Recorded on",
        "because",
        "PINWHEEL_WHEELS",
        "apt install libsimbody-dev g++",
        "solvers/ida/requirements.txt",
    ] {
        assert!(shown.contains(word), "{word}: {}", outcome.stdout);
    }
    // This scene has no recordings.
    for (engine, remedies) in [
        (
            "mujoco-shared-law",
            ["PINWHEEL_WHEELS", "PINWHEEL_PYTHON_ENV"],
        ),
        (
            "simbody-shared-law",
            ["apt install libsimbody-dev g++", "CXX"],
        ),
    ] {
        let alone = run(
            None,
            &format!("run one-wheel --engine {engine} --out other"),
        );
        assert_eq!(alone.code, Some(3), "{alone:?}");
        assert_eq!(alone.stderr.trim().lines().count(), 1, "{}", alone.stderr);
        for remedy in remedies {
            assert!(alone.stderr.contains(remedy), "{}", alone.stderr);
        }
    }
    assert_eq!(names_in(dir.path()), ["out"]);
    let left = names_in(cache.path());
    assert!(
        left.iter().all(|name| name.ends_with(".lock")),
        "half a program or environment: {left:?}"
    );
    // Without `--engines` the available ones are compared, with a reason for each of the others.
    let outcome = run(
        Some("/nowhere"),
        "compare one-wheel --set solver.duration_s=0.002 --longest 1 --out own",
    );
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    assert!(
        page("own").contains("not on this machine"),
        "{}",
        outcome.stdout
    );
}
