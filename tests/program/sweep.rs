//! `pinwheel sweep` in use: files, and remains of a kill.

use std::path::{Path, PathBuf};
use std::time::Duration;

use pinwheel_tests::{names_in, pinwheel, run_in, words};
use serde_json::Value;

const SWEEP: &str = "\
name = \"small\"
scene = \"paper\"
engines = [\"native-reduced\"]
[set]
solver.duration_s = 0.01
[vary]
gear.backlash_m = { from = 0.0, to = 3.0e-4, points = 4 }
contact.damping_n_s_m = [8.0, 16.0]
";

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn a_sweep_writes_whole_results() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("small.toml"), SWEEP).unwrap();
    let one = run_in(
        dir.path(),
        ["sweep", "small.toml", "--jobs", "1", "--out", "one"],
    );
    assert_eq!((one.code, one.stderr.as_str()), (Some(0), ""), "{one:?}");
    let three = run_in(dir.path(), ["sweep", "small.toml", "--jobs", "3"]);
    assert!(three.stdout.contains("8 finished"), "{three:?}");
    let (one, out) = (dir.path().join("one"), dir.path().join("out/small-sweep"));
    assert_eq!(
        read(&one.join("results.csv")),
        read(&out.join("results.csv"))
    );
    let names = names_in(&out);
    for name in words("costs.csv index.html results.csv runs summary.json sweep.toml") {
        assert!(names.iter().any(|n| n == name), "{name}: {names:?}");
    }
    assert_eq!(names_in(&out.join("runs")).len(), 8);
    assert_eq!(
        names_in(dir.path()),
        ["one", "out", "small.toml"],
        "nothing unfinished is left"
    );
    let summary: Value = serde_json::from_str(&read(&out.join("summary.json"))).unwrap();
    assert_eq!(
        (&summary["runs"], &summary["finished"]),
        (&Value::from(8), &Value::from(8))
    );
    assert_eq!(summary["rows"][7]["gear.backlash_m"], 3e-4);
    assert!(
        summary["rows"][0]["peak_external_sleeve_force_n"]
            .as_f64()
            .unwrap()
            > 100.0
    );
    let page = read(&out.join("index.html"));
    assert!(page.contains("gear.backlash_m") && page.contains("small"));
    // An earlier output is replaced completely; --list runs nothing.
    assert_eq!(run_in(dir.path(), ["sweep", "small.toml"]).code, Some(0));
    let list = run_in(
        dir.path(),
        ["sweep", "small.toml", "--list", "--set", "gear.wheels=1"],
    );
    assert_eq!(list.stdout.lines().count(), 10, "{}", list.stdout);
}

#[test]
fn bad_sweeps_end_with_a_line() {
    let dir = tempfile::tempdir().unwrap();
    for (text, part) in [
        (
            "scene = \"paper\"\n[vary]\ngear.wheels = [1, 0]\n",
            "run 2 (gear.wheels = 0)",
        ),
        ("[vary]\ngear.wheels = [1, 2]\n", "no key `scene`"),
        ("vry = 1\n", "did you mean `vary`?"),
        ("scene = \"paper\"\nengines = [\"nativ\"]\n", "did you mean"),
    ] {
        std::fs::write(dir.path().join("bad.toml"), text).unwrap();
        let outcome = run_in(dir.path(), ["sweep", "bad.toml"]);
        assert_eq!(outcome.code, Some(2), "{outcome:?}");
        assert!(
            outcome.stderr.contains(part) && outcome.stderr.lines().count() == 1,
            "{}",
            outcome.stderr
        );
        assert_eq!(names_in(dir.path()), ["bad.toml"]);
    }
    let missing = run_in(dir.path(), ["sweep", "none.toml"]);
    assert!(
        missing.code == Some(2) && missing.stderr.contains("sweep file"),
        "{missing:?}"
    );
    // A run that diverges is a result, and status 3.
    std::fs::write(
        dir.path().join("wild.toml"),
        "scene = \"paper\"\n[set]\nsolver.duration_s = 0.01\n[vary]\nsolver.step_s = [1e-5, 1e-4]\n",
    )
    .unwrap();
    let wild = run_in(dir.path(), ["sweep", "wild.toml", "--out", "wild"]);
    assert_eq!(wild.code, Some(3), "{wild:?}");
    assert!(read(&dir.path().join("wild/results.csv")).contains("diverged"));
}

