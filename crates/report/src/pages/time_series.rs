//! Time series of a page: one engine's values and the others' differences to it, [packed](crate::pages::packed).
//!
//! Differences are computed in 64 bits before rounding, so the page shows them also for engines that agree to 1e-9.
//! Readable digits are stored: values to five digits of the largest, differences to two digits or more of the millisecond
//! around them. Every engine keeps its own samples: those of a recording are marks, not a line. For runs with too many
//! samples, each interval keeps those of the smallest value, the largest, and the largest difference: no peak is lost. If
//! two samples a pixel are still too many for every channel, channels are omitted. Metrics are never computed from these
//! data.

use crate::script;
use crate::study::{Block, escape};
use pinwheel_compare::comparison::Comparison;
use pinwheel_compare::{Participant, Quantity, SharedModel, Verdict, quantities};
use pinwheel_timeseries::columns;
use serde::Serialize;
use serde_json::{Value, json};

use crate::pages::colours;
use crate::pages::packed::{Rounding, Writer};

/// Largest size of a page's time series, base64 characters; the complete page stays below 2 MB.
const BUDGET: usize = 1_180_000;
/// Least number of channels of a group, drawn even beyond the budget.
const FEW_CHANNELS: usize = 4;
/// Least number of samples of a channel before channels are omitted: two a pixel.
const FEW_SAMPLES: usize = 2400;
/// Binary digits of values, relative to the channel's largest.
const VALUE_DIGITS: i32 = 16;
/// Binary digits of differences, relative to their root mean square nearby, from the most to those of two decimal digits.
const DIFFERENCE_DIGITS: [i32; 3] = [7, 6, 5];
/// Relative distance within which sample times are equal.
const SAME_TIME: f64 = 1e-9;

/// Returns time series of the participants of a comparison, one quantity at a time: values, and differences to any of them.
/// Engines have their fixed colours, other participants (`in_order`) those of their order. `None` without time series; at
/// most one on a page.
pub(crate) fn block(
    comparison: &Comparison,
    participants: &[Participant],
    in_order: bool,
) -> Option<Block> {
    let mut data = ChartData::of(comparison, participants, in_order)?;
    if !in_order {
        data.notes.push(
            "Samples of recordings are marks. No engine is the truth: differences can be taken to any.".to_owned(),
        );
    }
    let note = |note: &String| format!("<p class=\"note\">{}</p>", escape(note));
    let notes: String = data.notes.iter().map(note).collect();
    Some(Block::Live {
        markup: format!(
            include_str!("../../templates/time_series.html"),
            notes = notes
        ),
        scripts: script::data("chart-data", &data)
            + &script::code(include_str!("../../assets/time_series.js")),
        asks: false,
    })
}

/// Data for the page's script.
#[derive(Debug, Clone, Serialize)]
struct ChartData {
    /// Sample times, s.
    time: Spaced,
    /// Name, track, colour and dash, indices of its samples among the times, and a flag for marks instead of a line.
    engines: Vec<Value>,
    quantities: Vec<ChartQuantity>,
    windows: Vec<Value>,
    /// Indices of the first drawing: a quantity, one of its channels, and the engine for differences.
    first: [usize; 3],
    /// Notes on omitted parts.
    notes: Vec<String>,
}

/// Increasing numbers: evenly spaced ones, or a list.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
enum Spaced {
    Even { from: f64, step: f64, count: usize },
    Listed { at: Vec<f64> },
}

#[derive(Debug, Clone, Serialize)]
struct ChartQuantity {
    name: String,
    label: String,
    unit: String,
    /// Uncertainty of an engine of track `measured` against another, about 95 %, in the unit: `[engine, other, half
    /// width]`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    bands: Vec<(usize, usize, f64)>,
    channels: Vec<ChartChannel>,
}

#[derive(Debug, Clone, Serialize)]
struct ChartChannel {
    /// Number within the group, or empty.
    label: String,
    /// Numbers of the engines with this channel.
    engines: Vec<usize>,
    /// Indices of the stored samples (none: all), values of the first of these engines, differences of the others to it.
    packed: String,
}

/// Participant with the indices of its samples among the times of the first.
struct Drawn<'a> {
    participant: &'a Participant,
    /// Colour and dash.
    style: usize,
    places: Vec<usize>,
}

