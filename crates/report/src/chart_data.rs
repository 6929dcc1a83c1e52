//! The courses as the page carries them: one engine's values and the others' differences to it,
//! base64 of little-endian 32-bit floats.
//!
//! Differences are taken in 64 bits before they are shortened: of two engines that agree to 1e-9
//! the page still shows what parts them. Metrics never come from here.

use std::borrow::Cow;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use pinwheel_compare::{Participant, Quantity, Track, Window, WindowKind, quantities};
use pinwheel_courses::Courses;
use serde::Serialize;

/// Base64 characters the courses of one page may take; with styles, scripts and tables the page
/// stays below 6 MB.
const BUDGET: usize = 5_000_000;
/// Channels of one group that are always worth drawing before samples are skipped.
const FEW_CHANNELS: usize = 4;

/// What the page's script reads.
#[derive(Debug, Serialize)]
pub(crate) struct ChartData {
    time: Time,
    engines: Vec<Line>,
    quantities: Vec<ChartQuantity>,
    windows: Vec<ChartWindow>,
    /// What is left out of the charts, for the reader.
    pub(crate) notes: Vec<String>,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Time {
    Even { start: f64, step: f64, count: usize },
    Listed { values: Vec<f64> },
}

#[derive(Debug, Serialize)]
struct Line {
    name: String,
    track: Track,
    /// Position among all participants: colour and dash of its line.
    style: usize,
    /// Samples lie apart with gaps between them, over which the line is drawn.
    sparse: bool,
}

#[derive(Debug, Serialize)]
struct ChartQuantity {
    name: String,
    label: String,
    unit: String,
    channels: Vec<ChartChannel>,
}

#[derive(Debug, Serialize)]
struct ChartChannel {
    /// Number within the group, or empty.
    label: String,
    /// The first engine's values.
    base: String,
    /// Per further engine its difference to the first; `None` without this channel.
    others: Vec<Option<String>>,
}

#[derive(Debug, Serialize)]
struct ChartWindow {
    kind: WindowKind,
    from: f64,
    to: f64,
}

impl ChartData {
    /// Chooses engines, channels and samples and encodes them; `None` if nobody has courses.
    pub(crate) fn of(participants: &[Participant], windows: &[Window]) -> Option<Self> {
        let mut notes = Vec::new();
        let participants = &spread(participants);
        let drawn = drawn(participants, &mut notes);
        let &(_, base) = drawn.first()?;
        let time_s = base.courses.time_s();
        let quantities = quantities::derive(drawn.iter().map(|(_, p)| &p.courses));
        let plan = Plan::within_budget(&quantities, drawn.len(), time_s.len());
        plan.tell(&mut notes);
        let windows = windows
            .iter()
            .map(|w| ChartWindow {
                kind: w.kind,
                from: w.from_s,
                to: w.to_s,
            })
            .collect();
        Some(Self {
            time: time(time_s, plan.every),
            engines: drawn
                .iter()
                .map(|&(style, p)| Line {
                    name: p.name.clone(),
                    track: p.track,
                    style,
                    sparse: p.cost.recorded.is_some(),
                })
                .collect(),
            quantities: quantities
                .iter()
                .map(|q| quantity(q, &drawn, plan))
                .filter(|q| !q.channels.is_empty())
                .collect(),
            windows,
            notes,
        })
    }
}

/// Recordings hold fewer samples than live runs: on the finest grid the others are gaps, not numbers.
fn spread(participants: &[Participant]) -> Vec<Cow<'_, Participant>> {
    let finest = participants
        .iter()
        .map(|p| p.courses.time_s())
        .max_by_key(|time| time.len())
        .unwrap_or_default();
    let spread = |participant: &Participant| -> Option<Participant> {
        participant.cost.recorded.as_ref()?;
        let mut whole = Courses::new(finest.to_vec()).ok()?;
        let time = participant.courses.time_s();
        let rows: Vec<Option<usize>> = finest
            .iter()
            .map(|t| {
                let row = time.partition_point(|other| *other < t - 1e-9 * t.max(1e-9));
                time.get(row)
                    .is_some_and(|other| (other - t).abs() <= 1e-9 * t.max(1e-9))
                    .then_some(row)
            })
            .collect();
        for channel in participant.courses.channels() {
            let values = rows
                .iter()
                .map(|row| row.map_or(f64::NAN, |row| channel.values[row]));
            whole.push(channel.name.clone(), values.collect()).ok()?;
        }
        Some(Participant {
            courses: whole,
            ..participant.clone()
        })
    };
    participants
        .iter()
        .map(|p| spread(p).map_or(Cow::Borrowed(p), Cow::Owned))
        .collect()
}

