//! Figs. 5, 6, 17 and 18: one contact of a disc with a ring pin, without and with backlash.

use std::ops::Range;

use pinwheel_scene::Scene;
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::figure::Figure;

use super::figure::{Curve, Drawn, Measured, number};
use super::read::{STEADY, largest, mean, range, roughness};
use super::runs::{BACKLASHES, Cases, Model, Runs, backlash};
use crate::StudyError;

/// Spacing of samples, s: sixteen per oscillation of a disc on its contacts (1.2 kHz).
const SAMPLE: f64 = 5e-5;
/// Start of the paper's contact, s (the text mentions 0.24 to 0.246 s).
const BEGINS: f64 = 0.24;
/// Length of a contact's onset, s, as in the paper.
const ONSET: f64 = 0.006;
/// Samples on both sides of the running mean: 0.5 ms.
const HALF: usize = 10;

const PENETRATION: &str = "wheel_0_external_penetration_m";
const STIFFNESS: &str = "wheel_0_external_stiffness_n_m15";
const NORMAL: &str = "wheel_0_external_normal_velocity_m_s";
const TANGENTIAL: &str = "wheel_0_external_tangential_velocity_m_s";

/// Contact of a run: the pin and its touching samples.
#[derive(Debug, Clone)]
struct Contact<'a> {
    time_series: &'a TimeSeries,
    sleeve: usize,
    samples: Range<usize>,
}

impl Contact<'_> {
    fn course(&self, name: &str) -> &[f64] {
        let values = self.time_series.channel(&format!("{name}_{}", self.sleeve));
        let values = values.and_then(|values| values.get(self.samples.clone()));
        values.unwrap_or(&[])
    }

    /// Returns a signal on the samples of `shown`, NaN outside the contact.
    fn spread(&self, name: &str, shown: &Range<usize>) -> Vec<f64> {
        let values = self.course(name);
        let at = |k: usize| values.get(k.checked_sub(self.samples.start)?).copied();
        let shown = shown.clone();
        shown.map(|k| at(k).unwrap_or(f64::NAN)).collect()
    }

    /// Returns start and end, s.
    fn times(&self) -> [f64; 2] {
        let Range { start, end } = self.samples;
        [start, end].map(|row| self.time_series.time_s()[row])
    }
}

/// Requests the channels of disc 0 and all ring pins.
fn traced(scene: &mut Scene) {
    scene.solver.sample_s = SAMPLE;
    let names = [PENETRATION, STIFFNESS, NORMAL, TANGENTIAL];
    scene.output.channels = names.map(|name| format!("{name}_*")).to_vec();
}

/// Returns the contacts of disc 0 that begin after `from` and end within the run. Gaps of a few samples, from a pin bouncing at
/// its start, do not end a contact.
fn contacts(time_series: &TimeSeries, from: f64) -> Vec<Contact<'_>> {
    let start = time_series.time_s().partition_point(|t| *t < from);
    // Gap between touches of one contact: 2 ms, and a sample at either end.
    let bridged = 42;
    let mut contacts = Vec::new();
    for (sleeve, depth) in time_series.group(PENETRATION).into_iter().enumerate() {
        let touching: Vec<usize> = (0..depth.len()).filter(|&k| depth[k] > 0.0).collect();
        for touches in touching.chunk_by(|one, next| next - one <= bridged) {
            let samples = touches[0]..touches[touches.len() - 1] + 1;
            if samples.start > start && samples.end + bridged <= depth.len() {
                contacts.push(Contact {
                    time_series,
                    sleeve,
                    samples,
                });
            }
        }
    }
    contacts.sort_by_key(|contact| contact.samples.start);
    contacts
}

/// Returns the [`contacts`] without touches of a sample or two: those more than half as long as the longest.
fn lasting(time_series: &TimeSeries, from: f64) -> impl Iterator<Item = Contact<'_>> {
    let all = contacts(time_series, from);
    let longest = all.iter().map(|c| c.samples.len()).max().unwrap_or(0);
    all.into_iter()
        .filter(move |c| 2 * c.samples.len() > longest)
}

/// Returns the mean duration of the steady contacts, s.
fn duration(time_series: &TimeSeries) -> f64 {
    let all = lasting(time_series, STEADY.0 - 0.1);
    let all = all.map(|c| c.samples.len() as f64 * SAMPLE);
    mean(&all.collect::<Vec<_>>())
}

/// Returns the largest approach speed in the first half millisecond of the steady contacts, m/s.
fn onset(time_series: &TimeSeries) -> f64 {
    let all = contacts(time_series, STEADY.0).into_iter();
    let all = all.filter(|c| c.samples.len() > 200);
    let begin = |c: Contact<'_>| largest(c.course(NORMAL).get(..10).unwrap_or(&[]));
    all.map(begin).fold(0.0, f64::max)
}

/// Returns the range of the normal velocity less its running mean, at the start of a contact and later.
fn swings(normal: &[f64]) -> [f64; 2] {
    let first = ((ONSET / SAMPLE) as usize).min(normal.len());
    let (onset, later) = normal.split_at(first);
    [onset, later].map(|part| roughness(part, HALF))
}

/// Corresponding contact in several runs.
struct Touches<'a> {
    cases: &'a Cases,
    /// Contact in each run.
    list: Vec<Contact<'a>>,
}

