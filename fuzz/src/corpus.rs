//! Seeds: files of the project, shortened where they are long, and those under `fuzz/corpus`.

use std::path::{Path, PathBuf};

use pinwheel_engines::kept;
use pinwheel_engines::recorded::Recording;
use pinwheel_scene::KEYS;
use pinwheel_timeseries::TimeSeries;

use crate::targets::PARTS;

/// Largest size of a seed, bytes. Longer ones would spend the time on copying.
const LONGEST: usize = 6000;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the files of a folder of the repository, sorted by name; none if the folder is absent.
fn files(folder: &str, ending: &str) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(root().join(folder))
        .into_iter()
        .flatten()
        .flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    paths.retain(|path| path.to_string_lossy().ends_with(ending));
    paths
        .iter()
        .filter_map(|path| std::fs::read(path).ok())
        .collect()
}

/// Joins two texts into one input.
fn joined(first: &str, second: &str) -> Vec<u8> {
    [first, PARTS, second].concat().into_bytes()
}

/// Returns the first complete lines of a text.
fn beginning(text: &str, most: usize) -> String {
    let lines = text.split_inclusive('\n');
    let mut kept = String::new();
    for line in lines.take_while(|line| line.len() <= LONGEST) {
        if kept.len() + line.len() > most {
            break;
        }
        kept.push_str(line);
    }
    kept
}

fn strings(list: Vec<Vec<u8>>) -> Vec<String> {
    list.into_iter()
        .filter_map(|bytes| String::from_utf8(bytes).ok())
        .collect()
}

/// Presets.
#[must_use]
pub fn scenes() -> Vec<Vec<u8>> {
    [
        files("reference/scenes", ".toml"),
        files("fuzz/corpus/scene", ""),
    ]
    .concat()
}

/// A line for every key of a scene.
#[must_use]
pub fn settings() -> Vec<Vec<u8>> {
    let values = [
        "0.01",
        "16",
        "\"auto\"",
        "1e-5",
        "true",
        "[0.0, 1.0]",
        "-0.0",
    ];
    let lines = KEYS.iter().enumerate().map(|(k, key)| {
        let other = &KEYS[(7 * k + 3) % KEYS.len()];
        format!(
            "{}={}\n{}={}\n",
            key.name,
            values[k % 7],
            other.name,
            values[(k + 3) % 7]
        )
    });
    lines
        .map(String::into_bytes)
        .chain(files("fuzz/corpus/settings", ""))
        .collect()
}

/// Example maps.
#[must_use]
pub fn maps() -> Vec<Vec<u8>> {
    [
        files("reference/maps", ".toml"),
        files("fuzz/corpus/map", ""),
    ]
    .concat()
}

/// Maps with a file for each.
#[must_use]
pub fn foreign() -> Vec<Vec<u8>> {
    const MAP: &str = "[columns]\ninput_torque_n_m = \"a\"\n\"external_sleeve_force_n_*\" = { magnitude_of = [\"x_*\", \"y_*\"], unit = \"kN\" }\n";
    const RIG: &str = "name = \"rig\"\n[file]\nseparator = \";\"\ndecimal = \",\"\ncomment = \"#\"\nlines_after_header = 1\n[time]\ncolumn = \"t\"\nunit = \"ms\"\n\
        [columns]\ninput_torque_n_m = { column = \"M\", unit = \"N mm\", factor = -1.0 }\n[rows]\nbad = \"skip\"\n\
        [resample]\nmethod = \"linear\"\n";
    let mut plain = "time_s,a,x_0,y_0\n".to_owned();
    let mut rig = "# rig\nt;M\nms;N mm\n".to_owned();
    for k in 0..30 {
        plain.push_str(&format!(
            "{:.4},{},{}.5,-{}e-3\n",
            1e-4 * f64::from(k),
            k,
            k % 3,
            k % 7
        ));
        rig.push_str(&format!("{},{:02};{}\n", k / 10, 10 * (k % 10), 40 - k));
    }
    const LOGGER: &str = "[file]\nthousands = \"'\"\n[time]\ncolumn = \"t\"\n[columns]\n\
        output_angle_rad = { column = \"A\", unit = \"deg\", unwrap = true }\n\
        transmission_error_arcmin = { sum_of = { A = 1.0, B = 0.0667 }, unit = \"deg\", unwrap = 360 }\n\
        [rows]\ntwice = \"first\"\n";
    let mut logger = "t,A,B\n".to_owned();
    for k in 0..30 {
        let (t, b) = (k / 2 * 2, 15 * k % 360);
        logger.push_str(&format!(
            "05.03.2024 10:00:00.{t:04},{}.5D0,1'{b:03}\n",
            7 * k % 360
        ));
    }
    let wide = |text: &str| -> Vec<u8> { text.encode_utf16().flat_map(u16::to_le_bytes).collect() };
    let wide = [
        format!("{MAP}{PARTS}").into_bytes(),
        wide(&format!("\u{feff}{plain}")),
    ];
    [
        joined(MAP, &plain),
        joined(RIG, &rig),
        joined(LOGGER, &logger),
        wide.concat(),
    ]
    .into_iter()
    .chain(files("fuzz/corpus/foreign", ""))
    .collect()
}