/// Participants with something to draw, the first being what the others are stored against:
/// a finished native run if there is one, because that is what differs least from most.
fn drawn<'a>(
    participants: &'a [Cow<'a, Participant>],
    notes: &mut Vec<String>,
) -> Vec<(usize, &'a Participant)> {
    let mut drawn: Vec<(usize, &Participant)> = participants
        .iter()
        .map(Cow::as_ref)
        .enumerate()
        .filter(|(_, p)| !p.courses.is_empty())
        .collect();
    drawn.sort_by_key(|(place, p)| {
        let finished = p.status.is_finished();
        (
            !finished,
            p.track != Track::Native,
            if finished {
                *place
            } else {
                usize::MAX - p.courses.len()
            },
        )
    });
    if let Some(&(_, base)) = drawn.first() {
        // Courses on other times cannot share an axis of samples.
        drawn.retain(|(_, p)| {
            let (time, whole) = (p.courses.time_s(), base.courses.time_s());
            let fits = time.len() <= whole.len()
                && time
                    .iter()
                    .zip(whole)
                    .all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs().max(1e-9));
            if !fits {
                notes.push(format!("{} is not drawn: its sample times differ.", p.name));
            }
            fits
        });
    }
    // In the legend engines keep the order they were given in; only the first stays first.
    if let Some((_, rest)) = drawn.split_first_mut() {
        rest.sort_by_key(|(place, _)| *place);
    }
    drawn
}

/// How much of the courses is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plan {
    /// Channels of a group at most.
    channels: usize,
    /// Every so many samples.
    every: usize,
    /// Whether a group was cut.
    cut: bool,
}

impl Plan {
    fn within_budget(quantities: &[Quantity], engines: usize, samples: usize) -> Self {
        let most = quantities
            .iter()
            .map(|q| q.channels.len())
            .max()
            .unwrap_or(0);
        let size = |channels: usize, every: usize| {
            let columns: usize = quantities
                .iter()
                .map(|q| q.channels.len().min(channels))
                .sum();
            columns
                .saturating_mul(engines)
                .saturating_mul(samples.div_ceil(every) * 16 / 3)
        };
        let mut channels = most;
        while channels > FEW_CHANNELS && size(channels, 1) > BUDGET {
            channels -= 1;
        }
        let mut every = 1;
        while size(channels, every) > BUDGET && every < samples {
            every += 1;
        }
        Self {
            channels,
            every,
            cut: channels < most,
        }
    }

    fn tell(self, notes: &mut Vec<String>) {
        if self.cut {
            notes.push(format!(
                "To keep this page small, {} evenly spaced channels of larger groups are drawn; \
                 metrics use all.",
                self.channels
            ));
        }
        if self.every > 1 {
            notes.push(format!(
                "To keep this page small, one sample in {} is drawn; metrics use all.",
                self.every
            ));
        }
    }

    /// Which of `count` channels are drawn: evenly spaced, the first among them.
    fn chosen(self, count: usize) -> Vec<usize> {
        let kept = count.min(self.channels);
        (0..kept).map(|k| k * count / kept).collect()
    }
}

fn time(time_s: &[f64], every: usize) -> Time {
    let values: Vec<f64> = time_s.iter().copied().step_by(every).collect();
    if let [start, .., end] = values[..] {
        let step = (end - start) / (values.len() - 1) as f64;
        let even = values
            .iter()
            .enumerate()
            .all(|(k, t)| (t - (start + k as f64 * step)).abs() <= 1e-6 * step);
        if even {
            return Time::Even {
                start,
                step,
                count: values.len(),
            };
        }
    }
    Time::Listed { values }
}

