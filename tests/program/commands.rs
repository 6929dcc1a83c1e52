//! The program in use: files, endings, stops.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use pinwheel_scene::Scene;
use pinwheel_tests::{Outcome, names_in, pinwheel, repository, run_in, words};
use pinwheel_timeseries::TimeSeries;
use serde_json::Value;

/// A run short enough for tests: 5 ms, 51 samples.
const SHORT: [&str; 2] = ["--set", "solver.duration_s=0.005"];

fn json(path: PathBuf) -> Value {
    serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap()
}

fn done(outcome: Outcome) -> String {
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    assert_eq!(outcome.stderr, "", "progress belongs on terminals only");
    outcome.stdout
}

/// Figures belong to the stated window "from 0.3 s on", not to the complete run. A converged run is within the uncertainty
/// of each.
#[test]
fn program_run_gives_figures_of_its_window_and_how_far_they_may_be_off() {
    let dir = tempfile::tempdir().unwrap();
    let figures = |words: &[&str], out: &str| {
        let args = ["run", "paper", "--out", out];
        let shown = done(run_in(dir.path(), args.iter().chain(words)));
        (
            shown,
            json(dir.path().join(out).join("run.json"))["results"].clone(),
        )
    };
    let (shown, results) = figures(&[], "one");
    assert!(
        shown.contains('\u{b1}') && shown.contains("estimated from one more run"),
        "{shown}"
    );
    assert_eq!(results["from_s"], 0.3);
    let get = |results: &Value, name: &str, key: &str| {
        let list = results["figures"].as_array().unwrap();
        let figure = list.iter().find(|f| f["key"] == name).unwrap();
        figure[key].as_f64()
    };
    // The start-up swings from -0.15 to 3.88 N m.
    let least = get(&results, "min_input_torque_n_m", "value").unwrap();
    assert!(least > 1.4, "{results}");
    let (_, exact) = figures(&["--engine", "native-resolved"], "exact");
    for name in words(
        "mean_input_torque_n_m peak_external_sleeve_force_n \
         peak_internal_sleeve_force_n",
    ) {
        let off = get(&results, name, "value").unwrap() - get(&exact, name, "value").unwrap();
        let bound = get(&results, name, "numerical_uncertainty").unwrap();
        assert!(
            off.abs() <= bound && bound < 0.02 * get(&results, name, "value").unwrap(),
            "{name}: {off} off, {bound} stated"
        );
    }
    // The law creates work, so the efficiency exceeds 100 %: a reason replaces the figure.
    let mut list = results["figures"].as_array().unwrap().iter();
    let share = list.find(|f| f["key"] == "efficiency").unwrap();
    let why = share["withheld"].as_str().unwrap();
    assert!(
        why.contains("creates 0.95 %") && shown.contains("not defined"),
        "{why}"
    );
    let (shown, results) = figures(&["--unchecked"], "unchecked");
    assert!(
        shown.contains("not verified") && !shown.contains('\u{b1}'),
        "{shown}"
    );
    assert_eq!(
        get(&results, "mean_input_torque_n_m", "numerical_uncertainty"),
        None
    );
}

#[test]
fn program_run_writes_courses_and_their_record() {
    let dir = tempfile::tempdir().unwrap();
    let shown = done(run_in(
        dir.path(),
        ["run", "paper", "--engine", "native-lagrange"]
            .iter()
            .chain(&SHORT),
    ));
    assert!(shown.contains("out/paper-run/courses.csv"), "{shown}");
    let out = dir.path().join("out/paper-run");
    assert_eq!(names_in(&out), ["courses.csv", "index.html", "run.json"]);

    let time_series = TimeSeries::load_csv(&out.join("courses.csv")).unwrap();
    assert_eq!(time_series.len(), 51);
    assert_eq!(time_series.channels()[0].name, "input_torque_n_m");
    assert_eq!(time_series.group("external_sleeve_force_n").len(), 16);
    assert_eq!(time_series.group("internal_sleeve_force_n").len(), 8);

    let record = json(out.join("run.json"));
    assert_eq!(record["engine"], "native-lagrange");
    assert_eq!(record["track"], "native");
    assert_eq!(record["status"], "finished");
    assert_eq!(record["steps"], 500);
    assert_eq!(record["rhs_calls"], 1000);
    assert_eq!(record["bodies"], 28);
    for key in ["wall_s", "cpu_s", "degrees_of_freedom"] {
        assert!(record[key].as_f64().unwrap() > 0.0, "{key}");
    }
    for key in ["version", "settings", "pinwheel_version"] {
        assert!(!record[key].as_str().unwrap().is_empty(), "{key}");
    }
    assert!(record["machine"]["cores"].as_u64().unwrap() >= 1);
    // The record has the complete scene: read back, it is equal to the one of the run.
    let scene: Scene = serde_json::from_value(record["scene"].clone()).unwrap();
    let set = "solver.duration_s=0.005".parse().unwrap();
    assert_eq!(scene, *Scene::load("paper", &[set]).unwrap());
}

