//! External solvers in the program: the examples in every available language, and one written from the header alone.
#![cfg(unix)]
#![allow(clippy::print_stdout)] // skipped parts, and the table of trials

use std::path::{Path, PathBuf};
use std::process::Command;

use pinwheel_tests::{pinwheel, repository, run_in, words};
use pinwheel_timeseries::{TimeSeries, columns};
use tempfile::TempDir;

/// Returns a path with the program's folder first, as for an installed program.
fn path() -> std::ffi::OsString {
    let program = PathBuf::from(pinwheel().get_program());
    let own = program.parent().map(Path::to_owned);
    let others = std::env::var_os("PATH").unwrap_or_default();
    std::env::join_paths(own.into_iter().chain(std::env::split_paths(&others))).expect("paths")
}

fn is_here(program: &str) -> bool {
    let available = Command::new(program).arg("--version").output();
    let available = available.is_ok_and(|output| output.status.success());
    if !available {
        println!("skipped: no {program} here");
    }
    available
}

/// Builds a solver by the command in its manifest.
fn build(folder: &Path) {
    let text = std::fs::read_to_string(folder.join("solver.toml")).expect("manifest");
    let stated = text
        .lines()
        .find_map(|line| line.strip_prefix("build = \""));
    let Some(line) = stated.map(|line| line.trim_end_matches('"').replace("\\\"", "\"")) else {
        return;
    };
    let built = Command::new("sh")
        .args(["-c", &line])
        .current_dir(folder)
        .env("PATH", path())
        .output()
        .expect("a shell");
    let words = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "{line}\n{words}");
}

/// Returns a folder with the built example in a language, called `mine`; `None` without its compiler.
fn example(language: &str, compiler: &str) -> Option<TempDir> {
    if !is_here(compiler) {
        return None;
    }
    let folder = tempfile::tempdir().expect("folder");
    let written = run_in(
        folder.path(),
        ["solver", "new", "--language", language, "mine"],
    );
    assert_eq!(written.code, Some(0), "{}", written.stderr);
    assert!(
        written
            .stdout
            .contains("pinwheel solver check mine/solver.toml")
    );
    build(&folder.path().join("mine"));
    Some(folder)
}

fn conforms(language: &str, compiler: &str) {
    let Some(folder) = example(language, compiler) else {
        return;
    };
    let words = words("solver check mine/solver.toml --junit junit.xml");
    let checked = run_in(folder.path(), words);
    assert_eq!(checked.code, Some(0), "{checked:?}");
    assert!(checked.stdout.contains("trials passed"), "{checked:?}");
    let page = std::fs::read_to_string(folder.path().join("out/mine-check/index.html"));
    assert!(page.expect("a page").contains("broken job"));
    // The verdict on the solver comes first, on the terminal and in the JUnit file.
    let agrees = checked.stdout.lines().next().unwrap_or_default();
    assert!(agrees.starts_with("mine: agrees: to "), "{checked:?}");
    let junit = std::fs::read_to_string(folder.path().join("junit.xml")).expect("junit");
    assert!(
        junit.contains("failures=\"0\"") && junit.contains("runs: a run of 0.02 s finishes"),
        "{junit}"
    );
}

#[test]
fn crossval_c_conforms() {
    conforms("c", "cc");
}

#[test]
#[ignore = "weekly: 3 s for a third language"]
fn crossval_cpp_conforms() {
    conforms("cpp", "c++");
}

#[test]
fn crossval_fortran_conforms() {
    conforms("fortran", "gfortran");
}

#[test]
#[ignore = "weekly: 10 s for a fourth language"]
fn crossval_python_conforms() {
    conforms("python", "python3");
}

fn time_series(folder: &Path, words: &[&str]) -> TimeSeries {
    let ran = run_in(folder, words);
    assert_eq!(ran.code, Some(0), "{words:?}\n{}", ran.stderr);
    let out = words.last().expect("--out is last");
    TimeSeries::load_csv(&folder.join(out).join("courses.csv")).expect("courses")
}

