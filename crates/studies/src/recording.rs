//! Recordings: stored time series of engines that need Python or a compiler, for builds and machines without them.

use std::path::Path;

use std::time::Duration;

use pinwheel_compare::uncertainty::{RecordedUncertainty, Source};
use pinwheel_compare::{Participant, RESOLUTION, uncertainties};
use pinwheel_engines::recorded::{
    RECORDED_SCENES, Recording, may_be_missing, thinned, worth_keeping,
};
use pinwheel_engines::{Engine, registry};
use pinwheel_scene::{CheckedScene, Scene};
use pinwheel_timeseries::Ending;

use crate::StudyError;
use crate::choice;
use crate::comparison::{Effort, context, refine};
use crate::control::{Control, Progress, compile};
use crate::file;
use crate::output::{OutputError, file_name};
use crate::provenance::Provenance;

/// Returns the named scenes (presets or files), or all recorded ones.
///
/// # Errors
/// A scene that cannot be read.
pub fn scenes(names: &[String]) -> Result<Vec<CheckedScene>, StudyError> {
    let load = |name: &str| Scene::load(name, &[]).map_err(StudyError::from);
    if names.is_empty() {
        return RECORDED_SCENES.into_iter().map(load).collect();
    }
    names.iter().map(|name| load(name)).collect()
}

/// Returns the named engines, or all that may be missing elsewhere.
///
/// # Errors
/// An engine that this build does not have.
pub fn engines(names: &[String], scene: &Scene) -> Result<Vec<Box<dyn Engine>>, StudyError> {
    if !names.is_empty() {
        let named = names.iter().map(|name| choice::find(name.trim(), scene));
        return Ok(named.collect::<Result<_, _>>()?);
    }
    let mut engines = registry();
    engines.retain(|engine| may_be_missing(engine.name()));
    Ok(engines)
}

/// Result of one recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Recorded {
    /// Stored recording.
    Kept {
        /// Number of samples.
        samples: usize,
        /// Size of description and time series, bytes.
        bytes: usize,
    },
    /// Omitted recording with its reason, for example an unsupported scene.
    Left(String),
    /// Failed recording with its reason.
    Broken(String),
}

/// Runs `engine` on `scene` and stores the time series, thinned and rounded, in `out/SCENE/ENGINE.toml` and `.csv`.
///
/// # Errors
/// Cancelled, or a file that cannot be written.
pub fn record(
    engine: &dyn Engine,
    scene: &Scene,
    out: &Path,
    control: &Control<'_>,
) -> Result<Recorded, StudyError> {
    let label = format!("{} {}", scene.name, engine.name());
    if let Err(reason) = worth_keeping(engine.name(), scene) {
        return Ok(Recorded::Left(reason));
    }
    let path = out.join(file_name(&scene.name)).join(engine.name());
    let [description, csv] = ["toml", "csv"].map(|ending| path.with_extension(ending));
    for path in [&description, &csv] {
        file::check(path, &is_ours)?;
    }
    let (participant, uncertainty) = refined(engine, scene, &label, control)?;
    let reason = format!("{} {}", engine.name(), participant.status);
    match participant.status {
        Ending::Finished if participant.cost.recorded.is_none() => {}
        Ending::Finished | Ending::Failed { .. } | Ending::Absent { .. } => {
            return Ok(Recorded::Broken(reason));
        }
        _ => return Ok(Recorded::Left(reason)),
    }
    let (cost, series) = (participant.cost, participant.time_series);
    let mut recording = Recording::new(engine, scene, cost, series, uncertainty);
    let (name, engine) = (&scene.name, engine.name());
    let origin = Provenance::here(format!("pinwheel record {name} --engines {engine}"));
    recording.machine = origin.machine.named();
    recording.date = origin.date;
    recording.command = origin.command;
    let written = recording.write();
    let (text, rows) = written.map_err(|error| OutputError::new(&path, &error))?;
    let bytes = text.len() + rows.len();
    // The time series is written first: without a description it is no recording.
    file::replace_all(&[(csv, rows), (description, text)], &is_ours)?;
    Ok(Recorded::Kept {
        samples: recording.time_series.len(),
        bytes,
    })
}

/// True for a description or time series written by [`record`].
fn is_ours(content: &[u8]) -> bool {
    content.starts_with(b"engine = ") || content.starts_with(b"time_s,")
}

/// Runs an engine with refinement; returns the thinned run with its uncertainties.
fn refined(
    engine: &dyn Engine,
    scene: &Scene,
    label: &str,
    control: &Control<'_>,
) -> Result<(Participant, Vec<RecordedUncertainty>), StudyError> {
    let effort = Effort {
        longest: Duration::MAX,
        obey: true,
        resolution: RESOLUTION,
    };
    let (gearbox, context) = (compile(scene)?, context(scene));
    let at = Progress::new(0, 1, label);
    let (mut participant, mut evidence) = refine(engine, &gearbox, &context, effort, at, control)?;
    if !participant.status.is_finished() {
        return Ok((participant, Vec::new()));
    }
    participant.time_series = thinned(&participant.time_series, scene);
    if let Source::Refinement(ladder) = &mut evidence.source {
        for run in ladder.coarser.iter_mut().flat_map(|level| &mut level.run) {
            *run = thinned(run, scene);
        }
    }
    // Half of the last stored digit.
    let rounding = 0.5 * 10_f64.powi(1 - i32::try_from(engine.info().digits).unwrap_or(i32::MAX));
    let evidence = evidence.with_floor(rounding);
    let known = uncertainties(&context, &participant, &evidence).into_iter();
    let known = known.filter(|(_, known)| known.l2.u().is_some());
    let recorded = known.map(|(window, known)| known.to_record(&window));
    Ok((participant, recorded.collect()))
}
