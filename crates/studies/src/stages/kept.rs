//! Search for a cause in runs of which only columns or figures were stored, without states.

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Layout, Start};
use pinwheel_timeseries::{TimeSeries, columns};

use super::cause::{Values, cause};
use super::judged::{Judged, SURE, Stage};
use super::locate::{Located, Runs, locate};
use super::model::{Model, Work};
use super::suspects::Suspect;
use super::{forces, motion, states};

/// Stored figures of a run from the scene's start.
pub(crate) struct Kept<'a> {
    /// Name of the engine.
    pub name: &'a str,
    /// Times of the samples, s.
    pub times_s: &'a [f64],
    /// Stored figures, each as a share of its quantity's size.
    pub written: &'a [f64],
    /// Root mean square change of the figures that counts as none.
    pub bound: f64,
    /// Largest number of force evaluations for the judgement.
    pub evaluations: u64,
}

/// Searches for the cause that explains the stored figures of a run. `figures` evaluates them from columns at the run's
/// samples. Returns `None` if they equal those of the native model, or the model has no reduced form.
pub(crate) fn of_kept(
    gearbox: &Gearbox,
    kept: &Kept<'_>,
    figures: &dyn Fn(&TimeSeries) -> Vec<f64>,
) -> Option<Located> {
    let work = &Work::new(gearbox, kept.evaluations);
    let mut native = Model::new(work, Vec::new())?;
    let begun = native.start();
    let is_at_rest = gearbox.scene.drive.start != Start::Kinematic;
    let values: Values<'_> = &|model: &mut Model<'_>| {
        let start = if is_at_rest {
            begun.clone()
        } else {
            model.start()
        };
        Some(figures(&followed(gearbox, model, kept.times_s, &start)?))
    };
    let base = values(&mut native)?;
    let off = kept.written.iter().zip(&base).map(|(a, b)| (a - b).powi(2));
    let off = (off.sum::<f64>() / base.len() as f64).sqrt();
    if off <= kept.bound {
        return None;
    }
    let cause = cause(work, [kept.written, &base], SURE, Suspect::moves, values);
    let cause = cause.map(|(cause, _)| cause);
    let columns = states::Columns::of(gearbox, native.free()).patterns();
    let note = format!("states were not stored; needs {}", columns.join(", "));
    let stage = |stage| match &cause {
        Some(cause) if cause.stage() == Some(stage) => {
            Judged::measured(stage, off, kept.bound, "over the whole run".to_owned())
        }
        _ => Judged::unknown(stage, &note),
    };
    Some(Located {
        run: kept.name.to_owned(),
        stages: Stage::ALL.map(stage).into(),
        cause,
        evaluations: [work.taken(), kept.evaluations],
        ..Located::default()
    })
}

/// Returns the columns of a model at `times`, from a state at the first one.
fn followed(
    gearbox: &Gearbox,
    model: &mut Model<'_>,
    times_s: &[f64],
    start: &[f64],
) -> Option<TimeSeries> {
    model.by_differences = true;
    let states = model.follow(*times_s.first()?, start, times_s)?;
    let output = model
        .free()
        .iter()
        .position(|&body| body == Layout::OUTPUT)?;
    let angle = states.iter().map(|y| y[output]).collect();
    let rows = forces::rows(model, &motion::numbered(times_s, states));
    let mut run = TimeSeries::new(times_s.to_vec()).ok()?;
    run.push(columns::OUTPUT_ANGLE, angle).ok()?;
    for (k, name) in forces::names(gearbox.layout).into_iter().enumerate() {
        run.push(name, rows.iter().map(|row| row[k]).collect())
            .ok()?;
    }
    Some(run)
}

/// Relative change of a record's columns that counts as none, because records are rounded and interpolated.
const RECORD: f64 = 1e-3;
/// Largest number of evaluations for a record, some tenths of a second, and number of its first samples that are judged.
pub(super) const RECORDED: u64 = 150_000;
const SHOWN: usize = 60;
/// Number of model runs in the search for a cause, and the least number of samples that distinguishes causes.
const FOLLOWS: u64 = 100;
const FEWEST: usize = 12;

/// Judges a record with all columns of a gear, by its states if it has them. A stage is named only for a known cause.
pub(super) fn of_record(
    gearbox: &Gearbox,
    name: &str,
    record: &TimeSeries,
    evaluations: u64,
) -> Option<Located> {
    let states = states::Columns::native(gearbox)?;
    let names = forces::names(gearbox.layout);
    let of: Option<Vec<&[f64]>> = names.iter().map(|name| record.channel(name)).collect();
    let of = of?;
    let is_known = |row: &usize| of.iter().all(|column| column[*row].is_finite());
    let rows: Vec<usize> = (0..record.len()).filter(is_known).collect();
    let run = record.select(&rows);
    if states.missing(&run).is_empty() {
        let runs = Runs {
            name,
            run: &run,
            finer: None,
            evaluations: [evaluations; 2],
        };
        let place = locate(gearbox, runs)?;
        let mut cause = place.cause.iter();
        return cause.any(|cause| cause.explained >= SURE).then_some(place);
    }
    let times = run.time_s().get(..run.len().min(SHOWN))?;
    (*times.first()? == 0.0).then_some(())?;
    // The evaluations limit the number of samples.
    let work = Work::new(gearbox, evaluations);
    let mut native = Model::new(&work, Vec::new())?;
    let begun = native.start();
    followed(gearbox, &mut native, times, &begun)?;
    let most = work.left() / FOLLOWS * times.len() as u64 / work.taken().max(1);
    let times = &times[..times.len().min(FEWEST.max(most as usize))];
    let evaluations = work.left();
    // Torques and forces have equal weight.
    let size = |column: &&[f64]| column.iter().fold(0.0, |most: f64, x| x.abs().max(most));
    let sizes: Vec<f64> = of.iter().map(size).collect();
    let force = sizes[forces::FORCES..].iter().copied().fold(0.0, f64::max);
    let figures = |run: &TimeSeries| -> Vec<f64> {
        let column = |(k, name): (usize, &String)| {
            let size = if k < forces::FORCES { sizes[k] } else { force };
            let values = run.channel(name).unwrap_or_default().iter();
            let shares = values.take(times.len()).map(move |value| value / size);
            shares.collect::<Vec<_>>()
        };
        names.iter().enumerate().flat_map(column).collect()
    };
    let (written, bound) = (&figures(&run)[..], RECORD);
    let kept = Kept {
        name,
        times_s: times,
        written,
        bound,
        evaluations,
    };
    of_kept(gearbox, &kept, &figures).filter(|place| place.cause.is_some())
}
