//! Writes the benchmark: problems, and their converged time series with what these are uncertain by.
//!
//! `cargo run --release -p pinwheel-studies --example benchmark -- reference/benchmark`; the folder's README says what is in it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use pinwheel_engines::recorded::Recording;
use pinwheel_gearbox::Gearbox;
use pinwheel_law::job;
use pinwheel_scene::Scene;
use pinwheel_studies::Control;
use pinwheel_studies::recording::{Recorded, engines, record};
use pinwheel_timeseries::group_of;
use serde_json::Value;

type Failure = Box<dyn std::error::Error>;

/// Name, preset, and what is set in it: each adds one difficulty.
pub const CASES: [(&str, &str, &[&str]); 6] = [
    ("paper", "paper", &[]),
    ("conservative", "paper", &["contact.law=paper-conservative"]),
    ("one-wheel", "one-wheel", &[]),
    ("forty-pins", "forty-pins", &[]),
    ("steel", "steel", &[]),
    ("friction", "paper-friction", &[]),
];

/// Every second sample of a recording: 2 ms.
const EVERY: usize = 2;

/// The scene of a case.
pub fn scene(preset: &str, sets: &[&str]) -> Result<Gearbox, Failure> {
    let overrides: Result<Vec<_>, _> = sets.iter().map(|set| set.parse()).collect();
    Ok(Gearbox::new(&Scene::load(preset, &overrides?)?)?)
}

/// The problem: bodies, start, law and load with every value, and the times of the samples.
pub fn problem(gearbox: &Gearbox, samples_s: &[f64]) -> Result<Value, Failure> {
    let mut job = job::job(gearbox, None)?;
    job["samples_s"] = samples_s.into();
    if let Some(job) = job.as_object_mut() {
        job.remove("law_library");
    }
    Ok(job)
}

/// Half of the last decimal that is written of a quantity.
fn rounding(courses: &str, quantity: &str) -> f64 {
    let mut lines = courses.lines().map(|line| line.split(','));
    let names = lines.next().into_iter().flatten();
    let ours: Vec<bool> = names.map(|name| group_of(name).0 == quantity).collect();
    let values = lines.flat_map(|line| line.zip(&ours).filter(|(_, ours)| **ours));
    let decimals = values.map(|(value, _)| value.split_once('.').map_or(0, |(_, d)| d.len()));
    0.5 * 0.1_f64.powi(decimals.max().and_then(|d| d.try_into().ok()).unwrap_or(0))
}

/// The files of a case by name.
fn files(gearbox: &Gearbox, scratch: &Path) -> Result<Vec<(&'static str, String)>, Failure> {
    let name = "native-resolved";
    let stop = AtomicBool::new(false);
    for engine in engines(&[name.to_owned()], &gearbox.scene)? {
        let control = Control::new(&stop, &|_| {});
        match record(&*engine, &gearbox.scene, scratch, &control)? {
            Recorded::Kept { .. } => {}
            Recorded::Left(why) | Recorded::Broken(why) => return Err(why.into()),
        }
    }
    let path = scratch.join(&gearbox.scene.name).join(name);
    let text = |ending| std::fs::read_to_string(path.with_extension(ending));
    let mut recording = Recording::read(&text("toml")?, &text("csv")?)?;
    let rows: Vec<usize> = (0..recording.time_series.len()).step_by(EVERY).collect();
    recording.time_series = recording.time_series.select(&rows);
    let (_, courses) = recording.write()?;
    let problem = problem(gearbox, recording.time_series.time_s())?;
    let mut uncertainty = "quantity,from_s,to_s,largest,rms\n".to_owned();
    for known in &recording.uncertainty {
        if let (Some(linf), Some(l2)) = (known.linf, known.l2) {
            let (quantity, from, to) = (&known.quantity, known.from_s, known.to_s);
            let rounding = rounding(&courses, quantity);
            let (linf, l2) = (linf + rounding, l2 + rounding / 3.0_f64.sqrt());
            let _ = writeln!(uncertainty, "{quantity},{from},{to},{linf:.1e},{l2:.1e}");
        }
    }
    Ok(vec![
        ("scene.json", serde_json::to_string_pretty(&problem)? + "\n"),
        ("time_series.csv", courses),
        ("uncertainty.csv", uncertainty),
    ])
}

#[allow(dead_code, reason = "the test reads the files and does not write them")]
fn main() -> Result<(), Failure> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    let folder = folder.ok_or("give the folder to write to")?;
    let scratch = tempfile::tempdir()?;
    for (case, preset, sets) in CASES {
        let files = files(&scene(preset, sets)?, &scratch.path().join(case))?;
        std::fs::create_dir_all(folder.join(case))?;
        for (name, text) in files {
            std::fs::write(folder.join(case).join(name), text)?;
        }
    }
    Ok(())
}