#[test]
fn program_compare_writes_report_summary_and_time_series() {
    let dir = tempfile::tempdir().unwrap();
    let args = words("compare paper --engines native-reduced,native-lagrange --verbose --out r");
    let shown = done(run_in(dir.path(), args.iter().chain(&SHORT)));
    for part in [
        "reduced / lagrange",
        "agree to ",
        "engines       agrees to ",
        "PASS, OUR OWN ENGINES ALONE  ",
        "page: r/index.html",
    ] {
        assert!(shown.contains(part), "{part} is not in:\n{shown}");
    }
    let out = dir.path().join("r");
    assert_eq!(
        names_in(&out),
        [
            "index.html",
            "native-lagrange",
            "native-reduced",
            "summary.json"
        ]
    );
    for engine in ["native-lagrange", "native-reduced"] {
        assert_eq!(names_in(&out.join(engine)), ["courses.csv", "run.json"]);
    }
    let summary = json(out.join("summary.json"));
    assert_eq!(summary["passed"], true);
    assert_eq!(summary["engines"].as_array().unwrap().len(), 2);
    assert_eq!(summary["counts"]["differ"], 0);
    let entry = &summary["pairs"][0]["entries"][0];
    assert_eq!(entry["verdict"], "agree", "{entry}");
    for key in ["value", "bound", "u_a", "u_b"] {
        assert!(entry["assessments"][0][key].is_number(), "{key}: {entry}");
    }
    let engine = &summary["engines"][0];
    assert_eq!(
        engine["refinement"]["levels"].as_array().unwrap().len(),
        2,
        "{engine}"
    );
    assert!(
        engine["numerical_uncertainty"][0]["relative_l2"]
            .as_f64()
            .unwrap()
            < 0.005
    );
    assert!(!summary["assumptions"].as_array().unwrap().is_empty());
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(
        page.contains("native-lagrange") && page.contains("pinwheel compare paper"),
        "the page"
    );
}

#[test]
fn program_diverged_run_ends_with_3_and_keeps_what_there_is() {
    let dir = tempfile::tempdir().unwrap();
    let outcome = run_in(dir.path(), ["run", "steel", "--out", "s"]);
    assert_eq!(outcome.code, Some(3), "{outcome:?}");
    assert_eq!(outcome.stdout, "");
    let line = outcome.stderr.trim_end();
    assert!(
        line.starts_with("error: native-reduced diverged at t = 0.0"),
        "{line}"
    );
    assert!(
        line.contains("courses.partial.csv") && !line.contains('\n'),
        "{line}"
    );
    let out = dir.path().join("s");
    assert_eq!(
        names_in(&out),
        ["courses.partial.csv", "index.html", "run.json"]
    );
    let record = json(out.join("run.json"));
    assert_eq!(record["status"], "diverged");
    let diverged_at = record["diverged_at_s"].as_f64().unwrap();
    assert!(record["diverged_quantity"].as_str().unwrap().len() > 5);
    let time_series = TimeSeries::load_csv(&out.join("courses.partial.csv")).unwrap();
    assert!(!time_series.is_empty() && time_series.time_s().iter().all(|&t| t <= diverged_at));
}

/// A named engine that cannot run the scene gives status 3, and the summary does not pass.
#[test]
fn program_a_summary_passes_only_with_status_0() {
    for (engines, code) in [("", 0), (",rapier-own-contact-colliders", 3)] {
        let (ended, text, summary) = compared(&words(&format!(
            "toleranced --engines native-reduced,native-lagrange{engines} --set solver.duration_s=0.004 --set contact.band_laws=[]"
        )));
        assert_eq!(ended, Some(code), "{text}");
        assert_eq!(summary["passed"], code == 0, "{text}");
    }
}

#[test]
fn program_compare_goes_on_when_engines_diverge() {
    let dir = tempfile::tempdir().unwrap();
    let args = words("compare steel --engines native-reduced,native-lagrange --out s");
    let outcome = run_in(
        dir.path(),
        args.iter().chain(&[
            "--set",
            "solver.duration_s=0.05",
            // An explicit step is not refined.
            "--set",
            "solver.step_s=1e-5",
        ]),
    );
    assert_eq!(outcome.code, Some(3), "{outcome:?}");
    assert!(
        outcome.stdout.contains("diverged at t = "),
        "{}",
        outcome.stdout
    );
    let out = dir.path().join("s");
    assert_eq!(
        names_in(&out.join("native-reduced")),
        ["courses.partial.csv", "run.json"]
    );
    let summary = json(out.join("summary.json"));
    assert_eq!(summary["engines"][0]["status"]["state"], "diverged");
    assert_eq!(summary["passed"], false);
    // The page shows a gear in motion with correct forces.
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.contains("by a method that finishes"));
}

/// Returns the result of `compare` on a scene: status, the last line before the path of the page, `summary.json`.
fn compared(args: &[&str]) -> (Option<i32>, String, Value) {
    let dir = tempfile::tempdir().unwrap();
    let outcome = run_in(
        dir.path(),
        ["compare"].iter().chain(args).chain(&["--out", "r"]),
    );
    let summary = json(dir.path().join("r/summary.json"));
    (outcome.code, outcome.stdout, summary)
}

/// Returns the keys of figures with a verdict in a comparison of two designs.
fn judged<'a>(summary: &'a Value, word: &str) -> Vec<&'a str> {
    let rows = summary["figures"].as_array().unwrap().iter();
    let so = rows.filter(|row| row["judged"] == word);
    so.map(|row| row["key"].as_str().unwrap()).collect()
}

