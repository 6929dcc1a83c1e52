//! What a scene models, assumes and lets one expect, without running it.

use pinwheel_gearbox::{Explanation as Model, Gearbox};
use pinwheel_scene::{Assumption, Derived, Scene, assumptions, derived};
use serde::Serialize;

/// Everything said of a scene.
#[derive(Debug, Clone, Serialize)]
pub struct Explanation<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What is modelled and what is left out.
    #[serde(flatten)]
    pub model: Model,
    /// What follows from the dimensions.
    pub derived: Derived,
    /// Values that are assumptions, and what they rest on.
    pub assumptions: Vec<Assumption>,
}

/// Explains the scene of `gearbox`.
#[must_use]
pub fn explain(gearbox: &Gearbox) -> Explanation<'_> {
    let scene = &gearbox.scene;
    Explanation {
        scene,
        model: pinwheel_gearbox::explain(gearbox),
        derived: derived(scene),
        assumptions: assumptions(&gearbox.scene),
    }
}
