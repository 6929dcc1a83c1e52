//! A baseline as files: `baseline.toml` with what made it and why, and one file a scene.
//!
//! Text that a review can read: an accepted change shows as changed lines of exact summaries, errors and counts,
//! with the courses' whole numbers below.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::{fs, io};

use serde::{Deserialize, Serialize};

use super::error::{BaselineError, FORMAT};
use super::quantity::{self, SKETCH};
use super::runner::Costs;
use crate::output::file_name;

/// Name of the file that makes a folder a baseline.
pub const HEAD: &str = "baseline.toml";

/// An accepted state of the solver.
#[derive(Debug, Clone, PartialEq)]
pub struct Baseline {
    /// What made it.
    pub head: Head,
    /// One a scene.
    pub scenes: Vec<SceneRecord>,
}

/// What made a baseline, and its history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// `FORMAT`.
    pub format: u32,
    /// Names of the scenes, whose files stand beside this one.
    pub scenes: Vec<String>,
    /// Solvers that joined and made it; empty: our own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub solvers: Vec<String>,
    /// What made the current state.
    pub made: Made,
    /// Every acceptance, oldest first.
    pub accepted: Vec<Acceptance>,
}

/// Where and by what a baseline was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Made {
    /// Year-month-day.
    pub date: String,
    /// Commit of the source, with `+changes` if there were any; `unknown` outside a repository.
    pub commit: String,
    /// Version of the program.
    pub version: String,
    /// `optimised` or `debug`.
    pub build: String,
    /// Vector instructions of the contact loop.
    pub vectors: String,
    /// Model of the processor.
    pub processor: String,
    /// Why instructions were not counted; empty if they were.
    pub no_instructions: String,
}

/// Why a state was accepted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Acceptance {
    /// Year-month-day.
    pub date: String,
    /// Commit of the source.
    pub commit: String,
    /// The reason given.
    pub reason: String,
}

/// One scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneRecord {
    /// Its name in the set.
    pub scene: String,
    /// What it is in the set for.
    pub why: String,
    /// Preset it is made of.
    pub preset: String,
    /// Keys changed.
    pub set: Vec<String>,
    /// The converged run.
    pub reference: ReferenceRecord,
    /// The accepted runs.
    #[serde(rename = "case")]
    pub cases: Vec<CaseRecord>,
}

/// A converged run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceRecord {
    /// How it was made.
    pub settings: String,
    /// One a quantity.
    #[serde(rename = "quantity")]
    pub quantities: Vec<ReferenceQuantity>,
}

/// One quantity of a converged run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceQuantity {
    /// Its key.
    pub key: String,
    /// What differences are shares of: the root mean square of all samples (for energies the larger work, for joint
    /// errors the penetration under static load), in the quantity's unit.
    pub scale: f64,
    /// The reference's own error, a share of the scale.
    pub own_error: f64,
    /// Unit of the numbers in `courses`.
    pub quantum: f64,
    /// Kept samples, one line a channel.
    pub courses: Vec<String>,
}

/// One accepted run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseRecord {
    /// Name of the solver choice.
    pub choice: String,
    /// Keys it sets.
    pub set: Vec<String>,
    /// What it cost.
    pub costs: Costs,
    /// Largest share by which roundings moved its right-hand sides when this was recorded.
    pub count_spread: f64,
    /// One a quantity.
    #[serde(rename = "quantity")]
    pub quantities: Vec<CaseQuantity>,
}

/// One quantity of an accepted run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseQuantity {
    /// Its key.
    pub key: String,
    /// Mean of all samples.
    pub mean: f64,
    /// Largest magnitude.
    pub peak: f64,
    /// Exact sketch of all samples, see [`quantity`].
    pub sketch: [f64; SKETCH],
    /// Error against the converged run over the kept samples, a share of the scale.
    pub error: f64,
    /// What roundings changed when this was recorded, a share of the scale.
    pub rounding: f64,
    /// Unit of the numbers in `differences`.
    pub quantum: f64,
    /// Kept samples less the converged ones, one line a channel.
    pub differences: Vec<String>,
}

/// One baseline of a list.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Listed {
    /// Its name.
    pub name: String,
    /// What it is.
    #[serde(flatten)]
    pub head: Head,
}

impl Baseline {
    /// The file of a scene.
    fn scene_file(name: &str) -> String {
        format!("{name}.toml")
    }

