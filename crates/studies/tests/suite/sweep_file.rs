//! Files of sweeps.

use std::path::Path;

use pinwheel_studies::sweep::{KeepTimeSeries, Sweep, Value};

fn read(text: &str) -> Result<Sweep, String> {
    Sweep::from_toml(text, Path::new("sweeps/mine.toml")).map_err(|error| error.to_string())
}

#[test]
fn a_full_file() {
    let sweep = read(
        "name = \"x\"\nscene = \"backlash-0.6\"\nengines = [\"native-reduced\", \"rapier-shared-law\"]\n\
         window_s = [0.1, 1]\nmeasure = \"*_n_m\"\ncourses = \"csv\"\n[set]\nsolver.duration_s = 0.02\n\
         [vary]\n\"contact.law\" = [\"paper\", \"constant\"]\ngear.backlash_m = { from = 0.0, to = 1e-3, points = 2 }\n\
         [[together]]\ngear.wheels = [1, 2]\ndrive.output_torque_n_m = [11.0, 22.0]\n",
    )
    .unwrap();
    let keys: Vec<Vec<&str>> = sweep
        .axes
        .iter()
        .map(|axis| axis.keys.iter().map(|(key, _)| key.as_str()).collect())
        .collect();
    assert_eq!(
        keys,
        [
            vec!["contact.law"],
            vec!["gear.backlash_m"],
            vec!["gear.wheels", "drive.output_torque_n_m"]
        ]
    );
    assert_eq!(
        sweep.axes[1].keys[0].1,
        [Value::Number(0.0), Value::Number(1e-3)]
    );
    assert_eq!(sweep.window_s, Some([0.1, 1.0]));
    assert_eq!(
        (sweep.measure.as_slice(), sweep.time_series),
        (&["*_n_m".to_owned()][..], KeepTimeSeries::Csv)
    );
    assert_eq!(sweep.set.len(), 1);
    let plain = read("scene = \"paper\"").unwrap();
    assert_eq!(
        (plain.name.as_str(), plain.scene.as_str()),
        ("mine", "paper")
    );
    assert_eq!(plain.engines, ["native"]);
    // Points of an axis must differ; values of one of its keys may repeat.
    let text = "scene = \"paper\"\n[[together]]\na = [1, 1]\nb = [1, 2]";
    assert_eq!(read(text).unwrap().axes[0].len(), 2);
}

#[test]
fn faults_name_line_and_remedy() {
    for (text, part) in [
        (
            "[vary]\ngear.wheels = [1, 2]",
            "line 1: no key `scene` says what is varied; write scene = \"paper\", another preset (",
        ),
        ("x = 1", "line 1: `x` is no key here"),
        (
            "\nengine = [\"native\"]",
            "line 2: `engine` is no key here; did you mean `engines`?",
        ),
        (
            "[vary]\ngear.backlash_m = []",
            "line 2: `gear.backlash_m`: the list is empty",
        ),
        ("vary = 3", "no table"),
        (
            "[set]\ngear.wheels = 1\n[vary]\ngear.wheels = [1, 2]",
            "line 4: `gear.wheels` is given twice",
        ),
        (
            "[[together]]\na = [1, 2]\nb = [1]",
            "line 3: `b` has 1 values, `a` has 2",
        ),
        ("[vary]\na = [1, 1]", "line 2: `a`: 1 is listed twice"),
        (
            "[[together]]\na = [1, 1, 1]\nb = [1, 2, 1]",
            "line 3: [[together]]: point 3 is one before it again",
        ),
        ("engines = []", "empty"),
        ("engines = [\"a\", \"a\"]", "twice"),
        ("window_s = [0.6, 0.3]", "no window"),
        (
            "courses = \"xls\"",
            "cannot be \"xls\"; write one of: none, csv, parquet",
        ),
        ("[vary", "not valid TOML"),
        ("name = 3", "expected a string"),
    ] {
        let line = read(text).unwrap_err();
        assert!(
            line.contains(part) && !line.contains('\n'),
            "{text}: {line}"
        );
    }
}
