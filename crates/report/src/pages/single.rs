//! Page and terminal text of a run.

use crate::figure::{self, cell, sentence};
use crate::format::{self, NONE, joined};
use crate::study::{Block, Decision, Fact, Mark, Question, Section, Study, Tone, Verdict};
use crate::terminal::{pairs, titled};
use pinwheel_compare::{Context, Cost, Participant, Rules, Status, compare};
use pinwheel_studies::Provenance;
use pinwheel_studies::results::Results;
use pinwheel_studies::single::Outcome;
use pinwheel_timeseries::columns;
use pinwheel_timeseries::figure::Figure;
use pinwheel_timeseries::figure::definitions::{FRICTION, SHARE_DELIVERED};

use crate::pages::design::bears;
use crate::pages::{DOUBT, animation, band, doubts, time_series};

/// Returns the results of a run as text.
fn results(results: &Results, looked: bool) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    let of = |kind: &str, quantity: &str| {
        let figure = results.statistic(kind, quantity);
        figure.map_or_else(|| NONE.to_owned(), cell)
    };
    let torque = columns::INPUT_TORQUE;
    if results.statistic("mean", torque).is_some() {
        let [mean, least, most] = ["mean", "min", "max"].map(|kind| of(kind, torque));
        let from = format::seconds(results.from_s);
        let text = format!("mean {mean} N m; {least} to {most}, from {from} on");
        rows.push(("driver torque", text));
    }
    for (label, group) in [
        ("external forces", columns::EXTERNAL_FORCE),
        ("internal forces", columns::INTERNAL_FORCE),
    ] {
        if let Some(peak) = results.statistic("peak", group) {
            let (peak, mean) = (sentence(peak), of("mean", group));
            rows.push((label, format!("peak {peak}, mean {mean} N")));
        }
    }
    let percent = |share: &Figure| cell(&share.scaled(100.0, "%"));
    if let Some(share) = results.get(&SHARE_DELIVERED) {
        let text = || format!("{} % {}", percent(share), share.def.how);
        rows.push(("efficiency", share.withheld.clone().unwrap_or_else(text)));
    }
    let lost = FRICTION.iter().filter_map(|def| results.get(def));
    let lost = lost.map(|share| format!("{} {} %", share.def.label, percent(share)));
    let lost = joined(", ", lost);
    if !lost.is_empty() {
        rows.push(("friction", lost));
    }
    if !rows.is_empty() {
        let how = match results.uncertainty {
            "verified" => "\u{b1}: by the run's own verification, see its note",
            "estimated" => "\u{b1}: estimated from one more run, see resolution",
            _ if looked => {
                "not known: too few samples to tell, resolution says how far forces move; give a smaller solver.sample_s"
            }
            _ => "not verified: the run was made once, how far its figures may be off is not known",
        };
        let mut how = how.to_owned();
        if results.figures.iter().any(Figure::is_off_by_sampling) {
            how += "; (sampling): mostly by what lies between samples, less with a smaller solver.sample_s";
        }
        rows.push(("numerical error", how));
    }
    rows
}

/// Returns results, settings and cost of a finished run; `time_series`: path of its samples, if in a file.
pub fn text(outcome: &Outcome, figures: &Results, time_series: Option<&str>) -> String {
    // Results come before settings.
    let mut rows = results(figures, outcome.resolution.is_some());
    rows.extend(settings(outcome));
    rows.extend(time_series.map(|place| ("courses", place.to_owned())));
    rows.retain(|(_, text)| !text.is_empty());
    titled(&outcome.scene.name, [pairs(rows)])
}

