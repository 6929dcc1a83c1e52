//! The sweep file (TOML).
//!
//! ```toml
//! name = "backlash"
//! scene = "paper"                 # preset, or a file beside this one
//! engines = ["native"]
//! window_s = [0.3, 0.6]           # window of the figures; the second half if left out
//! measure = ["*_torque_n_m"]      # quantities whose figures are kept; all if left out
//! courses = "none"                    # keep every run's time series: "none" | "csv" | "parquet"
//! [set]                           # keys of every run
//! solver.duration_s = 0.6
//! [vary]                          # every key an axis; all combinations are run
//! gear.backlash_m = { from = 0.0, to = 1.0e-3, points = 11 }
//! [[together]]                    # an axis whose keys change in step
//! gear.wheels = [1, 2]
//! drive.output_torque_n_m = [11.0, 22.0]
//! [sample]                        # keys at random, all together
//! points = 1000
//! gear.hole_radius_m = { plus_minus = 5e-6 }
//! [specification]                 # limits on columns of the results
//! lost_motion_arcmin = { most = 1.0 }
//! ```

use std::path::Path;

use pinwheel_files::{Document, Entries, FileError, Item, read, read_text};
use pinwheel_scene::{Override, PRESETS};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::sweep::axis::{self, Axis};
use crate::sweep::leaves::leaves;
use crate::sweep::sample::{self, Sample};
use crate::sweep::specification::{self, Limit};

/// File format of every run's time series, or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum KeepTimeSeries {
    /// Figures only.
    #[default]
    None,
    /// CSV file for each run.
    Csv,
    /// Parquet file for each run.
    Parquet,
}

/// Content of a sweep file.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Name shown in the results.
    pub name: String,
    /// Purpose of the sweep in one sentence.
    pub description: String,
    /// Preset or path of the base scene, as for [`pinwheel_scene::Scene::load`].
    pub scene: String,
    /// Engines by name.
    pub engines: Vec<String>,
    /// Overrides of keys for every run.
    pub set: Vec<Override>,
    /// Varied keys; the last axis changes fastest.
    pub axes: Vec<Axis>,
    /// Keys that are sampled at random, as the last axis of the plan.
    pub sample: Option<Sample>,
    /// Limits on columns of the results.
    pub specification: Vec<Limit>,
    /// Start and end of the window of the figures, s; `None` for the second half of each run.
    pub window_s: Option<[f64; 2]>,
    /// Patterns of quantities whose figures are kept (`*` for any characters).
    pub measure: Vec<String>,
    /// Form of stored time series.
    pub time_series: KeepTimeSeries,
    /// Text of the file.
    pub text: String,
}

/// Largest number of keys that a sweep sets and varies, and of names in a list.
const MOST_KEYS: usize = 1000;
const REMEDY: &str = "see docs/sweeps.md for an example";

/// Keys at the top of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Top {
    name: Option<String>,
    #[serde(default)]
    description: String,
    scene: Option<String>,
    #[serde(default = "native")]
    engines: Names,
    #[serde(default = "everything")]
    measure: Names,
    window_s: Option<Window>,
    #[serde(default, rename = "courses")]
    time_series: KeepTimeSeries,
    /// Tables whose keys are those of scenes and results, each read separately.
    #[serde(rename = "set")]
    _set: Option<IgnoredAny>,
    #[serde(rename = "vary")]
    _vary: Option<IgnoredAny>,
    #[serde(rename = "together")]
    _together: Option<IgnoredAny>,
    #[serde(rename = "sample")]
    _sample: Option<IgnoredAny>,
    #[serde(rename = "specification")]
    _specification: Option<IgnoredAny>,
}

fn native() -> Names {
    Names(vec!["native".to_owned()])
}

fn everything() -> Names {
    Names(vec!["*".to_owned()])
}

/// List of distinct names.
#[derive(Deserialize)]
#[serde(try_from = "OneOrMany")]
struct Names(Vec<String>);

#[derive(Deserialize)]
#[serde(untagged, expecting = "must be a list of texts, like [\"a\", \"b\"]")]
enum OneOrMany {
    One(String),
    Many(Vec<String>),
}