fn quantity(quantity: &Quantity, drawn: &[(usize, &Participant)], plan: Plan) -> ChartQuantity {
    let channels = plan
        .chosen(quantity.channels.len())
        .into_iter()
        .filter_map(|k| channel(&quantity.channels[k], &quantity.name, drawn, plan.every))
        .collect();
    ChartQuantity {
        name: quantity.name.clone(),
        label: quantity.label.clone(),
        unit: quantity.unit.clone(),
        channels,
    }
}

/// `None` if the first engine lacks the channel: there is nothing to store the others against.
fn channel(
    name: &str,
    group: &str,
    drawn: &[(usize, &Participant)],
    every: usize,
) -> Option<ChartChannel> {
    let (&(_, first), rest) = drawn.split_first()?;
    let base = first.courses.channel(name)?;
    let others = rest
        .iter()
        .map(|(_, participant)| {
            let values = participant.courses.channel(name)?;
            Some(encode(
                values.iter().zip(base).map(|(a, b)| a - b).step_by(every),
            ))
        })
        .collect();
    let label = name
        .strip_prefix(group)
        .unwrap_or_default()
        .trim_start_matches('_')
        .to_owned();
    Some(ChartChannel {
        label,
        base: encode(base.iter().copied().step_by(every)),
        others,
    })
}

fn encode(values: impl Iterator<Item = f64>) -> String {
    let bytes: Vec<u8> = values.flat_map(|v| (v as f32).to_le_bytes()).collect();
    STANDARD.encode(bytes)
}

/// JSON that may stand inside a script element: no character can end it or begin a comment.
pub(crate) fn json_for_script(value: &impl Serialize) -> Result<String, serde_json::Error> {
    Ok(serde_json::to_string(value)?
        .replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026")
        .replace('\u{2028}', "\\u2028")
        .replace('\u{2029}', "\\u2029"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_cannot_be_left() {
        let json = json_for_script(&"</script><!-- & \u{2028}").unwrap();
        assert_eq!(json, "\"\\u003c/script\\u003e\\u003c!-- \\u0026 \\u2028\"");
        assert_eq!(
            serde_json::from_str::<String>(&json).unwrap(),
            "</script><!-- & \u{2028}"
        );
    }

    #[test]
    fn floats_round_trip() {
        let bytes = STANDARD.decode(encode([1.5, -0.25].into_iter())).unwrap();
        assert_eq!(
            bytes,
            [1.5f32.to_le_bytes(), (-0.25f32).to_le_bytes()].concat()
        );
    }

    #[test]
    fn channels_are_evenly_spaced() {
        let plan = Plan {
            channels: 4,
            every: 1,
            cut: true,
        };
        assert_eq!(plan.chosen(16), [0, 4, 8, 12]);
        assert_eq!(plan.chosen(3), [0, 1, 2]);
        assert!(plan.chosen(0).is_empty());
    }

    #[test]
    fn budget() {
        let group = |count: usize| {
            let mut courses = pinwheel_courses::Courses::new(vec![0.0]).unwrap();
            for k in 0..count {
                courses.push(format!("force_n_{k}"), vec![0.0]).unwrap();
            }
            quantities::derive([&courses])
        };
        let plan =
            |channels, engines, samples| Plan::within_budget(&group(channels), engines, samples);
        assert_eq!(
            plan(24, 5, 6001),
            Plan {
                channels: 24,
                every: 1,
                cut: false
            }
        );
        let many = plan(200, 10, 6001);
        assert!(
            many.cut && many.every == 1 && many.channels >= FEW_CHANNELS,
            "{many:?}"
        );
        let long = plan(24, 10, 600_001);
        assert!(long.channels == FEW_CHANNELS && long.every > 1, "{long:?}");
        assert_eq!(
            plan(0, 0, 0),
            Plan {
                channels: 0,
                every: 1,
                cut: false
            }
        );
    }

    #[test]
    fn even_times_are_short() {
        let times: Vec<f64> = (0..=100).map(|k| f64::from(k) * 1e-4).collect();
        assert!(matches!(time(&times, 10), Time::Even { count: 11, .. }));
        assert!(matches!(time(&[0.0, 1.0, 3.0], 1), Time::Listed { .. }));
        assert!(matches!(time(&[], 1), Time::Listed { .. }));
    }
}