#[test]
fn program_two_designs_side_by_side() {
    let dir = tempfile::tempdir().unwrap();
    let design = |name: &str, rest: &str| {
        let text = format!("base = \"paper\"\n{rest}\n[solver]\nduration_s = 0.005\n");
        std::fs::write(dir.path().join(name), text).unwrap();
    };
    design("a.toml", "");
    design("b.toml", "[gear]\nbacklash_m = 1e-4");
    let side_by_side = |other: &str, more: &[&str]| {
        let words = ["compare", "a.toml", other, "--out", "r"];
        let outcome = run_in(dir.path(), words.iter().chain(more));
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        (outcome.stdout, json(dir.path().join("r/summary.json")))
    };
    let (shown, summary) = side_by_side("b.toml", &[]);
    assert_eq!(summary["identical"], false);
    assert_eq!(summary["changed"][0]["key"], "gear.backlash_m");
    assert_eq!(summary["changed"].as_array().unwrap().len(), 1);
    assert!(
        judged(&summary, "differ").contains(&"lost_motion_arcmin"),
        "{summary:#}"
    );
    // A disc's pins do not depend on the play of the others.
    assert!(
        judged(&summary, "below-uncertainty").contains(&"internal_force_n"),
        "{summary:#}"
    );
    assert!(
        shown.contains("gear.backlash_m") && shown.contains("figures differ"),
        "{shown}"
    );
    // Ring pins farther out have contacts at other depths.
    assert!(shown.contains("stage contact search: off by"), "{shown}");
    assert_eq!(summary["changed"][0]["stage"], "contact-search");
    let wide = shown.lines().map(|line| line.chars().count()).max();
    assert!(wide <= Some(80), "{wide:?}: {shown}");
    for folder in ["design-1", "design-2"] {
        let names = names_in(&dir.path().join("r").join(folder));
        assert!(names.contains(&"courses.csv".to_owned()), "{names:?}");
    }
    // The figures equal those of `design` alone.
    let alone = run_in(dir.path(), ["design", "b.toml", "--out", "d"]);
    assert_eq!(alone.code, Some(0), "{alone:?}");
    let alone = json(dir.path().join("d/summary.json"));
    for (row, figure) in summary["figures"]
        .as_array()
        .unwrap()
        .iter()
        .zip(alone["figures"].as_array().unwrap())
    {
        assert_eq!(row["key"], figure["key"]);
        assert_eq!(row["values"][1], figure["value"], "{row}");
    }
    // Two equal designs.
    let (shown, summary) = side_by_side("a.toml", &[]);
    assert_eq!(
        (&summary["identical"], &summary["changed"]),
        (&Value::Bool(true), &Value::from(Vec::<i32>::new()))
    );
    // The efficiency has no value under this law.
    let all = summary["figures"].as_array().unwrap().iter();
    let known = all.filter(|row| row["values"][0].is_number());
    assert_eq!(judged(&summary, "same").len(), known.count());
    assert!(shown.contains("identical"), "{shown}");
    // A real change that is too small for any figure.
    design("c.toml", "[contact]\nstiffness_multiplier = 0.0100000001");
    let (shown, summary) = side_by_side("c.toml", &["--engines", "native-lagrange"]);
    assert_eq!(summary["engine"], "native-lagrange");
    assert_eq!(summary["identical"], false);
    assert!(
        judged(&summary, "differ").is_empty(),
        "{:#}",
        summary["figures"]
    );
    assert!(shown.contains("No difference was shown"), "{shown}");
}

/// Returns the numbers in a text, each with half a unit of its last digit.
fn numbers(text: &str) -> Vec<[f64; 2]> {
    let words = text.split(|c: char| !c.is_ascii_digit() && c != '.');
    let number = |word: &str| {
        let decimals = word.split_once('.').map_or(0, |(_, after)| after.len());
        Some([word.parse().ok()?, 0.501 * 0.1_f64.powi(decimals as i32)])
    };
    words.filter_map(number).collect()
}

