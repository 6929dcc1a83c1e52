//! Invalid input of any kind: one line on stderr with the place, the key and the remedy, exit status 2, nothing on stdout,
//! nothing written.

use std::path::Path;
use std::process::{Command, Stdio};

use pinwheel_tests::{Outcome, names_in, pinwheel, run_in, words};

/// Asserts the form of a refusal and returns its line.
fn refusal(outcome: &Outcome, what: &str) -> String {
    assert_eq!(outcome.code, Some(2), "{what}: {outcome:?}");
    assert_eq!(outcome.stdout, "", "{what}");
    let line = outcome.stderr.trim_end_matches('\n');
    assert!(!line.contains('\n'), "{what}: more than one line: {line}");
    assert!(line.starts_with("error: "), "{what}: {line}");
    // The line consists of fault and remedy.
    assert!(line.contains("; "), "{what}: no remedy: {line}");
    line.to_owned()
}

/// Runs every command for a scene on `paper` with these overrides; all must refuse alike.
fn refused(sets: &[&str]) -> String {
    let dir = tempfile::tempdir().unwrap();
    let mut lines = ["run", "compare", "explain"].map(|command| {
        let mut args = vec![command, "paper"];
        sets.iter().for_each(|set| args.extend(["--set", set]));
        refusal(&run_in(dir.path(), args), &sets.join(" "))
    });
    assert!(
        names_in(dir.path()).is_empty(),
        "{:?}",
        names_in(dir.path())
    );
    assert_eq!(lines[0], lines[1]);
    assert_eq!(lines[0], lines[2]);
    std::mem::take(&mut lines[0])
}

/// Runs the text as a scene file called `mine.toml`.
fn refused_file(text: impl AsRef<[u8]>) -> String {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("mine.toml"), text).unwrap();
    let line = refusal(&run_in(dir.path(), ["run", "mine.toml"]), "mine.toml");
    assert_eq!(names_in(dir.path()), ["mine.toml"]);
    line
}

fn assert_parts(line: &str, parts: &[&str]) {
    for part in parts {
        assert!(line.contains(part), "`{part}` is not in: {line}");
    }
}

/// On GitHub Actions the line of a fault is also an annotation.
#[test]
fn bad_input_is_an_annotation_on_github() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(
        dir.path().join("mine.toml"),
        "base = \"paper\"\n[gear]\nwheels = 0\n",
    )
    .unwrap();
    let mut command = pinwheel();
    command.args(["run", "mine.toml"]).current_dir(dir.path());
    let output = command.env("GITHUB_ACTIONS", "true").output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(
        stderr.contains("\n::error file=mine.toml,line=3::mine.toml, line 3: "),
        "{stderr}"
    );
    // The annotation of a verdict is one sentence, without the table.
    for (typed, verdict) in [
        (
            "design paper --statics --set limits.pressure_pa=1e6",
            "::error::bears its load: no: ",
        ),
        (
            "compare paper --engines reduced --set solver.duration_s=0.002",
            "::warning::Not confirmed: ",
        ),
    ] {
        let mut command = pinwheel();
        command.args(words(typed)).current_dir(dir.path());
        let output = command.env("GITHUB_ACTIONS", "true").output().unwrap();
        let log = String::from_utf8(output.stderr).unwrap();
        assert!(log.contains(verdict) && !log.contains("%0A"), "{log}");
    }
}

#[test]
fn bad_input_two_designs() {
    let dir = tempfile::tempdir().unwrap();
    let idle = "base = \"paper\"\n[drive]\noutput_torque_n_m = 0.0\n";
    std::fs::write(dir.path().join("idle.toml"), idle).unwrap();
    for (words, part) in [
        (&["paper", "papper"][..], "paper"),
        (&["paper", "idle.toml"], "drive.output_torque_n_m"),
        (
            &words("paper steel --engines native-reduced,native-lagrange"),
            "one engine",
        ),
        (&["paper", "steel", "--junit", "j.xml"], "--junit"),
        (&["paper", "steel", "--set", "gear.wheels=0"], "gear.wheels"),
        (&["paper", "steel", "eleven-pins"], "eleven-pins"),
    ] {
        let line = refusal(&run_in(dir.path(), ["compare"].iter().chain(words)), part);
        assert!(line.contains(part), "{words:?}: {line}");
    }
    assert_eq!(names_in(dir.path()), ["idle.toml"]);
}

#[test]
fn bad_input_unknown_key() {
    let line = refused_file("name = \"mine\"\n\n[gear]\nhole_radius = 0.0088\n");
    assert_parts(
        &line,
        &[
            "mine.toml, line 4",
            "`gear.hole_radius`",
            "did you mean `gear.hole_radius_m`?",
        ],
    );
}

