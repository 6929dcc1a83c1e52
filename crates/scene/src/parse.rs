//! Conversion of TOML text, its base and overrides to a checked scene.
//!
//! The base comes first, then the file and then the overrides, key by key, each stored with its place. An unknown key or a
//! wrong type is thus reported at its line, and so is a check that fails later. Omitted keys are filled in by
//! [`crate::keys`], and listed as assumptions.

mod edit;
mod layers;
mod overrides;
mod unknown;
mod values;

use std::collections::HashMap;

use crate::checked::CheckedScene;
use crate::error::SceneError;
use crate::load;
use crate::model::Scene;
use crate::presets::preset;

pub use edit::edited;
pub use overrides::Override;

use layers::{Layers, located};
use unknown::BASE;

/// Common part of many scenes, read once: a file with its base, and overrides.
///
/// ```
/// use pinwheel_scene::{Draft, Override};
///
/// let draft = Draft::load("paper", &["drive.output_torque_n_m=30".parse()?])?;
/// let loose = draft.with(&[Override::new("gear.backlash_m", "6e-4")])?;
/// assert_eq!((loose.gear.backlash_m, loose.drive.output_torque_n_m), (6e-4, 30.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Draft {
    spec: String,
    overrides: Vec<Override>,
    layers: Layers,
}

impl Draft {
    /// Reads `spec` like [`Scene::load`] and applies the overrides; omitted keys stay open and combinations unchecked.
    ///
    /// # Errors
    /// The first fault, on one line with its remedy.
    pub fn load(spec: &str, overrides: &[Override]) -> Result<Self, SceneError> {
        let read;
        let text = match preset(spec) {
            Some(text) => text,
            None => {
                read = load::read(spec)?;
                &read
            }
        };
        Ok(Self {
            spec: spec.to_owned(),
            overrides: overrides.to_vec(),
            layers: Layers::read(text, spec, overrides)?,
        })
    }

    /// Returns the scene with more overrides, like [`Scene::load`] with the old and the new overrides together. Overridden
    /// values are exact: their uncertainties are removed.
    ///
    /// # Errors
    /// Errors of [`Scene::load`].
    pub fn with(&self, overrides: &[Override]) -> Result<CheckedScene, SceneError> {
        if overrides.iter().any(|set| set.key() == BASE) {
            let all = [self.overrides.as_slice(), overrides].concat();
            return Scene::load(&self.spec, &all);
        }
        let mut layers = self.layers.clone();
        overrides
            .iter()
            .for_each(|set| layers.drop_uncertainty(&set.key));
        for set in overrides {
            layers.set(set)?;
        }
        layers.finish()
    }
}

impl Scene {
    /// Loads `spec`, the name of a preset (`paper`) or the path of a scene file, applies the overrides and checks the
    /// result.
    ///
    /// # Errors
    /// The first fault, on one line with its remedy.
    pub fn load(spec: &str, overrides: &[Override]) -> Result<CheckedScene, SceneError> {
        Draft::load(spec, overrides)?.layers.finish()
    }

    /// Reads a scene from TOML text (or JSON, which begins with a brace: a scene, or a job file with one), applies the
    /// overrides in their order, fills in omitted keys, and checks the result.
    ///
    /// `source_name` is the file's or preset's name for messages; a relative `base` is searched beside it. A scene without
    /// `name` takes the file's (`gears/mine.toml` gives `mine`).
    ///
    /// # Errors
    /// The first fault, with its key, line and remedy.
    pub fn from_toml(
        text: &str,
        source_name: &str,
        overrides: &[Override],
    ) -> Result<CheckedScene, SceneError> {
        Layers::read(text, source_name, overrides)?.finish()
    }

    /// Reads the output of [`to_toml`](Self::to_toml), and checks it again, in a quarter of the time of
    /// [`from_toml`](Self::from_toml). A text that is not a complete scene is read by that function.
    ///
    /// # Errors
    /// The first fault.
    pub fn from_complete(text: &str) -> Result<CheckedScene, SceneError> {
        const SOURCE: &str = "a complete scene";
        let Ok(scene) = pinwheel_files::parse::<Self>(text) else {
            return Self::from_toml(text, SOURCE, &[]);
        };
        let located = |fault| located(fault, &HashMap::new(), SOURCE);
        scene.check().map_err(located)
    }

    /// Returns the scene as TOML with every key.
    pub fn to_toml(&self) -> String {
        // Tables of numbers and strings always serialise; floats keep all their digits.
        toml::to_string(self).unwrap_or_default()
    }

    /// Returns the scene as JSON, tables and keys as in TOML; keys without a value are null.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::to_value(self).unwrap_or_default()
    }
}
