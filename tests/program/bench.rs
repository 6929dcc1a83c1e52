//! `pinwheel bench` in use.

use pinwheel_tests::{names_in, run_in, words};
use serde_json::Value;

const SHORT: [&str; 2] = ["--set", "solver.duration_s=0.005"];

fn bench(dir: &std::path::Path, words: &[&str]) -> pinwheel_tests::Outcome {
    run_in(dir, ["bench", "paper"].iter().chain(words).chain(&SHORT))
}

#[test]
fn program_bench_writes_page_tables_and_summary() {
    let dir = tempfile::tempdir().unwrap();
    let words =
        words("--engines native,rapier-shared-law --methods rk4,dopri5 --repeats 1 --out b");
    let outcome = bench(dir.path(), &words);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    assert_eq!(outcome.stderr, "", "progress belongs on terminals only");
    for part in [
        "native-lagrange dopri5",
        "times faster than rapier-shared-law",
        "page: b/index.html",
    ] {
        assert!(outcome.stdout.contains(part), "{part}: {}", outcome.stdout);
    }
    let out = dir.path().join("b");
    assert_eq!(names_in(&out), ["bench.csv", "index.html", "summary.json"]);
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    for part in [
        "What is unequal",
        "semi-implicit Euler",
        "--methods rk4,dopri5",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let summary: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["complete"], true);
    let series = summary["work_precision"]["series"].as_array().unwrap();
    assert_eq!(series.len(), 5);
    assert!(
        summary["rankings"][0]["advantage"]["ratio"]
            .as_f64()
            .unwrap()
            > 0.0
    );

    // The earlier output may be replaced.
    let again = bench(dir.path(), &words);
    assert_eq!(again.code, Some(0), "{again:?}");
}

#[test]
fn program_bench_refuses_what_it_cannot_measure() {
    let dir = tempfile::tempdir().unwrap();
    for (words, code, part) in [
        (&["--engines", "native-resolved"][..], 2, "native-lagrange"),
        (&["--methods", "rk5"], 2, "integrator `rk5`"),
        (&["--target", "0"], 2, "target: 0"),
        (&["--longest=-1"], 2, "longest: -1"),
        (&["--repeats", "0"], 2, "--repeats"),
    ] {
        let outcome = bench(dir.path(), words);
        assert_eq!(outcome.code, Some(code), "{words:?}: {outcome:?}");
        let line = outcome.stderr.trim_end();
        assert!(line.contains(part) && !line.contains('\n'), "{line}");
        assert!(names_in(dir.path()).is_empty());
    }
}
