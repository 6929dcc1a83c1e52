//! Fig. 10: another engine in place of Adams, and possible causes of spikes.

use pinwheel_engines::{Engine, SharedModel, by_name, known, recorded};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Detection, Scene};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::rows_at;

use super::figure::{Curve, Measured, number};
use super::read::{DRAWN, EXTERNAL, INTERNAL, STEADY, all, largest, part, peak, times};
use super::runs::{Model, Peer, Runs};
use crate::StudyError;
use crate::choice::find_or_recorded;
use crate::control::{Control, Progress, compile};

/// Returns the named engine, live or else recorded; without a name the first preferred one that is recorded or in this build.
/// `None` if there is none.
///
/// Without a name recordings take precedence, because the Python engines take minutes for this page.
///
/// # Errors
/// Cancelled; an engine that is unknown, has no contacts of its own, or does not finish.
pub fn peer(named: Option<&str>, control: &Control<'_>) -> Result<Option<Peer>, StudyError> {
    let scene = Scene::load("paper", &[])?;
    let gearbox = compile(&scene)?;
    if let Some(name) = named {
        let engine = find_or_recorded(name, &scene)?;
        if engine.track() != SharedModel::OwnContact {
            return Err(StudyError::Input(format!(
                "--against {name}: takes its contact forces from our law; name an own-contact engine of `pinwheel engines`"
            )));
        }
        return run(engine.as_ref(), &gearbox, String::new(), control).map(Some);
    }
    let mut missing = Vec::new();
    let mut fit: Vec<_> = known().filter(|info| info.stands_in.is_some()).collect();
    fit.sort_by_key(|info| info.stands_in);
    for name in fit.into_iter().map(|info| info.name) {
        let why = "it takes minutes; name it with --against to run it";
        let recording = recorded::instead(name, &scene, why);
        let engine = recording.or_else(|| by_name(name, &scene));
        if let Some(engine) = engine.filter(|engine| engine.supports(&scene).is_ok()) {
            let note = match missing.join(", ") {
                names if names.is_empty() => names,
                names => format!("Neither built in nor recorded: {names}."),
            };
            return run(engine.as_ref(), &gearbox, note, control).map(Some);
        }
        missing.push(name);
    }
    Ok(None)
}

fn run(
    engine: &dyn Engine,
    gearbox: &Gearbox,
    note: String,
    control: &Control<'_>,
) -> Result<Peer, StudyError> {
    let at = control.piece(Progress::new(0, 1, engine.name()));
    let run = engine.run_compiled(gearbox, &at)?.finished();
    let run = run.map_err(|ending| StudyError::ended(engine, ending))?;
    let version = engine.version();
    Ok(Peer {
        name: format!("{} {version}", engine.name()),
        live: !version.contains("recorded"),
        differences: engine.info().differences.to_owned(),
        note,
        time_series: run.time_series,
        wall_s: Some(run.stats.wall_s),
    })
}

/// Returns a signal's largest value over the level that 1 % of its loaded samples exceed: near 1 for a smooth signal, 2 or more
/// with spikes.
fn spikes(values: &[f64]) -> f64 {
    let mut loaded: Vec<f64> = values.iter().copied().filter(|f| *f > 1.0).collect();
    loaded.sort_by(f64::total_cmp);
    let level = loaded.get((0.99 * loaded.len() as f64) as usize);
    largest(&loaded) / level.map_or(f64::MIN_POSITIVE, |level| *level)
}

/// Returns a signal at the times `x`, NaN without a sample (recordings are thinned).
fn on_grid(time_series: &TimeSeries, name: &str, x: &[f64]) -> Vec<f64> {
    let values = part(time_series, name, (0.0, f64::MAX));
    let at = |row: Option<usize>| row.and_then(|row| values.get(row)).copied();
    rows_at(x, time_series.time_s())
        .map(|row| at(row).unwrap_or(f64::NAN))
        .collect()
}