/// Makes the gears of the table in docs/design.md by their commands, and compares every figure in it with `design --statics`.
fn check_table(names: &[&str]) {
    let guide = std::fs::read_to_string(repository("docs/design.md")).unwrap();
    let dir = tempfile::tempdir().unwrap();
    let figures = |command: &str, more: &str| {
        let init = format!("{command} --force{more}");
        assert_eq!(run_in(dir.path(), words(&init)).code, Some(0), "{init}");
        let file = words(command)[1];
        let design = format!("design {file} --statics --force --out r");
        assert_eq!(run_in(dir.path(), words(&design)).code, Some(0), "{init}");
        json(dir.path().join("r/summary.json"))["figures"].clone()
    };
    let mut designs = [Value::Null, Value::Null];
    let mut count = 0;
    let mut gear = String::new();
    let rows = guide
        .lines()
        .skip_while(|l| !l.starts_with("| gear | figure |"));
    for row in rows.skip(2).take_while(|line| line.starts_with('|')) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        if !cells[1].is_empty() {
            gear = cells[1].trim_matches('`').to_owned();
            let line = format!("pinwheel init {gear}.toml ");
            let line = guide.lines().find(|l| l.starts_with(&line)).unwrap();
            let command = line.trim_start_matches("pinwheel ");
            if names.contains(&gear.as_str()) {
                designs = [" --ideal", ""].map(|more| figures(command, more));
            }
        }
        if !names.contains(&gear.as_str()) {
            continue;
        }
        let key = match cells[2] {
            "lost motion, arcmin" => "lost_motion_arcmin",
            "stiffness, N m/arcmin" => "torsional_stiffness_n_m_per_arcmin",
            "ring pin, N" => "external_force_n",
            "efficiency of slow motion, %" => "efficiency_slow_percent",
            other => panic!("{other}"),
        };
        for (design, cell) in designs.iter().zip(&cells[3..]) {
            let all = design.as_array().unwrap();
            let figure = all.iter().find(|figure| figure["key"] == key);
            let value = |part: &str, end: usize| figure.map(|f| f[part][end].as_f64());
            let known = [
                figure.map(|f| f["value"].as_f64()),
                value("by_contact_law", 0),
                value("by_contact_law", 1),
                value("by_fit", 0),
                value("by_fit", 1),
            ];
            for ([printed, half], known) in numbers(cell).into_iter().zip(known) {
                let known = known.flatten().unwrap();
                assert!(
                    (printed - known).abs() < half,
                    "{gear}, {key}: {cell}, {known}"
                );
                count += 1;
            }
        }
    }
    assert_eq!(count, 25 * names.len());
}

#[test]
fn regress_the_table_of_gears_as_built() {
    check_table(&["readme", "rv81"]);
}

#[test]
#[ignore = "weekly: 15 s for three gears more"]
fn regress_the_table_of_more_gears_as_built() {
    check_table(&["printed", "rv40", "drive"]);
}

/// An exceeded default limit is reported as text, a stated one gives status 1; a doubtful value is a line.
#[test]
fn program_design_says_whether_the_gear_bears_its_load() {
    let dir = tempfile::tempdir().unwrap();
    let init =
        "init g.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500";
    assert_eq!(run_in(dir.path(), words(init)).code, Some(0));
    for (keys, code, answer) in [
        ("", 0, "as far as judged"),
        ("limits.pressure_pa = 9e8", 1, "no: "),
        ("drive.output_torque_n_m = 2e3", 0, "no: "),
    ] {
        // Without bands, and in a file: of each `--set` the program asks what it changes.
        let text = format!("base = \"g.toml\"\ncontact.band_laws = []\n{keys}\n");
        std::fs::write(dir.path().join("mine.toml"), text).unwrap();
        let command = "design mine.toml --statics --force --out r";
        let outcome = run_in(dir.path(), words(command));
        assert_eq!(outcome.code, Some(code), "{outcome:?}");
        let line = outcome
            .stdout
            .lines()
            .find(|line| line.starts_with("bears its load"));
        assert!(
            line.is_some_and(|line| line.contains(answer)),
            "{}",
            outcome.stdout
        );
        assert_eq!(
            outcome.stdout.contains("typed in N mm?"),
            keys.contains("200e3"),
            "{}",
            outcome.stdout
        );
        let limits = &json(dir.path().join("r/summary.json"))["limits"];
        assert_eq!(
            limits["bears_its_load"] == "no",
            answer == "no: ",
            "{limits:#}"
        );
        assert_eq!(limits["margin"].as_f64().unwrap() < 1.0, answer == "no: ");
    }
    assert!(
        !dir.path().join("r/disc_1.dxf").exists(),
        "both discs are one part"
    );
}

/// Returns the largest U of agreeing entries, over all pairs.
fn bluntest(summary: &Value) -> f64 {
    let pairs = summary["pairs"].as_array().unwrap();
    let entries = pairs.iter().flat_map(|p| p["entries"].as_array().unwrap());
    let agree = entries.filter(|e| e["verdict"] == "agree");
    agree
        .filter_map(|e| e["bound"].as_f64())
        .fold(0.0, f64::max)
}

/// A stated step that is too coarse: a large uncertainty must not pass.
#[test]
fn program_what_is_inconclusive_ends_with_4() {
    let (code, text, summary) = compared(&words(
        "backlash-0.6 --engines native-reduced,native-lagrange --set solver.step_s=4e-5 \
         --set solver.duration_s=0.03",
    ));
    assert_eq!(code, Some(4), "{text}");
    assert!(text.contains("NOT CONFIRMED"), "{text}");
    assert_eq!(summary["passed"], false);
}

/// Scenes without measured limits and tuned settings: verdicts are resolved, without a false alarm.
#[test]
fn program_verdicts_are_sharp_where_nobody_calibrated() {
    let engines = [
        "--engines",
        "native-reduced,native-lagrange,native-resolved",
    ];
    for scene in [
        &["one-wheel"][..],
        &["paper", "--set", "gear.backlash_m=0.0006"],
        &["paper", "--set", "solver.integrator=dopri5"],
    ] {
        let args = [scene, &engines, &["--set", "solver.duration_s=0.02"]].concat();
        let (code, text, summary) = compared(&args);
        assert_eq!(code, Some(0), "{text}");
        assert!(summary["counts"]["agree"].as_u64().unwrap() >= 15, "{text}");
        assert_eq!(summary["counts"]["inconclusive"], 0, "{text}");
        let blunt = bluntest(&summary);
        assert!(blunt > 0.0 && blunt <= 0.01, "{blunt:e}\n{text}");
    }
}