/// Example sweeps.
#[must_use]
pub fn sweeps() -> Vec<Vec<u8>> {
    [
        files("reference/sweeps", ".toml"),
        files("fuzz/corpus/sweep", ""),
    ]
    .concat()
}

/// The accepted baseline, cut down to one scene each.
#[must_use]
pub fn baselines() -> Vec<Vec<u8>> {
    let text = strings(files("reference/baselines/accepted", "baseline.toml")).concat();
    let mut parts = text.split("[[scene]]");
    let head = parts.next().unwrap_or_default();
    let mut seeds: Vec<Vec<u8>> = parts
        .map(|part| format!("{head}[[scene]]{part}").into_bytes())
        .collect();
    seeds.sort_by_key(Vec::len);
    seeds.truncate(8);
    seeds
}

/// Recordings, of which the time series are cut short.
#[must_use]
pub fn recordings() -> Vec<Vec<u8>> {
    let folder = "reference/recorded/paper";
    let pairs = strings(files(folder, ".toml"))
        .into_iter()
        .zip(strings(files(folder, ".csv")));
    let short = pairs.map(|(description, csv)| joined(&description, &beginning(&csv, LONGEST)));
    short.chain(files("fuzz/corpus/recording", "")).collect()
}

/// Kept runs of a few samples.
#[must_use]
pub fn kept() -> Vec<Vec<u8>> {
    let recordings = recordings().into_iter().filter_map(|bytes| {
        let text = String::from_utf8(bytes).ok()?;
        let (description, csv) = text.split_once(PARTS)?;
        Recording::read(description, csv).ok()
    });
    recordings.map(kept::internals::body).collect()
}

fn few_time_series() -> Option<TimeSeries> {
    let mut time_series = TimeSeries::new(vec![0.0, 1e-4, 0.1 + 0.2]).ok()?;
    time_series
        .push("input_torque_n_m", vec![1.0 / 3.0, -1e-300, f64::MAX])
        .ok()?;
    time_series
        .push("external_sleeve_force_n_0", vec![1.0, 1.0, -0.0])
        .ok()?;
    Some(time_series)
}

/// Time series as CSV.
#[must_use]
pub fn time_series() -> Vec<Vec<u8>> {
    let mut written = Vec::new();
    if let Some(time_series) = few_time_series() {
        let _ = time_series.write_csv(&mut written);
    }
    let recorded = strings(files("reference/recorded/paper", ".csv"));
    let recorded = recorded
        .iter()
        .map(|csv| beginning(csv, LONGEST).into_bytes());
    [written]
        .into_iter()
        .chain(recorded)
        .chain(files("fuzz/corpus/courses", ""))
        .collect()
}

/// Manifests of the example solvers, and of one solver of the tests.
#[must_use]
pub fn manifests() -> Vec<Vec<u8>> {
    let folders = std::fs::read_dir(root().join("examples/solvers"));
    let mut names: Vec<String> = folders
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let shipped = names
        .iter()
        .flat_map(|name| files(&format!("examples/solvers/{name}"), "solver.toml"));
    shipped
        .chain(files("tests/data/held-out", "solver.toml"))
        .chain(files("fuzz/corpus/manifest", ""))
        .collect()
}

/// Time series as Parquet.
#[cfg(feature = "parquet")]
#[must_use]
pub fn parquet() -> Vec<Vec<u8>> {
    let written = few_time_series()
        .zip(tempfile::tempdir().ok())
        .and_then(|(time_series, dir)| {
            let path = dir.path().join("c.parquet");
            pinwheel_timeseries::save_time_series(&time_series, &path).ok()?;
            std::fs::read(path).ok()
        });
    written
        .into_iter()
        .chain(files("fuzz/corpus/parquet", ""))
        .collect()
}

/// Requests to a server: those of its page, and some that other servers took for two (bodies in chunks with a length too, lengths
/// given twice, names of headers with spaces) or for endless ones.
#[must_use]
pub fn requests() -> Vec<Vec<u8>> {
    files("fuzz/corpus/requests", "")
}
