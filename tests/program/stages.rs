//! The stage of a solver that differs, on the first screen and on the page of a comparison.
#![cfg(unix)]

use pinwheel_tests::{run_in, words};

use crate::solvers::{commit, faulty};

/// A solver whose curvature has the other sign in pits, and one that is right.
#[test]
fn crossval_a_comparison_names_the_stage() {
    let Some(folder) = faulty() else { return };
    let compare = "compare paper --set solver.duration_s=0.01 --engines native-resolved,faulty --solver solver.toml --out out";
    for (fault, named) in [("curvature", "law, likely curvature"), ("none", "")] {
        commit(folder.path(), fault);
        let ran = run_in(folder.path(), words(compare));
        let lines: Vec<&str> = ran.stdout.lines().take(12).collect();
        let stage = lines.iter().find(|line| line.starts_with("stage"));
        assert_eq!(
            stage.is_some(),
            !named.is_empty(),
            "{fault}: {}{}",
            ran.stdout,
            ran.stderr
        );
        assert!(
            stage.is_none_or(|line| line.contains(named)),
            "{}",
            ran.stdout
        );
        let page = std::fs::read_to_string(folder.path().join("out/index.html")).expect("a page");
        assert_eq!(
            page.contains("By place on a lobe"),
            !named.is_empty(),
            "{fault}"
        );
    }
}
