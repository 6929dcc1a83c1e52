//! One run on a terminal.

use crate::format::{self, NONE, joined};
use crate::terminal::{pairs, titled};
use pinwheel_gearbox::Efficiency;
use pinwheel_studies::band::{Band, Bands};
use pinwheel_studies::results::{Figure, Results};
use pinwheel_studies::single::Outcome;
use pinwheel_timeseries::columns;

use crate::pages::band;
use crate::pages::figure::{bounded, bounds, rounded};

/// A figure, `factor` times, with its uncertainty.
fn known(figure: &Figure, factor: f64) -> String {
    let uncertainty = figure.uncertainty.map(|u| factor * u);
    let [value, off] = bounded(factor * figure.value, uncertainty);
    match figure.is_off_by_sampling() {
        _ if off.is_empty() => value,
        true => format!("{value} {off} (sampling)"),
        false => format!("{value} {off}"),
    }
}

/// Peak and mean of forces, with the digits that contact laws leave them.
fn forces(peak: &Figure, mean: Option<&Figure>, laws: Option<&Band>) -> String {
    let of = |figure: &Figure| laws.map(|band| band.of_own_law.map(|share| share * figure.value));
    let mean = mean.map_or_else(
        || NONE.to_owned(),
        |mean| of(mean).map_or_else(|| known(mean, 1.0), |laws| rounded(mean.value, laws)),
    );
    let peak = match of(peak) {
        None => format!("{} N", known(peak, 1.0)),
        Some(laws) => {
            let cause = match peak.is_off_by_sampling() {
                true => "by sampling",
                false => "numerical",
            };
            let value = rounded(peak.value, laws);
            let [_, off] = bounded(peak.value, peak.uncertainty);
            let bounds = bounds(Some(laws), &off, cause);
            format!("{value} N ({bounds})")
        }
    };
    format!("peak {peak}, mean {mean} N")
}

/// Results of a run, in words.
fn results(found: &Results, bands: Option<&Bands>, looked: bool) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    let torque = columns::INPUT_TORQUE;
    if let Some(mean) = found.get(&format!("mean_{torque}")) {
        let [least, most] = ["min", "max"].map(|end| {
            let figure = found.get(&format!("{end}_{torque}"));
            figure.map_or_else(|| NONE.to_owned(), |figure| known(figure, 1.0))
        });
        let (mean, from_s) = (known(mean, 1.0), format::plain(found.from_s));
        let said = format!("mean {mean} N m; {least} to {most}, from {from_s} s on");
        rows.push(("driver torque", said));
    }
    for (label, group) in [
        ("external forces", columns::EXTERNAL_FORCE),
        ("internal forces", columns::INTERNAL_FORCE),
    ] {
        if let Some(peak) = found.get(&format!("peak_{group}")) {
            let mean = found.get(&format!("mean_{group}"));
            let laws = bands.and_then(|bands| bands.get(band::key_of_peak(group)?));
            rows.push((label, forces(peak, mean, laws)));
        }
    }
    match (&found.efficiency_reason, found.get("efficiency")) {
        (Some(reason), _) => rows.push(("efficiency", reason.clone())),
        (None, Some(share)) => {
            let said = format!("{} % by what is lost", known(share, 100.0));
            rows.push(("efficiency", said));
        }
        (None, None) => {}
    }
    let causes = ["contacts", "bearings", "sleeves on pins", "seals"];
    let lost = causes.into_iter().zip(Efficiency::CAUSES);
    let lost = lost.filter_map(|(cause, name)| {
        let share = known(found.get(name)?, 100.0);
        Some(format!("{cause} {share} %"))
    });
    let lost = joined(", ", lost);
    if !lost.is_empty() {
        rows.push(("friction", lost));
    }
    if !rows.is_empty() {
        let how = match found.uncertainty {
            "verified" => "\u{b1}: by the run's own verification, see its note",
            "estimated" => "\u{b1}: estimated from one more run, see resolution",
            _ if looked => {
                "not known: too few samples to tell, resolution says how far forces move; give a smaller solver.sample_s"
            }
            _ => "not verified: the run was made once, how far its figures may be off is not known",
        };
        let mut how = how.to_owned();
        if found.figures.iter().any(Figure::is_off_by_sampling) {
            how += "; (sampling): mostly by what lies between samples, less with a smaller solver.sample_s";
        }
        rows.push(("numerical error", how));
    }
    rows
}

/// Results, settings and cost of a run that finished; `time_series`: where its samples are, if in a file.
#[must_use]
pub fn text(found: &Outcome, time_series: Option<&str>) -> String {
    let stats = &found.run.stats;
    // What one runs it for comes first.
    let bands = found.bands.as_ref();
    let mut rows = results(&found.results(), bands, found.resolution.is_some());
    rows.extend(bands.into_iter().flat_map(band::rows));
    let track = found.track.as_str();
    let (samples, end_s) = (found.run.time_series.len(), found.scene.solver.duration_s);
    let time = format!("{:.3} s wall, {:.3} s CPU", stats.wall_s, stats.cpu_s);
    let steps = format!("{}, {} contact evaluations", stats.steps, stats.rhs_calls);
    let freedom = format!("{} velocities integrated", stats.degrees_of_freedom);
    rows.extend([
        (
            "engine",
            format!("{} {} ({track})", found.engine, found.version),
        ),
        ("settings", stats.settings.clone()),
        ("samples", format!("{samples}, to {end_s} s")),
        ("time", time),
        ("steps", steps),
        ("freedom", freedom),
    ]);
    if let Some(resolution) = &found.resolution {
        rows.push(("resolution", resolution.sentence()));
    }
    rows.extend(stats.notes.iter().map(|note| ("note", note.clone())));
    rows.extend(time_series.map(|place| ("courses", place.to_owned())));
    rows.retain(|(_, said)| !said.is_empty());
    titled(&found.scene.name, [pairs(rows)])
}