impl TryFrom<OneOrMany> for Names {
    type Error = String;

    fn try_from(names: OneOrMany) -> Result<Self, String> {
        let names = match names {
            OneOrMany::One(name) => vec![name],
            OneOrMany::Many(names) => names,
        };
        if names.is_empty() || names.len() > MOST_KEYS {
            return Err(format!("is empty, or names more than {MOST_KEYS}"));
        }
        let twice = (1..names.len()).find(|&k| names[..k].contains(&names[k]));
        match twice {
            Some(k) => Err(format!("names `{}` twice", names[k])),
            None => Ok(Self(names)),
        }
    }
}

/// Window: start and end, s.
#[derive(Deserialize)]
#[serde(try_from = "[f64; 2]")]
struct Window([f64; 2]);

impl TryFrom<[f64; 2]> for Window {
    type Error = &'static str;

    fn try_from([from, to]: [f64; 2]) -> Result<Self, Self::Error> {
        let sound = from >= 0.0 && from < to && to.is_finite();
        sound
            .then_some(Self([from, to]))
            .ok_or("is no window: write start and end in seconds, [0.3, 0.6]")
    }
}

impl Sweep {
    /// Reads the sweep file `path`. A scene file is searched in its folder.
    ///
    /// # Errors
    /// A file that cannot be read, or errors of [`from_toml`](Self::from_toml).
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let remedy = "give a sweep file (TOML), see docs/sweeps.md";
        Self::from_toml(&read_text(path, remedy)?, path)
    }

    /// Reads a sweep from the text of the file `path`. A scene file is searched in its folder.
    ///
    /// # Errors
    /// First fault with its line and remedy.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, StudyError> {
        let file = path.display().to_string();
        let top: Top = read(text, &file, REMEDY)?;
        let document = Document::parse(text, &file, REMEDY)?;
        if top.time_series == KeepTimeSeries::Parquet && cfg!(not(feature = "parquet")) {
            let remedy = "write courses = \"csv\", or build with --features parquet";
            return Err(FileError::new(&file, "this build writes no Parquet", remedy).into());
        }
        let mut known = Known::default();
        let mut set = Vec::new();
        for (key, item) in leaves(table(&document, "set")?, &[]) {
            known.once(&document, &key, item.line)?;
            set.push(Override::new(key, item.text));
        }
        let mut axes = Vec::new();
        for (key, item) in leaves(table(&document, "vary")?, &axis::RANGE) {
            known.once(&document, &key, item.line)?;
            let values = axis::values(&document, &key, item)?;
            let keys = vec![(key, values)];
            axes.push(distinct(&document, item.line, Axis { keys })?);
        }
        for entries in together(&document)? {
            axes.extend(in_step(&document, entries, &mut known)?);
        }
        let sample = match document.get("sample") {
            None => None,
            Some(item) => {
                let entries = table(&document, "sample")?;
                for (key, item) in leaves(entries, &sample::DISTRIBUTION) {
                    known.once(&document, &key, item.line)?;
                }
                Some(Sample::read(&document, item.line, entries)?)
            }
        };
        let specification = table(&document, "specification")?;
        let limits = specification.iter();
        let limits = limits.map(|(figure, item)| specification::read(&document, figure, item));
        let stem = path.file_stem().unwrap_or("sweep".as_ref());
        Ok(Self {
            name: top.name.unwrap_or(stem.to_string_lossy().into_owned()),
            description: top.description,
            engines: top.engines.0,
            set,
            axes,
            sample,
            specification: limits.collect::<Result<_, _>>()?,
            window_s: top.window_s.map(|window| window.0),
            measure: top.measure.0,
            time_series: top.time_series,
            // Checked last, so that a mistyped key is reported before a missing one.
            scene: scene_beside(path, &top.scene.ok_or_else(|| no_scene(&document))?),
            text: text.to_owned(),
        })
    }
}

