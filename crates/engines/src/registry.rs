//! Engines of this build, created by their families.

use std::collections::{BTreeMap, BTreeSet};

use pinwheel_scene::Scene;

use crate::engine::Engine;
use crate::external::admitted;
use crate::info::EngineInfo;
use crate::known::known;
use crate::native::Native;

/// Makes an engine; `None` if this build or this Python lacks it.
fn make(info: &'static EngineInfo<'static>) -> Option<Box<dyn Engine>> {
    match info.family() {
        "native" => Some(Box::new(Native::new(info.form?))),
        #[cfg(feature = "rapier")]
        "rapier" => crate::rapier::engine(info),
        #[cfg(feature = "python")]
        "mujoco" | "exudyn" => crate::python::engine(info),
        #[cfg(feature = "crossval")]
        _ => crate::solvers::engine(info),
        #[cfg(not(feature = "crossval"))]
        _ => None,
    }
}

/// Returns the facts of the engines of this project that this build lacks.
pub fn lacking() -> impl Iterator<Item = &'static EngineInfo<'static>> {
    known().filter(|info| make(info).is_none())
}

/// Returns the command that adds an engine missing in this build; `None` for engines of every build.
pub fn remedy(info: &EngineInfo<'_>) -> Option<String> {
    let feature = info.feature?;
    // Inside a Python process its packages are the engines; one command installs all missing ones.
    #[cfg(all(feature = "python", not(feature = "crossval")))]
    if crate::python::requirement(info.package).is_some() {
        let pins = lacking().filter_map(|info| crate::python::requirement(info.package));
        let pins: BTreeSet<String> = pins.collect();
        let pins: Vec<String> = pins.into_iter().collect();
        return Some(format!("pip install {}", pins.join(" ")));
    }
    Some(format!(
        "in Pinwheel's folder: `cargo install --path crates/cli --features {feature}`"
    ))
}

/// Returns the missing parts of an engine on this machine, with the command that installs them; `None` if it runs now.
pub fn needs(info: &EngineInfo<'_>) -> Option<String> {
    match info.family() {
        #[cfg(feature = "crossval")]
        "mujoco" | "exudyn" => crate::python::ENGINES.needs(),
        #[cfg(feature = "crossval")]
        _ => crate::solvers::needs(info),
        #[cfg(not(feature = "crossval"))]
        _ => None,
    }
}

/// Returns the additions that provide the engines missing in this build, each with their families.
pub fn remedies() -> BTreeMap<String, BTreeSet<&'static str>> {
    let mut all = BTreeMap::<_, BTreeSet<_>>::new();
    for info in lacking() {
        let of = remedy(info).unwrap_or_default();
        all.entry(of).or_default().insert(info.family());
    }
    all
}

/// Returns all engines of this build, native first, then added solvers ([`admit`](crate::external::admit)).
pub fn registry() -> Vec<Box<dyn Engine>> {
    known().filter_map(make).chain(admitted()).collect()
}

/// Returns an engine by name; `native` is the native solver in the scene's formulation.
pub fn by_name(name: &str, scene: &Scene) -> Option<Box<dyn Engine>> {
    if name == "native" {
        return Some(Box::new(Native::of(scene)));
    }
    let name = full_name(name);
    registry().into_iter().find(|engine| engine.name() == name)
}

/// Returns the full name of an engine from its short one; an added solver of that name takes precedence.
pub fn full_name(name: &str) -> &str {
    if admitted().any(|engine| engine.name() == name) {
        return name;
    }
    let short = known().find(|info| info.short == name);
    short.map_or(name, |info| info.name)
}
