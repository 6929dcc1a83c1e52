//! Baseline file `baseline.toml`, a text for review: an accepted change changes lines of statistics, errors and counts.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

use serde::{Deserialize, Serialize};

use super::limits::LARGEST_RECORDED;
use super::runner::Costs;
use super::snapshot::{Quantity, Statistics};
use crate::StudyError;
use crate::file;
use crate::output::OutputError;

/// Version of the layout.
pub(super) const FORMAT: u32 = 2;

/// Name of the file that marks a folder as a baseline.
pub const FILE: &str = "baseline.toml";

/// Accepted state of the solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Baseline {
    /// Version of the layout, `FORMAT`.
    pub format: u32,
    /// Manifests of the solvers that made the baseline; empty: the native solver.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub solvers: Vec<String>,
    /// Program and machine that made the current state.
    pub made: Made,
    /// Every acceptance, oldest first.
    pub accepted: Vec<Acceptance>,
    /// Accepted results, one entry a scene.
    #[serde(rename = "scene", default)]
    pub scenes: Vec<SceneSnapshot>,
}

/// Date, program and machine that made a baseline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Made {
    /// Year-month-day.
    pub date: String,
    /// Version of the program.
    pub version: String,
    /// `optimised` or `debug`.
    pub build: String,
    /// Vector instructions of the contact loop.
    pub vectors: String,
    /// Model of the processor.
    pub processor: String,
}

/// Acceptance of a state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Acceptance {
    /// Year-month-day.
    pub date: String,
    /// Stated reason.
    pub reason: String,
}

/// Accepted results of one scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneSnapshot {
    /// Name of the scene in the set.
    pub name: String,
    /// Reason why the scene is in the set.
    pub why: String,
    /// Preset that the scene begins with.
    pub preset: String,
    /// Overrides of the preset's keys, `key=value`.
    pub set: Vec<String>,
    /// Quantities of the converged run, the reference of all cases.
    pub converged: BTreeMap<Quantity, Converged>,
    /// Accepted runs, one a solver.
    #[serde(rename = "case")]
    pub cases: Vec<CaseSnapshot>,
}

/// Quantity of a converged run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Converged {
    /// Denominator of relative differences: the root mean square of all samples (for energies the larger work, for
    /// joint errors the penetration under static load), in the quantity's unit.
    pub scale: f64,
    /// Distance of a coarser run from the converged one, as a share of `scale`.
    pub own_error: f64,
    /// Statistics of the quantity.
    #[serde(flatten)]
    pub statistics: Statistics,
}

/// Accepted run of one scene by one solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseSnapshot {
    /// Formulation and integrator, or the name of a user's solver.
    pub choice: String,
    /// Overrides of the scene's keys, `key=value`.
    pub set: Vec<String>,
    /// Evaluations and steps of the run.
    pub costs: Costs,
    /// Largest relative change of the number of evaluations under perturbed rounding.
    pub count_spread: f64,
    /// Accepted results by quantity.
    pub quantity: BTreeMap<Quantity, QuantitySnapshot>,
}

/// Quantity of an accepted run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuantitySnapshot {
    /// Distance from the converged run, as a share of its scale.
    pub error: f64,
    /// Largest distance under perturbed rounding, measured at recording, as a share of the scale.
    pub rounding: f64,
    /// Statistics of the quantity.
    #[serde(flatten)]
    pub statistics: Statistics,
}

