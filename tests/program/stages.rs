//! Names of the stage in which a solver differs, on the first screen and on the page of a comparison.
#![cfg(unix)]

use pinwheel_tests::{run_in, words};

use crate::solvers::{commit, faulty};

/// Compares solvers with one fault each: the first screen names the stage, and the page draws it. A correct solver and an engine
/// with its own contacts are not accused.
#[test]
fn crossval_a_comparison_names_the_stage() {
    let Some(folder) = faulty() else { return };
    let compare = "compare paper --set solver.duration_s=0.01 --engines native-resolved,rapier-colliders,faulty --solver solver.toml --out out";
    for (fault, named, drawn) in [
        ("none", "", ""),
        ("phase", "start, likely phase", "By place on a lobe: law"),
        ("search", "contact search: off by", "By pin: contact search"),
        (
            "curvature",
            "law, likely curvature",
            "By place on a lobe: law",
        ),
        ("exponent", "law, likely exponent", "By pin: law"),
        ("sum", "assembly, likely torque", "Over time: assembly"),
        (
            "inertia",
            "equations, likely inertia",
            "By coordinate: equations",
        ),
        ("driver", "driver, likely share", "Over time: driver"),
    ] {
        commit(folder.path(), fault);
        let ran = run_in(folder.path(), words(compare));
        let log = format!("{fault}: {}{}", ran.stdout, ran.stderr);
        let lines: Vec<&str> = ran.stdout.lines().take(12).collect();
        let mut stages = lines.iter().filter(|line| line.starts_with("stage"));
        let stage = stages.next();
        assert_eq!(stage.is_some(), !named.is_empty(), "{log}");
        assert!(stage.is_none_or(|line| line.contains(named)), "{log}");
        let page = std::fs::read_to_string(folder.path().join("out/index.html")).expect("a page");
        assert!(page.contains(drawn), "{log}");
        assert_eq!(page.contains("off above"), !named.is_empty(), "{log}");
    }
}

/// Compares with records without states: one of this gear, and one with twice its load.
#[test]
fn crossval_a_record_names_the_stage() {
    let folder = tempfile::tempdir().expect("folder");
    let ran = |line: &str| {
        let ran = run_in(folder.path(), words(line));
        (ran.stdout.replace('\n', " "), ran.stderr)
    };
    let columns = "[columns]\ninput_torque_n_m = \"input_torque_n_m\"\noutput_torque_n_m = \"output_torque_n_m\"\noutput_angle_rad = \
                   \"output_angle_rad\"\n\"external_sleeve_force_n_*\" = \"external_sleeve_force_n_*\"\n\"internal_sleeve_force_n_*\" = \
                   \"internal_sleeve_force_n_*\"\n";
    std::fs::write(folder.path().join("map.toml"), columns).expect("written");
    for (set, named) in [
        ("drive.output_torque_n_m=22.0", None),
        (
            "drive.output_torque_n_m=44.0",
            Some("equations, likely load: load twice"),
        ),
    ] {
        ran(&format!(
            "run paper --set solver.duration_s=0.01 --set {set} --out rig --force"
        ));
        let (stdout, wrong) = ran(
            "compare paper --set solver.duration_s=0.01 --engines native-resolved --against rig/courses.csv --map map.toml",
        );
        assert_eq!(
            stdout.contains("likely"),
            named.is_some(),
            "{set}: {stdout}{wrong}"
        );
        assert!(named.is_none_or(|named| stdout.contains(named)), "{stdout}");
    }
}
