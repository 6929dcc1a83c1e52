//! Foreign data in a comparison: `pinwheel compare --against FILE --map MAP.toml`.

use std::fmt::Write as _;
use std::path::Path;

use pinwheel_tests::{Outcome, run_in, words};
use pinwheel_timeseries::TimeSeries;
use serde_json::Value;

const COMPARE: [&str; 9] = [
    "compare",
    "paper",
    "--engines",
    "native-reduced",
    "--set",
    "solver.duration_s=0.02",
    // Stated explicitly, so that comparison and run use equal steps.
    "--set",
    "solver.step_s=1e-5",
    "--force",
];

/// Returns the native time series in another program's format: semicolons, decimal commas, milliseconds from another start,
/// newton millimetres of the opposite sign, degrees, components of forces in kN counted from 1.
fn disguised(ours: &TimeSeries, step: usize) -> String {
    let comma = |x: f64| x.to_string().replace('.', ",");
    let mut text = String::from("Export 7\nTIME;Motor;Angle");
    for k in 1..=16 {
        let _ = write!(text, ";FX_{k};FY_{k}");
    }
    text.push_str("\nms;N mm;deg\n");
    let channel = |name: &str| ours.channel(name).unwrap();
    let (torque, angle) = (channel("input_torque_n_m"), channel("output_angle_rad"));
    let forces = ours.group("external_sleeve_force_n");
    for k in (0..ours.len()).step_by(step) {
        let values = [
            (ours.time_s()[k] - 0.5) * 1e3,
            -torque[k] * 1e3,
            angle[k].to_degrees(),
        ];
        let mut row: Vec<String> = values.iter().map(|&x| comma(x)).collect();
        for force in &forces {
            row.push(comma(0.6e-3 * force[k]));
            row.push(comma(-0.8e-3 * force[k]));
        }
        text.push_str(&row.join(";"));
        text.push('\n');
    }
    text
}