impl ChartData {
    /// Selects and packs engines, channels and samples; `None` without time series. `in_order`: participants are not
    /// engines with fixed colours.
    fn of(comparison: &Comparison, participants: &[Participant], in_order: bool) -> Option<Self> {
        let mut notes = Vec::new();
        let names: Vec<&str> = participants.iter().map(|p| p.name.as_str()).collect();
        let styles = match in_order {
            true => (0..names.len()).collect(),
            false => colours::styles(&names),
        };
        let drawn = drawn(participants, &styles, &mut notes);
        let time_s = drawn.first()?.participant.time_series.time_s();
        let quantities = quantities::derive(drawn.iter().map(|d| &d.participant.time_series));
        let most = quantities.iter().map(|q| q.channels.len()).max();
        let full = Plan {
            channels: most.unwrap_or(0),
            samples: time_s.len(),
            digits: DIFFERENCE_DIGITS[0],
        };
        let (plan, mut quantities) = fitting(full, &quantities, &drawn);
        plan.tell(full, &mut notes);
        let line = |d: &Drawn<'_>| {
            json!({
                "name": d.participant.name,
                "track": d.participant.track,
                "style": d.style,
                "marks": 2 * d.places.len() < time_s.len(),
                "places": spaced(d.places.iter().map(|&place| place as f64).collect()),
            })
        };
        for quantity in &mut quantities {
            quantity.bands = bands(comparison, &drawn, &quantity.name);
        }
        let windows = comparison.windows.iter();
        let windows = windows.map(|w| json!({ "kind": w.kind, "from": w.from_s, "to": w.to_s }));
        Some(Self {
            time: spaced(time_s.to_vec()),
            first: first(comparison, &drawn, &quantities),
            windows: windows.collect(),
            engines: drawn.iter().map(line).collect(),
            quantities,
            notes,
        })
    }
}

/// Returns participants with time series. The first is the base for differences: a finished native run if there is one,
/// because most others are close to it; the one with most samples, so that the others' are among its times.
fn drawn<'a>(
    participants: &'a [Participant],
    styles: &[usize],
    notes: &mut Vec<String>,
) -> Vec<Drawn<'a>> {
    let list = participants.iter().enumerate();
    let list = list.filter(|(_, p)| !p.time_series.is_empty());
    let mut list: Vec<(usize, &Participant)> = list.collect();
    list.sort_by_key(|(place, p)| {
        let finished = p.status.is_finished();
        let samples = usize::MAX - p.time_series.len();
        let native = p.track == SharedModel::Native;
        (!finished, samples, !native, *place)
    });
    let Some(&(_, base)) = list.first() else {
        return Vec::new();
    };
    // Engines keep their order in the legend, except for the first entry.
    list[1..].sort_by_key(|(place, _)| *place);
    let mut drawn = Vec::new();
    for (place, participant) in list {
        match standing(participant.time_series.time_s(), base.time_series.time_s()) {
            Some(places) => drawn.push(Drawn {
                participant,
                style: styles[place],
                places,
            }),
            None => {
                let name = &participant.name;
                notes.push(format!("{name} is not drawn: its sample times differ."));
            }
        }
    }
    drawn
}

/// Returns the indices of `times` among `all`; `None` if one is missing.
fn standing(times: &[f64], all: &[f64]) -> Option<Vec<usize>> {
    let mut at = 0;
    let place = |t: &f64| {
        let near = SAME_TIME * t.abs().max(SAME_TIME);
        while at < all.len() && all[at] < t - near {
            at += 1;
        }
        (at < all.len() && (all[at] - t).abs() <= near).then_some(at)
    };
    times.iter().map(place).collect()
}

/// Size of the drawn time series.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plan {
    /// Largest number of channels of a group.
    channels: usize,
    /// Largest number of samples of a channel.
    samples: usize,
    /// Binary digits of differences.
    digits: i32,
}