impl Baseline {
    /// Returns the folder of the baseline `name` within `dir`, the folder of all baselines.
    ///
    /// # Errors
    /// A name that some file system refuses as a folder.
    pub fn folder(dir: &Path, name: &str) -> Result<PathBuf, StudyError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        if name.is_empty() || name.starts_with('.') || !name.chars().all(plain) {
            return Err(StudyError::Input(format!(
                "`{name}` is no name for a baseline; use letters, digits, `-`, `_` and `.`"
            )));
        }
        Ok(dir.join(name))
    }

    /// Reads the baseline `name` in `dir`, the folder of all baselines.
    ///
    /// ```
    /// use pinwheel_studies::baseline::Baseline;
    ///
    /// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../reference/baselines");
    /// let accepted = Baseline::open(folder.as_ref(), "accepted")?;
    /// assert!(accepted.scenes.iter().any(|scene| scene.name == "paper"));
    /// # Ok::<(), pinwheel_studies::StudyError>(())
    /// ```
    ///
    /// # Errors
    /// Errors of [`earlier`](Self::earlier); no such baseline, with the names of those in `dir`.
    pub fn open(dir: &Path, name: &str) -> Result<Self, StudyError> {
        if let Some(baseline) = Self::earlier(&Self::folder(dir, name)?)? {
            return Ok(baseline);
        }
        let remedy = match Self::names(dir).as_slice() {
            [] => "run in the project's folder, name --dir, or record one with `pinwheel baseline record`".to_owned(),
            known => format!("there are {}", known.join(", ")),
        };
        let dir = dir.display();
        Err(StudyError::Input(format!(
            "no baseline `{name}` in {dir}; {remedy}"
        )))
    }

    /// Reads the baseline in `folder`; `None` where the folder has no baseline.
    ///
    /// # Errors
    /// A file that cannot be read, or that [`write`](Self::write) would not write.
    pub fn earlier(folder: &Path) -> Result<Option<Self>, StudyError> {
        let path = folder.join(FILE);
        match fs::read_to_string(&path) {
            Ok(text) => Self::parse(&path, &text).map(Some),
            Err(source) if source.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(StudyError::Input(format!(
                "{}: cannot be read: {source}; choose another --dir or restore the file",
                path.display()
            ))),
        }
    }

    /// Returns the names of the baselines in `folder`, sorted.
    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let entries = entries.filter(|entry| entry.path().join(FILE).is_file());
        let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    /// Reads the text of the file `path`.
    ///
    /// # Errors
    /// A text that [`write`](Self::write) would not write.
    pub fn parse(path: &Path, text: &str) -> Result<Self, StudyError> {
        let place = path.display();
        let spoiled = |what: &str| {
            StudyError::Input(format!(
                "{place}: {what}; restore the file, or delete it and record the baseline anew"
            ))
        };
        let unread = |error: toml::de::Error| spoiled(error.message());
        let value: toml::Value = toml::from_str(text).map_err(unread)?;
        if let Some(format) = value.get("format").and_then(toml::Value::as_integer)
            && format != i64::from(FORMAT)
        {
            return Err(StudyError::Input(format!(
                "{place}: format {format} is not the one this program writes ({FORMAT}); record it anew under another name"
            )));
        }
        if !is_finite(&value) {
            return Err(spoiled("holds a number that is not finite"));
        }
        let read: Self = value.try_into().map_err(unread)?;
        if read.scenes.is_empty() {
            let what = "holds no scenes, so that nothing could be compared";
            return Err(spoiled(what));
        }
        read.sound().map_err(|what| spoiled(&what))?;
        Ok(read)
    }

    /// Checks that `solvers` made this baseline, which is valid only for them.
    ///
    /// # Errors
    /// Other solvers made the baseline.
    pub(super) fn made_by(&self, solvers: &[String]) -> Result<(), StudyError> {
        if self.solvers == solvers {
            return Ok(());
        }
        Err(StudyError::Input(match self.solvers.as_slice() {
            [] => "this baseline was made by Pinwheel's own solver; leave out --solver, or record one under another name"
                .to_owned(),
            recorded => format!(
                "this baseline was made by {}; name the same by --solver, in this order",
                recorded.join(", ")
            ),
        }))
    }

    /// Returns true for the text of a baseline.
    fn is_ours(content: &[u8]) -> bool {
        std::str::from_utf8(content).is_ok_and(|text| Self::parse(Path::new(FILE), text).is_ok())
    }

    /// Checks that the figures are consistent and such as [`record`](super::record) writes.
    fn sound(&self) -> Result<(), String> {
        let twice = |names: Vec<&str>| {
            let mut all = names.iter().enumerate();
            let again = all.find(|(k, name)| names[..*k].contains(name));
            again.map(|(_, name)| (*name).to_owned())
        };
        let scenes = self.scenes.iter().map(|scene| scene.name.as_str());
        if let Some(name) = twice(scenes.collect()) {
            return Err(format!("holds the scene `{name}` twice"));
        }
        for scene in &self.scenes {
            let name = &scene.name;
            let choices = scene.cases.iter().map(|case| case.choice.as_str());
            if let Some(choice) = twice(choices.collect()) {
                return Err(format!("{name}: holds the case `{choice}` twice"));
            }
            for converged in scene.converged.values() {
                if converged.scale <= 0.0 {
                    return Err(format!("{name}: holds a scale that is not positive"));
                }
                let sound = share("own_error", converged.own_error, LARGEST_RECORDED);
                sound.map_err(|what| format!("{name}: {what}"))?;
            }
            for case in &scene.cases {
                let sound = case.sound(&scene.converged);
                sound.map_err(|what| format!("{name}, {}: {what}", case.choice))?;
            }
        }
        Ok(())
    }

    /// Checks that [`write`](Self::write) may write into the folder `dir`; called before long runs.
    ///
    /// # Errors
    /// The file cannot be written, or exists and is not a baseline.
    pub fn check_place(dir: &Path) -> Result<(), OutputError> {
        file::check(&dir.join(FILE), &Self::is_ours)
    }

    /// Writes [`FILE`] into the folder `dir` and leaves other files there alone.
    ///
    /// # Errors
    /// Errors of [`check_place`](Self::check_place).
    pub fn write(&self, dir: &Path) -> Result<(), OutputError> {
        let path = dir.join(FILE);
        let text = toml::to_string(self).map_err(|error| OutputError::new(&path, &error))?;
        file::replace(&path, text.as_bytes(), &Self::is_ours)
    }
}