/// Returns the page: answers, gear in motion, and time series.
pub fn page(outcome: &Outcome, results: &Results, origin: &Provenance) -> String {
    let share = results.get(&SHARE_DELIVERED);
    let share = share.map(|share| share.scaled(100.0, "%"));
    let forces = results.figures.iter();
    let is_head = |one: &&Figure| {
        let mut keys = ["mean_input", "peak_"].iter();
        keys.any(|key| one.def.key.starts_with(key))
    };
    let heads = forces.filter(is_head).chain(&share);
    let facts = settings(outcome).into_iter();
    let facts = facts.filter(|(_, text)| !text.is_empty());
    let facts = facts.map(|(label, text)| Fact::new(label, Mark::warn(label == DOUBT), text));
    let over_time = time_series(outcome);
    let over_time = over_time.map(|drawn| Section::new("courses", "Over time").with(drawn));
    let every = figure::table("Figures", &results.figures, figure::how);
    let bands = outcome.bands.iter().flat_map(band::blocks);
    let figures = Section::new("figures", "Figures").with(every);
    let figures = figures.with(bands.collect::<Vec<_>>());
    let study = Study {
        title: outcome.scene.name.clone(),
        eyebrow: format!("Pinwheel run, by {}", outcome.engine),
        lead: outcome.scene.description.clone(),
        verdict: outcome.diverged().map(|headline| Verdict {
            tone: Tone::Bad,
            headline,
            detail: "Shown is what there is until then.".to_owned(),
        }),
        decision: decision(outcome, heads.clone(), origin),
        tiles_title: format!("from {} on", format::seconds(results.from_s)),
        tiles: heads.map(figure::tile).collect(),
        below: vec![
            Block::heading("How it was computed"),
            Block::Facts(facts.collect()),
        ],
        aside: animation::aside(outcome.motion.as_ref()),
        sections: over_time.into_iter().chain([figures]).collect(),
        ..Study::default()
    };
    crate::pages::render(study, origin)
}

fn decision<'a>(
    outcome: &Outcome,
    heads: impl Iterator<Item = &'a Figure>,
    origin: &Provenance,
) -> Decision {
    let (mark, why) = match &outcome.resolution {
        Some(resolution) => (Mark::warn(!resolution.holds()), resolution.sentence()),
        None => (Mark::Warn, "one engine alone".to_owned()),
    };
    let right = Question::Right.answered(mark, "not compared", why);
    let bears = outcome.limits.as_ref().map(bears);
    let next = crate::pages::next(origin, "compare", "whether other engines agree");
    [Some(right), bears, crate::pages::sure(heads), Some(next)]
}

/// Returns the time series in the layout of a comparison with one engine.
fn time_series(outcome: &Outcome) -> Option<Block> {
    let participant = Participant {
        name: outcome.engine.clone(),
        track: outcome.track,
        version: outcome.version.clone(),
        summary: String::new(),
        differences: String::new(),
        time_series: outcome.run.time_series.clone(),
        cost: Cost::default(),
        status: Status::Finished,
    };
    let context = Context {
        scene: outcome.scene.name.clone(),
        duration_s: outcome.scene.solver.duration_s,
        ..Context::default()
    };
    let all = [participant];
    let alone = compare(&context, &all, &Rules::default()).ok()?;
    time_series::block(&alone, &all, false)
}

/// Returns facts on the computation of a run, and on the bounds of its figures.
fn settings(outcome: &Outcome) -> Vec<(&'static str, String)> {
    let stats = &outcome.run.stats;
    let mut rows = Vec::from_iter(outcome.bands.iter().flat_map(band::rows));
    rows.extend(doubts(&outcome.scene));
    let engine = format!("{} {} ({})", outcome.engine, outcome.version, outcome.track);
    let samples = outcome.run.time_series.len();
    let end_s = format::plain(outcome.scene.solver.duration_s);
    let time = format!("{:.3} s wall, {:.3} s CPU", stats.wall_s, stats.cpu_s);
    let steps = format!("{}, {} contact evaluations", stats.steps, stats.rhs_calls);
    let freedom = format!("{} velocities integrated", stats.degrees_of_freedom);
    rows.extend([
        ("engine", engine),
        ("settings", stats.settings.clone()),
        ("samples", format!("{samples}, to {end_s} s")),
        ("time", time),
        ("steps", steps),
        ("freedom", freedom),
    ]);
    if let Some(resolution) = &outcome.resolution {
        rows.push(("resolution", resolution.sentence()));
    }
    rows.extend(stats.notes.iter().map(|note| ("note", note.clone())));
    rows
}