    /// The folder of the baseline `name`, below `dir`, the folder of all.
    ///
    /// # Errors
    /// A name that cannot be a folder's everywhere.
    pub fn folder(dir: &Path, name: &str) -> Result<PathBuf, BaselineError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        if name.is_empty() || name.starts_with('.') || !name.chars().all(plain) {
            return Err(BaselineError::Name(name.to_owned()));
        }
        Ok(dir.join(name))
    }

    /// Reads the baseline `name` in `dir`, the folder of all.
    ///
    /// ```
    /// use pinwheel_studies::baseline::Baseline;
    ///
    /// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../reference/baselines");
    /// let accepted = Baseline::open(folder.as_ref(), "accepted")?;
    /// assert_eq!(accepted.scenes.len(), accepted.head.scenes.len());
    /// # Ok::<(), pinwheel_studies::baseline::BaselineError>(())
    /// ```
    ///
    /// # Errors
    /// As [`folder`](Self::folder) and [`read`](Self::read); where there is none, the error names those that there are.
    pub fn open(dir: &Path, name: &str) -> Result<Self, BaselineError> {
        let folder = Self::folder(dir, name)?;
        if folder.join(HEAD).is_file() {
            return Self::read(&folder);
        }
        let known = Self::names(dir);
        Err(BaselineError::Missing {
            name: name.to_owned(),
            dir: dir.to_owned(),
            remedy: if known.is_empty() {
                "run in the project's folder, name --dir, or record one with `pinwheel baseline record`".to_owned()
            } else {
                format!("there are {}", known.join(", "))
            },
        })
    }

    /// The heads of all baselines in `dir`, by their names.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn list(dir: &Path) -> Result<Vec<Listed>, BaselineError> {
        let read = |name: String| {
            let head = Self::open(dir, &name)?.head;
            Ok(Listed { name, head })
        };
        Self::names(dir).into_iter().map(read).collect()
    }

    /// Reads the baseline in the folder `dir`.
    ///
    /// # Errors
    /// No such folder, or files that are not what [`write`](Self::write) left.
    pub fn read(dir: &Path) -> Result<Self, BaselineError> {
        Self::read_by(dir, &|path| fs::read_to_string(path))
    }

    /// The same of files that `text` reads.
    ///
    /// # Errors
    /// As of [`read`](Self::read).
    pub fn read_by(
        dir: &Path,
        text: &dyn Fn(&Path) -> io::Result<String>,
    ) -> Result<Self, BaselineError> {
        let head: Head = read_toml(&dir.join(HEAD), text)?;
        if head.format != FORMAT {
            return Err(BaselineError::Format {
                path: dir.join(HEAD),
                found: head.format,
            });
        }
        if head.scenes.is_empty() {
            return Err(BaselineError::Spoiled {
                path: dir.join(HEAD),
                what: "it lists no scenes, so that nothing could be compared".to_owned(),
            });
        }
        let (mut scenes, mut known) = (Vec::new(), HashSet::new());
        for name in &head.scenes {
            if !known.insert(name) {
                return Err(BaselineError::Spoiled {
                    path: dir.join(HEAD),
                    what: format!("it lists `{name}` twice"),
                });
            }
            if file_name(name) != *name {
                return Err(BaselineError::Spoiled {
                    path: dir.join(HEAD),
                    what: format!("`{name}` is no name of a scene"),
                });
            }
            let path = dir.join(Self::scene_file(name));
            let record: SceneRecord = read_toml(&path, text)?;
            record.check(&path)?;
            scenes.push(record);
        }
        Ok(Self { head, scenes })
    }

    /// Names of its files, which are all that its folder holds.
    #[must_use]
    pub fn files(&self) -> Vec<String> {
        let scenes = self.head.scenes.iter();
        let files = scenes.map(|name| Self::scene_file(name));
        files.chain([HEAD.to_owned()]).collect()
    }

    /// Writes all files into the folder `dir`, which exists.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn write(&self, dir: &Path) -> Result<(), BaselineError> {
        write_toml(&dir.join(HEAD), &self.head)?;
        for scene in &self.scenes {
            write_toml(&dir.join(Self::scene_file(&scene.scene)), scene)?;
        }
        Ok(())
    }

    /// Names of the baselines in a folder of baselines, sorted.
    #[must_use]
    pub fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .into_iter()
            .flatten()
            .flatten()
            .filter(|entry| entry.path().join(HEAD).is_file())
            .filter_map(|entry| entry.file_name().into_string().ok())
            .collect();
        names.sort();
        names
    }
}

impl SceneRecord {
    /// Refuses what could not be compared.
    fn check(&self, path: &Path) -> Result<(), BaselineError> {
        let spoiled = |what: String| BaselineError::Spoiled {
            path: path.to_owned(),
            what,
        };
        for quantity in &self.reference.quantities {
            if quantity::by_key(&quantity.key).is_none() {
                return Err(spoiled(format!("no quantity is called `{}`", quantity.key)));
            }
            let sound = quantity.scale > 0.0 && quantity.quantum > 0.0 && quantity.own_error >= 0.0;
            if !sound || quantity.samples().is_none() {
                return Err(spoiled(format!(
                    "the converged {} is damaged",
                    quantity.key
                )));
            }
        }
        for case in &self.cases {
            for quantity in &case.quantities {
                let reference = self.reference.quantity(&quantity.key);
                if reference
                    .and_then(|reference| quantity.samples(reference))
                    .is_none()
                {
                    return Err(spoiled(format!(
                        "{} of {} is damaged",
                        quantity.key, case.choice
                    )));
                }
            }
        }
        Ok(())
    }
}

