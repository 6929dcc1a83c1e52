//! The only door to building and running: a scene whose values were checked.

use std::ops::Deref;

use serde::Serialize;

use crate::check;
use crate::error::Fault;
use crate::model::Scene;

/// A scene that passed [`Scene::check`]. It reads like the [`Scene`] inside and cannot be changed but through
/// [`changed`](Self::changed), which checks again.
///
/// ```
/// use pinwheel_scene::Scene;
///
/// let paper = Scene::load("paper", &[])?;
/// let loose = paper.changed(|scene| scene.gear.backlash_m = 6e-4)?;
/// assert_eq!(loose.gear.backlash_m, 6e-4);
/// assert!(paper.changed(|scene| scene.solver.step_s = 0.0).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct CheckedScene {
    scene: Scene,
}

impl Scene {
    /// Checks every value, each alone and then together.
    ///
    /// # Errors
    /// The first fault found: its keys, what is wrong and the remedy.
    pub fn check(self) -> Result<CheckedScene, Fault> {
        check::check(&self)?;
        Ok(CheckedScene { scene: self })
    }
}

impl CheckedScene {
    /// A copy with changes, checked again.
    ///
    /// # Errors
    /// As [`Scene::check`].
    pub fn changed(&self, change: impl FnOnce(&mut Scene)) -> Result<Self, Fault> {
        let mut scene = self.scene.clone();
        change(&mut scene);
        scene.check()
    }

    /// The scene alone, free to be changed.
    #[must_use]
    pub fn into_scene(self) -> Scene {
        self.scene
    }

    /// Lets a scene pass that the checks refuse. For studies of published models only, whose point is a value that
    /// no sound scene has (negative damping); whoever calls it answers for the end of the run.
    #[must_use]
    pub fn unchecked_for_published_study(scene: Scene) -> Self {
        Self { scene }
    }
}

impl Deref for CheckedScene {
    type Target = Scene;

    fn deref(&self) -> &Scene {
        &self.scene
    }
}

impl AsRef<Scene> for CheckedScene {
    fn as_ref(&self) -> &Scene {
        &self.scene
    }
}