impl<'a> Touches<'a> {
    /// Returns the contacts of disc 0 with the pin whose contact in the first run is nearest to the paper's.
    fn find(cases: &'a Cases) -> Result<Self, StudyError> {
        let mut list: Vec<Contact<'_>> = Vec::new();
        for (.., run) in &cases.0 {
            let sleeve = list.first().map(|first| first.sleeve);
            let all = lasting(&run.time_series, 0.12);
            let all = all.filter(|c| sleeve.is_none_or(|s| s == c.sleeve));
            let off = |c: &Contact<'_>| (c.times()[0] - BEGINS).abs();
            let nearest = all.min_by(|a, b| off(a).total_cmp(&off(b)));
            list.push(nearest.ok_or_else(|| StudyError::Reference {
                scene: "paper".to_owned(),
                reason: "has no contact of disc 0 with a ring pin near 0.24 s".to_owned(),
            })?);
        }
        Ok(Self { cases, list })
    }

    /// Returns a channel of all runs, over the samples in which any of them touches.
    fn plot(&self, key: &str, name: &str) -> Drawn {
        let starts = self.list.iter().map(|touch| touch.samples.start);
        let ends = self.list.iter().map(|touch| touch.samples.end);
        let shown = starts.min().unwrap_or(0)..ends.max().unwrap_or(0);
        let curves = self.cases.0.iter().zip(&self.list);
        let curves = curves.map(|((_, label, _), it)| Curve::line(label, it.spread(name, &shown)));
        let curves = curves.collect();
        let x = self.list[0].time_series.time_s()[shown.clone()].to_vec();
        (key.to_owned(), x, curves)
    }

    /// Returns numbers and plots of a figure.
    fn figure(&self, id: &'static str, numbers: Vec<Figure>, plots: Vec<Drawn>) -> Measured {
        Measured {
            words: vec![("pin", self.list[0].sleeve.to_string())],
            ..Measured::new(id, numbers, plots)
        }
    }

    /// Returns the difference between the last run's signal and the first's where both touch, relative to the first's range.
    fn apart(&self, name: &str) -> f64 {
        let [a, b] = [0, self.list.len() - 1].map(|k| &self.list[k]);
        let both = a.samples.start.max(b.samples.start)..a.samples.end.min(b.samples.end);
        let [first, other] = [a, b].map(|contact| contact.spread(name, &both));
        let off = first.iter().zip(&other).map(|(a, b)| (a - b).abs());
        mean(&off.collect::<Vec<_>>()) / range(&first).max(f64::MIN_POSITIVE)
    }
}

pub(super) fn one_contact(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let (rough, fine, ours) = (Model::ROUGH, Model::FINE, Model::Ours);
    let models = [
        ("exact", ours),
        ("4000_points", fine),
        ("600_points", rough),
    ];
    let cases = runs.models(models, traced)?;
    let touches = Touches::find(&cases)?;
    let exact = &touches.list[0];
    let stiffness = exact.course(STIFFNESS);
    let (low, high) = (largest(stiffness) - range(stiffness), largest(stiffness));
    let [begins, ends] = exact.times();
    let mut five = vec![
        number("begins", begins, "s"),
        number("ends", ends, "s"),
        number("stiffness_smallest", low, "N/m^1.5"),
        number("stiffness_largest", high, "N/m^1.5"),
        number("stiffness_ratio", high / low, ""),
    ];
    let mut six = Vec::new();
    for ((name, _), touch) in models.iter().zip(&touches.list) {
        let rough = roughness(touch.course(STIFFNESS), HALF) / range(stiffness);
        five.push(number(format!("oscillation_{name}"), rough, ""));
        let [onset, later] = swings(touch.course(NORMAL)).map(|swing| 1e3 * swing);
        six.push(number(format!("onset_{name}"), onset, "mm/s"));
        six.push(number(format!("later_{name}"), later, "mm/s"));
    }
    let slides = 1e3 * range(exact.course(TANGENTIAL));
    six.push(number("tangential_range", slides, "mm/s"));
    let stiffnesses = vec![touches.plot("fig-05", STIFFNESS)];
    let velocities = vec![
        touches.plot("fig-06a", NORMAL),
        touches.plot("fig-06b", TANGENTIAL),
    ];
    Ok(vec![
        touches.figure("fig-05", five, stiffnesses),
        touches.figure("fig-06", six, velocities),
    ])
}

pub(super) fn with_backlash(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let cases = runs.cases(Model::Ours, &BACKLASHES, backlash, |s, d| {
        traced(s);
        s.gear.backlash_m = d;
    })?;
    let touches = Touches::find(&cases)?;
    let shift = 1e3 * (touches.list[2].times()[0] - touches.list[0].times()[0]);
    let mut seventeen = cases.numbers("contact_lasts", "ms", |run| 1e3 * duration(run));
    seventeen.push(number("shift_0.6_mm", shift, "ms"));
    seventeen.push(number("stiffness_apart", touches.apart(STIFFNESS), ""));
    let mut eighteen = cases.numbers("begins_at", "mm/s", |run| 1e3 * onset(run));
    eighteen.push(number("tangential_apart", touches.apart(TANGENTIAL), ""));
    let stiffnesses = vec![touches.plot("fig-17", STIFFNESS)];
    let velocities = vec![
        touches.plot("fig-18a", NORMAL),
        touches.plot("fig-18b", TANGENTIAL),
    ];
    Ok(vec![
        touches.figure("fig-17", seventeen, stiffnesses),
        touches.figure("fig-18", eighteen, velocities),
    ])
}