/// Heun on the angles in Fortran, the paper's language, and the native `rk2`: one method on equal equations by two codes.
#[test]
fn crossval_fortran_heun_is_native_rk2() {
    let Some(folder) = example("fortran", "gfortran") else {
        return;
    };
    let set = ["--set", "solver.duration_s=0.05"];
    let head = words("run paper --set solver.integrator=rk2 --unchecked");
    let native = time_series(
        folder.path(),
        &[&head[..], &set, &["--out", "native"]].concat(),
    );
    let solver = ["--solver", "mine/solver.toml", "--out", "fortran"];
    let fortran = time_series(folder.path(), &[&head[..4], &set, &solver].concat());
    let channel = |time_series: &TimeSeries| {
        time_series
            .channel(columns::INPUT_TORQUE)
            .map(<[f64]>::to_vec)
    };
    let (a, b) = (
        channel(&native).expect("there"),
        channel(&fortran).expect("there"),
    );
    let square = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
    let off = square(&mut a.iter().zip(&b).map(|(a, b)| a - b)) / square(&mut a.iter().copied());
    println!("fortran-heun against native rk2: {off:.2e} in the driver torque");
    // Measured 9e-14: equal steps on equal angles, so only rounding remains, which contacts amplify. Times 1e4.
    assert!(off < 1e-9, "{off:e}");
}

/// Returns a folder with the solver of `tests/data/NAME`, built by `line`.
fn built(name: &str, line: &str) -> Option<TempDir> {
    if !is_here("cc") {
        return None;
    }
    let folder = tempfile::tempdir().expect("folder");
    for file in std::fs::read_dir(repository("tests/data").join(name)).expect("data") {
        let file = file.expect("file");
        std::fs::copy(file.path(), folder.path().join(file.file_name())).expect("copied");
    }
    std::fs::copy(
        repository("crates/law/include/pinwheel_law.h"),
        folder.path().join("pinwheel_law.h"),
    )
    .expect("copied");
    let built = Command::new("sh")
        .args(["-c", line])
        .current_dir(folder.path())
        .env("PATH", path())
        .output()
        .expect("a shell");
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    Some(folder)
}

/// Returns the solver written from the header alone.
fn held_out() -> Option<TempDir> {
    let line = "cc -O2 -o solver midpoint.c -L\"$(pinwheel solver library)\" -lpinwheel_law -lm";
    built("held-out", line)
}

/// Returns the solver with its own law, before [`commit`] adds a fault.
pub(crate) fn faulty() -> Option<TempDir> {
    let line = "cc -O2 -o solver solver.c -L\"$(pinwheel solver library)\" -lpinwheel_law -lm";
    built("faulty", line)
}

/// Sets a fault of the solver of [`faulty`]; `none` removes it.
pub(crate) fn commit(folder: &Path, fault: &str) {
    let manifest = std::fs::read_to_string(repository("tests/data/faulty/solver.toml"));
    let manifest = manifest.expect("manifest");
    let with = manifest.replace("\"none\"", &format!("{fault:?}"));
    std::fs::write(folder.join("solver.toml"), with).expect("written");
}

