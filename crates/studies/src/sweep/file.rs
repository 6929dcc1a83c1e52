//! The sweep file (TOML).
//!
//! ```toml
//! name = "backlash"
//! scene = "paper"                 # preset, or a file beside this one
//! engines = ["native"]
//! window_s = [0.3, 0.6]           # what figures are taken of; the second half if left out
//! measure = ["*_torque_n_m"]      # quantities whose figures are kept; all if left out
//! courses = "none"                # keep every run's courses: "none" | "csv" | "parquet"
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

use std::fs;
use std::path::Path;

use pinwheel_scene::{Override, PRESETS, nearest};
use serde::Serialize;
use toml_edit::{Document, Item, TableLike, Value as Toml};

use crate::sweep::SweepError;
use crate::sweep::axis::{self, Axis};
use crate::sweep::sample::{NotFinite, Sample, finite};
use crate::sweep::specification::Limit;

/// Bytes of a sweep file at most.
const MOST_BYTES: usize = 1 << 20;

/// Whether and how every run's courses are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum KeepCourses {
    /// Figures only.
    #[default]
    None,
    /// A CSV file a run.
    Csv,
    /// A Parquet file a run.
    Parquet,
}

/// A sweep as its file says it.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Name shown in the results.
    pub name: String,
    /// Why, one sentence.
    pub description: String,
    /// Preset or path of the base scene, as [`pinwheel_scene::Scene::load`] takes it.
    pub scene: String,
    /// Engines by name.
    pub engines: Vec<String>,
    /// Keys of every run.
    pub set: Vec<Override>,
    /// What is varied; the last axis changes fastest.
    pub axes: Vec<Axis>,
    /// Keys at random; the last axis of the plan.
    pub sample: Option<Sample>,
    /// Limits on columns of the results.
    pub specification: Vec<Limit>,
    /// Start and end of the window that figures are taken of, s; `None`: the second half of each run.
    pub window_s: Option<[f64; 2]>,
    /// Patterns of quantities whose figures are kept (`*` for any characters).
    pub measure: Vec<String>,
    /// Whether courses are kept.
    pub courses: KeepCourses,
    /// The file's text.
    pub text: String,
}

/// Keys that a sweep sets and varies at most.
const MOST_KEYS: usize = 1000;

const KEYS: [&str; 12] = [
    "name",
    "description",
    "scene",
    "engines",
    "window_s",
    "measure",
    "courses",
    "set",
    "vary",
    "together",
    "sample",
    "specification",
];

impl Sweep {
    /// Reads the sweep file `path`; a scene file is looked for beside it.
    ///
    /// # Errors
    /// A file that cannot be read, or as [`from_toml`](Self::from_toml).
    pub fn read(path: &Path) -> Result<Self, SweepError> {
        let unreadable = |what: String| SweepError::NotRead {
            path: path.to_owned(),
            what,
        };
        let failed = |error: std::io::Error| unreadable(format!("cannot be read: {error}"));
        let size = fs::metadata(path).map_err(failed)?;
        // Before it is read: a device has no end.
        if !size.is_file() || size.len() > MOST_BYTES as u64 {
            return Err(unreadable(
                "is no sweep file: not a file, or far too long".to_owned(),
            ));
        }
        Self::from_toml(&fs::read_to_string(path).map_err(failed)?, path)
    }

    /// Reads a sweep from the text of the file `path`; a scene file is looked for beside it.
    ///
    /// # Errors
    /// The first fault with its line and remedy.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, SweepError> {
        let reader = Reader {
            text,
            source: path.display().to_string(),
        };
        if text.len() > MOST_BYTES {
            return Err(reader.fault(
                0,
                format!("longer than {MOST_BYTES} bytes"),
                "give a sweep file",
            ));
        }
        let document = Document::parse(text).map_err(|error| {
            let at = error.span().map_or(0, |span| span.start);
            let what = error.message().trim().replace('\n', " ");
            reader.fault(
                at,
                format!("not valid TOML: {what}"),
                "see docs/sweeps.md for an example",
            )
        })?;
        reader.sweep(document.as_table(), path)
    }
}

struct Reader<'a> {
    text: &'a str,
    source: String,
}