/// Untuned gears, from a dozen lines without a solver: every verdict is resolved at the first attempt.
#[test]
fn program_own_gears_need_no_settings() {
    for (gear, duration_s) in [
        ("forty", 0.004),
        ("rv39", 0.006),
        ("single", 0.006),
        ("three", 0.004),
        ("sixty", 0.002),
    ] {
        let file = repository(&format!("tests/data/gears/{gear}.toml"));
        let lines = std::fs::read_to_string(&file).unwrap().lines().count();
        assert!(lines <= 15, "{gear}: {lines} lines");
        let (file, duration) = (
            file.to_str().unwrap(),
            format!("solver.duration_s={duration_s}"),
        );
        let engines = "native-reduced,native-resolved,rapier-shared-law";
        let (code, text, summary) = compared(&[file, "--engines", engines, "--set", &duration]);
        assert_eq!(code, Some(0), "{gear}: {text}");
        assert_eq!(summary["counts"]["inconclusive"], 0, "{gear}: {text}");
        let blunt = bluntest(&summary);
        assert!(blunt > 0.0 && blunt <= 0.01, "{gear}: {blunt:e}\n{text}");
        let dir = tempfile::tempdir().unwrap();
        let run = done(run_in(dir.path(), ["run", file, "--set", &duration]));
        // The band of contact laws is beside a force, and the numerical error is stated once.
        let shown = run.split_whitespace().collect::<Vec<_>>().join(" ");
        for group in ["external forces", "internal forces"] {
            let (_, after) = shown.split_once(group).unwrap();
            let (peak, _) = after.split_once("), mean").unwrap();
            assert!(peak.contains(" by contact law; \u{b1} "), "{gear}: {shown}");
            let causes = peak.matches("numerical").count() + peak.matches("sampling").count();
            assert_eq!(causes, 1, "{gear}: {shown}");
        }
    }
}

/// Bearings and sleeves on their pins lose power without any friction of contacts.
#[test]
fn program_friction_of_bearings_is_a_loss() {
    let of = "needle-bearings --engines native-resolved --set solver.duration_s=0.02";
    let (_, text, _) = compared(&words(of));
    let line = text.lines().find(|line| line.starts_with("Efficiency"));
    assert!(line.is_some_and(|line| line.contains('%')), "{text}");
}

/// An engine out of time reports it: it proves nothing, and neither does a comparison with it alone.
#[test]
fn program_a_spent_budget_is_stated() {
    let (code, text, summary) = compared(&words(
        "backlash-0.6 --engines native-resolved,rapier-shared-law --longest 0 --set \
         solver.duration_s=0.05 --set name=own --set gear.backlash_m=0.00061",
    ));
    assert_eq!(code, Some(4), "{text}");
    assert!(
        summary["counts"]["inconclusive"].as_u64().unwrap() > 0,
        "{text}"
    );
    assert!(text.contains("--longest"), "{text}");
}

#[test]
fn program_missing_engine_ends_with_3() {
    if cfg!(feature = "crossval") {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let outcome = run_in(
        dir.path(),
        ["run", "paper", "--engine", "exudyn-explicit-shared-law"],
    );
    assert_eq!(outcome.code, Some(3), "{outcome:?}");
    assert!(
        outcome.stderr.contains("--features crossval"),
        "{}",
        outcome.stderr
    );
    assert!(names_in(dir.path()).is_empty());
}

#[test]
fn program_replaces_its_own_output_and_with_force_a_changed_one() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("o");
    let run = |more: &[&str]| {
        let args = ["run", "paper", "--out", "o"];
        run_in(dir.path(), args.iter().chain(&SHORT).chain(more))
    };
    done(run(&[]));
    // An earlier comparison there is replaced completely.
    let compare = words("compare paper --engines native-reduced,native-resolved --out o");
    done(run_in(dir.path(), compare.iter().chain(&SHORT)));
    assert!(out.join("native-reduced/courses.csv").is_file());
    done(run(&["--set", "name=second"]));
    assert_eq!(names_in(&out), ["courses.csv", "index.html", "run.json"]);
    assert_eq!(json(out.join("run.json"))["scene"]["name"], "second");
    // A changed file of the program stops it unless forced; a foreign file stops both.
    std::fs::write(out.join("run.json"), "mine").unwrap();
    let kept = run(&[]);
    assert_eq!(kept.code, Some(2), "{kept:?}");
    assert!(
        kept.stderr.contains("`run.json`") && kept.stderr.contains("--force"),
        "{kept:?}"
    );
    done(run(&["--force"]));
    std::fs::write(out.join("notes.txt"), "mine").unwrap();
    for more in [&[][..], &["--force"]] {
        assert_eq!(run(more).code, Some(2));
    }
    assert_eq!(
        names_in(&out),
        ["courses.csv", "index.html", "notes.txt", "run.json"]
    );
    assert_eq!(names_in(dir.path()), ["o"]);
}

