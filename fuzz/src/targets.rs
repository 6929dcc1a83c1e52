//! One function per reader: takes any bytes, asserts the reader's invariants, and returns true if the bytes were accepted.

use std::path::Path;

use pinwheel_engines::external::Manifest;
use pinwheel_engines::kept;
use pinwheel_engines::recorded::Recording;
use pinwheel_gearbox::native;
use pinwheel_gearbox::{Frequencies, Gearbox, explain};
use pinwheel_scene::{CheckedScene, Override, Scales, Scene, names};
use pinwheel_studies::baseline::Baseline;
use pinwheel_studies::sweep::{Plan, Sweep};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::foreign::{Map, read, resample, shift};

use crate::loopback::Question;

/// Separator of the parts of an input that stands for two files.
pub const PARTS: &str = "\n%%%%\n";

/// Number of steps of [`first_steps`].
const STEPS: f64 = 40.0;
/// Largest sweep that is planned, in runs.
const RUNS: usize = 64;

fn text(bytes: &[u8]) -> Option<&str> {
    std::str::from_utf8(bytes).ok()
}

fn parts(bytes: &[u8]) -> Option<(&str, &str)> {
    text(bytes)?.split_once(PARTS)
}

/// Splits an input into two parts, of which only the first must be UTF-8.
fn text_and_bytes(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let mut places = bytes.windows(PARTS.len());
    let at = places.position(|part| part == PARTS.as_bytes())?;
    Some((text(&bytes[..at])?, &bytes[at + PARTS.len()..]))
}

/// Checks that an error's message is not empty.
fn check_message(error: &dyn std::fmt::Display) {
    assert!(!error.to_string().trim().is_empty());
}

fn finite(what: &str, values: impl IntoIterator<Item = f64>) {
    for value in values {
        assert!(value.is_finite(), "{what}: {value}");
    }
}

/// Checks that `shown` contains no infinite or undefined number.
fn no_numberless(what: &str, shown: &str) {
    let mut words = shown.split(|c: char| !c.is_alphanumeric());
    let wrong = words.find(|word| ["inf", "NaN", "infinity"].contains(word));
    assert!(wrong.is_none(), "{what}: {shown}");
}

fn load(text: &str, sets: &[Override]) -> Option<CheckedScene> {
    // Seeds have no `base`; one that a mutation adds is looked up relative to this missing file.
    match Scene::from_toml(text, "/nonexistent/fuzz.toml", sets) {
        Ok(scene) => Some(scene),
        Err(error) => {
            check_message(&error);
            None
        }
    }
}

/// Checks that an accepted scene can be written and read again, has finite scales, and is compiled or refused.
fn sound(scene: &CheckedScene) -> Option<Gearbox> {
    let again = Scene::from_toml(&scene.to_toml(), "/nonexistent/fuzz.toml", &[]);
    match again {
        Ok(again) => assert!(
            again.clone().into_scene() == scene.clone().into_scene(),
            "read again"
        ),
        Err(error) => panic!("an accepted scene is refused when read again: {error}"),
    }
    let scales = Scales::of(scene);
    let sizes = [
        scales.wheel_torque_n_m,
        scales.external_force_n,
        scales.penetration_m,
        scales.contact_stiffness_n_m,
    ];
    finite("scales", sizes.into_iter().chain(scales.modes_rad_s));
    assert!(sizes.iter().all(|size| *size > 0.0), "{scales:?}");
    finite("longest step", [Frequencies::of(scene).longest_step_s()]);
    match Gearbox::new(scene) {
        Ok(gearbox) => {
            no_numberless("explain", &format!("{:?}", explain(&gearbox)));
            Some(gearbox)
        }
        Err(error) => {
            check_message(&error);
            None
        }
    }
}

/// Reads a scene file.
pub fn scene(bytes: &[u8]) -> bool {
    let scene = text(bytes).and_then(|text| load(text, &[]));
    scene.as_ref().and_then(sound).is_some()
}

/// Applies `--set KEY=VALUE`, one a line, to the preset `paper`.
pub fn settings(bytes: &[u8]) -> bool {
    let Some(text) = text(bytes) else {
        return false;
    };
    let mut sets = Vec::new();
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        match line.parse::<Override>() {
            Ok(set) => sets.push(set),
            Err(error) => check_message(&error),
        }
    }
    match Scene::load("paper", &sets) {
        Ok(scene) => sound(&scene).is_some(),
        Err(error) => {
            check_message(&error);
            false
        }
    }
}