/// Possible causes of Adams' spikes, each reproduced in the native solver: name, factor on the stiffness of Adams' IMPACT, and
/// vertices of a faceted disc.
const SUSPECTS: [(&str, Option<f64>, Option<usize>); 5] = [
    (
        "one stiffness for all contacts, Adams' IMPACT",
        Some(1.0),
        None,
    ),
    ("the same with 40 times the stiffness", Some(40.0), None),
    ("a faceted disc, 600 vertices", None, Some(600)),
    ("a faceted disc, 300 vertices", None, Some(300)),
    (
        "a faceted disc, 300 vertices, IMPACT of 40 times the stiffness",
        Some(40.0),
        Some(300),
    ),
];

pub(super) fn figure(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let ours = runs.get(Model::Ours, |_| {})?;
    let published = runs.get(Model::FINE, |_| {})?;
    let groups = [EXTERNAL, INTERNAL];
    let within = |run: &TimeSeries, window| groups.map(|group| peak(run, group, window));
    let spiky = |run: &TimeSeries| groups.map(|group| spikes(&all(run, group, STEADY)));
    let mut measured = Measured::new("fig-10", Vec::new(), Vec::new());
    let mut add = |name: &str, [external, internal]: [f64; 2]| {
        for (kind, value) in [("external", external), ("internal", internal)] {
            let name = format!("{kind}_peak{name}");
            measured.numbers.push(number(name, value, "N"));
        }
    };
    add("_ours", within(&ours.time_series, STEADY));
    add("_later", within(&ours.time_series, (0.1, 0.6)));
    add("_first", within(&ours.time_series, (0.0, 0.05)));
    let rough = runs.get(Model::ROUGH, |_| {})?;
    let rough = within(&rough.time_series, STEADY);
    add("_600_points", rough);
    let mut tried = Vec::new();
    for (name, impact, vertices) in SUSPECTS {
        let result = runs.get(Model::Ours, |s| {
            if let Some(times) = impact {
                "adams-impact".clone_into(&mut s.contact.law);
                s.contact.constant_stiffness_n_m15 *= times;
            }
            if let Some(count) = vertices {
                s.contact.detection = Detection::Points;
                (s.contact.wheel_points, s.contact.hole_points) = (count, 20);
            }
            s.solver.step_s = 5e-6; // for the stiffest of them
        });
        tried.push(match result {
            Ok(run) => {
                let [e, i] = within(&run.time_series, STEADY);
                let [se, si] = spiky(&run.time_series);
                add(&format!(", {name}"), [e, i]);
                format!("{name}: {e:.0} and {i:.0} N (spikes {se:.2}, {si:.2})")
            }
            Err(StudyError::Reference { reason, .. }) => format!("{name}: {reason}"),
            Err(other) => return Err(other),
        });
    }
    if let Some(peer) = runs.peer {
        let [e, i] = within(&peer.time_series, STEADY);
        let [se, si] = spiky(&peer.time_series);
        add("_other", [e, i]);
        measured.numbers.extend([
            number("external_spikes_other", se, ""),
            number("internal_spikes_other", si, ""),
            number("spikes_other", se.max(si), ""),
        ]);
        let how = ["recorded", "computed now"][usize::from(peer.live)];
        let other = format!(
            "{} ({how}) in Adams' place: {e:.1} N and {i:.1} N; its largest values are {se:.2} and {si:.2} times what 1 % of the \
             samples exceed. ",
            peer.name,
        );
        let differences = format!("{} {} ", peer.differences, peer.note);
        measured.words = vec![("other", other), ("differences", differences)];
    }
    let holds = rough.iter().all(|peak| *peak < 200.0);
    let rough = if holds { "holds" } else { "fails" };
    measured.words.push(("with_600_points", rough.to_owned()));
    measured.words.push(("tried", tried.join("; ")));
    for (key, group) in [("fig-10a", INTERNAL), ("fig-10b", EXTERNAL)] {
        let x = times(&ours.time_series, DRAWN);
        let line = |label: &str, run: &TimeSeries| Curve::line(label, part(run, group, DRAWN));
        let mut curves = vec![
            line("ours, exact profile", &ours.time_series),
            line("ours, 4000 points", &published.time_series),
        ];
        let other = |peer: &Peer| Curve::line(&peer.name, on_grid(&peer.time_series, group, &x));
        curves.extend(runs.peer.map(other));
        measured.plots.push((key.to_owned(), x, curves));
    }
    Ok(vec![measured])
}
