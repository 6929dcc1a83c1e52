//! The list of engines. A new engine is a new file and one line here.

use pinwheel_scene::Scene;

use crate::engine::Engine;
use crate::native::Native;

/// All engines of this build, native first.
#[must_use]
pub fn registry() -> Vec<Box<dyn Engine>> {
    let native: [Box<dyn Engine>; 3] = [
        Box::new(Native::REDUCED),
        Box::new(Native::LAGRANGE),
        Box::new(Native::RESOLVED),
    ];
    let engines = native.into_iter();
    #[cfg(feature = "rapier")]
    let engines = engines.chain(crate::rapier::engines());
    #[cfg(feature = "python")]
    let engines = engines.chain(crate::python::engines());
    engines.collect()
}

/// The engine of a name; `native` is the native solver in the formulation that the scene asks for.
#[must_use]
pub fn by_name(name: &str, scene: &Scene) -> Option<Box<dyn Engine>> {
    if name == "native" {
        return Some(Box::new(Native::of(scene)));
    }
    registry().into_iter().find(|engine| engine.name() == name)
}