/// Reads a scene file and runs its first steps: they end, with finite results or a reported divergence.
pub fn first_steps(bytes: &[u8]) -> bool {
    let Some(scene) = text(bytes).and_then(|text| load(text, &[])) else {
        return false;
    };
    let short = scene.changed(|scene| {
        let solver = &mut scene.solver;
        solver.duration_s = solver.duration_s.min(STEPS * solver.step_s);
        solver.sample_s = solver.sample_s.min(0.25 * solver.duration_s);
    });
    let Ok(scene) = short else { return false };
    let Ok(gearbox) = Gearbox::new(&scene) else {
        return false;
    };
    let mut samples = 0;
    let run = native::run(&gearbox, &mut |_| {
        samples += 1;
        samples > 200
    });
    match run.and_then(|run| Ok(run.finished()?)) {
        Ok(run) => {
            for channel in run.time_series.channels() {
                finite(&channel.name, channel.values.iter().copied());
            }
            let shares = run.energy.total().and_then(|audit| audit.remainder_share);
            finite("share of the account", shares);
            true
        }
        Err(error) => {
            check_message(&error);
            false
        }
    }
}

/// Reads a map of foreign data.
pub fn map(bytes: &[u8]) -> bool {
    match text(bytes).map(|text| Map::from_toml(text, "map.toml")) {
        Some(Ok(_)) => true,
        Some(Err(error)) => {
            check_message(&error);
            false
        }
        None => false,
    }
}

/// Reads a map and its data file: values, their shift against themselves and their resampling are finite.
pub fn foreign(bytes: &[u8]) -> bool {
    let Some((map, csv)) = text_and_bytes(bytes) else {
        return false;
    };
    let Ok(map) = Map::from_toml(map, "map.toml") else {
        return false;
    };
    let foreign = match read(csv, &map) {
        Ok(foreign) => foreign,
        Err(error) => {
            check_message(&error);
            return false;
        }
    };
    finite("time", foreign.time_series.time_s().iter().copied());
    for channel in foreign.time_series.channels() {
        finite(&channel.name, channel.values.iter().copied());
    }
    let (series, time) = (&foreign.time_series, foreign.time_series.time_s());
    let shortest = time.windows(2).map(|pair| pair[1] - pair[0]);
    let shortest = shortest.fold(f64::INFINITY, f64::min);
    // A finer grid than of some thousand points takes too long for millions of inputs.
    if time[time.len() - 1] - time[0] < 1000.0 * shortest {
        match shift(series, series) {
            Ok(fit) => finite("shift", [fit.seconds, fit.uncertainty_s, fit.unshifted]),
            Err(why) => check_message(&why),
        }
    }
    let times: Vec<f64> = (0..50).map(|k| f64::from(k) * 1e-4).collect();
    match resample(&foreign.time_series, &times, map.resample) {
        Ok(on) => {
            assert_eq!(on.time_series.len(), times.len());
            let values = on.time_series.channels().iter().flat_map(|c| &c.values);
            // NaN marks times that the file does not cover.
            assert!(values.clone().all(|value| !value.is_infinite()));
            true
        }
        Err(error) => {
            check_message(&error);
            false
        }
    }
}

/// Reads a sweep file, and plans a small sweep.
pub fn sweep(bytes: &[u8]) -> bool {
    let Some(text) = text(bytes) else {
        return false;
    };
    let sweep = match Sweep::from_toml(text, Path::new("/nonexistent/fuzz.toml")) {
        Ok(sweep) => sweep,
        Err(error) => {
            check_message(&error);
            return false;
        }
    };
    let lengths = sweep.axes.iter().map(|axis| axis.len());
    let points = sweep.sample.as_ref().map_or(1, |sample| sample.points);
    let runs = lengths.fold(sweep.engines.len(), usize::saturating_mul);
    let runs = runs.saturating_mul(points);
    if runs > RUNS {
        return true;
    }
    match Plan::new(sweep, &[]) {
        Ok(plan) => {
            assert_eq!(plan.len(), runs);
            for run in 0..runs {
                if let Err(error) = plan.run(run) {
                    check_message(&error);
                }
            }
            true
        }
        Err(error) => {
            check_message(&error);
            false
        }
    }
}

/// Reads a baseline.
pub fn baseline(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return false;
    };
    match Baseline::parse(Path::new("baseline.toml"), text) {
        Ok(baseline) => {
            for converged in baseline
                .scenes
                .iter()
                .flat_map(|scene| scene.converged.values())
            {
                let statistics = &converged.statistics;
                finite("scale", [converged.scale, converged.own_error]);
                finite("peak", [statistics.whole_mean(), statistics.whole_peak()]);
            }
            true
        }
        Err(error) => {
            check_message(&error);
            false
        }
    }
}