/// Tries a solver with a fault: its trial, its quantity and its stage are named, with place and time.
fn check_names(fault: &str, trial: &str, quantity: &str, stage: &str) {
    let Some(folder) = faulty() else { return };
    commit(folder.path(), fault);
    let ran = run_in(
        folder.path(),
        words("solver check solver.toml --junit j.xml"),
    );
    let code = i32::from(fault != "none");
    assert_eq!(ran.code, Some(code), "{}{}", ran.stdout, ran.stderr);
    if fault == "none" {
        return;
    }
    let at = folder.path().join("out/faulty-check/summary.json");
    let summary: serde_json::Value =
        serde_json::from_slice(&std::fs::read(at).expect("summary")).expect("json");
    let answer = summary["answer"].as_str().unwrap_or_default();
    assert!(answer.starts_with("faulty: differs: "), "{answer}");
    assert!(
        summary.to_string().contains(&format!("stage {stage}")) || stage.is_empty(),
        "{summary}"
    );
    let page = std::fs::read_to_string(folder.path().join("out/faulty-check/index.html"));
    let page = page.expect("a page");
    assert_eq!(page.contains("Over time: "), !stage.is_empty());
    let failed = summary["findings"].as_array().into_iter().flatten();
    let mut failed = failed.filter(|finding| finding["state"] == "failed");
    let named = failed.any(|finding| {
        let facts = finding["seen"].as_str().unwrap_or_default();
        let line = format!("{}: {facts}", finding["name"].as_str().unwrap_or_default());
        let dated = facts.contains(" off at t = ") || !quantity.starts_with("sleeve");
        line.contains(trial) && facts.contains(quantity) && dated
    });
    assert!(named, "{summary}");
    let junit = std::fs::read_to_string(folder.path().join("j.xml")).expect("junit");
    let first = junit.lines().find(|line| line.contains("<failure"));
    assert!(
        first.is_some_and(|line| line.contains("faulty: differs")),
        "{junit}"
    );
}