/// Reduces the plan to the budget: first invisible digits, then samples between peaks, then channels.
fn fitting(full: Plan, quantities: &[Quantity], drawn: &[Drawn<'_>]) -> (Plan, Vec<ChartQuantity>) {
    let mut plan = full;
    // Skips packing of a long run that is certainly too large: a value takes at least a quarter of a byte.
    let columns = quantities.iter().map(|q| q.channels.len()).sum::<usize>() * drawn.len();
    let most = (4 * BUDGET / columns.max(1)).max(FEW_SAMPLES);
    plan.samples = plan.samples.min(most);
    loop {
        let packed = quantities.iter().map(|q| quantity(q, drawn, plan));
        let packed = packed.filter(|q| !q.channels.is_empty());
        let packed: Vec<ChartQuantity> = packed.collect();
        let channels = packed.iter().flat_map(|q| &q.channels);
        let size: usize = channels.map(|c| c.packed.len()).sum();
        if size <= BUDGET {
            return (plan, packed);
        }
        // Slightly less than in proportion, so that few rounds suffice.
        let fit = |count: usize| count.saturating_mul(BUDGET) / size * 49 / 50;
        let digits = DIFFERENCE_DIGITS.iter().find(|d| **d < plan.digits);
        if let Some(&digits) = digits {
            plan.digits = digits;
        } else if plan.samples > FEW_SAMPLES {
            plan.samples = fit(plan.samples).max(FEW_SAMPLES);
        } else if plan.channels > FEW_CHANNELS {
            plan.channels = fit(plan.channels).max(FEW_CHANNELS);
        } else {
            return (plan, packed);
        }
    }
}

impl Plan {
    /// Appends notes on the parts that the plan omits.
    fn tell(self, full: Self, notes: &mut Vec<String>) {
        notes.push(format!(
            "Drawn are values to five digits of the largest and differences to {:.1}\u{202f}% of those nearby; metrics use \
             all digits and samples.",
            100.0 * 0.5f64.powi(self.digits + 1)
        ));
        if self.channels < full.channels {
            notes.push(format!(
                "To keep this page small, {} evenly spaced channels of larger groups are drawn.",
                self.channels
            ));
        }
        if self.samples < full.samples {
            notes.push(format!(
                "To keep this page small, of every stretch only the samples are drawn in which a channel is smallest or \
                 largest or its engines are furthest apart, {} in all: no peak is lost.",
                self.samples
            ));
        }
    }

    /// Returns the numbers of the drawn channels out of `count`: evenly spaced, the first among them.
    fn chosen(self, count: usize) -> Vec<usize> {
        let kept = count.min(self.channels);
        (0..kept).map(|k| k * count / kept).collect()
    }
}

fn spaced(at: Vec<f64>) -> Spaced {
    if let [from, .., end] = *at {
        let count = at.len();
        let step = (end - from) / (count - 1) as f64;
        let off = |(k, value): (usize, &f64)| (value - (from + k as f64 * step)).abs();
        if at.iter().enumerate().map(off).all(|d| d <= 1e-6 * step) {
            return Spaced::Even { from, step, count };
        }
    }
    Spaced::Listed { at }
}

/// Returns quantity, channel and engine of the first view: measured data against the first engine; else a difference, else
/// external forces, else the first quantity.
fn first(comparison: &Comparison, drawn: &[Drawn<'_>], quantities: &[ChartQuantity]) -> [usize; 3] {
    let rig = |d: &Drawn<'_>| d.participant.track == SharedModel::Measured;
    let measured = drawn.iter().position(rig);
    if let Some(engine) = measured {
        let shown = quantities.iter().enumerate().find_map(|(q, quantity)| {
            let has = |c: &ChartChannel| c.engines.contains(&engine);
            Some([q, quantity.channels.iter().position(has)?, engine])
        });
        if let Some(shown) = shown {
            return shown;
        }
    }
    let place = |name: &str| quantities.iter().position(|q| q.name == name);
    let mut entries = comparison.pairs.iter().flat_map(|pair| &pair.entries);
    let differs =
        entries.find_map(|e| place(&e.quantity).filter(|_| e.result.verdict == Verdict::Differ));
    let force = place(columns::EXTERNAL_FORCE);
    [differs.or(force).unwrap_or(0), 0, 0]
}

/// Returns the uncertainty of every comparison with measured data, in the quantity's unit.
fn bands(comparison: &Comparison, drawn: &[Drawn<'_>], quantity: &str) -> Vec<(usize, usize, f64)> {
    let place = |name: &str| drawn.iter().position(|d| d.participant.name == name);
    let mut bands = Vec::new();
    for pair in &comparison.pairs {
        for entry in pair.entries.iter().filter(|e| e.quantity == quantity) {
            let rms = |name: &str| {
                let engine = comparison.engines.iter().find(|e| e.name == name)?;
                let figures = engine.figures_in(entry.window)?;
                Some(figures.quantities.get(quantity)?.rms)
            };
            let budget = entry.assessments.iter().find_map(|one| one.budget);
            let scale = rms(&pair.a).zip(rms(&pair.b)).map(|(a, b)| a.max(b));
            if let (Some(budget), Some(scale), Some(a), Some(b)) =
                (budget, scale, place(&pair.a), place(&pair.b))
                && !bands.iter().any(|(x, y, _)| (*x, *y) == (a, b))
            {
                bands.push((a, b, budget.bound() * scale));
            }
        }
    }
    bands
}

fn quantity(quantity: &Quantity, drawn: &[Drawn<'_>], plan: Plan) -> ChartQuantity {
    // A measured channel is always drawn.
    let measured = |name: &String| {
        let rig = |d: &&Drawn<'_>| d.participant.track == SharedModel::Measured;
        let has = |d: &Drawn<'_>| d.participant.time_series.channel(name).is_some();
        drawn.iter().filter(rig).any(has)
    };
    let chosen = plan.chosen(quantity.channels.len());
    let names = quantity.channels.iter().enumerate();
    let names = names.filter(|(k, name)| chosen.contains(k) || measured(name));
    let channels = names.filter_map(|(_, name)| channel(name, &quantity.name, drawn, plan));
    ChartQuantity {
        name: quantity.name.clone(),
        label: quantity.label.clone(),
        unit: quantity.unit.clone(),
        bands: Vec::new(),
        channels: channels.collect(),
    }
}

/// Returns a channel; `None` if no engine has it. The base for differences is the first engine with most samples of it.
fn channel(name: &str, group: &str, drawn: &[Drawn<'_>], plan: Plan) -> Option<ChartChannel> {
    let all = drawn.first()?.places.len();
    let has = |k: &usize| drawn[*k].participant.time_series.channel(name).is_some();
    let mut order: Vec<usize> = (0..drawn.len()).filter(has).collect();
    order.sort_by_key(|&k| all - drawn[k].places.len());
    let first = drawn.get(*order.first()?)?;
    let mut base = vec![f64::NAN; all];
    let values = first.participant.time_series.channel(name)?;
    for (place, value) in first.places.iter().zip(values) {
        base[*place] = *value;
    }
    // Differences to the first at an engine's own samples.
    let having = order.into_iter().filter_map(|k| {
        let d = &drawn[k];
        let values = d.participant.time_series.channel(name)?;
        let off = |(value, &place): (&f64, &usize)| (place, value - base[place]);
        let differences: Vec<(usize, f64)> = values.iter().zip(&d.places).map(off).collect();
        Some((k, differences))
    });
    let having: Vec<(usize, Vec<(usize, f64)>)> = having.collect();
    let kept = kept(&base, &having, plan.samples);
    let stays = |place: &usize| kept.is_empty() || kept.binary_search(place).is_ok();
    let mut writer = Writer::default();
    writer.places(&kept);
    for (n, (_, differences)) in having.iter().enumerate() {
        let (rounding, own) = match n {
            0 => (Rounding::OfPeak(VALUE_DIGITS), true),
            _ => (Rounding::OfBlock(plan.digits), false),
        };
        let stored = differences.iter().filter(|(place, _)| stays(place));
        let stored = stored.map(|(place, off)| if own { base[*place] } else { *off });
        writer.column(&stored.collect::<Vec<_>>(), rounding);
    }
    let label = name.strip_prefix(group).unwrap_or_default();
    Some(ChartChannel {
        label: label.trim_start_matches('_').to_owned(),
        engines: having.iter().map(|(k, _)| *k).collect(),
        packed: writer.finish(),
    })
}

/// Returns the indices of stored samples if there are more than `most`, increasing; empty to store all.
fn kept(base: &[f64], having: &[(usize, Vec<(usize, f64)>)], most: usize) -> Vec<usize> {
    if base.len() <= most {
        return Vec::new();
    }
    // At most four of every interval, among them its first.
    let stretch = (4 * base.len()).div_ceil(most);
    let mut apart = vec![0.0f64; base.len()];
    let mut kept: Vec<usize> = Vec::new();
    for (_, differences) in &having[1..] {
        for (place, value) in differences {
            apart[*place] = apart[*place].max(value.abs());
        }
        // Few samples, as of a recording, are all stored.
        if 8 * differences.len() < most {
            kept.extend(differences.iter().map(|(place, _)| place));
        }
    }
    for from in (0..base.len()).step_by(stretch) {
        let range = from..(from + stretch).min(base.len());
        let largest = |values: &[f64], sign: f64| {
            let of = |k: &usize| sign * values[*k];
            range.clone().max_by(|a, b| of(a).total_cmp(&of(b)))
        };
        kept.push(from);
        kept.extend(largest(base, 1.0));
        kept.extend(largest(base, -1.0));
        kept.extend(largest(&apart, 1.0));
    }
    kept.push(base.len() - 1);
    kept.sort_unstable();
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_evenly_spaced() {
        let plan = Plan {
            channels: 4,
            samples: 1,
            digits: 6,
        };
        assert_eq!(plan.chosen(16), [0, 4, 8, 12]);
        assert_eq!(plan.chosen(3), [0, 1, 2]);
        assert!(plan.chosen(0).is_empty());
    }

    #[test]
    fn samples_find_their_times() {
        let all: Vec<f64> = (0..=100).map(|k| f64::from(k) * 1e-4).collect();
        let every: Vec<f64> = (0..=10).map(|k| f64::from(k) * 1e-3).collect();
        let rows = standing(&every, &all).unwrap();
        assert_eq!(rows, (0..11).map(|k| 10 * k).collect::<Vec<_>>());
        assert_eq!(standing(&all[40..], &all).unwrap()[0], 40);
        assert_eq!(standing(&[1.5e-4], &all), None);
    }

    #[test]
    fn no_peak_is_lost() {
        let mut base: Vec<f64> = (0..100_000).map(|k| (1e-3 * f64::from(k)).sin()).collect();
        base[45_678] = 9.0;
        let mut other: Vec<(usize, f64)> = (0..100_000).map(|k| (k, 1e-6)).collect();
        other[77_777].1 = 1.0;
        let none = vec![(0, Vec::new()), (1, other)];
        let few = kept(&base, &none, 3000);
        assert!(few.len() <= 3002, "{}", few.len());
        for place in [0, 45_678, 77_777, 99_999] {
            assert!(few.contains(&place), "{place}");
        }
        assert!(kept(&base, &none, 100_000).is_empty());
    }

    fn engine(name: &str, track: SharedModel, scale: f64, every: usize) -> Participant {
        let time: Vec<f64> = (0..601).step_by(every).map(|k| k as f64 * 1e-3).collect();
        let of = |k: usize| move |t: &f64| scale * (2.0 + (90.0 * t + k as f64).sin());
        let values = |k| time.iter().map(of(k)).collect();
        participant(name, track, &time, (0..3).map(values).collect())
    }

    fn participant(
        name: &str,
        track: SharedModel,
        time: &[f64],
        forces: Vec<Vec<f64>>,
    ) -> Participant {
        let mut time_series = pinwheel_timeseries::TimeSeries::new(time.to_vec()).unwrap();
        for (k, values) in forces.into_iter().enumerate() {
            time_series
                .push(format!("external_sleeve_force_n_{k}"), values)
                .unwrap();
        }
        Participant {
            name: name.to_owned(),
            track,
            version: String::new(),
            summary: String::new(),
            differences: String::new(),
            time_series,
            cost: pinwheel_compare::Cost::default(),
            status: pinwheel_compare::Status::Finished,
        }
    }

    #[test]
    fn time_series_can_be_read_back() {
        let mut rig = engine("rig", SharedModel::Measured, 1.02, 1);
        let mut gapped = rig.time_series.clone();
        let late = pinwheel_timeseries::TimeSeries::new(gapped.time_s().to_vec()).unwrap();
        let full = std::mem::replace(&mut gapped, late);
        for channel in full.channels() {
            let mut values = channel.values.clone();
            values[..100].fill(f64::NAN);
            gapped.push(channel.name.clone(), values).unwrap();
        }
        rig.time_series = gapped;
        let mut recorded = engine("mujoco-own-contact", SharedModel::OwnContact, 1.01, 10);
        recorded.cost.recorded = Some("recorded".to_owned());
        let participants = [
            rig,
            recorded,
            engine("native-reduced", SharedModel::Native, 1.0, 1),
            engine("rapier-shared-law", SharedModel::SharedLaw, 1.0 + 1e-6, 1),
        ];
        let data = data(&participants);
        let names = data.engines.iter().flat_map(|e| e["name"].as_str());
        let names: Vec<&str> = names.collect();
        let wanted = "native-reduced rig mujoco-own-contact rapier-shared-law";
        assert_eq!(names.join(" "), wanted);
        assert_eq!(data.first, [0, 0, 1], "what was measured comes first");
        let marks: Vec<&Value> = data.engines.iter().map(|e| &e["marks"]).collect();
        assert_eq!(marks, [false, false, true, false]);
        let channel = &data.quantities[0].channels[1];
        assert_eq!(
            channel.engines,
            [0, 1, 3, 2],
            "those with most samples come first"
        );
        let mut read = crate::pages::packed::tests::Reader::new(&channel.packed);
        assert_eq!(read.places(), [0usize; 0], "all samples are kept");
        let [base, rig, peer, marks] = [(); 4].map(|()| read.column());
        let name = "external_sleeve_force_n_1";
        let wanted = participants[2].time_series.channel(name).unwrap();
        assert_eq!(
            (base.len(), rig.len(), marks.len(), peer.len()),
            (601, 601, 61, 601)
        );
        for k in 0..601 {
            assert!((base[k] - wanted[k]).abs() < 3e-5, "{k}");
            // A stored difference has its own digits.
            assert!((peer[k] - 1e-6 * wanted[k]).abs() < 2e-8, "{k}");
            assert_eq!(rig[k].is_nan(), k < 100, "{k}");
        }
        for k in 0..61 {
            assert!((marks[k] - 0.01 * wanted[10 * k]).abs() < 5e-4, "{k}");
        }
    }

    fn data(participants: &[Participant]) -> ChartData {
        let context = pinwheel_compare::Context {
            duration_s: 0.6,
            ..pinwheel_compare::Context::default()
        };
        let comparison =
            pinwheel_compare::compare(&context, participants, &Default::default()).unwrap();
        ChartData::of(&comparison, participants, false).unwrap()
    }

    #[test]
    fn every_channel_can_be_read_where_noise_fills_the_page() {
        let time: Vec<f64> = (0..4001).map(|k| f64::from(k) * 1e-4).collect();
        let mut state = 1_u64;
        let mut noise = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 30)
        };
        let mut forces = || -> Vec<Vec<f64>> {
            let column = |_| time.iter().map(|_| 10.0 + noise()).collect();
            (0..60).map(column).collect()
        };
        let participants = ["native-reduced", "a", "b", "c"]
            .map(|name| participant(name, SharedModel::Native, &time, forces()));
        let drawn = data(&participants);
        let channels = &drawn.quantities[0].channels;
        let size: usize = channels.iter().map(|c| c.packed.len()).sum();
        assert!(size > BUDGET / 2 && size <= BUDGET, "{size}");
        assert_eq!(channels.len(), 60, "{:?}", drawn.notes);
        assert!(
            drawn.notes[1].contains("no peak is lost"),
            "{:?}",
            drawn.notes
        );
    }

    #[test]
    fn what_only_some_have_is_drawn_too() {
        let time: Vec<f64> = (0..601).map(|k| f64::from(k) * 1e-3).collect();
        let forces = |count: usize| vec![time.clone(); count];
        let few = participant("a", SharedModel::Native, &time, forces(2));
        let drawn = data(&[few, participant("b", SharedModel::Native, &time, forces(3))]);
        let engines = drawn.quantities[0]
            .channels
            .iter()
            .map(|c| c.engines.clone());
        assert_eq!(
            engines.collect::<Vec<_>>(),
            [vec![0, 1], vec![0, 1], vec![1]]
        );
        let mut read =
            crate::pages::packed::tests::Reader::new(&drawn.quantities[0].channels[2].packed);
        assert_eq!(read.places(), [0usize; 0]);
        assert!((read.column()[600] - 0.6).abs() < 1e-4);
    }

    #[test]
    fn even_times_are_short() {
        let times: Vec<f64> = (0..=100).map(|k| f64::from(k) * 1e-4).collect();
        assert!(matches!(spaced(times), Spaced::Even { count: 101, .. }));
        for few in [vec![0.0, 1.0, 3.0], vec![2.0], Vec::new()] {
            assert_eq!(spaced(few.clone()), Spaced::Listed { at: few });
        }
    }
}