#[test]
fn bad_input_missing_file() {
    let dir = tempfile::tempdir().unwrap();
    let line = refusal(&run_in(dir.path(), ["run", "no/such.toml"]), "missing file");
    assert_parts(
        &line,
        &[
            "`no/such.toml`",
            "give the path of a scene file or a preset",
        ],
    );
    let line = refusal(&run_in(dir.path(), ["explain", "papr"]), "missing preset");
    assert_parts(&line, &["`papr`", "did you mean the preset `paper`?"]);
}

#[test]
fn bad_input_unreadable_files() {
    let line = refused_file(b"[gear]\nwheels = 2 # \xff\n");
    assert_parts(&line, &["mine.toml, line 2", "UTF-8"]);
    let line = refused_file("#".repeat(2 << 20));
    assert_parts(&line, &["longer than"]);
    let dir = tempfile::tempdir().unwrap();
    let line = refusal(&run_in(dir.path(), ["run", "."]), "a folder");
    assert_parts(&line, &["cannot be read"]);
}

#[test]
fn bad_input_wrong_type() {
    let line = refused_file("[gear]\nwheels = \"two\"\n");
    assert_parts(
        &line,
        &["mine.toml, line 2", "`gear.wheels`", "a whole number"],
    );
}

#[test]
fn bad_input_negative_radius() {
    for key in words(
        "gear.external_sleeve_radius_m gear.internal_sleeve_radius_m \
         gear.internal_circle_radius_m gear.hole_radius_m",
    ) {
        let line = refused(&[&format!("{key}=-0.006")]);
        assert_parts(&line, &[&format!("`{key}` is -0.006 m"), "metres"]);
    }
}

#[test]
fn bad_input_parts_that_do_not_fit() {
    for (sets, parts) in [
        // Smallest convex radius: 13.1226 mm.
        (
            "gear.external_sleeve_radius_m=0.0132",
            "`gear.external_sleeve_radius_m`|undercut|0.0131226 m",
        ),
        (
            "gear.hole_radius_m=0.0146",
            "`gear.hole_radius_m`|neighbouring holes overlap",
        ),
        (
            "gear.internal_circle_radius_m=0.0525",
            "leave the disc|would do: gear.internal_circle_radius_m = 0.046",
        ),
        (
            "gear.internal_sleeve_radius_m=0.009",
            "`gear.internal_sleeve_radius_m`|larger than its hole of 0.0088 m",
        ),
        (
            "contact.detection=points contact.wheel_points=119",
            "`contact.wheel_points` is 119|15 lobes|at least 120",
        ),
        ("contact.law=papr", "`contact.law`|did you mean `paper`?"),
        ("solver.integrator=rk5", "`solver.integrator`|no integrator"),
    ] {
        let parts: Vec<&str> = parts.split('|').collect();
        assert_parts(&refused(&words(sets)), &parts);
    }
}

#[test]
fn bad_input_zero_step() {
    for key in ["solver.step_s", "solver.sample_s", "solver.duration_s"] {
        let line = refused(&[&format!("{key}=0")]);
        assert_parts(&line, &[&format!("`{key}` is 0 s"), "seconds"]);
    }
}

#[test]
fn bad_input_a_million_sleeves() {
    for (key, range) in [
        ("gear.external_sleeves", "from 3 to 1000"),
        ("gear.internal_sleeves", "from 2 to 1000"),
    ] {
        let line = refused(&[&format!("{key}=1000000")]);
        assert_parts(&line, &[&format!("`{key}` is 1000000"), range]);
    }
}

/// The refusal comes before any allocation: it needs less than 300 MB of address space, and one column of time series for
/// each of a million pins would take 48 GB.
#[cfg(target_os = "linux")]
#[test]
fn bad_input_a_million_sleeves_allocates_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let output = Command::new("sh")
        .arg("-c")
        .arg("ulimit -v 300000 && exec \"$0\" \"$@\"")
        .arg(pinwheel().get_program())
        .args(["run", "paper", "--set", "gear.external_sleeves=1000000"])
        .current_dir(dir.path())
        .stdin(Stdio::null())
        .output()
        .unwrap();
    refusal(&output.into(), "a million pins in 300 MB");
}

#[test]
fn bad_input_memory_and_time_bounds() {
    for (sets, part) in [
        (
            &["gear.wheels=64", "gear.external_sleeves=1000"][..],
            "pairs of disc and pin",
        ),
        (&["solver.sample_s=1e-9"], "samples"),
        (&["solver.step_s=1e-12"], "steps"),
        (&["solver.duration_s=1e-7"], "longer than the whole run"),
    ] {
        assert_parts(&refused(sets), &[part]);
    }
}

#[test]
fn bad_input_unknown_names() {
    let dir = tempfile::tempdir().unwrap();
    let line = refusal(
        &run_in(dir.path(), ["run", "paper", "--engine", "native-reducd"]),
        "unknown engine",
    );
    assert_parts(
        &line,
        &["`native-reducd`", "did you mean `native-reduced`?"],
    );
    let line = refusal(
        &run_in(
            dir.path(),
            ["compare", "paper", "--engines", "native,native-reduced"],
        ),
        "one engine twice",
    );
    assert_parts(&line, &["native-reduced twice"]);
}