/// Error about a sweep without a scene.
fn no_scene(document: &Document<'_>) -> FileError {
    let soft = PRESETS.iter().filter(|p| !p.name.starts_with("hard-"));
    let names: Vec<&str> = soft.map(|preset| preset.name).collect();
    let remedy = format!(
        "write scene = \"paper\", another preset ({}), or a scene file beside this one",
        names.join(", ")
    );
    document.fault(1, "no key `scene` says what is varied", remedy)
}

/// Scene keys that the file has set so far.
#[derive(Default)]
struct Known(Vec<String>);

impl Known {
    fn once(&mut self, document: &Document<'_>, key: &str, line: usize) -> Result<(), FileError> {
        if self.0.iter().any(|other| other == key) {
            let what = format!("`{key}` is given twice");
            return Err(document.fault(line, what, "keep it in one place"));
        }
        if self.0.len() == MOST_KEYS {
            let what = format!("sets and varies more than {MOST_KEYS} keys");
            return Err(document.fault(line, what, "leave some out: no scene has that many"));
        }
        self.0.push(key.to_owned());
        Ok(())
    }
}

/// Returns the table at a key of the top level; an empty one without the key.
fn table<'d, 't>(
    document: &'d Document<'t>,
    key: &str,
) -> Result<&'d [(String, Item<'t>)], FileError> {
    let Some(item) = document.get(key) else {
        return Ok(&[]);
    };
    let table = item.node.as_table().map(Vec::as_slice);
    table.ok_or_else(|| {
        let remedy = format!("write [{key}] on its own line, then key = ... lines");
        document.fault(item.line, format!("`{key}` is no table"), remedy)
    })
}

/// Returns the tables `[[together]]`, or the single table `[together]`.
fn together<'d, 't>(document: &'d Document<'t>) -> Result<Vec<&'d Entries<'t>>, FileError> {
    let Some(item) = document.get("together") else {
        return Ok(Vec::new());
    };
    let one = || item.node.as_table().map(|table| vec![table]);
    item.node.as_tables().or_else(one).ok_or_else(|| {
        let remedy = "write [[together]] on its own line, then key = [...] lines";
        document.fault(item.line, "`together` is no table", remedy)
    })
}

/// Returns the axis of keys that vary together; `None` without keys.
fn in_step(
    document: &Document<'_>,
    entries: &Entries<'_>,
    known: &mut Known,
) -> Result<Option<Axis>, FileError> {
    let mut keys: Vec<(String, Vec<axis::Value>)> = Vec::new();
    let mut last = 0;
    for (key, item) in leaves(entries, &axis::RANGE) {
        last = item.line;
        known.once(document, &key, item.line)?;
        let values = axis::values(document, &key, item)?;
        if let Some((first, other)) = keys.first()
            && other.len() != values.len()
        {
            let (own, others) = (values.len(), other.len());
            let what = format!("`{key}` has {own} values, `{first}` has {others}");
            let remedy = "keys of one [[together]] change in step: give lists of one length";
            return Err(document.fault(item.line, what, remedy));
        }
        keys.push((key, values));
    }
    let axis = (!keys.is_empty()).then_some(Axis { keys });
    axis.map(|axis| distinct(document, last, axis)).transpose()
}

/// Returns the axis if its points are distinct.
fn distinct(document: &Document<'_>, line: usize, axis: Axis) -> Result<Axis, FileError> {
    let Some(point) = axis.repeated() else {
        return Ok(axis);
    };
    let what = match axis.keys.as_slice() {
        [(key, values)] => format!("`{key}`: {} is listed twice", values[point]),
        _ => format!("[[together]]: point {} is one before it again", point + 1),
    };
    Err(document.fault(line, what, "give each point once"))
}

/// Returns the path of a scene file beside the sweep file; other names, such as presets, unchanged.
fn scene_beside(path: &Path, scene: &str) -> String {
    let beside = path.parent().map(|folder| folder.join(scene));
    match beside {
        Some(file) if file.is_file() && pinwheel_scene::preset(scene).is_none() => {
            file.display().to_string()
        }
        _ => scene.to_owned(),
    }
}
