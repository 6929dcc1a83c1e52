//! Engines with their own contacts, each against a native run with equal contacts, its twin.

use pinwheel_compare::{Comparison, Participant, SharedModel, Verdict, WindowKind};
use pinwheel_engines::{Engine, Native, OwnContact, known};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;
use pinwheel_timeseries::figure::FigureDef;
use pinwheel_timeseries::{TimeSeries, columns, stem_and_unit};
use serde::Serialize;

use crate::control::{Progress, compile};
use crate::{Control, StudyError};

/// Figure of an engine, its twin and the scene's own law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TwinFigure {
    /// Definition.
    #[serde(flatten)]
    pub def: FigureDef,
    /// Value of the engine.
    pub engine: f64,
    /// Value of the native solver with the engine's contacts, at the engine's samples.
    pub twin: f64,
    /// Value of the native solver with the scene's law.
    pub scene: f64,
}

impl TwinFigure {
    /// Returns the relative difference of engine and twin.
    pub fn difference(&self) -> f64 {
        self.engine / self.twin - 1.0
    }

    /// Returns the relative difference between the engine's contacts and the scene's law.
    pub fn of_law(&self) -> f64 {
        self.twin / self.scene - 1.0
    }
}

/// Engine with its twin.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MatchedContactRun {
    /// Name of the engine.
    pub engine: String,
    /// Contacts of the engine in words.
    pub contacts: String,
    /// Peaks of the forces and the mean driver torque.
    pub figures: Vec<TwinFigure>,
    /// Largest permitted relative difference of engine and twin.
    pub tolerance: f64,
    /// Verdict: *agree* within the tolerance; *inconclusive* if the twin did not finish.
    pub verdict: Verdict,
}

impl MatchedContactRun {
    /// Returns the figure with the largest difference of engine and twin.
    pub fn worst(&self) -> Option<&TwinFigure> {
        let size = |figure: &TwinFigure| figure.difference().abs();
        self.figures
            .iter()
            .max_by(|a, b| size(a).total_cmp(&size(b)))
    }
}

/// Largest value of all channels at a sample, averaged over the window. A single largest sample would include residual
/// vibrations, which every integrator damps differently.
const LARGEST: &str = "largest";

/// Compared figures, each with its kind.
const FIGURES: [(&str, &str, &str); 3] = [
    (
        columns::EXTERNAL_FORCE,
        LARGEST,
        "external force, mean over time",
    ),
    (
        columns::INTERNAL_FORCE,
        LARGEST,
        "internal force, mean over time",
    ),
    (columns::INPUT_TORQUE, "mean", "driver torque"),
];

/// Returns the twins of all own-contact engines that finished.
///
/// # Errors
/// Cancelled.
pub(super) fn of(
    gearbox: &Gearbox,
    comparison: &Comparison,
    participants: &[Participant],
    control: &Control<'_>,
) -> Result<Vec<MatchedContactRun>, StudyError> {
    // A start-up transient depends on each engine's own damping, so the steady window is compared.
    let mut windows = comparison.windows.iter();
    let Some(window) = windows.find(|w| w.kind != WindowKind::Transient) else {
        return Ok(Vec::new());
    };
    let window = (window.from_s, window.to_s);
    let finished = |p: &&Participant| p.track == SharedModel::Native && p.status.is_finished();
    let Some(native) = participants.iter().rfind(finished) else {
        return Ok(Vec::new());
    };
    let mut twins = Vec::new();
    for engine in participants.iter().filter(|p| p.status.is_finished()) {
        let info = known().find(|info| info.name == engine.name);
        let kind = info.map_or(OwnContact::SceneLaw, |info| info.own_contact);
        let Ok(Some(scene)) = kind.twin(gearbox) else {
            continue;
        };
        control.check()?;
        let at = Progress::new(0, 1, &engine.name);
        let Ok(twin_of) = compile(&scene) else {
            continue;
        };
        let run = Native::RESOLVED.run_compiled(&twin_of, &control.piece(at))?;
        let mut twin = MatchedContactRun {
            engine: engine.name.clone(),
            contacts: in_words(kind, &scene),
            figures: Vec::new(),
            tolerance: kind.tolerance(),
            verdict: Verdict::Inconclusive,
        };
        if run.ending.is_finished() {
            let of = |series: &TimeSeries, quantity, of| {
                figure(series, &engine.time_series, quantity, of, window)
            };
            twin.figures = FIGURES
                .iter()
                .filter_map(|&(quantity, kind, what)| {
                    let (key, label) = (format!("{kind}_{quantity}"), format!("{kind} {what}"));
                    Some(TwinFigure {
                        def: FigureDef::named(key, label, stem_and_unit(quantity).1),
                        engine: of(&engine.time_series, quantity, kind)?,
                        twin: of(&run.time_series, quantity, kind)?,
                        scene: of(&native.time_series, quantity, kind)?,
                    })
                })
                .filter(|figure| figure.difference().is_finite())
                .collect();
            let worst = twin.worst().map(|figure| figure.difference().abs());
            twin.verdict = match worst {
                Some(worst) if worst <= twin.tolerance => Verdict::Agree,
                Some(_) => Verdict::Differ,
                None => Verdict::Inconclusive,
            };
        }
        twins.push(twin);
    }
    Ok(twins)
}

fn in_words(kind: OwnContact, scene: &Scene) -> String {
    let contact = &scene.contact;
    match kind {
        OwnContact::SceneLaw => "the scene's law".to_owned(),
        OwnContact::Springs => format!(
            "linear springs of {:.3e} N/m outside and {:.3e} N/m inside",
            contact.external_spring_n_m.unwrap_or_default(),
            contact.internal_spring_n_m.unwrap_or_default()
        ),
        OwnContact::Balls => "beds of springs, as stiff as balls".to_owned(),
    }
}

/// Returns a figure of `series` at the samples of `like` in a window.
fn figure(
    series: &TimeSeries,
    like: &TimeSeries,
    quantity: &str,
    of: &str,
    (from_s, to_s): (f64, f64),
) -> Option<f64> {
    let mut channels = series.group(quantity);
    if channels.is_empty() {
        channels = series.channel(quantity).into_iter().collect();
    }
    let times = series.time_s();
    let (mut sum, mut count) = (0.0, 0_u32);
    let inside = like.time_s().iter();
    for &time in inside.filter(|t| (from_s..=to_s).contains(*t)) {
        let at = times.partition_point(|t| *t < time - 1e-9);
        let values = channels.iter().map(|channel| channel.get(at).copied());
        let values: Vec<f64> = values.collect::<Option<_>>()?;
        sum += match of {
            LARGEST => values
                .iter()
                .fold(0.0, |most: f64, value| most.max(value.abs())),
            _ => values.iter().sum::<f64>() / values.len() as f64,
        };
        count += 1;
    }
    (count > 0).then(|| sum / f64::from(count))
}
