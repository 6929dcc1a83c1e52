//! Stored runs of other engines in `compare`.

use std::fs;
use std::path::Path;
use std::process::Stdio;
#[cfg(unix)]
use std::time::Duration;

use pinwheel_tests::{Outcome, names_in, pinwheel, words};

const COMPARE: &str = "compare paper --engines native,rapier-shared-law --longest 5 --set solver.duration_s=0.02 \
    --out out";

/// Runs `compare` in `dir`, with runs stored in the folder `runs` below it.
fn compare(dir: &Path, more: &str) -> Outcome {
    pinwheel()
        .args(words(COMPARE))
        .args(words(more))
        .env("PINWHEEL_RUNS", dir.join("runs"))
        .current_dir(dir)
        .stdin(Stdio::null())
        .output()
        .unwrap()
        .into()
}

#[test]
fn program_compare_keeps_runs_and_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let rapier =
        |file: &str| fs::read(dir.path().join("out/rapier-shared-law").join(file)).unwrap();
    let first = compare(dir.path(), "");
    assert_eq!((first.code, &*first.stderr), (Some(0), ""), "{first:?}");
    assert!(!first.stdout.contains("kept"), "{}", first.stdout);
    let (series, record) = (rapier("courses.csv"), rapier("run.json"));
    let files = names_in(&dir.path().join("runs"));
    assert!(
        files.len() > 2 && files.iter().all(|name| name.ends_with(".run")),
        "{files:?}"
    );

    let second = compare(dir.path(), "");
    assert_eq!((second.code, &*second.stderr), (Some(0), ""));
    let stdout = second
        .stdout
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    assert!(
        stdout.contains("kept rapier (1 engines): not run now but kept, of 20"),
        "{stdout}"
    );
    assert_eq!(rapier("courses.csv"), series);
    let now = String::from_utf8(rapier("run.json")).unwrap();
    assert!(now.contains("\"kept\": \"20"), "{now}");
    assert!(!String::from_utf8(record).unwrap().contains("\"kept\""));
    let page = fs::read_to_string(dir.path().join("out/index.html")).unwrap();
    assert!(page.contains("Kept: run by this version of Pinwheel on 20"));
    assert_eq!(names_in(&dir.path().join("runs")), files);

    let fresh = compare(dir.path(), "--fresh --jobs 1");
    assert_eq!((fresh.code, &*fresh.stderr), (Some(0), ""));
    assert!(!fresh.stdout.contains("kept"), "{}", fresh.stdout);
    assert_eq!(rapier("courses.csv"), series);

    for name in &files {
        fs::write(dir.path().join("runs").join(name), "damaged").unwrap();
    }
    let anew = compare(dir.path(), "");
    assert_eq!(anew.code, Some(0), "{anew:?}");
    let note = "note: a kept run of rapier-shared-law was damaged or not ours; it is made anew\n";
    assert_eq!(anew.stderr, note);
    assert_eq!(rapier("courses.csv"), series);
}

/// Ctrl-C stores finished runs, and reports the way to continue.
#[cfg(unix)]
#[test]
fn program_compare_stopped_keeps_what_is_done() {
    let dir = tempfile::tempdir().unwrap();
    let runs = dir.path().join("runs");
    let child = pinwheel()
        .args(words("compare paper --engines rapier-shared-law,rapier-hook --longest 600 --resolution 1e-9 --out out"))
        .env("PINWHEEL_RUNS", &runs)
        .current_dir(dir.path())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let kept = || {
        names_in(&runs)
            .into_iter()
            .filter(|name| name.ends_with(".run"))
    };
    while kept().next().is_none() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let stopped = ["-s", "INT", &child.id().to_string()];
    assert!(
        std::process::Command::new("kill")
            .args(stopped)
            .status()
            .unwrap()
            .success()
    );
    let outcome = Outcome::from(child.wait_with_output().unwrap());
    assert_eq!(outcome.code, Some(130), "{outcome:?}");
    let message = format!(
        "error: stopped; {} runs are kept: the same command goes on with them\n",
        kept().count()
    );
    assert_eq!(outcome.stderr, message);
    assert!(!dir.path().join("out").exists());
}