/// Tests of a check, one for each fault, as a check takes seconds: fault, trial, quantity and stage.
macro_rules! checks {
    ($($(#[$weekly:meta])? $test:ident: $fault:literal $trial:literal $quantity:literal $stage:literal;)*) => {
        $(#[test]
        $(#[$weekly])?
        fn $test() {
            check_names($fault, $trial, $quantity, $stage);
        })*
    };
}

checks! {
    crossval_a_check_passes_own_contacts: "none" "" "" "";
    crossval_a_check_names_friction: "friction" "friction" "sleeve_force_n_" "law, likely friction: friction of all contacts with the other sign";
    crossval_a_check_names_curvature: "curvature" "law vectors" "sleeve_force_n_" "law, likely curvature: curvature of the other sign in pits";
    crossval_a_check_names_inertia: "inertia" "laws" "sleeve_force_n_" "equations, likely inertia: mass of the output pins on the output shaft, missing";
    #[ignore = "weekly: 3 s for a second fault of the trial of contacts"]
    crossval_a_check_names_a_phase: "phase" "contacts" "sleeve_force_n_" "start, likely phase: phase of disc 1's eccentric off by 1.000e-3";
    crossval_a_check_names_a_step: "step" "runs" "the output shaft is" "";
    crossval_a_check_names_damping: "damping" "contacts" "sleeve_force_n_" "law, likely damping: damping without its ramp";
    crossval_a_check_names_an_order: "order" "accuracy" "order " "integration: off by";
    crossval_a_check_names_long_steps: "long-step" "repeats" "longer than solver.step_s" "";
}

/// A record reports the solver's errors, and keeps the scenes that were not requested.
#[test]
fn regress_a_record_merges_and_names_what_is_wrong() {
    let Some(folder) = faulty() else { return };
    let ran = |line: &str| {
        run_in(
            folder.path(),
            words(&format!("{line} --dir b --solver solver.toml")),
        )
    };
    commit(folder.path(), "curvature");
    let wrong = ran("baseline record mine --only paper");
    assert_eq!(wrong.code, Some(0), "{}{}", wrong.stdout, wrong.stderr);
    assert!(
        wrong.stdout.starts_with("faulty: DIFFERS in 1 of 1 cases"),
        "{}",
        wrong.stdout
    );
    commit(folder.path(), "none");
    let right = ran("baseline record mine --accept pits --only paper");
    assert!(
        right
            .stdout
            .starts_with("faulty: 1 cases recorded, none more than"),
        "{}",
        right.stdout
    );
    let more = ran("baseline record mine --accept more --only one-wheel,flores");
    // A refused scene was requested and is not stored.
    assert_eq!(more.code, Some(4), "{}{}", more.stdout, more.stderr);
    assert!(
        more.stdout
            .contains("not recorded by faulty: flores: its manifest"),
        "{}",
        more.stdout
    );
    // A solver that diverges on one scene is recorded on the others.
    commit(folder.path(), "away");
    let away = ran("baseline record other --only paper,one-wheel");
    let note = "not recorded by faulty: one-wheel: diverged at t =";
    assert!(
        away.code == Some(4) && away.stdout.contains(note),
        "{}{}",
        away.stdout,
        away.stderr
    );
    commit(folder.path(), "none");
    let text = std::fs::read_to_string(folder.path().join("b/mine/baseline.toml")).expect("there");
    let scenes: Vec<&str> = text
        .lines()
        .filter(|line| line.starts_with("name = "))
        .collect();
    assert_eq!(scenes, ["name = \"paper\"", "name = \"one-wheel\""]);
    assert!(text.contains("more (only one-wheel, flores)"), "{text}");

    let both = ran("baseline check mine");
    assert_eq!(both.code, Some(0), "{}{}", both.stdout, both.stderr);
    assert!(
        both.stdout.starts_with("faulty: 2 same to rounding"),
        "{}",
        both.stdout
    );
    // The changed stage is named.
    commit(folder.path(), "curvature");
    let moved = ran("baseline check mine --junit k.xml --only paper");
    let named = "stage law, likely curvature: curvature of the other sign in pits";
    let stdout = moved.stdout.replace('\n', " ");
    assert!(moved.code == Some(1) && stdout.contains(named), "{stdout}");
    let junit = std::fs::read_to_string(folder.path().join("k.xml")).expect("junit");
    assert!(junit.contains(named), "{junit}");
    commit(folder.path(), "none");
    // Scenes without a record, and refused scenes, get no verdict.
    for only in ["eleven-pins", "flores"] {
        let nothing = ran(&format!("baseline check mine --junit j.xml --only {only}"));
        assert_eq!(
            nothing.code,
            Some(4),
            "{}{}",
            nothing.stdout,
            nothing.stderr
        );
        let start = format!("faulty: nothing shown: 1 not in the baseline: {only} ");
        assert!(nothing.stdout.starts_with(&start), "{}", nothing.stdout);
        let junit = std::fs::read_to_string(folder.path().join("j.xml")).expect("junit");
        assert!(
            junit.contains("failures=\"2\"") && junit.contains("nothing shown"),
            "{junit}"
        );
    }
    // A solver that no longer supports a recorded scene.
    let manifest = folder.path().join("solver.toml");
    let narrow = std::fs::read_to_string(&manifest).expect("there");
    std::fs::write(&manifest, narrow.replace("[\"paper\"]", "[\"kunert\"]")).expect("written");
    let gone = ran("baseline check mine");
    assert_eq!(gone.code, Some(1), "{}{}", gone.stdout, gone.stderr);
    assert!(
        gone.stdout.starts_with("faulty: 2 worse: paper (refused: "),
        "{}",
        gone.stdout
    );
    let none = ran("baseline record none");
    assert_eq!(none.code, Some(4), "{}{}", none.stdout, none.stderr);
    let one = none.stderr.trim_end().lines().count() == 1;
    assert!(
        one && none.stderr.contains("faulty: nothing recorded"),
        "{}",
        none.stderr
    );
    assert!(!folder.path().join("b/none").exists());
    // Scenes of different solvers are not mixed.
    let own = run_in(
        folder.path(),
        words("baseline record mine --dir b --accept x --only paper"),
    );
    assert_eq!(own.code, Some(2), "{}", own.stderr);
    assert!(own.stderr.contains("was made by faulty"), "{}", own.stderr);
}

#[test]
fn crossval_a_held_out_solver_joins_every_command() {
    let Some(folder) = held_out() else { return };
    let short = ["--set", "solver.duration_s=0.02", "--solver", "solver.toml"];
    let natives = ["--engines", "native-reduced,native-resolved"];
    let run = |words: &[&str]| {
        let ran = run_in(folder.path(), [words, &short].concat());
        assert_eq!(ran.code, Some(0), "{words:?}\n{}{}", ran.stdout, ran.stderr);
        ran.stdout
    };
    let compared = run(&[
        "compare",
        "paper",
        natives[0],
        natives[1],
        "--junit",
        "junit.xml",
        "--verbose",
    ]);
    assert!(
        compared.contains("resolved / held-out-midpoint"),
        "{compared}"
    );
    let line = compared
        .lines()
        .find(|line| line.starts_with("held-out-midpoint "));
    assert!(
        line.is_some_and(|line| line.contains("agrees to ")),
        "{compared}"
    );
    assert!(compared.contains("PASS, ONE CONTACT LAW"), "{compared}");
    let junit = std::fs::read_to_string(folder.path().join("junit.xml")).expect("junit");
    assert!(
        junit.contains("native-resolved and held-out-midpoint"),
        "{junit}"
    );

    let parts = words("bench paper --engines native-reduced --methods rk4");
    let bench = run(&[&parts[..], &["--repeats", "1"]].concat());
    assert!(bench.contains("held-out-midpoint"), "{bench}");

    let sweep =
        "scene = \"paper\"\nengines = [\"native\"]\n[vary]\ngear.backlash_m = [0.0, 3e-4]\n";
    std::fs::write(folder.path().join("sweep.toml"), sweep).expect("written");
    run(&["sweep", "sweep.toml", "--out", "swept"]);
    let table = std::fs::read_to_string(folder.path().join("swept/results.csv")).expect("table");
    assert_eq!(table.matches("held-out-midpoint").count(), 2, "{table}");
}

/// Status 0 needs evidence on the solver, and the first lines name it.
#[test]
fn crossval_nothing_shown_of_a_solver_is_no_pass() {
    let Some(folder) = example("python", "python3") else {
        return;
    };
    let manifest = folder.path().join("mine/solver.toml");
    let right = std::fs::read_to_string(&manifest).expect("manifest");
    let (before, _) = right.split_once("[refine]").expect("a study");
    let command = right.lines().find(|line| line.starts_with("command"));
    let broken = right.replace(command.expect("a command"), "command = [\"false\"]");
    let compare = "compare paper --engines native-resolved,native-reduced --set solver.duration_s=0.01 \
                   --solver mine/solver.toml --junit junit.xml --out out --force";
    for (text, words, code, line, failures) in [
        (&right, compare, 0, "mine agrees to ", 0),
        (
            &before.to_owned(),
            compare,
            4,
            "mine nothing shown: it does not say",
            1,
        ),
        (&broken, compare, 3, "mine nothing shown: its run failed", 2),
        (
            &broken,
            "stability paper --quick --solver mine/solver.toml",
            4,
            "mine: nothing shown: right in no scene",
            0,
        ),
    ] {
        std::fs::write(&manifest, text).expect("manifest");
        let done = run_in(folder.path(), pinwheel_tests::words(words));
        let top: Vec<&str> = done
            .stdout
            .lines()
            .take(12)
            .flat_map(str::split_whitespace)
            .collect();
        assert_eq!(done.code, Some(code), "{}{}", done.stdout, done.stderr);
        assert!(top.join(" ").contains(line), "{}", done.stdout);
        if words == compare {
            // Programs that read the summary find no pass that the status denies.
            let summary = std::fs::read_to_string(folder.path().join("out/summary.json"));
            let passed = summary.expect("summary").contains("\"passed\": true");
            assert_eq!(passed, code == 0, "{line}");
            let junit = std::fs::read_to_string(folder.path().join("junit.xml")).expect("junit");
            assert!(
                junit.contains(&format!("failures=\"{failures}\"")),
                "{junit}"
            );
        }
    }
}

#[test]
fn regress_a_baseline_sees_a_change_of_the_solver() {
    let Some(folder) = held_out() else { return };
    let solver = words("--dir b --only eleven-pins --solver solver.toml");
    let ran = |words: &[&str]| run_in(folder.path(), [words, &solver].concat());
    let recorded = ran(&["baseline", "record", "mine"]);
    assert_eq!(recorded.code, Some(0), "{}", recorded.stderr);
    let same = ran(&["baseline", "check", "mine"]);
    assert_eq!(same.code, Some(0), "{}{}", same.stdout, same.stderr);

    // Each change affects the intended figures: errors, or counts.
    let source = folder.path().join("midpoint.c");
    let text = std::fs::read_to_string(&source).expect("source");
    let line = "cc -O2 -o solver midpoint.c -L\"$(pinwheel solver library)\" -lpinwheel_law -lm";
    let damped = "for (b = 0; b < count; b++) state[b][3] *= 0.9, state[b][4] *= 0.9, state[b][5] *= 0.9;\n    \
                  if (pinwheel_law_loads(gear";
    for (what, from, to, expected, shared_error) in [
        // Cheaper, with a larger error: no trade.
        (
            "the midpoint rule is no longer solved",
            "again < 8",
            "again < 1",
            "error of",
            "sides",
        ),
        (
            "every contact is damped by a tenth less",
            "if (pinwheel_law_loads(gear",
            damped,
            "error of",
            "sides",
        ),
        (
            "steps of half the length",
            "/ pinwheel_law_step(gear)",
            "/ (0.5 * pinwheel_law_step(gear))",
            "",
            "",
        ),
    ] {
        assert!(text.contains(from), "{what}");
        std::fs::write(&source, text.replace(from, to)).expect("written");
        let built = Command::new("sh")
            .args(["-c", line])
            .current_dir(folder.path())
            .env("PATH", path())
            .status();
        assert!(built.expect("a shell").success(), "{what}");
        let junit = ["--junit", "junit.xml"];
        let worse = ran(&[&["baseline", "check", "mine"][..], &junit].concat());
        let log = format!("{what}\n{}{}", worse.stdout, worse.stderr);
        // Half the step at least halves the error, which is worth its steps.
        let traded = expected.is_empty();
        assert_eq!(worse.code, Some(if traded { 0 } else { 1 }), "{log}");
        let verdict = if traded { "traded" } else { "worse" };
        let start = format!("held-out-midpoint: 1 {verdict}: eleven-pins");
        assert!(worse.stdout.starts_with(&start), "{log}");
        if traded {
            continue;
        }
        let junit = std::fs::read_to_string(folder.path().join("junit.xml")).expect("junit");
        // The first failure is the solver's, the second the case's.
        let failure = junit
            .lines()
            .filter(|line| line.contains("<failure"))
            .nth(1);
        let failure = failure.unwrap_or_default();
        assert!(
            failure.contains(expected) && !failure.contains(shared_error),
            "{what}\n{junit}"
        );
    }

    // A baseline applies only to the solvers that made it.
    let other = run_in(folder.path(), ["baseline", "check", "mine", "--dir", "b"]);
    assert_eq!(other.code, Some(2));
    assert!(
        other.stderr.contains("was made by held-out-midpoint"),
        "{}",
        other.stderr
    );
}

#[test]
fn bad_input_of_solvers_is_one_line() {
    let folder = tempfile::tempdir().expect("folder");
    let manifest = std::fs::read_to_string(repository("examples/solvers/c-rk4/solver.toml"));
    let manifest = manifest.expect("example");
    let at = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("written");
    };
    at("one.toml", &manifest);
    at("bad.toml", &manifest.replace("{job}", "{jobs}"));
    std::fs::create_dir(folder.path().join("taken")).expect("made");
    std::fs::write(folder.path().join("taken/notes.txt"), "precious").expect("written");
    for (words, code, message) in [
        (
            &["run", "paper", "--solver", "none.toml"][..],
            2,
            "cannot be read",
        ),
        (
            &["run", "paper", "--solver", "bad.toml"],
            2,
            "known are {here}",
        ),
        (
            &["run", "paper", "--solver", "one.toml"],
            3,
            "does not start",
        ),
        (
            &[
                "compare", "paper", "--solver", "one.toml", "--solver", "one.toml",
            ],
            2,
            "name each --solver once",
        ),
        (
            &[
                "run",
                "paper",
                "--engine",
                "rapier-colliders",
                "--solver",
                "one.toml",
            ],
            2,
            "leave one out, or type `pinwheel compare SCENE --engines rapier-colliders --solver one.toml`",
        ),
        // An engine named twice runs once.
        (
            &["run", "paper", "--engine", "c-rk4", "--solver", "one.toml"],
            3,
            "does not start",
        ),
        (
            &["run", "paper", "--engine", "one.toml"],
            2,
            "a solver of your own joins by `--solver one.toml`",
        ),
        (
            &["solver", "new", "--language", "c", "../up"],
            2,
            "small letters",
        ),
        (
            &["solver", "new", "--language", "c", "taken"],
            2,
            "choose another name",
        ),
        (
            &["solver", "new", "--language", "c", "native-mine"],
            2,
            "choose another name",
        ),
        (&["solver", "check", "none.toml"], 2, "cannot be read"),
        (
            &["solver", "job", "papre", "job"],
            2,
            "did you mean the preset `paper`?",
        ),
    ] {
        let ended = run_in(folder.path(), words);
        assert_eq!(ended.code, Some(code), "{words:?} {}", ended.stderr);
        assert!(ended.stderr.contains(message), "{words:?} {}", ended.stderr);
        assert_eq!(
            ended.stderr.trim().lines().count(),
            1,
            "{words:?} {}",
            ended.stderr
        );
    }
    assert!(!folder.path().join("job").exists());
}

/// A program stopped twice ends at once, and its solver with it.
#[test]
fn hard_a_second_signal_leaves_nothing_running() {
    let folder = tempfile::tempdir().expect("folder");
    let at = |name: &str| folder.path().join(name);
    let manifest = "protocol = 1\nname = \"sleeper\"\nversion = \"1\"\ntrack = \"own-contact\"\nsummary = \"sleeps\"\n\
        command = [\"/bin/sh\", \"-c\", \"trap '' TERM; echo $$ > '{here}/pid'; while :; do sleep 1; done\"]\n";
    std::fs::write(at("solver.toml"), manifest).expect("written");
    let mut program = pinwheel()
        .args(["run", "paper", "--solver", "solver.toml"])
        .current_dir(folder.path())
        .spawn()
        .expect("it starts");
    let pid = || std::fs::read_to_string(at("pid")).unwrap_or_default();
    for _ in 0..500 {
        if !pid().trim().is_empty() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let own = program.id().to_string();
    let kill = || Command::new("kill").args(["-INT", &own]).status();
    kill().expect("kill");
    std::thread::sleep(std::time::Duration::from_millis(50));
    kill().expect("kill");
    let ended = program.wait().expect("it ends");
    assert_eq!(ended.code(), Some(130));
    let pid = pid();
    assert!(!pid.trim().is_empty(), "the solver never ran");
    // A zombie process has ended, too.
    let stat = format!("/proc/{}/stat", pid.trim());
    for _ in 0..100 {
        let lives = std::fs::read_to_string(&stat).is_ok_and(|stat| !stat.contains(") Z "));
        if !lives {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    panic!("{} still runs", pid.trim());
}
