//! Scenes: the compiled part of `pinwheel.Scene`.

use pinwheel::scene::{
    CheckedScene, KEYS, Location, Override, PRESETS, Scene, SceneError, did_you_mean, preset,
};
use pinwheel::studies::sweep;
use pinwheel::time_series::figure::{FigureDef, definitions};
use pyo3::prelude::*;

use crate::errors::{Raises, input};

/// Checked scene with its sources, so that a change derives dependent values again.
#[pyclass(frozen, module = "pinwheel._core", name = "Scene")]
pub(crate) struct Core {
    pub(crate) checked: CheckedScene,
    name: String,
    text: String,
    sets: Vec<(String, String)>,
}

pub(crate) fn overrides(sets: &[(String, String)]) -> Vec<Override> {
    let each = |(key, value): &(String, String)| Override::new(key.clone(), value.clone());
    sets.iter().map(each).collect()
}

#[pymethods]
impl Core {
    /// Reads a scene from TOML text; `name` is its file, beside which a base is searched. `sets`: (dotted key, TOML value).
    #[new]
    fn new(name: String, text: String, sets: Vec<(String, String)>) -> Raises<Self> {
        let checked = Scene::from_toml(&text, &name, &overrides(&sets))?;
        Ok(Self {
            checked,
            name,
            text,
            sets,
        })
    }

    /// Loads a preset or a file.
    #[staticmethod]
    fn load(spec: String, sets: Vec<(String, String)>) -> Raises<Self> {
        if let Some(text) = preset(&spec) {
            return Self::new(spec, text.to_owned(), sets);
        }
        // Small plain files are read here. An unreadable file causes the program's own error.
        let small = std::fs::metadata(&spec)
            .is_ok_and(|file| file.is_file() && file.len() <= pinwheel::scene::MOST_BYTES as u64);
        match small.then(|| std::fs::read_to_string(&spec)) {
            Some(Ok(text)) => {
                let path = std::path::absolute(&spec);
                let name = path.map_or(spec, |path| path.display().to_string());
                Self::new(name, text, sets)
            }
            _ => match Scene::load(&spec, &overrides(&sets)) {
                Err(error) => Err(error.into()),
                Ok(_) => Err(input(format!("{spec}: is no plain file"))),
            },
        }
    }

    /// Returns the scene with more keys set; dependent values are derived again.
    fn changed(&self, sets: Vec<(String, String)>) -> Raises<Self> {
        let all = self.sets.iter().cloned().chain(sets).collect();
        Self::new(self.name.clone(), self.text.clone(), all)
    }

    /// Returns name, text and settings of the scene's sources.
    fn spec(&self) -> (String, String, Vec<(String, String)>) {
        (self.name.clone(), self.text.clone(), self.sets.clone())
    }

    /// Returns every key as TOML.
    fn to_toml(&self) -> String {
        self.checked.to_toml()
    }

    /// Returns omitted keys: (key, value as TOML, source).
    fn origins(&self) -> Vec<(&'static str, String, String)> {
        let origins = self.checked.origins();
        let each = origins.iter();
        each.map(|o| (o.key, o.value.to_string(), o.source.words()))
            .collect()
    }
}

/// Returns the full name of a key from its full name or its last part. Of several matches the least nested one is returned,
/// if unique: `gear.hole_radius_m` before `gear.errors.hole_radius_m`.
#[pyfunction]
pub(crate) fn key(name: &str) -> Raises<String> {
    if ["name", "description", "base"].contains(&name) || KEYS.iter().any(|key| key.name == name) {
        return Ok(name.to_owned());
    }
    let last = |full: &'static str| full.rsplit('.').next().unwrap_or(full);
    let ends = KEYS.iter().map(|key| key.name);
    let mut names: Vec<&str> = ends.filter(|full| last(full) == name).collect();
    let depth = |full: &str| full.matches('.').count();
    let least = names.iter().map(|full| depth(full)).min();
    names.retain(|full| Some(depth(full)) == least);
    let wrong = |what: String| {
        Err(SceneError::Key {
            place: Location::Set(String::new()),
            key: name.to_owned(),
            what: "is no key of a scene".to_owned(),
            remedy: what,
        }
        .into())
    };
    match names.as_slice() {
        [one] => Ok((*one).to_owned()),
        [] => {
            let known = KEYS.iter().map(|key| match name.contains('.') {
                true => key.name,
                false => last(key.name),
            });
            wrong(did_you_mean(name, &known.collect::<Vec<_>>()))
        }
        several => wrong(format!(
            "it stands for several; write one of `{}` in full",
            several.join("`, `")
        )),
    }
}

/// Returns all keys: (name, meaning, unit).
#[pyfunction]
pub(crate) fn keys() -> Vec<(&'static str, &'static str, &'static str)> {
    let all = KEYS.iter();
    all.map(|key| (key.name, key.about, key.unit())).collect()
}

/// Returns all figures: (key, label, unit, definition).
#[pyfunction]
pub(crate) fn figures() -> Vec<(&'static str, &'static str, &'static str, &'static str)> {
    let row = |def: &'static FigureDef| (&*def.key, &*def.label, &*def.unit, def.how);
    definitions::all().map(row).collect()
}

/// Returns label and unit of a figure or of a column of a sweep.
#[pyfunction]
pub(crate) fn named(name: &str) -> (String, String) {
    let known = definitions::all().find(|def| def.key == name).cloned();
    let def = known.unwrap_or_else(|| sweep::definition(name));
    (def.label.into_owned(), def.unit.into_owned())
}

/// Returns the JSON schema of scene files: permitted values of every key.
#[pyfunction]
pub(crate) fn schema() -> String {
    pinwheel::scene::schema::schema().to_string()
}

/// Returns the names of the presets.
#[pyfunction]
pub(crate) fn presets() -> Vec<&'static str> {
    PRESETS.iter().map(|preset| preset.name).collect()
}
