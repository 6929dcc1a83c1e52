//! Figs. 5, 6, 17 and 18: one contact of a disc with a ring pin, without and with backlash.

use std::ops::Range;
use std::rc::Rc;

use pinwheel_timeseries::TimeSeries;

use super::backlash::NAMES;
use super::figure::{Curve, Measured, Plot, number, numbers};
use super::read::{STEADY, largest, mean, range, roughness};
use super::runs::{BACKLASHES, Model, Run, Runs, backlash};
use crate::StudyError;

/// Distance of samples, s: sixteen in a swing of a disc on its contacts (1.2 kHz).
const SAMPLE: f64 = 5e-5;
/// Where the paper's contact begins, s (it speaks of 0.24 to 0.246 s).
const BEGINS: f64 = 0.24;
/// The beginning of a contact, s: as long as the paper's.
const ONSET: f64 = 0.006;
/// Samples to both sides of the running mean: 0.5 ms.
const HALF: usize = 10;

const PENETRATION: &str = "wheel_0_external_penetration_m";
const STIFFNESS: &str = "wheel_0_external_stiffness_n_m15";
const NORMAL: &str = "wheel_0_external_normal_velocity_m_s";
const TANGENTIAL: &str = "wheel_0_external_tangential_velocity_m_s";

/// One contact: the pin and the samples in which it touches.
#[derive(Debug, Clone)]
struct Contact {
    sleeve: usize,
    samples: Range<usize>,
}

/// Disc 0 and all ring pins.
fn run(runs: &Runs<'_>, model: Model, backlash: f64) -> Result<Rc<Run>, StudyError> {
    runs.get(model, |s| {
        s.gear.backlash_m = backlash;
        s.solver.sample_s = SAMPLE;
        s.output.channels = [PENETRATION, STIFFNESS, NORMAL, TANGENTIAL]
            .map(|name| format!("{name}_*"))
            .to_vec();
    })
}

fn course<'a>(time_series: &'a TimeSeries, name: &str, contact: &Contact) -> &'a [f64] {
    let values = time_series.channel(&format!("{name}_{}", contact.sleeve));
    let values = values.and_then(|values| values.get(contact.samples.clone()));
    values.unwrap_or(&[])
}

/// All contacts of disc 0 that begin after `from` and have ended in the run. Gaps of a few samples, a pin
/// bouncing at its start, do not end a contact.
fn contacts(time_series: &TimeSeries, from: f64) -> Vec<Contact> {
    let start = time_series.time_s().partition_point(|t| *t < from);
    // From one touch to the next: 2 ms, and a sample at either end.
    let bridged = 42;
    let mut found = Vec::new();
    for (sleeve, depth) in time_series.group(PENETRATION).into_iter().enumerate() {
        let touching: Vec<usize> = (0..depth.len()).filter(|&k| depth[k] > 0.0).collect();
        for touches in touching.chunk_by(|one, next| next - one <= bridged) {
            let samples = touches[0]..touches[touches.len() - 1] + 1;
            if samples.start > start && samples.end + bridged <= depth.len() {
                found.push(Contact { sleeve, samples });
            }
        }
    }
    found.sort_by_key(|contact| contact.samples.start);
    found
}