#[test]
fn program_lists_engines_and_explains_for_people_and_programs() {
    let dir = tempfile::tempdir().unwrap();
    let words = done(run_in(dir.path(), ["engines"]));
    let listed: Value =
        serde_json::from_str(&done(run_in(dir.path(), ["engines", "--json"]))).unwrap();
    for engine in listed.as_array().unwrap() {
        assert!(words.contains(engine["name"].as_str().unwrap()), "{engine}");
        assert!(
            ["native", "shared-law", "own-contact"].contains(&engine["track"].as_str().unwrap())
        );
    }
    assert!(words.contains("  here  shares  "), "{words}");
    let explained = done(run_in(dir.path(), ["explain", "paper"]));
    for part in [
        "28 planar bodies",
        "27 degrees of freedom",
        "15 : 1",
        "13.1226 mm",
        "Fig. 3",
    ] {
        let squeezed: String = explained.split_whitespace().collect();
        let part: String = part.split_whitespace().collect();
        assert!(squeezed.contains(&part), "{part} is not in:\n{explained}");
    }
    let report: Value =
        serde_json::from_str(&done(run_in(dir.path(), ["explain", "paper", "--json"]))).unwrap();
    assert_eq!(report["derived"]["lobes"], 15);
    assert_eq!(report["scene"]["name"], "paper");
    assert!(names_in(dir.path()).is_empty(), "explaining writes nothing");
    // Answers to a reader's questions come before the equations.
    let order = [
        "ratio  15 : 1",
        "To be expected",
        "Modelled",
        "28 planar bodies",
        "Left out",
    ];
    let places = order.map(|part| {
        explained
            .find(part)
            .unwrap_or_else(|| panic!("{part}: {explained}"))
    });
    assert!(places.is_sorted(), "{places:?}");
}

/// No escape codes outside terminals, help included.
#[test]
fn program_is_plain_where_nobody_sees_colours() {
    let dir = tempfile::tempdir().unwrap();
    for args in [
        &["--help"][..],
        &["run", "--help"],
        &["engines"],
        &["explain", "paper"],
        &["rnu"],
    ] {
        let outcome = run_in(dir.path(), args);
        assert!(
            !outcome.stdout.contains('\x1b') && !outcome.stderr.contains('\x1b'),
            "{args:?}"
        );
    }
    assert!(run_in(dir.path(), ["--help"]).stdout.contains("Examples:"));
}

#[test]
fn program_survives_a_closed_pipe() {
    let dir = tempfile::tempdir().unwrap();
    for args in [
        &["explain", "paper"][..],
        &["engines", "--json"],
        &["--help"],
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = pinwheel()
            .args(args)
            .current_dir(dir.path())
            .stdin(Stdio::null())
            .stdout(writer)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let outcome = Outcome::from(output);
        assert_eq!(
            (outcome.code, outcome.stderr.as_str()),
            (Some(0), ""),
            "{args:?}"
        );
    }
}

/// Starts a run of a day's length in `dir`; returns when its unfinished folder exists.
#[cfg(unix)]
fn endless(dir: &Path, more: &[&str]) -> Child {
    let child = pinwheel()
        .args(["run", "paper", "--out", "never"])
        .args(words(
            "--set solver.duration_s=10000 --set solver.sample_s=0.01",
        ))
        .args(more)
        .current_dir(dir)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while names_in(dir).is_empty() {
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

#[cfg(unix)]
fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill")
        .args(["-s", name, &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
}

#[cfg(unix)]
#[test]
fn program_stopped_leaves_nothing() {
    for name in ["INT", "TERM"] {
        let dir = tempfile::tempdir().unwrap();
        let child = endless(dir.path(), &[]);
        signal(&child, name);
        let outcome = Outcome::from(child.wait_with_output().unwrap());
        assert_eq!(outcome.code, Some(130), "{name}: {outcome:?}");
        assert_eq!(outcome.stderr, "error: stopped; nothing was written\n");
        assert_eq!(outcome.stdout, "");
        assert!(
            names_in(dir.path()).is_empty(),
            "{:?}",
            names_in(dir.path())
        );
    }
}

/// The engine checks the flag at its samples; between two distant ones only the second signal has an effect.
#[cfg(unix)]
#[test]
fn program_stopped_twice_ends_at_once_and_leaves_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let mut child = endless(dir.path(), &["--set", "solver.sample_s=10000"]);
    // Pending signals of one kind merge, so they are repeated until the program has ended.
    let code = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status.code();
        }
        signal(&child, "INT");
        std::thread::sleep(Duration::from_millis(20));
    };
    assert_eq!(code, Some(130));
    assert!(
        names_in(dir.path()).is_empty(),
        "{:?}",
        names_in(dir.path())
    );
}

/// The program alone, in a folder without files of the project.
#[test]
fn program_works_from_any_folder() {
    let dir = tempfile::tempdir().unwrap();
    let explained = done(run_in(dir.path(), ["explain", "steel"]));
    assert!(explained.contains("Modelled"), "{explained}");
    let listed = done(run_in(dir.path(), ["engines"]));
    assert!(listed.contains("native-reduced"), "{listed}");
    // Recordings are embedded too; live engines do not need them.
    #[cfg(not(feature = "crossval"))]
    {
        let words = words("compare paper --engines native-reduced,mujoco-own-contact");
        let shown = done(run_in(dir.path(), words));
        assert!(shown.contains("recorded"), "{shown}");
    }
}

