//! The engines of this build, made by their families.

use pinwheel_scene::Scene;

use crate::engine::Engine;
use crate::external::admitted;
use crate::info::EngineInfo;
use crate::known::known;
use crate::native::Native;

/// Makes an engine; `None` where this build or this Python lacks it.
fn make(info: &'static EngineInfo<'static>) -> Option<Box<dyn Engine>> {
    match info.family() {
        "native" => Some(Box::new(Native::new(info.form?))),
        #[cfg(feature = "rapier")]
        "rapier" => crate::rapier::engine(info),
        #[cfg(feature = "python")]
        "mujoco" | "exudyn" => crate::python::engine(info),
        #[cfg(feature = "crossval")]
        "simbody" | "ida" => crate::solvers::engine(info),
        _ => None,
    }
}

/// Returns the facts of the engines of this project that this build lacks.
pub fn lacking() -> impl Iterator<Item = &'static EngineInfo<'static>> {
    known().filter(|info| make(info).is_none())
}

/// Returns what adds an engine that this build lacks; `None` for engines of every build.
#[must_use]
pub fn remedy(info: &EngineInfo<'_>) -> Option<String> {
    let feature = info.feature?;
    // Where a Python holds us, its packages are the engines; one command installs all that are not here.
    #[cfg(all(feature = "python", not(feature = "crossval")))]
    if crate::python::requirement(info.package).is_some() {
        let pins = lacking().filter_map(|info| crate::python::requirement(info.package));
        let pins: std::collections::BTreeSet<String> = pins.collect();
        let pins: Vec<String> = pins.into_iter().collect();
        return Some(format!("pip install {}", pins.join(" ")));
    }
    Some(format!("build with --features {feature}"))
}

/// Returns all engines of this build, native first, then the solvers that joined ([`admit`](crate::external::admit)).
#[must_use]
pub fn registry() -> Vec<Box<dyn Engine>> {
    known().filter_map(make).chain(admitted()).collect()
}

/// Returns the engine of a name; `native` is the native solver in the formulation that the scene asks for.
#[must_use]
pub fn by_name(name: &str, scene: &Scene) -> Option<Box<dyn Engine>> {
    if name == "native" {
        return Some(Box::new(Native::of(scene)));
    }
    let name = full_name(name);
    registry().into_iter().find(|engine| engine.name() == name)
}

/// Returns the name of an engine that pages and terminals call by its short one; a solver that joined by that name comes
/// first.
#[must_use]
pub fn full_name(name: &str) -> &str {
    if admitted().any(|engine| engine.name() == name) {
        return name;
    }
    let short = known().find(|info| info.short == name);
    short.map_or(name, |info| info.name)
}
