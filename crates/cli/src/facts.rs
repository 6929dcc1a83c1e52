//! The scene in one line.

use pinwheel_scene::Scene;

/// Name and description.
pub(crate) fn title(scene: &Scene) -> String {
    if scene.description.is_empty() {
        scene.name.clone()
    } else {
        format!("{}: {}", scene.name, scene.description)
    }
}