/// Output has at most 80 columns if the width of the terminal is unknown.
#[test]
fn program_fits_a_screen() {
    let dir = tempfile::tempdir().unwrap();
    let short = "--set solver.duration_s=0.005 --engines native-reduced,native-lagrange --out";
    let compare = format!("compare paper {short} c");
    let mut asked: Vec<String> = ["engines", "laws", "explain steel", "--help", &compare]
        .map(str::to_owned)
        .to_vec();
    let commands = "run compare bench record explain init design fmu sweep engines stability laws schema paper solver \
                    baseline open completions";
    asked.extend(commands.split_whitespace().map(|c| format!("{c} --help")));
    for words in &asked {
        let outcome = run_in(dir.path(), words.split(' '));
        for line in outcome.stdout.lines() {
            assert!(line.chars().count() <= 80, "{words}: {line}");
        }
        assert!(!outcome.stdout.is_empty(), "{words}: {outcome:?}");
    }
}

#[test]
fn program_opens_and_completes() {
    let dir = tempfile::tempdir().unwrap();
    let nothing = run_in(dir.path(), ["open", "--print"]);
    assert_eq!(nothing.code, Some(2), "{nothing:?}");
    assert!(nothing.stderr.contains("no page in out/"), "{nothing:?}");
    for (name, age) in [("old", 100), ("new", 0)] {
        let page = dir.path().join("out").join(name).join("index.html");
        std::fs::create_dir_all(page.parent().unwrap()).unwrap();
        let file = std::fs::File::create(&page).unwrap();
        #[expect(clippy::disallowed_methods, reason = "an age, no duration")]
        let when = std::time::SystemTime::now() - Duration::from_secs(age);
        file.set_modified(when).unwrap();
    }
    let newest = done(run_in(dir.path(), ["open", "--print"]));
    assert_eq!(newest, "page: out/new/index.html\n");
    let named = done(run_in(dir.path(), ["open", "out/old", "--print"]));
    assert_eq!(named, "page: out/old/index.html\n");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = done(run_in(dir.path(), ["completions", shell]));
        assert!(script.contains("stability"), "{shell}");
    }
}

/// Documents refer to existing items: links lead to files and headings, commands and their flags are those of this program.
#[test]
fn program_documents_name_what_is_there() {
    let folders = words(". docs python solvers reference/law-vectors reference/recorded");
    let pages = folders.into_iter().map(repository).flat_map(|folder| {
        let names = names_in(&folder).into_iter();
        let pages = names.filter(|name| name.ends_with(".md"));
        pages.map(move |name| folder.join(name)).collect::<Vec<_>>()
    });
    let of_heading = |line: &str| {
        let kept = |c: &char| c.is_alphanumeric() || " -_".contains(*c);
        let title = line.trim_start_matches('#').trim().to_lowercase();
        title
            .chars()
            .filter(kept)
            .collect::<String>()
            .replace(' ', "-")
    };
    let (mut wrong, mut commands) = (Vec::new(), 0);
    for page in pages {
        let text = std::fs::read_to_string(&page).unwrap();
        let text = text.replace("run: $PINWHEEL", "\npinwheel");
        let links = text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next());
        for link in links.filter(|link| !link.contains("://")) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() {
                page.clone()
            } else {
                page.with_file_name(file)
            };
            let there = match std::fs::read_to_string(&target) {
                Ok(text) if !heading.is_empty() => text
                    .lines()
                    .any(|line| line.starts_with('#') && of_heading(line) == heading),
                _ => target.exists(),
            };
            if !there {
                wrong.push(format!("{}: {link}", page.display()));
            }
        }
        for piece in text
            .split(['\n', '`'])
            .filter(|piece| piece.starts_with("pinwheel "))
        {
            let typed = piece.split(" #").next().unwrap_or_default();
            let words: Vec<&str> = typed.split_whitespace().skip(1).collect();
            let depth = if matches!(words[0], "baseline" | "solver") {
                2
            } else {
                1
            };
            let command = words
                .iter()
                .take(depth)
                .filter(|word| !word.starts_with('-'));
            let help = run_in(Path::new("."), command.chain(&["--help"]));
            let flags = words.iter().filter(|word| word.starts_with("--"));
            let mut flags = flags.map(|flag| flag.split('=').next().unwrap_or_default());
            if help.code != Some(0) || !flags.all(|flag| help.stdout.contains(flag)) {
                wrong.push(format!("{}: {typed}", page.display()));
            }
            commands += 1;
        }
    }
    assert!(wrong.is_empty() && commands > 40, "{commands}, {wrong:#?}");
}

/// For a run with nearly no samples the error is unknown, and no text claims a missing check.
#[test]
fn a_run_of_few_samples_says_one_thing_of_its_error() {
    let dir = tempfile::tempdir().unwrap();
    let sets = "run paper --set solver.duration_s=0.02 --set solver.sample_s=0.02 --out out";
    let run = run_in(dir.path(), words(sets));
    assert_eq!(run.code, Some(0), "{run:?}");
    let stdout = run.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        stdout.contains("too few samples to tell") && stdout.contains("solver.sample_s"),
        "{stdout}"
    );
    assert!(!stdout.contains("made once"), "{stdout}");
}