impl Reader<'_> {
    fn fault(&self, at: usize, what: impl Into<String>, remedy: impl Into<String>) -> SweepError {
        let head = &self.text.as_bytes()[..at.min(self.text.len())];
        SweepError::File {
            source_name: self.source.clone(),
            line: 1 + head.iter().filter(|&&byte| byte == b'\n').count(),
            what: what.into(),
            remedy: remedy.into(),
        }
    }

    fn sweep(&self, root: &dyn TableLike, path: &Path) -> Result<Sweep, SweepError> {
        for (key, item) in root.iter() {
            if !KEYS.contains(&key) {
                let remedy = match nearest(key, KEYS) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("known here: {}", KEYS.join(", ")),
                };
                return Err(self.fault(
                    place(root, key, item),
                    format!("`{key}` is no key of a sweep"),
                    remedy,
                ));
            }
        }
        let stem = path
            .file_stem()
            .map_or("sweep".into(), |stem| stem.to_string_lossy());
        let mut axes = Vec::new();
        if let Some(item) = root.get("vary") {
            for (key, value, at) in self.leaves(root, "vary", item)? {
                let values = self.values(&value, at)?;
                axes.push((
                    Axis {
                        keys: vec![(key, values)],
                    },
                    at,
                ));
            }
        }
        if let Some(item) = root.get("together") {
            let at = place(root, "together", item);
            let tables: Vec<&dyn TableLike> =
                match (item.as_array_of_tables(), item.as_table_like()) {
                    (Some(tables), _) => {
                        tables.iter().map(|table| table as &dyn TableLike).collect()
                    }
                    (None, Some(table)) => vec![table],
                    (None, None) => {
                        return Err(self.fault(
                            at,
                            "`together` is no table",
                            "write [[together]] on its own line, then key = [...] lines",
                        ));
                    }
                };
            for table in tables {
                let mut keys = Vec::new();
                for (key, value, at) in self.leaves_of(table, "")? {
                    let values = self.values(&value, at)?;
                    let axis: Option<&(String, Vec<axis::Value>)> = keys.first();
                    if let Some((first, known)) = axis
                        && known.len() != values.len()
                    {
                        let what = format!(
                            "`{key}` has {} values, `{first}` has {}",
                            values.len(),
                            known.len()
                        );
                        return Err(self.fault(
                            at,
                            what,
                            "keys of one [[together]] change in step: give lists of one length",
                        ));
                    }
                    keys.push((key, values));
                }
                if !keys.is_empty() {
                    axes.push((Axis { keys }, at));
                }
            }
        }
        let mut set = Vec::new();
        let mut known: Vec<String> = Vec::new();
        if let Some(item) = root.get("set") {
            for (key, value, at) in self.leaves(root, "set", item)? {
                self.once(&mut known, &key, at)?;
                set.push(Override::new(key, value.to_string().trim()));
            }
        }
        for (axis, at) in &axes {
            for (key, _) in &axis.keys {
                self.once(&mut known, key, *at)?;
            }
        }
        let sample = self.sample(root)?;
        for (key, _) in sample.iter().flat_map(|sample| &sample.keys) {
            let at = root
                .get("sample")
                .map_or(0, |item| place(root, "sample", item));
            self.once(&mut known, key, at)?;
        }
        Ok(Sweep {
            name: self
                .string(root, "name")?
                .unwrap_or_else(|| stem.into_owned()),
            description: self.string(root, "description")?.unwrap_or_default(),
            engines: self
                .strings(root, "engines")?
                .unwrap_or_else(|| vec!["native".to_owned()]),
            set,
            axes: axes.into_iter().map(|(axis, _)| axis).collect(),
            sample,
            specification: self.specification(root)?,
            window_s: self.window(root)?,
            measure: self
                .strings(root, "measure")?
                .unwrap_or_else(|| vec!["*".to_owned()]),
            courses: self.courses(root)?,
            // Last: a mistyped key is named before a missing one.
            scene: scene_beside(path, &self.scene(root)?),
            text: self.text.to_owned(),
        })
    }

    /// Which gear is varied is never guessed.
    fn scene(&self, root: &dyn TableLike) -> Result<String, SweepError> {
        self.string(root, "scene")?.ok_or_else(|| {
            let soft = PRESETS.iter().filter(|p| !p.name.starts_with("hard-"));
            let names: Vec<&str> = soft.map(|preset| preset.name).collect();
            let remedy = format!(
                "write scene = \"paper\", another preset ({}), or a scene file beside this one",
                names.join(", ")
            );
            self.fault(0, "no key `scene` says what is varied", remedy)
        })
    }

    fn once(&self, known: &mut Vec<String>, key: &str, at: usize) -> Result<(), SweepError> {
        if known.iter().any(|other| other == key) {
            return Err(self.fault(
                at,
                format!("`{key}` is given twice"),
                "keep it in one place",
            ));
        }
        if known.len() == MOST_KEYS {
            return Err(self.fault(
                at,
                format!("sets and varies more than {MOST_KEYS} keys"),
                "leave some out: no scene has that many",
            ));
        }
        known.push(key.to_owned());
        Ok(())
    }

    fn sample(&self, root: &dyn TableLike) -> Result<Option<Sample>, SweepError> {
        let Some(item) = root.get("sample") else {
            return Ok(None);
        };
        let at = place(root, "sample", item);
        let Some(table) = item.as_table_like() else {
            return Err(self.fault(
                at,
                "`sample` is no table",
                "write [sample] on its own line, then points = 1000 and key = { from = ..., to = ... } lines",
            ));
        };
        let of = |table: &dyn TableLike, key: &str| {
            table.get(key).map_or(at, |item| place(table, key, item))
        };
        let read = Sample::of(table, &of);
        read.map(Some)
            .map_err(|(own, what, remedy)| self.fault(own.max(at), what, remedy))
    }

    fn specification(&self, root: &dyn TableLike) -> Result<Vec<Limit>, SweepError> {
        const FORM: &str = "write lost_motion_arcmin = { most = 1.0 }, with least = ... for what must not be below";
        let Some(item) = root.get("specification") else {
            return Ok(Vec::new());
        };
        let at = place(root, "specification", item);
        let Some(table) = item.as_table_like() else {
            return Err(self.fault(at, "`specification` is no table", FORM));
        };
        let mut limits = Vec::new();
        for (figure, item) in table.iter() {
            let at = place(table, figure, item);
            let wrong = |what: String| self.fault(at, format!("`{figure}` {what}"), FORM);
            let ends = item
                .as_table_like()
                .ok_or_else(|| wrong("has no `least` or `most`".to_owned()))?;
            if let Some((key, _)) = ends
                .iter()
                .find(|(key, _)| !["least", "most"].contains(key))
            {
                return Err(wrong(format!("has `{key}`, which is no limit")));
            }
            let number = |key: &str| {
                let number = ends.get(key).map(finite).transpose();
                number.map_err(|NotFinite| wrong(format!("has a `{key}` that is no finite number")))
            };
            let (least, most) = (number("least")?, number("most")?);
            match (least, most) {
                (None, None) => return Err(wrong("has no `least` or `most`".to_owned())),
                (Some(least), Some(most)) if least > most => {
                    return Err(wrong("has a `least` above its `most`".to_owned()));
                }
                _ => limits.push(Limit {
                    figure: figure.to_owned(),
                    least,
                    most,
                }),
            }
        }
        Ok(limits)
    }

    fn values(&self, value: &Toml, at: usize) -> Result<Vec<axis::Value>, SweepError> {
        axis::values(value).map_err(|(what, remedy)| self.fault(at, what, remedy))
    }

    /// Dotted keys of a table with their values, in the file's order.
    fn leaves(
        &self,
        root: &dyn TableLike,
        key: &str,
        item: &Item,
    ) -> Result<Vec<(String, Toml, usize)>, SweepError> {
        match item.as_table_like() {
            Some(table) => self.leaves_of(table, ""),
            None => Err(self.fault(
                place(root, key, item),
                format!("`{key}` is no table"),
                format!("write [{key}] on its own line, then key = ... lines"),
            )),
        }
    }

    fn leaves_of(
        &self,
        table: &dyn TableLike,
        prefix: &str,
    ) -> Result<Vec<(String, Toml, usize)>, SweepError> {
        let mut leaves = Vec::new();
        for (name, item) in table.iter() {
            let at = place(table, name, item);
            let key = format!("{prefix}{name}");
            match item {
                // A range is an inline table that begins or ends somewhere.
                Item::Value(Toml::InlineTable(inner)) if !is_range(inner) => {
                    leaves.extend(self.leaves_of(inner, &format!("{key}."))?);
                }
                Item::Value(value) => leaves.push((key, value.clone(), at)),
                Item::Table(inner) => leaves.extend(self.leaves_of(inner, &format!("{key}."))?),
                _ => {
                    return Err(self.fault(
                        at,
                        format!("`{key}` has no value"),
                        "write key = value",
                    ));
                }
            }
        }
        Ok(leaves)
    }

    fn string(&self, root: &dyn TableLike, key: &str) -> Result<Option<String>, SweepError> {
        let Some(item) = root.get(key) else {
            return Ok(None);
        };
        let text = item.as_str().map(str::to_owned);
        let wrong = || {
            self.fault(
                place(root, key, item),
                format!("`{key}` is no text"),
                "write it in quotes",
            )
        };
        text.ok_or_else(wrong).map(Some)
    }

    fn strings(&self, root: &dyn TableLike, key: &str) -> Result<Option<Vec<String>>, SweepError> {
        let Some(item) = root.get(key) else {
            return Ok(None);
        };
        let at = place(root, key, item);
        let texts: Option<Vec<String>> = match (item.as_array(), item.as_str()) {
            (Some(list), _) => list
                .iter()
                .map(|value| value.as_str().map(str::to_owned))
                .collect(),
            (None, text) => text.map(|text| vec![text.to_owned()]),
        };
        match texts {
            Some(texts) if texts.len() > MOST_KEYS => Err(self.fault(
                at,
                format!("`{key}` names more than {MOST_KEYS}"),
                "leave some out, or write one pattern with `*` for many",
            )),
            Some(texts) if !texts.is_empty() => {
                let twice = texts
                    .iter()
                    .enumerate()
                    .find(|(k, text)| texts[..*k].contains(text));
                match twice {
                    Some((_, text)) => Err(self.fault(
                        at,
                        format!("`{key}` names `{text}` twice"),
                        "name each once",
                    )),
                    None => Ok(Some(texts)),
                }
            }
            Some(_) => Err(self.fault(at, format!("`{key}` is empty"), "name at least one")),
            None => Err(self.fault(
                at,
                format!("`{key}` is no list of texts"),
                "write it like [\"a\", \"b\"]",
            )),
        }
    }

    fn window(&self, root: &dyn TableLike) -> Result<Option<[f64; 2]>, SweepError> {
        let Some(item) = root.get("window_s") else {
            return Ok(None);
        };
        let number = |value: &Toml| {
            value
                .as_float()
                .or_else(|| value.as_integer().map(|x| x as f64))
        };
        let ends: Option<Vec<f64>> = item
            .as_array()
            .and_then(|list| list.iter().map(number).collect());
        match ends.as_deref() {
            Some(&[from, to]) if from >= 0.0 && from < to && to.is_finite() => Ok(Some([from, to])),
            _ => Err(self.fault(
                place(root, "window_s", item),
                "`window_s` is no window",
                "write start and end in seconds: [0.3, 0.6]",
            )),
        }
    }

    fn courses(&self, root: &dyn TableLike) -> Result<KeepCourses, SweepError> {
        let kept = self.string(root, "courses")?;
        let at = root
            .get("courses")
            .map_or(0, |item| place(root, "courses", item));
        match kept.as_deref() {
            None | Some("none") => Ok(KeepCourses::None),
            Some("csv") => Ok(KeepCourses::Csv),
            Some("parquet") if cfg!(feature = "parquet") => Ok(KeepCourses::Parquet),
            Some("parquet") => Err(self.fault(
                at,
                "this build writes no Parquet",
                "write \"csv\", or build with --features parquet",
            )),
            Some(_) => Err(self.fault(
                at,
                "`courses` is not understood",
                "write \"none\", \"csv\" or \"parquet\"",
            )),
        }
    }
}

