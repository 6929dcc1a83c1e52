//! One function a reader: any bytes in, true if they were accepted. What must hold is asserted.

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

/// Stands between the parts of an input that is two files.
pub const PARTS: &str = "\n%%%%\n";

/// Steps of [`first_steps`].
const STEPS: f64 = 40.0;
/// Runs of a sweep that are planned.
const RUNS: usize = 64;

fn text(bytes: &[u8]) -> Option<&str> {
    std::str::from_utf8(bytes).ok()
}

fn parts(bytes: &[u8]) -> Option<(&str, &str)> {
    text(bytes)?.split_once(PARTS)
}

/// Two parts of which the second may be no UTF-8.
fn text_and_bytes(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let mut places = bytes.windows(PARTS.len());
    let at = places.position(|part| part == PARTS.as_bytes())?;
    Some((text(&bytes[..at])?, &bytes[at + PARTS.len()..]))
}

/// A message says something.
fn told(error: &dyn std::fmt::Display) {
    assert!(!error.to_string().trim().is_empty());
}

fn finite(what: &str, values: impl IntoIterator<Item = f64>) {
    for value in values {
        assert!(value.is_finite(), "{what}: {value}");
    }
}

/// No word of what is shown is a number that there is none of.
fn no_numberless(what: &str, shown: &str) {
    let mut words = shown.split(|c: char| !c.is_alphanumeric());
    let found = words.find(|word| ["inf", "NaN", "infinity"].contains(word));
    assert!(found.is_none(), "{what}: {shown}");
}

fn load(text: &str, sets: &[Override]) -> Option<CheckedScene> {
    // Seeds come without `base`, and what mutation makes of it is looked for here.
    match Scene::from_toml(text, "/nonexistent/fuzz.toml", sets) {
        Ok(scene) => Some(scene),
        Err(error) => {
            told(&error);
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
        Err(error) => panic!("what was accepted is refused when read again: {error}"),
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
            told(&error);
            None
        }
    }
}

/// A scene file.
pub fn scene(bytes: &[u8]) -> bool {
    let scene = text(bytes).and_then(|text| load(text, &[]));
    scene.as_ref().and_then(sound).is_some()
}

/// `--set KEY=VALUE`, one a line, on the preset `paper`.
pub fn settings(bytes: &[u8]) -> bool {
    let Some(text) = text(bytes) else {
        return false;
    };
    let mut sets = Vec::new();
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        match line.parse::<Override>() {
            Ok(set) => sets.push(set),
            Err(error) => told(&error),
        }
    }
    match Scene::load("paper", &sets) {
        Ok(scene) => sound(&scene).is_some(),
        Err(error) => {
            told(&error);
            false
        }
    }
}

/// A scene file, and the first steps of its run: they end, and what they give is finite or said to have diverged.
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
            told(&error);
            false
        }
    }
}

/// A map of foreign data.
pub fn map(bytes: &[u8]) -> bool {
    match text(bytes).map(|text| Map::from_toml(text, "map.toml")) {
        Some(Ok(_)) => true,
        Some(Err(error)) => {
            told(&error);
            false
        }
        None => false,
    }
}

/// A map and its file: what is read is finite, and so is what it gives at the times of a run, and where it fits itself.
pub fn foreign(bytes: &[u8]) -> bool {
    let Some((map, csv)) = text_and_bytes(bytes) else {
        return false;
    };
    let Ok(map) = Map::from_toml(map, "map.toml") else {
        return false;
    };
    let found = match read(csv, &map) {
        Ok(found) => found,
        Err(error) => {
            told(&error);
            return false;
        }
    };
    finite("time", found.time_series.time_s().iter().copied());
    for channel in found.time_series.channels() {
        finite(&channel.name, channel.values.iter().copied());
    }
    let (series, time) = (&found.time_series, found.time_series.time_s());
    let shortest = time.windows(2).map(|pair| pair[1] - pair[0]);
    let shortest = shortest.fold(f64::INFINITY, f64::min);
    // A finer grid than of some thousand points takes too long for millions of inputs.
    if time[time.len() - 1] - time[0] < 1000.0 * shortest {
        match shift(series, series) {
            Ok(fit) => finite("shift", [fit.seconds, fit.uncertainty_s, fit.unshifted]),
            Err(why) => told(&why),
        }
    }
    let times: Vec<f64> = (0..50).map(|k| f64::from(k) * 1e-4).collect();
    match resample(&found.time_series, &times, map.resample) {
        Ok(on) => {
            assert_eq!(on.time_series.len(), times.len());
            let values = on.time_series.channels().iter().flat_map(|c| &c.values);
            // NaN says that the file says nothing at that time.
            assert!(values.clone().all(|value| !value.is_infinite()));
            true
        }
        Err(error) => {
            told(&error);
            false
        }
    }
}