/// A sweep keeps its finished runs after SIGKILL, and continues with them; torn ones are run again.
#[test]
fn a_killed_sweep_goes_on() {
    let dir = tempfile::tempdir().unwrap();
    // Long enough on any machine for a kill in the middle, which comes after two runs.
    let long = SWEEP.replace("0.01", "0.05");
    std::fs::write(dir.path().join("long.toml"), &long).unwrap();
    let journal = dir.path().join("long.unfinished");
    let runs = || {
        names_in(&journal)
            .iter()
            .filter(|name| name.starts_with("run-"))
            .count()
    };
    let mut child = pinwheel()
        .current_dir(dir.path())
        .args(["sweep", "long.toml", "--jobs", "1", "--out", "long"])
        .spawn()
        .unwrap();
    while runs() < 2 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = runs();
    assert!((2..8).contains(&kept), "{kept}");
    assert!(!dir.path().join("long").exists());
    let stamps = || -> Vec<Value> {
        let names = names_in(&journal).into_iter();
        let names = names.filter(|name| name.starts_with("run-"));
        let records = names.filter_map(|name| {
            let text = read(&journal.join(name));
            serde_json::from_str::<Value>(&text).ok()
        });
        let finished = records.inspect(|record| assert_eq!(record["state"], "finished"));
        finished.map(|record| record["cpu_s"].clone()).collect()
    };
    // One record may be torn by the kill, and one is torn here: both are invalid.
    assert!(stamps().len() + 1 >= kept, "{kept}");
    let mut names = names_in(&journal).into_iter();
    let torn = names.find(|name| name.starts_with("run-"));
    std::fs::write(journal.join(torn.unwrap()), "").unwrap();
    let stamps = stamps();
    let again = run_in(dir.path(), ["sweep", "long.toml", "--out", "long"]);
    assert!(
        again.code == Some(2) && again.stderr.contains("--resume"),
        "{again:?}"
    );
    let resumed = run_in(
        dir.path(),
        ["sweep", "long.toml", "--out", "long", "--resume"],
    );
    assert_eq!(resumed.code, Some(0), "{resumed:?}");
    // The stored runs were not repeated: their times are still those of the first attempt.
    let costs = read(&dir.path().join("long/costs.csv"));
    for stamp in stamps {
        assert!(costs.contains(&stamp.to_string()), "{stamp} {costs}");
    }
    assert!(!journal.exists());
    let full = run_in(dir.path(), ["sweep", "long.toml", "--out", "full"]);
    assert_eq!(full.code, Some(0));
    let results = |name: &str| read(&dir.path().join(name).join("results.csv"));
    assert_eq!(results("long"), results("full"));
}

/// Time series that were cut, emptied, altered or exchanged, and records with a changed digit are invalid: the run is
/// repeated.
#[test]
fn damaged_runs_are_made_again() {
    let dir = tempfile::tempdir().unwrap();
    let formats = ["csv", "parquet"];
    for format in &formats[..1 + usize::from(cfg!(feature = "parquet"))] {
        let sweep = SWEEP.replace("[set]", &format!("courses = \"{format}\"\n[set]"));
        std::fs::write(dir.path().join("s.toml"), sweep).unwrap();
        let run = |more: &[&str]| run_in(dir.path(), ["sweep", "s.toml"].iter().chain(more));
        assert_eq!(run(&["--out", "full"]).code, Some(0));
        let file = |out: &str, number: usize| {
            let name = format!("{out}/runs/run-000{number}.{format}");
            dir.path().join(name)
        };
        let content = |out: &str, number| std::fs::read(file(out, number)).unwrap();
        let damage = |path: &dyn Fn(usize) -> PathBuf| {
            let original = |number| std::fs::read(path(number)).unwrap();
            let put = |number, bytes: &[u8]| std::fs::write(path(number), bytes).unwrap();
            put(1, b"");
            let half = original(2);
            put(2, &half[..half.len() / 2]);
            let mut altered = original(3);
            let middle = altered.len() / 2;
            altered[middle] ^= 1;
            put(3, &altered);
            put(4, &original(5));
            std::fs::remove_file(path(6)).unwrap();
            // Changes a digit of the largest force in the record of run 7.
            let record = path(7).with_extension("json");
            let text = read(&record);
            let (before, digits) = text.split_once("\"peak\": ").unwrap();
            let first = if digits.starts_with('1') { "7" } else { "1" };
            let changed = format!("{before}\"peak\": {first}{}", &digits[1..]);
            std::fs::write(record, changed).unwrap();
        };
        // Damage to a finished output.
        let sound: Vec<Vec<u8>> = (1..=8).map(|number| content("full", number)).collect();
        let results = read(&dir.path().join("full/results.csv"));
        damage(&|number| file("full", number));
        let kept = run(&["--out", "full", "--resume"]);
        assert!(
            kept.code == Some(2) && kept.stderr.contains("--force"),
            "{kept:?}"
        );
        assert_eq!(run(&["--out", "full", "--resume", "--force"]).code, Some(0));
        for (number, sound) in (1..=8).zip(&sound) {
            assert!(content("full", number) == *sound, "{format} {number}");
        }
        assert_eq!(read(&dir.path().join("full/results.csv")), results);
        std::fs::remove_dir_all(dir.path().join("full")).unwrap();
    }
}