/// Reads a recording: description and time series.
pub fn recording(bytes: &[u8]) -> bool {
    let Some((description, csv)) = parts(bytes) else {
        return false;
    };
    match Recording::read(description, csv) {
        Ok(recording) => {
            if let Err(error) = recording.write() {
                check_message(&error);
            }
            true
        }
        Err(error) => {
            check_message(&error);
            false
        }
    }
}

/// Reads a kept run without its hash, which would reject every mutation.
pub fn kept(bytes: &[u8]) -> bool {
    kept::internals::reads(bytes)
}

/// Reads the manifest of a solver. No command of it is run.
pub fn manifest(bytes: &[u8]) -> bool {
    let Some(text) = text(bytes) else {
        return false;
    };
    match Manifest::from_toml(text, "solver.toml") {
        Ok(solver) => {
            assert!(Manifest::is_name(&solver.name).is_ok(), "{}", solver.name);
            assert!(
                solver
                    .command
                    .first()
                    .is_some_and(|program| !program.is_empty())
            );
            finite("timeout", [solver.timeout_s]);
            finite("order", solver.refine.iter().map(|refine| refine.order));
            finite(
                "tolerance",
                solver.model.values().map(|stated| stated.tolerance),
            );
            assert!(
                names::laws().iter().any(|law| solver.honours_law(law))
                    || solver.honours.laws.is_empty()
            );
            true
        }
        Err(error) => {
            check_message(&error);
            assert!(!error.to_string().contains('\n'), "one line: {error}");
            false
        }
    }
}

/// Reads time series as CSV: accepted series are equal after writing and reading again.
pub fn time_series(bytes: &[u8]) -> bool {
    let series = match TimeSeries::read_csv(bytes) {
        Ok(series) => series,
        Err(error) => {
            check_message(&error);
            return false;
        }
    };
    let mut written = Vec::new();
    match series
        .write_csv(&mut written)
        .map(|()| TimeSeries::read_csv(written.as_slice()))
    {
        Ok(Ok(again)) => assert!(alike(&series, &again), "read again"),
        Ok(Err(error)) => panic!("a written series is refused: {error}"),
        Err(error) => check_message(&error),
    }
    true
}

/// Reads time series as Parquet.
#[cfg(feature = "parquet")]
pub fn parquet(bytes: &[u8]) -> bool {
    match pinwheel_timeseries::read_time_series(bytes::Bytes::copy_from_slice(bytes), 1 << 20) {
        Ok(series) => !series.is_empty(),
        Err(error) => {
            check_message(&error);
            false
        }
    }
}

/// Compares time series by their bits; NaN equals NaN.
fn alike(a: &TimeSeries, b: &TimeSeries) -> bool {
    let bits = |time_series: &TimeSeries| -> Vec<(String, Vec<u64>)> {
        let bits = |values: &[f64]| {
            values
                .iter()
                .map(|v| if v.is_nan() { 0 } else { v.to_bits() })
                .collect()
        };
        let time = [("time_s".to_owned(), bits(time_series.time_s()))];
        let channels = time_series.channels().iter();
        time.into_iter()
            .chain(channels.map(|c| (c.name.clone(), bits(&c.values))))
            .collect()
    };
    bits(a) == bits(b)
}

/// Reads a request to the server of `pinwheel explore`: a request in pieces gives the same question as one in a single piece,
/// its head has no control characters, and its body has the length of its only `Content-Length`.
pub fn requests(bytes: &[u8]) -> bool {
    let all = Question::read(bytes);
    for part in 1..4 {
        let first = Question::read(&bytes[..bytes.len() * part / 4]);
        match (&first, &all) {
            (Ok(Some(first)), Ok(Some(all))) => {
                let same = first.method == all.method && first.path == all.path;
                assert!(same && first.body == all.body, "{first:?} {all:?}");
            }
            (Ok(Some(_)), _) => panic!("{first:?}, and with more {all:?}"),
            (Err(status), all) => assert_eq!(Err(*status), all.as_ref().map(drop).map_err(|s| *s)),
            (Ok(None), _) => {}
        }
    }
    let Ok(Some(question)) = all else {
        return false;
    };
    let plain = |text: &str| !text.contains(|c: char| c.is_control() || c == ' ');
    assert!(plain(&question.method) && plain(&question.path));
    let named = |name| question.headers(name).count();
    assert_eq!(named("Transfer-Encoding"), 0);
    let length = question.header("Content-Length");
    assert_eq!(named("Content-Length"), usize::from(length.is_some()));
    let length = length.map_or("0", |length| length.trim_start_matches('0'));
    assert_eq!(length.parse().unwrap_or(0), question.body.len());
    true
}
