//! The published benchmark equals the output of this repository, and its uncertainties are valid.

#[path = "../../examples/benchmark.rs"]
#[allow(unreachable_pub, reason = "an example's main file")]
mod benchmark;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::AtomicBool;

use pinwheel_engines::{Control, by_name};
use pinwheel_scene::Scene;
use pinwheel_timeseries::TimeSeries;
use serde_json::Value;

/// Permitted distance beyond the benchmark's uncertainty, relative to the largest value: truncation error of the other solutions.
/// Measured: 4.0e-8, in `one-wheel`.
const LIMIT: f64 = 2e-7;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../reference/benchmark")
}

fn stored(case: &str) -> TimeSeries {
    let file = std::fs::File::open(folder().join(case).join("time_series.csv")).expect(case);
    TimeSeries::read_csv(file).expect(case)
}

/// True if two values are equal to rounding.
fn same(now: &Value, was: &Value) -> bool {
    match (now, was) {
        (Value::Array(now), Value::Array(was)) => {
            now.len() == was.len() && now.iter().zip(was).all(|(now, was)| same(now, was))
        }
        (Value::Object(now), Value::Object(was)) => {
            let each =
                |(key, now): (&String, &Value)| was.get(key).is_some_and(|was| same(now, was));
            now.len() == was.len() && now.iter().all(each)
        }
        (Value::Number(now), Value::Number(was)) => {
            let (now, was) = (now.as_f64().unwrap(), was.as_f64().unwrap());
            (now - was).abs() <= 1e-15 + 1e-12 * was.abs()
        }
        _ => now == was,
    }
}

#[test]
fn regress_problems_are_what_the_presets_say() {
    for (case, preset, sets) in benchmark::CASES {
        let gearbox = benchmark::scene(preset, sets).unwrap();
        let now = benchmark::problem(&gearbox, stored(case).time_s()).unwrap();
        let text = std::fs::read_to_string(folder().join(case).join("scene.json")).unwrap();
        let was: Value = serde_json::from_str(&text).unwrap();
        assert!(
            same(&now, &was),
            "{case}: write it anew, see the folder's README"
        );
    }
}

/// Solves a case by another integrator, and by the form with multipliers where its cost permits.
fn again(case: &str, preset: &str, sets: &[&str]) -> TimeSeries {
    // Friction is stiff: stability would limit the steps of an explicit method.
    let (form, integrator, tolerance) = match case {
        "friction" => ("native-reduced", "rodas5p", 1e-8),
        "steel" | "forty-pins" => ("native-reduced", "dop853", 1e-10),
        _ => ("native-lagrange", "dop853", 1e-10),
    };
    let gearbox = benchmark::scene(preset, sets).unwrap();
    let mut scene = Scene::clone(&gearbox.scene);
    scene.solver.integrator = integrator.to_owned();
    scene.solver.tolerance = tolerance;
    let scene = scene.check().unwrap();
    let stop = AtomicBool::new(false);
    let engine = by_name(form, &scene).unwrap();
    let run = engine.run(&scene, &Control::new(&stop, &|_| {})).unwrap();
    assert!(run.ending.is_finished(), "{case}: {:?}", run.ending);
    run.time_series
}

/// Runs the benchmark's own reader. Returns true if no error exceeds `limit`, and the reader's output.
fn read(case: &str, mine: &TimeSeries, limit: f64) -> (bool, String) {
    let folder_of_mine = tempfile::tempdir().unwrap();
    let path = folder_of_mine.path().join("mine.csv");
    mine.write_csv(std::fs::File::create(&path).unwrap())
        .unwrap();
    let python = std::env::var_os("PYO3_PYTHON").unwrap_or_else(|| "python3".into());
    let mut command = Command::new(python);
    command.arg(folder().join("read.py")).arg(case).arg(&path);
    let output = command.arg(limit.to_string()).output().expect("Python");
    let text = [output.stdout, output.stderr].concat();
    (
        output.status.success(),
        String::from_utf8_lossy(&text).into_owned(),
    )
}

#[test]
fn regress_another_form_and_integrator_give_the_benchmark() {
    for (case, preset, sets) in benchmark::CASES {
        let start = std::time::Instant::now();
        let mine = again(case, preset, sets);
        let (agrees, text) = read(case, &mine, LIMIT);
        println!("{case}, {:.1} s\n{text}", start.elapsed().as_secs_f64());
        assert!(agrees, "{case}: {text}");
        // One force off by a thousandth is detected, and so is NaN.
        for factor in [1.001, f64::NAN].into_iter().filter(|_| case == "paper") {
            let mut spoiled = TimeSeries::new(mine.time_s().to_vec()).unwrap();
            for channel in mine.channels() {
                let mut values = channel.values.to_vec();
                if channel.name == "external_sleeve_force_n_3" {
                    values.iter_mut().for_each(|value| *value *= factor);
                }
                spoiled.push(&channel.name, values).unwrap();
            }
            assert!(!read(case, &spoiled, LIMIT).0, "{case}: {factor}");
        }
    }
}
