//! Fixed set of scenes, `cases.toml`, with their windows, formulations and integrators.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use pinwheel_scene::{CheckedScene, Override, Scene, SceneError};
use serde::Deserialize;

/// Scene of the set.
#[derive(Debug, Clone, Deserialize)]
pub struct SceneCase {
    /// Name in the baseline.
    pub name: String,
    /// Base preset; `None`: the one of its name.
    preset: Option<String>,
    /// Reason why the scene is in the set.
    pub why: String,
    /// Changed keys.
    #[serde(default)]
    set: Vec<String>,
    /// Solvers: names of choices, `<formulation>-<integrator>` with further distinctions.
    pub choices: Vec<String>,
}

#[derive(Debug, Default, Deserialize)]
struct Set {
    /// Sampling of every scene.
    window: Vec<String>,
    /// Keys set by each choice.
    choice: BTreeMap<String, Vec<String>>,
    scene: Vec<SceneCase>,
}

/// Embedded set, checked by a test.
static SET: LazyLock<Set> =
    LazyLock::new(|| pinwheel_files::parse(include_str!("cases.toml")).unwrap_or_default());

/// Returns the scenes of the set.
pub fn scenes() -> &'static [SceneCase] {
    &SET.scene
}

/// Returns the keys set by a choice.
pub fn sets(choice: &str) -> &'static [String] {
    SET.choice.get(choice).map_or(&[], Vec::as_slice)
}

impl SceneCase {
    /// Returns the base preset.
    pub fn preset(&self) -> &str {
        self.preset.as_deref().unwrap_or(&self.name)
    }

    /// Returns every key changed by scene and window, as for `--set`.
    pub fn changes(&self) -> Vec<String> {
        SET.window.iter().chain(&self.set).cloned().collect()
    }

    /// Returns the scene with these settings of a solver.
    ///
    /// # Errors
    /// A wrong key or value in the set.
    pub fn scene(&self, solver: &[String]) -> Result<CheckedScene, SceneError> {
        let keys = SET.window.iter().chain(&self.set).chain(solver);
        let overrides = keys.map(|change| {
            let (key, value) = change.split_once('=').unwrap_or((change, ""));
            Override::new(key, value)
        });
        Scene::load(self.preset(), &overrides.collect::<Vec<_>>())
    }
}