impl ReferenceRecord {
    /// The quantity called `key`.
    #[must_use]
    pub fn quantity(&self, key: &str) -> Option<&ReferenceQuantity> {
        self.quantities.iter().find(|quantity| quantity.key == key)
    }
}

impl ReferenceQuantity {
    /// Kept samples by channel; `None` if a line is damaged.
    #[must_use]
    pub fn samples(&self) -> Option<Vec<Vec<f64>>> {
        self.courses
            .iter()
            .map(|line| super::quantised::from_line(line, self.quantum))
            .collect()
    }
}

impl CaseQuantity {
    /// Kept samples by channel; `None` if a line is damaged or does not fit the reference.
    #[must_use]
    pub fn samples(&self, reference: &ReferenceQuantity) -> Option<Vec<Vec<f64>>> {
        let base = reference.samples()?;
        if base.len() != self.differences.len() || !(self.quantum > 0.0) {
            return None;
        }
        let lines = self.differences.iter().zip(base);
        lines
            .map(|(line, base)| {
                let differences = super::quantised::from_line(line, self.quantum)?;
                let fits = differences.len() == base.len();
                fits.then(|| base.iter().zip(&differences).map(|(a, d)| a + d).collect())
            })
            .collect()
    }
}

fn read_toml<T: serde::de::DeserializeOwned>(
    path: &Path,
    text: &dyn Fn(&Path) -> io::Result<String>,
) -> Result<T, BaselineError> {
    let text = text(path).map_err(|source| BaselineError::Read {
        path: path.to_owned(),
        source,
    })?;
    let spoiled = |what: String| BaselineError::Spoiled {
        path: path.to_owned(),
        what,
    };
    let read = |error: toml::de::Error| spoiled(error.message().to_owned());
    let value: toml::Value = toml::from_str(&text).map_err(read)?;
    if !is_finite(&value) {
        return Err(spoiled("holds a number that is not finite".to_owned()));
    }
    value.try_into().map_err(read)
}

/// Whether every number in it is finite: TOML knows `inf` and `nan`, and neither can be compared with.
fn is_finite(value: &toml::Value) -> bool {
    match value {
        toml::Value::Float(number) => number.is_finite(),
        toml::Value::Array(list) => list.iter().all(is_finite),
        toml::Value::Table(table) => table.values().all(is_finite),
        _ => true,
    }
}

fn write_toml(path: &PathBuf, value: &impl Serialize) -> Result<(), BaselineError> {
    let text = toml::to_string_pretty(value).map_err(|error| BaselineError::Spoiled {
        path: path.clone(),
        what: error.to_string(),
    })?;
    fs::write(path, text).map_err(|source| BaselineError::Write {
        path: path.clone(),
        source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_numbers_that_are_not_finite_are_refused() {
        let accepted = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../reference/baselines/accepted/paper.toml"
        );
        let text = fs::read_to_string(accepted).unwrap();
        let path = Path::new("paper.toml");
        let read = |text: &str| {
            let record: Result<SceneRecord, _> = read_toml(path, &|_| Ok(text.to_owned()));
            record.and_then(|record| record.check(path))
        };
        read(&text).unwrap();
        for key in [
            "scale",
            "own_error",
            "quantum",
            "mean",
            "peak",
            "error",
            "rounding",
        ] {
            let start = text.find(&format!("\n{key} = ")).unwrap() + 1;
            let end = start + text[start..].find('\n').unwrap();
            for value in ["inf", "-inf", "nan"] {
                let spoiled = format!("{}{key} = {value}{}", &text[..start], &text[end..]);
                let error = read(&spoiled).unwrap_err().to_string();
                assert!(error.contains("finite"), "{key} = {value}: {error}");
            }
            // Each is finite, and the samples are not.
            if key == "quantum" {
                let spoiled = format!("{}{key} = 1e308{}", &text[..start], &text[end..]);
                assert!(read(&spoiled).is_err());
            }
        }
    }

    /// A scene listed a hundred thousand times would be read that often.
    #[test]
    fn regress_a_scene_is_listed_once() {
        let accepted = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../reference/baselines/accepted"
        );
        let twice = |path: &Path| -> io::Result<String> {
            let text = fs::read_to_string(path)?;
            Ok(text.replacen("scenes = [", "scenes = [\n    \"steel\",", 1))
        };
        let error = Baseline::read_by(Path::new(accepted), &twice).unwrap_err();
        assert!(error.to_string().contains("lists `steel` twice"), "{error}");
    }
}
