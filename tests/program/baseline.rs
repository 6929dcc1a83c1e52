//! `pinwheel baseline` in use: files, refusals, endings.

use std::path::{Path, PathBuf};

use pinwheel_tests::{names_in, repository, run_in};

/// Returns a folder of baselines with a copy of the accepted one.
fn copied(base: &Path) -> PathBuf {
    let from = repository("reference/baselines/accepted");
    let to = base.join("baselines/accepted");
    std::fs::create_dir_all(&to).unwrap();
    for file in std::fs::read_dir(from).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), to.join(file.file_name())).unwrap();
    }
    to
}

const CHECK: [&str; 7] = [
    "baseline",
    "check",
    "accepted",
    "--dir",
    "baselines",
    "--only",
    "paper",
];

#[test]
fn a_check_writes_its_page_and_judges() {
    let base = tempfile::tempdir().unwrap();
    let accepted = copied(base.path());
    let fine = run_in(base.path(), CHECK);
    assert_eq!(fine.code, Some(0), "{}{}", fine.stdout, fine.stderr);
    assert!(fine.stdout.contains("reduced-dopri5"), "{}", fine.stdout);
    assert!(fine.stdout.starts_with("accepted: "), "{}", fine.stdout);
    assert_eq!(
        names_in(&base.path().join("out/baseline-accepted")),
        ["index.html", "summary.json"]
    );

    // An accepted run with one step less makes the present one worse.
    let file = accepted.join("baseline.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let tampered = text.replacen("right_hand_sides = 4000", "right_hand_sides = 3998", 1);
    assert_ne!(text, tampered);
    std::fs::write(&file, tampered).unwrap();
    let worse = run_in(base.path(), CHECK);
    assert_eq!(worse.code, Some(1), "{}{}", worse.stdout, worse.stderr);
    let first = "accepted: 1 worse: paper by reduced-rk2";
    assert!(worse.stdout.starts_with(first), "{}", worse.stdout);

    // One unrecorded case, and eleven compared ones.
    let case = text.find("[[scene.case]]").unwrap();
    let next = case + 1 + text[case + 1..].find("[[scene.case]]").unwrap();
    std::fs::write(&file, format!("{}{}", &text[..case], &text[next..])).unwrap();
    let nothing = run_in(base.path(), CHECK);
    assert_eq!(
        nothing.code,
        Some(4),
        "{}{}",
        nothing.stdout,
        nothing.stderr
    );
    let first = "accepted: nothing shown: 1 not in the baseline: paper by reduced-rk2 (`baseline record --only paper` adds it); 11 ";
    let line = nothing.stdout.replace('\n', " ");
    assert!(line.starts_with(first), "{}", nothing.stdout);
}

#[test]
fn what_cannot_be_is_refused_with_a_remedy() {
    let base = tempfile::tempdir().unwrap();
    let accepted = copied(base.path());
    let before = names_in(&accepted);
    for (words, part) in [
        (
            &["record", "accepted", "--dir", "baselines"][..],
            "--accept",
        ),
        (
            &["record", "accepted", "--dir", "baselines", "--accept", " "],
            "--accept",
        ),
        (
            &["check", "nothing", "--dir", "baselines"],
            "there are accepted",
        ),
        (&["check", "--dir", "nowhere"], "--dir"),
        (&["check", "../up", "--dir", "baselines"], "no name"),
        (&["check", "--dir", "baselines", "--only", "papr"], "papr"),
    ] {
        let outcome = run_in(base.path(), [&["baseline"], words].concat());
        assert_eq!(outcome.code, Some(2), "{words:?} {}", outcome.stderr);
        assert!(
            outcome.stderr.contains(part),
            "{words:?} {}",
            outcome.stderr
        );
        assert_eq!(
            outcome.stderr.trim_end().lines().count(),
            1,
            "{}",
            outcome.stderr
        );
    }
    std::fs::write(accepted.join("baseline.toml"), "scene = 1").unwrap();
    let spoiled = run_in(base.path(), CHECK);
    assert_eq!(spoiled.code, Some(2), "{}", spoiled.stderr);
    assert!(
        spoiled.stderr.contains("baseline.toml"),
        "{}",
        spoiled.stderr
    );
    assert_eq!(names_in(&accepted), before);
    assert_eq!(names_in(base.path()), ["baselines"]);
}