const MAP: &str = "\
name = \"rig\"
[file]
separator = \";\"
decimal = \",\"
skip_lines = 1
lines_after_header = 1
[time]
column = \"TIME\"
unit = \"ms\"
offset_s = 0.5
[columns]
input_torque_n_m = { column = \"Motor\", unit = \"N mm\", factor = -1.0 }
output_angle_rad = { column = 3, unit = \"deg\" }
\"external_sleeve_force_n_*\" = { magnitude_of = [\"FX_*\", \"FY_*\"], unit = \"kN\", first = 1 }
";

/// Returns a folder with the native time series, their converted form and its map.
fn folder(step: usize) -> (tempfile::TempDir, TimeSeries) {
    let dir = tempfile::tempdir().unwrap();
    let ran = run_in(
        dir.path(),
        words("run paper --engine native-reduced --set solver.duration_s=0.02 --out ours"),
    );
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let ours = TimeSeries::load_csv(&dir.path().join("ours/courses.csv")).unwrap();
    std::fs::write(dir.path().join("rig.csv"), disguised(&ours, step)).unwrap();
    std::fs::write(dir.path().join("rig.toml"), MAP).unwrap();
    (dir, ours)
}

/// Exit status of a comparison with a record whose map states neither limits nor uncertainties.
const NOTHING_SHOWN: i32 = 4;

fn compare(dir: &Path) -> Outcome {
    let foreign = ["--against", "rig.csv", "--map", "rig.toml", "--out", "out"];
    run_in(dir, COMPARE.iter().chain(&foreign))
}

fn summary(dir: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(dir.join("out/summary.json")).unwrap()).unwrap()
}

/// Returns the relative L2 of a quantity between the native run and the foreign set.
fn difference(summary: &Value, quantity: &str) -> Option<f64> {
    let entries = summary["pairs"][0]["entries"].as_array().unwrap();
    let entry = entries.iter().find(|e| e["quantity"] == quantity).unwrap();
    entry["metrics"]["relative_l2"].as_f64()
}

fn notes(summary: &Value) -> String {
    let engines = summary["engines"].as_array().unwrap();
    let rig = engines.iter().find(|e| e["name"] == "rig").unwrap();
    assert_eq!(rig["track"], "measured");
    let notes = rig["cost"]["notes"].as_array().unwrap();
    notes
        .iter()
        .map(|n| n.as_str().unwrap())
        .collect::<Vec<_>>()
        .join(" ")
}

/// Conversion of units, signs, components and offsets and back loses only rounding.
#[test]
fn our_own_courses_come_back() {
    let (dir, ours) = folder(1);
    let outcome = compare(dir.path());
    assert_eq!(outcome.code, Some(NOTHING_SHOWN), "{outcome:?}");
    let summary = summary(dir.path());
    for quantity in [
        "input_torque_n_m",
        "output_angle_rad",
        "external_sleeve_force_n",
    ] {
        // Two multiplications and a root round by 2^-53 each: measured 6e-17.
        let off = difference(&summary, quantity).unwrap();
        assert!(off < 1e-15, "{quantity}: {off:e}");
    }
    assert_eq!(difference(&summary, "internal_sleeve_force_n"), None);
    assert!(
        notes(&summary).contains("It has no output_torque_n_m, 8 of 8 internal_sleeve_force_n.")
    );
    // Measured data have no limit of the shared law, and no check against the load.
    let judged = summary["engines"][1]["judged"].as_array().unwrap();
    assert!(judged.is_empty());
    let verdicts = summary["pairs"][0]["entries"].as_array().unwrap();
    assert!(verdicts.iter().all(|e| e["verdict"] == "not-compared"));
    let kept = TimeSeries::load_csv(&dir.path().join("out/rig/courses.csv")).unwrap();
    assert_eq!((kept.len(), kept.channels().len()), (ours.len(), 18));
    let page = std::fs::read_to_string(dir.path().join("out/index.html")).unwrap();
    assert!(page.contains("Measured") && page.contains("rig"));
}

/// A time shift is determined if the map requests it, and reported if the map states another one.
#[test]
fn a_shift_in_time_is_found_told_and_offered() {
    let (dir, _) = folder(1);
    let with = |offset: &str| {
        let map = MAP.replace("offset_s = 0.5", &format!("offset_s = {offset}"));
        std::fs::write(dir.path().join("rig.toml"), map).unwrap();
        let outcome = compare(dir.path());
        assert_eq!(outcome.code, Some(NOTHING_SHOWN), "{outcome:?}");
        (outcome.stdout, summary(dir.path()))
    };
    let (shown, aligned) = with("\"align\"");
    let note = notes(&aligned);
    assert!(note.contains("s were added to its times"), "{note}");
    let seconds: f64 = note
        .split(" s were added")
        .next()
        .unwrap()
        .rsplit(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert!((seconds - 0.5).abs() < 1e-5, "{note}");
    // A parabola through three samples locates the peak of an even correlation to a hundredth of a sample.
    let off = difference(&aligned, "input_torque_n_m").unwrap();
    assert!(off < 0.02, "{off:e}");
    // The terminal reports it too, with the distances.
    let shown: Vec<&str> = shown.split_whitespace().collect();
    let shown = shown.join(" ");
    assert!(
        shown.contains("s were added to its times") && shown.contains("apart (relative L2, "),
        "{shown}"
    );
    let (_, apart) = with("0.503");
    let note = notes(&apart);
    assert!(
        note.contains("offset_s = 0.500") && note.contains("\"align\""),
        "{note}"
    );
    assert!(difference(&apart, "input_torque_n_m").unwrap() > 0.1);
    let (_, right) = with("0.5");
    assert!(!notes(&right).contains("align"), "{}", notes(&right));
    std::fs::write(dir.path().join("rig.toml"), MAP.replace("0.5", "\"algin\"")).unwrap();
    let refused = compare(dir.path());
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(
        refused.stderr.contains("neither a number of seconds nor"),
        "{refused:?}"
    );
}

/// With half the samples the others are interpolated, and the effect is reported.
#[test]
fn other_sample_times_are_interpolated_and_told() {
    let (dir, _) = folder(2);
    assert_eq!(compare(dir.path()).code, Some(NOTHING_SHOWN));
    let summary = summary(dir.path());
    let notes = notes(&summary);
    assert!(
        notes.contains("101 of 201 sample times are its own"),
        "{notes}"
    );
    let stated: f64 = notes
        .split("restores them to ")
        .nth(1)
        .unwrap()
        .split(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    let made = difference(&summary, "external_sleeve_force_n").unwrap();
    assert!(made > 1e-6 && made < stated, "{made:e} {stated:e}");
}

/// A file that covers a part, lacks columns, and has a stated limit.
#[test]
fn a_part_is_compared_and_stated_limits_hold() {
    let (dir, _) = folder(1);
    let text = std::fs::read_to_string(dir.path().join("rig.csv")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let part: Vec<&str> = lines[..3]
        .iter()
        .chain(&lines[3 + 50..3 + 150])
        .copied()
        .collect();
    // Torques 2 % off, forces of two pins only.
    let map = MAP
        .replace("factor = -1.0", "factor = -1.02")
        .replace("\"external_sleeve_force_n_*\" = { magnitude_of = [\"FX_*\", \"FY_*\"], unit = \"kN\", first = 1 }", "external_sleeve_force_n_3 = { magnitude_of = [\"FX_4\", \"FY_4\"], unit = \"kN\" }");
    let limits = |limit: f64| {
        format!(
            "{map}[[limits]]\nquantity = \"*_torque_n_m\"\nwindow = \"transient\"\nmetric = \"relative-l2\"\nlimit = {limit}\nreason = \"cell class 0.5\"\n"
        )
    };
    std::fs::write(dir.path().join("rig.csv"), part.join("\n")).unwrap();
    for (limit, code) in [(0.03, 0), (0.01, 1)] {
        std::fs::write(dir.path().join("rig.toml"), limits(limit)).unwrap();
        let outcome = compare(dir.path());
        assert_eq!(outcome.code, Some(code), "{outcome:?}");
        let summary = summary(dir.path());
        let off = difference(&summary, "input_torque_n_m").unwrap();
        assert!((off - 0.02 / 1.02).abs() < 1e-9, "{off}");
        assert!(difference(&summary, "external_sleeve_force_n").unwrap() < 1e-15);
        let notes = notes(&summary);
        assert!(notes.contains("Compared from 0.005 to 0.0149 s"), "{notes}");
        assert!(
            notes.contains("15 of 16 external_sleeve_force_n"),
            "{notes}"
        );
    }
}

/// Channels that only the foreign file has are computed.
#[test]
fn mapped_channels_are_recorded() {
    let (dir, _) = folder(1);
    std::fs::write(
        dir.path().join("rig.toml"),
        format!("{MAP}eccentric_bearing_force_n_1 = {{ column = \"FX_1\", unit = \"kN\" }}\n"),
    )
    .unwrap();
    assert_eq!(compare(dir.path()).code, Some(NOTHING_SHOWN));
    assert!(difference(&summary(dir.path()), "eccentric_bearing_force_n").is_some());
}

/// Bad rows, columns and maps: one line with the file's line and the remedy, and nothing is written.
#[test]
fn bad_input_is_named() {
    let (dir, _) = folder(1);
    let text = std::fs::read_to_string(dir.path().join("rig.csv")).unwrap();
    let lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let spoilt = |changes: &[(usize, &str)]| {
        let mut lines = lines.clone();
        for (line, text) in changes {
            lines[line - 1] = (*text).to_owned();
        }
        lines.join("\n")
    };
    let rows = spoilt(&[(7, "x;1;2"), (9, "-490;1"), (11, "-499,9;1;2")]);
    for (csv, map, parts) in [
        (
            rows.clone(),
            MAP.to_owned(),
            &[
                "rig.csv: 3 of 201 rows are bad: line 7: column `TIME`: `x` is not a number; line 9: column `Angle` is empty; line 11: ",
                "bad = \"skip\"",
            ][..],
        ),
        (
            text.clone(),
            MAP.replace("\"Motor\"", "\"Moto\""),
            &["`input_torque_n_m`: the file has no column `Moto`; it has `TIME`, `Motor`"],
        ),
        (
            text.clone(),
            MAP.replace("input_torque_n_m", "input_torqe_n_m"),
            &[
                "rig.toml: `input_torqe_n_m` is no column of this gearbox; did you mean `input_torque_n_m`?",
            ],
        ),
        (
            text.clone(),
            MAP.replace("\"N mm\"", "\"mm\""),
            &["rig.toml: `input_torque_n_m` cannot be in `mm`; write one of Nm"],
        ),
        (
            text.clone(),
            MAP.replace("offset_s = 0.5", "offset_s = 5.0"),
            &["none of it in the run's 0 to 0.02 s; set time.unit"],
        ),
        (
            text.clone(),
            MAP.replace("name = \"rig\"", "name = \"native-reduced\""),
            &["`native-reduced` is an engine's name"],
        ),
        (
            text.clone(),
            MAP.replace("[time]", "[tiem]"),
            &["rig.toml, line 7", "did you mean `time`?"],
        ),
        (
            String::new(),
            MAP.to_owned(),
            &["it has none: check file.separator"],
        ),
    ] {
        std::fs::write(dir.path().join("rig.csv"), csv).unwrap();
        std::fs::write(dir.path().join("rig.toml"), map).unwrap();
        let outcome = compare(dir.path());
        assert_eq!(outcome.code, Some(2), "{outcome:?}");
        assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
        for part in parts {
            assert!(outcome.stderr.contains(part), "{part}: {}", outcome.stderr);
        }
        assert!(!dir.path().join("out").exists());
    }
    // Bad rows are omitted on request, and named in the report.
    std::fs::write(dir.path().join("rig.csv"), rows).unwrap();
    std::fs::write(
        dir.path().join("rig.toml"),
        MAP.replace("[columns]", "[rows]\nbad = \"skip\"\n[columns]"),
    )
    .unwrap();
    assert_eq!(compare(dir.path()).code, Some(NOTHING_SHOWN));
    let notes = notes(&summary(dir.path()));
    assert!(
        notes.contains(
            "3 of 201 rows are bad and left out: line 7: column `TIME`: `x` is not a number"
        ),
        "{notes}"
    );
    let alone = run_in(dir.path(), COMPARE.iter().chain(&["--against", "rig.csv"]));
    assert!(
        alone.code == Some(2) && alone.stderr.contains("--map"),
        "{alone:?}"
    );
}

/// With the uncertainty of its cells a rig's data validate the model by ASME V&V 20, and the budget is reported.
#[test]
fn stated_uncertainties_give_validation_verdicts() {
    let (dir, _) = folder(1);
    let map = |torque: &str| {
        let wanted = format!("factor = -1.0, {torque} }}");
        MAP.replace("factor = -1.0 }", &wanted)
    };
    let torque = |text: String| {
        std::fs::write(dir.path().join("rig.toml"), text).unwrap();
        let outcome = compare(dir.path());
        let summary = summary(dir.path());
        let entries = summary["pairs"][0]["entries"].as_array().unwrap().clone();
        let entry = entries
            .into_iter()
            .find(|e| e["quantity"] == "input_torque_n_m");
        (outcome, entry.unwrap())
    };
    let (outcome, entry) = torque(map("uncertainty = { of_reading = 0.005 }"));
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    assert_eq!(entry["verdict"], "agree", "{entry}");
    let budget = &entry["assessments"][0]["budget"];
    assert!(
        (budget["data"].as_f64().unwrap() - 0.005).abs() < 1e-9,
        "{budget}"
    );
    assert!(budget["numerical"].as_f64().unwrap() > 0.0, "{budget}");
    // An error of 10 % is far beyond the uncertainty.
    let off = map("uncertainty = { absolute = 1e-3 }").replace("factor = -1.0", "factor = -1.1");
    let (outcome, entry) = torque(off);
    assert_eq!(entry["verdict"], "differ", "{entry}");
    assert_eq!(
        outcome.code,
        Some(0),
        "an error of a model is a result: {outcome:?}"
    );
    let (outcome, _) = torque(map("uncertainty = { of_range = 0.01 }"));
    assert_eq!(outcome.code, Some(2), "{outcome:?}");
    assert!(outcome.stderr.contains("range"), "{}", outcome.stderr);
}

/// The uncertainty of the scene's values counts in proportion, and a bar on the terminal shows each share.
#[test]
fn uncertain_inputs_are_part_of_the_budget() {
    let (dir, _) = folder(1);
    let map = MAP.replace(
        "factor = -1.0 }",
        "factor = -1.0, uncertainty = { of_reading = 0.001 } }",
    );
    std::fs::write(dir.path().join("rig.toml"), map).unwrap();
    // Budgets appear only in details.
    let foreign = words("--against rig.csv --map rig.toml --out out --verbose");
    let budget = |sets: &[&str]| {
        let outcome = run_in(
            dir.path(),
            COMPARE
                .iter()
                .copied()
                .chain(foreign.clone())
                .chain(sets.iter().copied()),
        );
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        let summary = summary(dir.path());
        let entries = summary["pairs"][0]["entries"].as_array().unwrap().clone();
        let entry = entries
            .into_iter()
            .find(|e| e["quantity"] == "input_torque_n_m");
        (
            outcome.stdout,
            entry.unwrap()["assessments"][0]["budget"].clone(),
        )
    };
    let (_, before) = budget(&[]);
    assert_eq!(before["input"], 0.0, "{before}");
    let (text, after) = budget(&["--set", "uncertain.drive.output_torque_n_m.plus_minus=0.11"]);
    let input = after["input"].as_f64().unwrap();
    // Measured: 0.0107, because a start-up oscillates faster under more load; a tenth of that would be wrong.
    assert!((0.005..0.02).contains(&input), "{after}");
    // Measured: 87 % of the budget, numerics 12 %.
    assert!(
        text.contains("inputs 8") || text.contains("inputs 9"),
        "{text}"
    );
    let double = ["--set", "uncertain.drive.output_torque_n_m.plus_minus=0.22"];
    let twice = budget(&double).1["input"].as_f64().unwrap();
    assert!((twice / input - 2.0).abs() < 0.2, "{input} {twice}");
    // From nine uncertain keys on, all are varied at once; the additional keys have little effect here.
    let many: Vec<String> = [
        ("drive.output_torque_n_m", "0.11"),
        ("mass.wheel.mass_kg", "1e-9"),
        ("mass.wheel.moment_kg_m2", "1e-12"),
        ("mass.output_shaft.mass_kg", "1e-9"),
        ("mass.output_shaft.moment_kg_m2", "1e-12"),
        ("mass.internal_sleeve.mass_kg", "1e-9"),
        ("mass.external_sleeve.mass_kg", "1e-9"),
        ("mass.input_shaft.mass_kg", "1e-9"),
        ("gear.internal_circle_radius_m", "1e-12"),
    ]
    .iter()
    .flat_map(|(key, half)| {
        [
            "--set".to_owned(),
            format!("uncertain.{key}.plus_minus={half}"),
        ]
    })
    .collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    let (_, hypercube) = budget(&many);
    let sampled = hypercube["input"].as_f64().unwrap();
    assert!((sampled / input - 1.0).abs() < 0.15, "{input} {sampled}");
}
