//! Text of one run for a terminal.

use crate::figure::{cell, sentence};
use crate::format::{self, NONE, joined};
use crate::terminal::{pairs, titled};
use pinwheel_studies::results::Results;
use pinwheel_studies::single::Outcome;
use pinwheel_timeseries::columns;
use pinwheel_timeseries::figure::Figure;
use pinwheel_timeseries::figure::definitions::{FRICTION, SHARE_DELIVERED};

use crate::pages::{band, doubts};

/// Returns the results of a run as text.
fn results(found: &Results, looked: bool) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    let of = |kind: &str, quantity: &str| {
        let figure = found.statistic(kind, quantity);
        figure.map_or_else(|| NONE.to_owned(), cell)
    };
    let torque = columns::INPUT_TORQUE;
    if found.statistic("mean", torque).is_some() {
        let [mean, least, most] = ["mean", "min", "max"].map(|kind| of(kind, torque));
        let from_s = format::plain(found.from_s);
        let said = format!("mean {mean} N m; {least} to {most}, from {from_s} s on");
        rows.push(("driver torque", said));
    }
    for (label, group) in [
        ("external forces", columns::EXTERNAL_FORCE),
        ("internal forces", columns::INTERNAL_FORCE),
    ] {
        if let Some(peak) = found.statistic("peak", group) {
            let (peak, mean) = (sentence(peak), of("mean", group));
            rows.push((label, format!("peak {peak}, mean {mean} N")));
        }
    }
    let percent = |share: &Figure| cell(&share.scaled(100.0, "%"));
    if let Some(share) = found.get(&SHARE_DELIVERED) {
        let said = || format!("{} % {}", percent(share), share.def.how);
        rows.push(("efficiency", share.withheld.clone().unwrap_or_else(said)));
    }
    let lost = FRICTION.iter().filter_map(|def| found.get(def));
    let lost = joined(
        ", ",
        lost.map(|share| format!("{} {} %", share.def.label, percent(share))),
    );
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

/// Returns results, settings and cost of a finished run; `time_series`: path of its samples, if in a file.
#[must_use]
pub fn text(found: &Outcome, time_series: Option<&str>) -> String {
    let stats = &found.run.stats;
    // The main results come first.
    let bands = found.bands.as_ref();
    let mut rows = results(&found.results(), found.resolution.is_some());
    rows.extend(bands.into_iter().flat_map(band::rows));
    rows.extend(doubts(&found.scene));
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