/// A sweep file, and the plan of a small one.
pub fn sweep(bytes: &[u8]) -> bool {
    let Some(text) = text(bytes) else {
        return false;
    };
    let sweep = match Sweep::from_toml(text, Path::new("/nonexistent/fuzz.toml")) {
        Ok(sweep) => sweep,
        Err(error) => {
            told(&error);
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
                    told(&error);
                }
            }
            true
        }
        Err(error) => {
            told(&error);
            false
        }
    }
}

/// A baseline.
pub fn baseline(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return false;
    };
    match Baseline::parse(Path::new("baseline.toml"), text) {
        Ok(found) => {
            for converged in found
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
            told(&error);
            false
        }
    }
}

/// A recording: its description and its time series.
pub fn recording(bytes: &[u8]) -> bool {
    let Some((description, csv)) = parts(bytes) else {
        return false;
    };
    match Recording::read(description, csv) {
        Ok(found) => {
            if let Err(error) = found.write() {
                told(&error);
            }
            true
        }
        Err(error) => {
            told(&error);
            false
        }
    }
}

/// A kept run without its hash, which would let no change through.
pub fn kept(bytes: &[u8]) -> bool {
    kept::internals::reads(bytes)
}

/// The manifest of a solver. It is only read here: nothing that it names is run.
pub fn manifest(bytes: &[u8]) -> bool {
    let Some(text) = text(bytes) else {
        return false;
    };
    match Manifest::from_toml(text, "solver.toml") {
        Ok(found) => {
            assert!(Manifest::is_name(&found.name).is_ok(), "{}", found.name);
            assert!(
                found
                    .command
                    .first()
                    .is_some_and(|program| !program.is_empty())
            );
            finite("timeout", [found.timeout_s]);
            finite("order", found.refine.iter().map(|refine| refine.order));
            finite(
                "tolerance",
                found.model.values().map(|stated| stated.tolerance),
            );
            assert!(
                names::laws().iter().any(|law| found.honours_law(law))
                    || found.honours.laws.is_empty()
            );
            true
        }
        Err(error) => {
            told(&error);
            assert!(!error.to_string().contains('\n'), "one line: {error}");
            false
        }
    }
}

/// Time series as CSV: what is read is written and read the same again.
pub fn time_series(bytes: &[u8]) -> bool {
    let found = match TimeSeries::read_csv(bytes) {
        Ok(found) => found,
        Err(error) => {
            told(&error);
            return false;
        }
    };
    let mut written = Vec::new();
    match found
        .write_csv(&mut written)
        .map(|()| TimeSeries::read_csv(written.as_slice()))
    {
        Ok(Ok(again)) => assert!(alike(&found, &again), "read again"),
        Ok(Err(error)) => panic!("what was written is refused: {error}"),
        Err(error) => told(&error),
    }
    true
}

/// Time series as Parquet.
#[cfg(feature = "parquet")]
pub fn parquet(bytes: &[u8]) -> bool {
    match pinwheel_timeseries::read_time_series(bytes::Bytes::copy_from_slice(bytes), 1 << 20) {
        Ok(found) => !found.is_empty(),
        Err(error) => {
            told(&error);
            false
        }
    }
}

/// Equal, NaN being equal to itself.
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

/// What the server of `pinwheel explore` is asked: read in pieces it is the question that it is in one, nothing in its head ends a
/// line, and its body is as long as its one length says.
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