fn is_range(table: &toml_edit::InlineTable) -> bool {
    ["from", "to", "points", "step", "spacing"]
        .iter()
        .any(|key| table.contains_key(key))
}

/// Byte offset of a key.
fn place(table: &dyn TableLike, key: &str, item: &Item) -> usize {
    let span = table.get_key_value(key).and_then(|(key, _)| key.span());
    span.or_else(|| item.span()).map_or(0, |span| span.start)
}

/// A scene file beside the sweep file, otherwise the words as they are.
fn scene_beside(path: &Path, scene: &str) -> String {
    let beside = path.parent().map(|folder| folder.join(scene));
    match beside {
        Some(file) if file.is_file() && pinwheel_scene::preset(scene).is_none() => {
            file.display().to_string()
        }
        _ => scene.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Value;

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
            (sweep.measure.as_slice(), sweep.courses),
            (&["*_n_m".to_owned()][..], KeepCourses::Csv)
        );
        assert_eq!(sweep.set.len(), 1);
        let plain = read("scene = \"paper\"").unwrap();
        assert_eq!(
            (plain.name.as_str(), plain.scene.as_str()),
            ("mine", "paper")
        );
        assert_eq!(plain.engines, ["native"]);
    }

    #[test]
    fn faults_name_line_and_remedy() {
        for (text, part) in [
            (
                "[vary]\ngear.wheels = [1, 2]",
                "line 1: no key `scene` says what is varied; write scene = \"paper\", another preset (",
            ),
            ("x = 1", "line 1: `x` is no key of a sweep"),
            (
                "\nengine = [\"native\"]",
                "line 2: `engine` is no key of a sweep; did you mean `engines`?",
            ),
            ("[vary]\ngear.backlash_m = []", "line 2: the list is empty"),
            ("vary = 3", "no table"),
            (
                "[set]\ngear.wheels = 1\n[vary]\ngear.wheels = [1, 2]",
                "line 4: `gear.wheels` is given twice",
            ),
            (
                "[[together]]\na = [1, 2]\nb = [1]",
                "line 3: `b` has 1 values, `a` has 2",
            ),
            ("engines = []", "empty"),
            ("engines = [\"a\", \"a\"]", "twice"),
            ("window_s = [0.6, 0.3]", "no window"),
            ("courses = \"xls\"", "not understood"),
            ("[vary", "not valid TOML"),
            ("name = 3", "no text"),
        ] {
            let line = read(text).unwrap_err();
            assert!(
                line.contains(part) && !line.contains('\n'),
                "{text}: {line}"
            );
        }
    }
}
