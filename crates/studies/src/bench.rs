//! What accuracy costs: the scene by every engine and method, published mechanisms, cost against size, and gears a second.

use std::path::Path;

use pinwheel_engines::{Engine, Track, by_name, registry};
use pinwheel_scene::Scene;
use serde::Serialize;

use crate::control::Control;
use crate::output::{OutputError, write_with};
use crate::precision::batch::{self, Batch};
use crate::precision::mechanisms::{self, MechanismStudy};
use crate::precision::scaling::{self, Scaling};
use crate::precision::{self, Options, Ranking, WorkPrecision};
use crate::provenance::{Provenance, Summary};
use crate::{StudyError, choice};

/// A part of the measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The scene: error against cost of every engine and method.
    Scene,
    /// Cost against the number of wheels, sleeves and points.
    Scaling,
    /// Error against cost on published mechanisms.
    Mechanisms,
    /// Gears a second and core.
    Batch,
}

/// Everything measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The scene.
    pub scene: Scene,
    /// The scene by every engine and method.
    pub study: Option<WorkPrecision>,
    /// Cost against size.
    pub scaling: Option<Scaling>,
    /// Published mechanisms.
    pub mechanisms: Option<Vec<MechanismStudy>>,
    /// Gears a second.
    pub batch: Option<Batch>,
    /// Names of the engines, and what each is unlike.
    pub unequal: Vec<(String, String)>,
    /// False if the measurement was stopped; what had been measured until then is there.
    pub complete: bool,
}

/// Payload of `summary.json`.
#[derive(Serialize)]
struct Found<'a> {
    /// False if the user stopped the measurement.
    complete: bool,
    scene: &'a Scene,
    #[serde(skip_serializing_if = "Option::is_none")]
    work_precision: Option<&'a WorkPrecision>,
    /// What errors cost, window by window.
    rankings: &'a [Ranking],
    #[serde(skip_serializing_if = "Option::is_none")]
    scaling: Option<&'a Scaling>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mechanisms: Option<&'a [MechanismStudy]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    batch: Option<&'a Batch>,
}

/// The engines named (`native` stands for both its forms); without names both native forms and the peers that solve
/// the same equations.
///
/// # Errors
/// An engine that there is not, or that chooses its own integrator and step.
pub fn engines(names: &[String], scene: &Scene) -> Result<Vec<Box<dyn Engine>>, StudyError> {
    let native = ["native-reduced", "native-lagrange"];
    if names.is_empty() {
        let friction = scene.contact.friction_coefficient > 0.0;
        return Ok(registry()
            .into_iter()
            .filter(|engine| match engine.track() {
                Track::Native => native.contains(&engine.name()),
                Track::SharedLaw => true,
                Track::OwnContact => friction || engine.is_outside(),
                Track::Measured => false,
            })
            .collect());
    }
    let mut engines: Vec<Box<dyn Engine>> = Vec::new();
    let mut add = |engine: Box<dyn Engine>| {
        if engine.track() == Track::Native && !native.contains(&engine.name()) {
            return Err(StudyError::Input(format!(
                "{} chooses its own integrator and step, which is what is varied here; name native, native-reduced \
                 or native-lagrange",
                engine.name()
            )));
        }
        if engines.iter().all(|other| other.name() != engine.name()) {
            engines.push(engine);
        }
        Ok(())
    };
    for name in names {
        if name.trim() == "native" {
            for engine in native.iter().filter_map(|form| by_name(form, scene)) {
                add(engine)?;
            }
        } else {
            add(choice::find(name.trim(), scene)?)?;
        }
    }
    Ok(engines)
}

/// Measures the parts asked for. Stopped after the first, it gives what there is.
///
/// # Errors
/// Stopped before anything was measured; a reference run that fails.
pub fn run(
    scene: &Scene,
    engines: &[Box<dyn Engine>],
    options: &Options,
    parts: &[Part],
    control: &Control<'_>,
) -> Result<Outcome, StudyError> {
    let mut found = Outcome {
        scene: scene.clone(),
        study: None,
        scaling: None,
        mechanisms: None,
        batch: None,
        unequal: engines
            .iter()
            .map(|engine| (engine.name().to_owned(), engine.differences().to_owned()))
            .collect(),
        complete: false,
    };
    let asked = |part: Part| parts.contains(&part) && !control.is_cancelled();
    if parts.contains(&Part::Scene) {
        found.study = Some(precision::run(scene, engines, options, control)?);
    }
    if asked(Part::Mechanisms) {
        found.mechanisms = Some(mechanisms::run(control)?);
    }
    if asked(Part::Scaling) {
        match scaling::run(control) {
            Ok(scaling) => found.scaling = Some(scaling),
            // What was measured before is worth keeping.
            Err(StudyError::Cancelled) => {}
            Err(error) => return Err(error),
        }
    }
    if asked(Part::Batch) {
        match batch::run(scene, options, control) {
            Ok(batch) => found.batch = Some(batch),
            Err(StudyError::Cancelled) => {}
            Err(error) => return Err(error),
        }
    }
    found.complete = !control.is_cancelled();
    if !found.complete && found.study.is_none() && found.mechanisms.is_none() {
        return Err(StudyError::Cancelled);
    }
    Ok(found)
}

impl Outcome {
    /// Rankings of all windows at the target, then of the whole run at ten times and a tenth of it.
    #[must_use]
    pub fn rankings(&self) -> Vec<Ranking> {
        let Some(study) = &self.study else {
            return Vec::new();
        };
        let target = study.options.target;
        let mut rankings: Vec<Ranking> = (0..study.windows.len())
            .map(|window| study.ranking(window, target))
            .collect();
        rankings.extend([10.0 * target, target / 10.0].map(|error| study.ranking(0, error)));
        rankings
    }

    /// Writes `summary.json`, `bench.csv`, `scaling.csv`, `mechanisms.csv` and `batch.csv` of what was measured into the folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, dir: &Path, made: &Provenance) -> Result<(), OutputError> {
        if let Some(study) = &self.study {
            write_with(dir, "bench.csv", |sink| precision::write_csv(study, sink))?;
        }
        if let Some(found) = &self.scaling {
            write_with(dir, "scaling.csv", |sink| scaling::write_csv(found, sink))?;
        }
        if let Some(found) = &self.mechanisms {
            write_with(dir, "mechanisms.csv", |sink| {
                mechanisms::write_csv(found, sink)
            })?;
        }
        if let Some(found) = &self.batch {
            write_with(dir, "batch.csv", |sink| batch::write_csv(found, sink))?;
        }
        let rankings = self.rankings();
        let found = Found {
            complete: self.complete,
            scene: &self.scene,
            work_precision: self.study.as_ref(),
            rankings: &rankings,
            scaling: self.scaling.as_ref(),
            mechanisms: self.mechanisms.as_deref(),
            batch: self.batch.as_ref(),
        };
        Summary::new(made, found).write(dir)
    }
}
