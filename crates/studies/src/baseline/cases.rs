//! The fixed set, `cases.toml`: which scenes, over which window, by which formulations and integrators.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use pinwheel_scene::{CheckedScene, Override, Scene, SceneError};
use serde::Deserialize;

/// A scene of the set.
#[derive(Debug, Clone, Deserialize)]
pub struct SceneCase {
    /// Name in the baseline.
    pub name: String,
    /// Preset it is made of; none: that of its name.
    preset: Option<String>,
    /// Reason why the scene is in the set.
    pub why: String,
    /// Keys it changes.
    #[serde(default)]
    set: Vec<String>,
    /// By which solvers it runs: names of choices, `<formulation>-<integrator>` and what else sets them apart.
    pub choices: Vec<String>,
}

#[derive(Debug, Default, Deserialize)]
struct Set {
    /// Sampling of every scene.
    window: Vec<String>,
    /// Keys that each choice sets.
    choice: BTreeMap<String, Vec<String>>,
    scene: Vec<SceneCase>,
}

/// Embedded; a test reads it.
static SET: LazyLock<Set> =
    LazyLock::new(|| toml::from_str(include_str!("cases.toml")).unwrap_or_default());

/// The scenes of the set.
#[must_use]
pub fn scenes() -> &'static [SceneCase] {
    &SET.scene
}

/// Keys that a choice of ours sets.
pub fn sets(choice: &str) -> &'static [String] {
    SET.choice.get(choice).map_or(&[], Vec::as_slice)
}

impl SceneCase {
    /// Preset it is made of.
    #[must_use]
    pub fn preset(&self) -> &str {
        self.preset.as_deref().unwrap_or(&self.name)
    }

    /// Every key that it and its window change, as one would type them.
    #[must_use]
    pub fn changes(&self) -> Vec<String> {
        SET.window.iter().chain(&self.set).cloned().collect()
    }

    /// The scene with these settings of a solver.
    ///
    /// # Errors
    /// A key or value of the set is wrong.
    pub fn scene(&self, solver: &[String]) -> Result<CheckedScene, SceneError> {
        let keys = SET.window.iter().chain(&self.set).chain(solver);
        let overrides = keys.map(|change| {
            let (key, value) = change.split_once('=').unwrap_or((change, ""));
            Override::new(key, value)
        });
        Scene::load(self.preset(), &overrides.collect::<Vec<_>>())
    }
}
