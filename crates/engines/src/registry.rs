//! The list of engines. A new engine is a file in `registry/`, its `mod`, and one line here.

mod native;

use pinwheel_scene::Scene;

use crate::engine::Engine;
pub use native::Native;

/// All engines of this build, native first, then the solvers that joined ([`admit`](crate::external::admit)).
#[must_use]
pub fn registry() -> Vec<Box<dyn Engine>> {
    of_build().chain(crate::external::admitted()).collect()
}

/// Whether an engine of this project is called so, in this build or another.
pub(crate) fn built_in(name: &str) -> bool {
    let kin = [
        "rapier-",
        "mujoco-",
        "exudyn-",
        "simbody-shared",
        "ida-shared",
    ];
    kin.iter().any(|prefix| name.starts_with(prefix))
        || of_build().any(|engine| engine.name() == name)
}

fn of_build() -> impl Iterator<Item = Box<dyn Engine>> {
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
    #[cfg(feature = "crossval")]
    let engines = engines.chain(crate::solvers::engines());
    engines
}

/// The engine of a name; `native` is the native solver in the formulation that the scene asks for.
#[must_use]
pub fn by_name(name: &str, scene: &Scene) -> Option<Box<dyn Engine>> {
    if name == "native" {
        return Some(Box::new(Native::of(scene)));
    }
    registry().into_iter().find(|engine| engine.name() == name)
}