/// The longest of the contacts that begin nearest to the paper's: touches of a sample or two are left out.
fn nearest(time_series: &TimeSeries, sleeve: Option<usize>) -> Option<Contact> {
    let all = contacts(time_series, 0.12);
    let longest = all.iter().map(|c| c.samples.len()).max()?;
    let off = |c: &Contact| (time_series.time_s()[c.samples.start] - BEGINS).abs();
    all.into_iter()
        .filter(|c| 2 * c.samples.len() > longest && sleeve.is_none_or(|s| s == c.sleeve))
        .min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// Mean duration of the steady contacts, s.
fn duration(time_series: &TimeSeries) -> f64 {
    let all = contacts(time_series, STEADY.0 - 0.1);
    let longest = all.iter().map(|c| c.samples.len()).max().unwrap_or(0);
    let whole = all.iter().map(|c| c.samples.len());
    let whole = whole.filter(|n| 2 * n > longest);
    mean(&whole.map(|n| n as f64 * SAMPLE).collect::<Vec<_>>())
}

/// Swing of the normal velocity (largest less smallest of it less its running mean) at the beginning of a contact and later.
fn swings(normal: &[f64]) -> [f64; 2] {
    let first = ((ONSET / SAMPLE) as usize).min(normal.len());
    let (onset, later) = normal.split_at(first);
    [onset, later].map(|part| roughness(part, HALF))
}

fn missing() -> StudyError {
    StudyError::Reference {
        scene: "paper".to_owned(),
        reason: "has no contact of disc 0 with a ring pin near 0.24 s".to_owned(),
    }
}

/// A course on the samples of `shown`, not a number where the contact is not.
fn spread(values: &[f64], samples: &Range<usize>, shown: &Range<usize>) -> Vec<f64> {
    let at = |k: usize| values.get(k.checked_sub(samples.start)?).copied();
    let at = |k: usize| at(k).filter(|_| samples.contains(&k));
    shown.clone().map(|k| at(k).unwrap_or(f64::NAN)).collect()
}

/// One contact in several runs, over the samples in which any of them touches.
struct Touches {
    /// Name, run and contact.
    list: Vec<(String, Rc<Run>, Contact)>,
    shown: Range<usize>,
}

impl Touches {
    /// Touches of the contact of disc 0 that is nearest to the paper's in the first of the runs.
    fn find(runs: impl Iterator<Item = (String, Rc<Run>)>) -> Result<Self, StudyError> {
        let mut list: Vec<(String, Rc<Run>, Contact)> = Vec::new();
        for (label, run) in runs {
            let sleeve = list.first().map(|first| first.2.sleeve);
            let contact = nearest(&run.time_series, sleeve).ok_or_else(missing)?;
            list.push((label, run, contact));
        }
        let samples = || list.iter().map(|touch| &touch.2.samples);
        let start = samples().map(|range| range.start).min().unwrap_or(0);
        let end = samples().map(|range| range.end).max().unwrap_or(0);
        Ok(Self {
            list,
            shown: start..end,
        })
    }

    fn values(&self, k: usize, name: &str) -> &[f64] {
        course(&self.list[k].1.time_series, name, &self.list[k].2)
    }

    /// Begin and end of a contact, s.
    fn times(&self, k: usize) -> [f64; 2] {
        let (_, run, contact) = &self.list[k];
        let time = run.time_series.time_s();
        [time[contact.samples.start], time[contact.samples.end]]
    }

    /// One channel of all; `[key, what, y_label]`.
    fn plot(&self, [key, what, y_label]: [&str; 3], name: &str) -> Plot {
        let (_, run, contact) = &self.list[0];
        let sleeve = contact.sleeve;
        let title = format!("{what}, disc 0 with ring pin {sleeve}");
        let curve = |(label, run, contact): &(String, Rc<Run>, Contact)| {
            let values = course(&run.time_series, name, contact);
            Curve::line(label, spread(values, &contact.samples, &self.shown))
        };
        let x = run.time_series.time_s()[self.shown.clone()].to_vec();
        let curves = self.list.iter().map(curve).collect();
        Plot::over_time([key, &title, y_label], x, curves)
    }

    fn stiffness(&self, key: &str) -> Plot {
        let words = [key, "Contact stiffness", "Contact stiffness (N/m^1.5)"];
        self.plot(words, STIFFNESS)
    }

    fn velocities(&self, [normal, tangential]: [&str; 2]) -> Vec<Plot> {
        let normal = [normal, "Normal velocity", "Normal velocity (m/s)"];
        let title = "Tangential velocity";
        let tangential = [tangential, title, "Tangential velocity (m/s)"];
        vec![
            Plot {
                note: "Positive while the penetration grows.".to_owned(),
                ..self.plot(normal, NORMAL)
            },
            self.plot(tangential, TANGENTIAL),
        ]
    }

    /// Where both touch, how far the last run's course lies from the first's, of the first's range.
    fn apart(&self, name: &str) -> f64 {
        let last = self.list.len() - 1;
        let [a, b] = [0, last].map(|k| &self.list[k].2.samples);
        let both = a.start.max(b.start)..a.end.min(b.end);
        let first = spread(self.values(0, name), a, &both);
        let other = spread(self.values(last, name), b, &both);
        let off = first.iter().zip(&other).map(|(a, b)| (a - b).abs());
        mean(&off.collect::<Vec<_>>()) / range(&first).max(f64::MIN_POSITIVE)
    }
}

pub(super) fn one_contact(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let models = [Model::Ours, Model::FINE, Model::ROUGH];
    let mut ran = Vec::new();
    for model in models {
        ran.push((model.words(), run(runs, model, 0.0)?));
    }
    let found = Touches::find(ran.into_iter())?;
    let stiffness = found.values(0, STIFFNESS);
    let (low, high) = (largest(stiffness) - range(stiffness), largest(stiffness));
    let rough: Vec<f64> = (0..models.len())
        .map(|k| roughness(found.values(k, STIFFNESS), HALF) / range(stiffness))
        .collect();
    let [begins, ends] = found.times(0);
    let names = ["exact", "4000_points", "600_points"];
    let mut five = vec![
        number("begins", begins, "s"),
        number("ends", ends, "s"),
        number("stiffness_smallest", low, "N/m^1.5"),
        number("stiffness_largest", high, "N/m^1.5"),
        number("stiffness_ratio", high / low, ""),
    ];
    five.extend(numbers("oscillation", &names, &rough, ""));
    let mut six = Vec::new();
    for (k, name) in names.into_iter().enumerate() {
        let swings = swings(found.values(k, NORMAL)).map(|swing| 1e3 * swing);
        six.push(number(format!("onset_{name}"), swings[0], "mm/s"));
        six.push(number(format!("later_{name}"), swings[1], "mm/s"));
    }
    let slides = 1e3 * range(found.values(0, TANGENTIAL));
    six.push(number("tangential_range", slides, "mm/s"));
    Ok(vec![
        Measured::new("fig-05", five, vec![found.stiffness("fig-05")]),
        Measured::new("fig-06", six, found.velocities(["fig-06a", "fig-06b"])),
    ])
}

/// Largest approach in the first half millisecond of the steady contacts, m/s.
fn onset(time_series: &TimeSeries) -> f64 {
    let first = 10;
    let all = contacts(time_series, STEADY.0).into_iter();
    let speeds = all.filter(|c| c.samples.len() > 200).map(|c| {
        let speed = course(time_series, NORMAL, &c);
        largest(&speed[..first.min(speed.len())])
    });
    speeds.fold(0.0, f64::max)
}

pub(super) fn with_backlash(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let mut ran = Vec::new();
    for d in BACKLASHES {
        ran.push((backlash(d), run(runs, Model::Ours, d)?));
    }
    let found = Touches::find(ran.into_iter())?;
    let each = |of: fn(&TimeSeries) -> f64| -> Vec<f64> {
        let all = found.list.iter();
        all.map(|touch| 1e3 * of(&touch.1.time_series)).collect()
    };
    let shift = 1e3 * (found.times(2)[0] - found.times(0)[0]);
    let mut seventeen = numbers("contact_lasts", &NAMES, &each(duration), "ms");
    seventeen.push(number("shift_0.6_mm", shift, "ms"));
    seventeen.push(number("stiffness_apart", found.apart(STIFFNESS), ""));
    let mut eighteen = numbers("begins_at", &NAMES, &each(onset), "mm/s");
    eighteen.push(number("tangential_apart", found.apart(TANGENTIAL), ""));
    Ok(vec![
        Measured::new("fig-17", seventeen, vec![found.stiffness("fig-17")]),
        Measured::new("fig-18", eighteen, found.velocities(["fig-18a", "fig-18b"])),
    ])
}
