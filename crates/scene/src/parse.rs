//! From TOML text, its base and overrides to a checked scene.
//!
//! The base is laid down first, the file over it and then the overrides, key by key, each remembered with its place. So
//! a key that does not exist is caught where it stands, a wrong type too, and a check that fails later still knows the
//! line to name. What nobody wrote is filled in by [`crate::keys`], and told as an assumption.

mod layers;
mod overrides;
mod unknown;
mod values;

use crate::checked::CheckedScene;
use crate::error::SceneError;
use crate::load;
use crate::model::Scene;
use crate::presets::preset;

pub use overrides::Override;

use layers::Layers;
use unknown::BASE;

impl Scene {
    /// Loads `spec`, the bare name of a preset (`paper`) or the path of a scene file, applies the
    /// overrides and checks the result.
    ///
    /// # Errors
    /// The first fault found, on one line with its remedy.
    pub fn load(spec: &str, overrides: &[Override]) -> Result<CheckedScene, SceneError> {
        if let Some(text) = preset(spec) {
            return Self::from_toml(text, spec, overrides);
        }
        let text = load::read(spec)?;
        Self::from_toml(&text, spec, overrides)
    }

    /// Reads a scene from TOML text (or JSON, which begins with a brace: a scene, or a job file that holds one), applies
    /// the overrides in their order, fills in what is left out, and checks the
    /// result.
    ///
    /// `source_name` is the file's or preset's name for messages, and where a `base` is looked for beside it. A scene
    /// without `name` takes the file's (`gears/mine.toml` gives `mine`).
    ///
    /// # Errors
    /// The first fault found, with its key, line and remedy.
    pub fn from_toml(
        text: &str,
        source_name: &str,
        overrides: &[Override],
    ) -> Result<CheckedScene, SceneError> {
        let mut layers = Layers::new(source_name);
        layers.file(text, source_name, overrides, 0)?;
        for set in overrides.iter().filter(|set| set.key() != BASE) {
            layers.set(set)?;
        }
        layers.finish()
    }

    /// The scene as TOML with every key written out.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Tables of numbers and strings always serialise; floats print with all their digits.
        toml::to_string(self).unwrap_or_default()
    }
}
