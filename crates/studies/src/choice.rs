//! Engines by their names.

use pinwheel_engines::{
    Engine, SharedModel, by_name, family, full_name, known, needs, recorded, registry, remedy,
};
use pinwheel_scene::{Scene, did_you_mean};

/// Reason why a name gives no engine.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ChoiceError {
    /// Unknown name.
    #[error("there is no engine `{name}`; {remedy}")]
    Unknown {
        /// Name as typed.
        name: String,
        /// Names that could be meant.
        remedy: String,
    },
    /// Known engine that this build does not have.
    #[error(
        "engine `{name}` is missing: this build has none of its kind; {remedy}, or see `pinwheel engines`"
    )]
    NotBuilt {
        /// Name as typed.
        name: String,
        /// Command or option that adds it.
        remedy: String,
    },
    /// Engine named twice.
    #[error("--engines names {0} twice; name each engine once")]
    Twice(String),
}

/// Returns the engine with the name or short name `name`. `native` is the native engine in the scene's formulation.
///
/// # Errors
/// An unknown name, or an engine that was not built in.
pub fn find(name: &str, scene: &Scene) -> Result<Box<dyn Engine>, ChoiceError> {
    by_name(name, scene).ok_or_else(|| {
        let (registry, name) = (registry(), full_name(name).to_owned());
        let kin = |of: &str| family(of) == family(&name);
        let left_out = known().find(|info| kin(info.name));
        let left_out = left_out.and_then(remedy);
        if let Some(remedy) = left_out.filter(|_| !registry.iter().any(|e| kin(e.name()))) {
            return ChoiceError::NotBuilt { name, remedy };
        }
        let mut known = vec!["native"];
        known.extend(registry.iter().map(|engine| engine.name()));
        let remedy = match name.ends_with(".toml") {
            true => format!("a solver of your own joins by `--solver {name}`"),
            false => did_you_mean(&name, &known),
        };
        ChoiceError::Unknown { name, remedy }
    })
}

/// Returns the engine `name`, or its recording of `scene` if this build lacks the engine.
///
/// # Errors
/// Errors of [`find`], if there is no recording either.
pub fn find_or_recorded(name: &str, scene: &Scene) -> Result<Box<dyn Engine>, ChoiceError> {
    find(name, scene)
        .or_else(|missing| recorded::in_place_of_lacking(full_name(name), scene).ok_or(missing))
}

/// Returns the engines in `names`; without names all engines of this build, and recordings of those that it lacks.
///
/// # Errors
/// Errors of [`find_or_recorded`], or an engine that is named twice.
pub fn engines(
    names: &[impl AsRef<str>],
    scene: &Scene,
) -> Result<Vec<Box<dyn Engine>>, ChoiceError> {
    if names.is_empty() {
        let mut engines = registry();
        engines.extend(recorded::missing(scene));
        return Ok(engines);
    }
    let names = names.iter().map(|name| name.as_ref().trim());
    distinct(names.map(|name| find_or_recorded(name, scene)))
}

/// Returns the engines of several choices.
///
/// # Errors
/// First failed choice, or an engine that is chosen twice.
pub fn distinct(
    chosen: impl Iterator<Item = Result<Box<dyn Engine>, ChoiceError>>,
) -> Result<Vec<Box<dyn Engine>>, ChoiceError> {
    let mut engines: Vec<Box<dyn Engine>> = Vec::new();
    for engine in chosen {
        let engine = engine?;
        if engines.iter().any(|other| other.name() == engine.name()) {
            return Err(ChoiceError::Twice(engine.name().to_owned()));
        }
        engines.push(engine);
    }
    Ok(engines)
}

/// Entry of an engine of this build in a list.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Listed {
    /// Name for users.
    pub name: String,
    /// Parts of the model that the engine shares with the native solver.
    pub track: SharedModel,
    /// Version of the engine's program.
    pub version: String,
    /// Description in one line.
    pub summary: String,
    /// Differences from the native solver.
    pub differences: String,
    /// Missing part without which the engine does not run here; `None` if it runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub needs: Option<String>,
}

/// Returns the engines of this build.
pub fn listed() -> Vec<Listed> {
    let one = |engine: &dyn Engine| {
        let info = engine.info();
        Listed {
            name: info.name.to_owned(),
            track: info.track,
            version: engine.version(),
            summary: info.summary.to_owned(),
            differences: info.differences.to_owned(),
            needs: needs(&info),
        }
    };
    registry().iter().map(|engine| one(&**engine)).collect()
}
