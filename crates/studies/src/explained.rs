//! Explanation of a scene without running it: its model, its assumptions and its expected figures.

use pinwheel_gearbox::{Explanation as Model, Gearbox};
use pinwheel_scene::{Assumption, Derived, Scene, assumptions, derived};
use serde::Serialize;

/// Explanation of a scene.
#[derive(Debug, Clone, Serialize)]
pub struct Explanation<'a> {
    /// Explained scene.
    pub scene: &'a Scene,
    /// Modelled and omitted parts.
    #[serde(flatten)]
    pub model: Model,
    /// Quantities that follow from the dimensions.
    pub derived: Derived,
    /// Assumed values with their reasons.
    pub assumptions: Vec<Assumption>,
}

/// Explains the scene of `gearbox`.
pub fn explain(gearbox: &Gearbox) -> Explanation<'_> {
    let scene = &gearbox.scene;
    Explanation {
        scene,
        model: pinwheel_gearbox::explain(gearbox),
        derived: derived(scene),
        assumptions: assumptions(&gearbox.scene),
    }
}