/// For few runs only the ends are reported; equal values have no spread and no decisive key.
#[test]
fn small_samples_say_no_more_than_they_know() {
    let dir = tempfile::tempdir().unwrap();
    let sample = |points: usize, key: &str| {
        let text = format!(
            "name = \"s\"\nscene = \"paper\"\nengines = [\"native-reduced\"]\n[set]\nsolver.duration_s = 0.01\n\
             [sample]\npoints = {points}\n{key}\n"
        );
        std::fs::write(dir.path().join("s.toml"), text).unwrap();
        run_in(dir.path(), ["sweep", "s.toml"]).stdout
    };
    let backlash = "gear.backlash_m = { from = 0.0, to = 1e-4 }";
    let few = sample(8, backlash);
    assert!(
        few.contains(", 8 runs from ") && !few.contains("90 % of runs"),
        "{few}"
    );
    assert!(sample(30, backlash).contains(", 90 % of runs from "));
    let same = sample(8, "gear.backlash_m = { mean = 1e-4, plus_minus = 1e-19 }");
    for text in [few, same] {
        // The continuation may be on the next line, indented.
        let unfinished = |pair: (&str, &str)| pair.0.ends_with(';') && !pair.1.starts_with(' ');
        let below = text.lines().skip(1).chain([""]);
        assert!(!text.lines().zip(below).any(unfinished), "{text}");
    }
}

/// A key without effect on the run is reported, as an axis and on the command line; one with an effect is not.
#[test]
fn regress_keys_that_do_nothing_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let all = read(
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../reference/scenes/paper.toml")
            .as_path(),
    );
    std::fs::write(dir.path().join("all.toml"), all).unwrap();
    let short = "engines = [\"native-reduced\"]\n[set]\nsolver.duration_s = 0.002\n[vary]\n";
    let summary = |vary: &str, scene: &str| {
        let text =
            format!("name = \"s\"\nscene = \"{scene}\"\n{short}{vary}\ngear.wheels = [1, 2]\n");
        std::fs::write(dir.path().join("s.toml"), text).unwrap();
        let swept = run_in(dir.path(), ["sweep", "s.toml", "--out", "s"]);
        assert_eq!(swept.code, Some(0), "{swept:?}");
        let summary: Value =
            serde_json::from_str(&read(&dir.path().join("s/summary.json"))).unwrap();
        let page = read(&dir.path().join("s/index.html"));
        (summary["no_effect"].clone(), swept.stdout, page)
    };
    let bases = "base = [\"paper\", \"steel\", \"backlash-0.6\"]";
    for (vary, scene) in [
        ("contact.restitution = [0.2, 0.5, 0.8]", "paper"),
        (bases, "all.toml"),
    ] {
        let (none, shown, page) = summary(vary, scene);
        let (key, _) = vary.split_once(" = ").unwrap();
        assert_eq!(none, serde_json::json!([key]));
        assert!(
            shown.contains("no effect") && page.contains("No effect on this scene"),
            "{shown}"
        );
    }
    let (none, shown, _) = summary("contact.damping_n_s_m = [8, 9]", "paper");
    assert!(none.is_null() && !shown.contains("no effect"), "{none}");

    let with = |command: &str, sets: &str| {
        let command =
            format!("{command} all.toml --out r --force --set solver.duration_s=0.01 {sets}");
        run_in(dir.path(), words(&command)).stderr
    };
    let run = |sets: &str| with("run", sets);
    let compare = "compare --engines native-reduced,native-resolved";
    let idle = "--set contact.restitution=0.3 --set gear.backlash_m=1e-5 --set base=steel";
    for command in ["run", compare] {
        let notes = with(command, idle);
        let keys = notes
            .lines()
            .map(|line| line.split(['=', ' ']).nth(2).unwrap());
        let keys: Vec<&str> = keys.collect();
        assert_eq!(keys, ["contact.restitution", "base"], "{command}: {notes}");
    }
    // This change has no effect on the first samples, which are compared first; the later ones must be compared, too.
    let later = "--set drive.load_changes=[{time_s=0.005,output_torque_n_m=30}]";
    assert_eq!(run(later), "");
    for typed in [
        "design paper --out r --force --statics --set drive.output_torque_n_m=20",
        // No figure of statics depends on these.
        "design paper --out r --force --set mass.wheel.mass_kg=0.7 --set contact.band_laws=[\"kunert\"]",
        "explain paper --set gear.hole_radius_m=0.00881",
        &format!("explain paper {later}"),
    ] {
        let typed = format!("{typed} --set contact.restitution=0.3");
        let outcome = run_in(dir.path(), words(&typed));
        let of = match typed.starts_with("design") {
            true => "the figures and files of this design",
            false => "the native time series of this scene",
        };
        let without = format!("{of}: without it they are equal to the bit\n");
        let note = format!("note: --set contact.restitution=0.3 has no effect on {without}");
        assert_eq!((outcome.code, outcome.stderr), (Some(0), note), "{typed}");
    }

    // A diverged run has no bands, whose computation would take longest.
    let wheels = "run steel --out w --set gear.wheels=64";
    assert_eq!(run_in(dir.path(), words(wheels)).code, Some(3));
    assert!(!read(&dir.path().join("w/run.json")).contains("by_contact_law"));
}