#[test]
fn bad_input_usage() {
    let dir = tempfile::tempdir().unwrap();
    for args in [
        &["rnu", "paper"][..],
        &["run"],
        &["run", "paper", "--egnine", "native"],
        &["run", "paper", "--set", "gear.wheels"],
        &["run", "paper", "extra"],
        &["compare", "paper", "--out"],
    ] {
        let line = refusal(&run_in(dir.path(), args), &args.join(" "));
        assert!(
            line.contains("--help") || line.contains("--set key=value"),
            "{line}"
        );
    }
    assert!(names_in(dir.path()).is_empty());
}

#[test]
fn bad_input_output_folder_of_somebody_else() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("thesis");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("chapter.tex"), "precious").unwrap();
    for command in ["run", "compare"] {
        let args = [
            command,
            "paper",
            "--out",
            "thesis",
            "--set",
            "solver.duration_s=0.001",
        ];
        let line = refusal(&run_in(dir.path(), args), command);
        assert_parts(&line, &["--out thesis", "`chapter.tex`"]);
        assert!(!line.contains("--force"), "nothing erases it: {line}");
        assert_eq!(
            std::fs::read_to_string(out.join("chapter.tex")).unwrap(),
            "precious"
        );
    }
    for (out, part) in [("thesis/chapter.tex", "not a folder"), (".", "working in")] {
        let args = ["run", "paper", "--force", "--out", out];
        assert_parts(&refusal(&run_in(dir.path(), args), out), &[part]);
    }
    assert_eq!(names_in(dir.path()), ["thesis"]);
    assert_eq!(names_in(&out), ["chapter.tex"]);
}

/// A folder that cannot be written is an error before the run.
#[test]
fn bad_input_output_below_a_file() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("file");
    std::fs::write(&file, "").unwrap();
    let out: &Path = &file.join("out");
    let args = ["run", "paper", "--out", out.to_str().unwrap()];
    let line = refusal(&run_in(dir.path(), args), "below a file");
    assert_parts(&line, &["cannot be written", "another --out"]);
}

/// Texts typed for numbers, and inconsistent data.
#[test]
fn bad_input_of_init() {
    let dir = tempfile::tempdir().unwrap();
    let init = |more: &str| {
        let typed =
            "init - --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500";
        let mut all = words(typed);
        for pair in words(more).chunks(2) {
            match all.iter().position(|word| *word == pair[0]) {
                Some(place) => all[place + 1] = pair[1],
                None => all.extend(pair),
            }
        }
        run_in(dir.path(), all)
    };
    for right in [
        "--ratio 39:1",
        "--pin-circle-diameter-mm 104mm",
        "--pin-circle-diameter-mm 0.104m",
        "--torque-n-m -200",
        "--torque-n-m 0.2kNm",
        "--speed-rpm 157.08rad/s",
    ] {
        let outcome = init(right);
        assert_eq!(outcome.code, Some(0), "{right}: {outcome:?}");
        let radius = "pin_circle_radius_m = 0.052 ";
        assert!(
            outcome.stdout.contains(radius),
            "{right}: {}",
            outcome.stdout
        );
    }
    for (wrong, part) in [
        ("--ratio 39,5", "39 is 39:1"),
        (
            "--pin-circle-diameter-mm 0,052",
            "write a decimal point: 0.052",
        ),
        ("--pin-circle-diameter-mm 104kg", "a number of millimetres"),
        ("--pin-circle-diameter-mm 0.104", "did you type metres? 104"),
        (
            "--output-circle-diameter-mm 95",
            "`--output-circle-diameter-mm` does not go with the rest",
        ),
    ] {
        let line = refusal(&init(wrong), wrong);
        assert!(line.contains(part), "{wrong}: {line}");
    }
}

#[test]
fn bad_input_numbers_of_scenes() {
    let dir = tempfile::tempdir().unwrap();
    for (line, part) in [
        (
            "gear.eccentricity_m = 0,0028",
            "write a decimal point: 0.0028",
        ),
        ("gear.eccentricity_m = 2.8mm", "write the number alone"),
        ("gear.eccentricity_m = \"2.8 mm\"", "did you mean 0.0028?"),
        (
            "drive.input_speed_rpm = 1500",
            "did you mean `drive.input_speed_rad_s`? 157.08 there",
        ),
        (
            "gear.eccentricity_mm = 2.8",
            "did you mean `gear.eccentricity_m`? 0.0028 there",
        ),
        (
            "contact.young_gpa = 210",
            "did you mean `contact.young_pa`? 2.1e11 there",
        ),
    ] {
        std::fs::write(
            dir.path().join("s.toml"),
            format!("base = \"paper\"\n{line}\n"),
        )
        .unwrap();
        let message = refusal(&run_in(dir.path(), ["explain", "s.toml"]), line);
        assert!(message.contains(part), "{line}: {message}");
    }
}