impl CaseSnapshot {
    /// Checks that the figures of the case are possible, can show a change, and agree with the converged run.
    pub(super) fn sound(&self, converged: &BTreeMap<Quantity, Converged>) -> Result<(), String> {
        share("count_spread", self.count_spread, 1.0)?;
        if self.quantity.is_empty() {
            return Err("holds no quantity".to_owned());
        }
        for (quantity, own) in &self.quantity {
            let label = quantity.label();
            share("rounding", own.rounding, LARGEST_RECORDED)
                .map_err(|what| format!("{what} of the {label}"))?;
            let error = converged.get(quantity).and_then(|converged| {
                Some(own.statistics.distance(&converged.statistics)? / converged.scale)
            });
            // Stored error and figures differ only by the digits of a text file.
            let same = |error: f64| (error - own.error).abs() <= 1e-9 * (error + 1e-6);
            if !error.is_some_and(same) {
                let error = own.error;
                return Err(format!(
                    "error = {error:e} of the {label} is not that of its figures"
                ));
            }
        }
        Ok(())
    }
}

/// Checks that a share lies between 0 and `most`.
fn share(what: &str, value: f64, most: f64) -> Result<(), String> {
    match (0.0..=most).contains(&value) {
        true => Ok(()),
        false => Err(format!(
            "{what} = {value:e} is not within 0 and {most}, and would hide a change"
        )),
    }
}

/// Returns true if every number in `value` is finite. TOML has `inf` and `nan`, with which nothing can be compared.
fn is_finite(value: &toml::Value) -> bool {
    match value {
        toml::Value::Float(number) => number.is_finite(),
        toml::Value::Array(list) => list.iter().all(is_finite),
        toml::Value::Table(table) => table.values().all(is_finite),
        _ => true,
    }
}