/// Pages and terminals write short names, which the program accepts.
#[test]
fn program_takes_engines_as_its_pages_call_them() {
    let dir = tempfile::tempdir().unwrap();
    let compare = "compare paper --engines reduced,lagrange --out r --set solver.duration_s=0.005";
    done(run_in(dir.path(), words(compare)));
    let summary = json(dir.path().join("r/summary.json"));
    let names = summary["engines"]
        .as_array()
        .unwrap()
        .iter()
        .map(|e| e["name"].as_str().unwrap());
    let names: Vec<&str> = names.collect();
    assert_eq!(names, ["native-reduced", "native-lagrange"]);
    let twice = run_in(
        dir.path(),
        words("compare paper --engines reduced,native-reduced"),
    );
    assert_eq!(twice.code, Some(2), "{twice:?}");
}

/// Output options: `--json` shows the content of the folder, `--quiet` its path, `--verbose` its files.
#[test]
fn program_speaks_as_it_is_asked() {
    let dir = tempfile::tempdir().unwrap();
    let of = |words_of: &str| {
        let short = "--set solver.duration_s=0.005 --force --out r";
        done(run_in(dir.path(), words(&format!("{words_of} {short}"))))
    };
    for (command, file, place) in [
        ("run paper", "run.json", "courses.csv"),
        (
            "compare paper --engines reduced,lagrange",
            "summary.json",
            "index.html",
        ),
        ("design paper --statics", "summary.json", "index.html"),
    ] {
        let printed: Value = serde_json::from_str(&of(&format!("{command} --json"))).unwrap();
        assert_eq!(printed, json(dir.path().join("r").join(file)), "{command}");
        let quiet = of(&format!("{command} -q"));
        assert_eq!(quiet.lines().count(), 1, "{quiet}");
        assert!(quiet.trim().ends_with(place), "{quiet}");
        let verbose = of(&format!("-v {command}"));
        assert!(
            verbose.contains(place) && verbose.contains(file),
            "{verbose}"
        );
        assert!(verbose.len() > of(command).len());
        let coloured = of(&format!("{command} --color always"));
        let plain = of(&format!("{command} --color never"));
        assert!(
            coloured.contains("\u{1b}[") && !plain.contains('\u{1b}'),
            "{command}"
        );
        // Output options are no part of the record.
        let record = std::fs::read_to_string(dir.path().join("r").join(file)).unwrap();
        assert!(!record.contains("--color"), "{command}");
    }
    for command in ["engines", "laws", "explain paper"] {
        let printed = done(run_in(dir.path(), words(&format!("{command} --json"))));
        serde_json::from_str::<Value>(&printed).unwrap();
    }
    let both = run_in(dir.path(), words("compare paper -q -v"));
    assert_eq!(both.code, Some(2), "{both:?}");
}

/// First use: a catalogue, then each command that the previous one suggests, to figures by fit, drawings and a study of
/// tolerances that runs at the first attempt.
#[test]
fn program_from_a_catalogue_to_its_tolerances() {
    let dir = tempfile::tempdir().unwrap();
    let catalogue = "--ratio 11 --pin-circle-diameter-mm 60 --torque-n-m 20 --speed-rpm 500";
    let hints = done(run_in(
        dir.path(),
        words(&format!("init mine.toml {catalogue}")),
    ));
    let commands: Vec<&str> = hints
        .lines()
        .filter_map(|line| line.split_once(" pinwheel "))
        .map(|(_, next)| next)
        .collect();
    assert_eq!(commands, ["design mine.toml", "sweep mine.tolerances.toml"]);
    let scene = std::fs::read_to_string(dir.path().join("mine.toml")).unwrap();
    assert!(
        scene.starts_with("#:schema ./scene.schema.json\n"),
        "{scene}"
    );
    assert_eq!(
        json(dir.path().join("scene.schema.json")),
        pinwheel_scene::schema::schema()
    );
    let printed = done(run_in(dir.path(), words("design mine.toml --statics")));
    assert!(
        printed.contains("tighten this first") && printed.contains("By fit"),
        "{printed}"
    );
    let summary = json(dir.path().join("out/mine-design/summary.json"));
    let lost = &summary["figures"][0];
    let [low, high] = [0, 1].map(|end| lost["by_fit"][end].as_f64().unwrap());
    let value = lost["value"].as_f64().unwrap();
    assert!(
        lost["key"] == "lost_motion_arcmin" && low < value && value < high,
        "{lost}"
    );
    assert!(dir.path().join("out/mine-design/disc_0.dxf").exists());
    let study = dir.path().join("mine.tolerances.toml");
    let text = std::fs::read_to_string(&study)
        .unwrap()
        .replace("points = 64", "points = 4");
    std::fs::write(&study, text).unwrap();
    assert!(done(run_in(dir.path(), words(commands[1]))).contains("4 finished"));
    // Neither scene nor study of the user is replaced.
    std::fs::remove_file(dir.path().join("mine.toml")).unwrap();
    assert_eq!(
        run_in(dir.path(), words(&format!("init mine.toml {catalogue}"))).code,
        Some(2)
    );
    assert!(!dir.path().join("mine.toml").exists());
}
