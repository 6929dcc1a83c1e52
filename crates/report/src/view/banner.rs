//! The top of the page: the verdict in one sentence, and the figures people come for.

use pinwheel_compare::comparison::EngineSummary;
use pinwheel_compare::{Comparison, Outcome, Quantity, Track, WindowKind, quantities};

use super::{Mark, mark, pairs, quantity_label, window_label};
use crate::statement::Unresolved;
use crate::{format, statement};

/// The verdict.
pub(super) struct Banner {
    /// `pass`, `fail` or `open`.
    pub(super) class: &'static str,
    pub(super) sign: &'static str,
    pub(super) headline: String,
    /// How many statements of each kind there are.
    pub(super) counts: Vec<(usize, &'static str)>,
    pub(super) finished: usize,
    /// Engine and reason of each run that did not finish.
    pub(super) unfinished: Vec<(String, String)>,
    /// Who keeps comparisons from being resolved, why and what would do; not what nothing would change.
    pub(super) unresolved: Vec<Unresolved>,
}

/// One headline figure.
pub(super) struct Tile {
    pub(super) label: String,
    pub(super) value: String,
    /// `± 3·10⁻⁷`, or empty.
    pub(super) uncertainty: String,
    pub(super) unit: String,
    /// The second line, e.g. smallest and largest value.
    pub(super) detail: String,
    /// Whose figure it is and how far the engines are apart.
    pub(super) spread: String,
}

/// What differs most on a track.
pub(super) struct Difference {
    pub(super) track: &'static str,
    pub(super) mark: Mark,
    pub(super) figure: String,
    pub(super) of: String,
    pub(super) said: String,
    pub(super) who: String,
    /// The pair's details.
    pub(super) target: String,
}

/// Of each track the pair and quantity that differ most, gravest first.
pub(super) fn differences(comparison: &Comparison) -> Vec<Difference> {
    let mut found = Vec::new();
    for (track, title) in [
        (Track::Measured, "Measured data"),
        (Track::OwnContact, "Own contact"),
        (Track::SharedLaw, "Shared law"),
        (Track::Native, "Native"),
    ] {
        let of_track = comparison.pairs.iter().enumerate();
        let of_track = of_track.filter(|(_, pair)| pair.track == track);
        let entries = of_track.flat_map(|(k, pair)| pair.entries.iter().map(move |e| (k, pair, e)));
        let size = |(k, pair, entry)| {
            let figure = statement::figure(entry)?;
            let size = figure.value.map_or(f64::INFINITY, f64::abs);
            Some((entry.verdict.outcome(), size, (k, pair, entry, figure)))
        };
        // What is not resolved for a stated reason says less than what is.
        let rank = |outcome: Outcome| {
            if outcome == Outcome::Stated {
                0
            } else {
                1 + outcome as u8
            }
        };
        let most = entries.filter_map(size).max_by(|a, b| {
            let graver = rank(a.0).cmp(&rank(b.0));
            graver.then(a.1.total_cmp(&b.1))
        });
        if let Some((outcome, _, (k, pair, entry, figure))) = most {
            let quantity = quantity_label(comparison, &entry.quantity).to_lowercase();
            let difference = Difference {
                track: title,
                mark: mark(&entry.verdict),
                figure: format::relative_or_none(figure.value.map(f64::abs)),
                of: format!(
                    "{} of the {quantity}, {}",
                    statement::metric(figure.metric),
                    entry.window.word()
                ),
                said: statement::entry(entry, format::relative),
                who: format!(
                    "{} \u{2194} {}",
                    statement::short(&pair.a),
                    statement::short(&pair.b)
                ),
                target: pairs::pair_id(k),
            };
            found.push((outcome == Outcome::Finding, difference));
        }
    }
    found.sort_by_key(|(finding, _)| !finding);
    found
        .into_iter()
        .map(|(_, difference)| difference)
        .collect()
}

pub(super) fn banner(comparison: &Comparison) -> Banner {
    let counts = comparison.counts;
    let limits = |n: usize| {
        if n == 1 {
            "1 limit".to_owned()
        } else {
            format!("{n} limits")
        }
    };
    // An engine that cannot run a scene says so beforehand; that is no finding.
    let engines = || comparison.engines.iter();
    let broken = engines().filter(|e| e.status.is_broken()).count();
    let differing = counts.differ + counts.model_beyond;
    let (class, sign, headline) = if differing > 0 {
        let all = differing + counts.exceeded;
        let verb = if all == 1 {
            "statement differs"
        } else {
            "statements differ"
        };
        ("fail", "\u{2715}", format!("{all} {verb}"))
    } else if counts.exceeded > 0 {
        let checked = limits(counts.within + counts.exceeded);
        (
            "fail",
            "\u{2715}",
            format!("{} of {checked} exceeded", counts.exceeded),
        )
    } else if broken > 0 {
        let (count, runs) = match broken {
            1 => ("1".to_owned(), "engine"),
            n => (n.to_string(), "engines"),
        };
        ("fail", "!", format!("{count} {runs} did not finish"))
    } else if counts.not_resolved > 0 {
        let n = counts.not_resolved;
        let verb = if n == 1 {
            "comparison is"
        } else {
            "comparisons are"
        };
        ("open", "\u{25cb}", format!("{n} {verb} not resolved"))
    } else if counts.agree + counts.model > 0 {
        ("pass", "\u{2713}", "Every statement holds".to_owned())
    } else if !engines().any(|e| e.status.is_finished()) {
        let headline = "No engine could run this scene".to_owned();
        ("open", "\u{25cb}", headline)
    } else if counts.stated > 0 && counts.within == 0 {
        let headline = "Not resolved, for stated reasons".to_owned();
        ("open", "\u{25cb}", headline)
    } else if counts.within > 0 {
        let all = if counts.within == 1 {
            "The one limit holds"
        } else {
            "All limits hold"
        };
        ("pass", "\u{2713}", all.to_owned())
    } else {
        (
            "open",
            "\u{25cb}",
            "Nothing was judged: no limit applies".to_owned(),
        )
    };
    Banner {
        class,
        sign,
        headline,
        counts: [
            (counts.differ, "differ"),
            (counts.exceeded, "exceeded"),
            (counts.model_beyond, "beyond a model's tolerance"),
            (counts.not_resolved, "not resolved"),
            (counts.agree, "agree"),
            (counts.model - counts.model_beyond, "model differences"),
            (counts.within, "within"),
            (counts.stated, "not resolved for a stated reason"),
            (counts.not_judged, "not judged"),
        ]
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .collect(),
        finished: comparison
            .engines
            .iter()
            .filter(|e| e.status.is_finished())
            .count(),
        unfinished: comparison
            .engines
            .iter()
            .filter_map(|e| Some((e.name.clone(), e.status.reason()?)))
            .collect(),
        unresolved: statement::unresolved(comparison)
            .into_iter()
            .filter(|found| !found.stated)
            .collect(),
    }
}

/// Headline figures: torques by their mean, forces by their largest value, and the efficiency;
/// each the median of the engines that share the contact law, or of all if none does.
pub(super) fn tiles(comparison: &Comparison) -> Vec<Tile> {
    let Some(window) = comparison.windows.first().map(|w| w.kind) else {
        return Vec::new();
    };
    let finished: Vec<&EngineSummary> = comparison
        .engines
        .iter()
        .filter(|e| e.status.is_finished())
        .collect();
    let one_law: Vec<&EngineSummary> = finished
        .iter()
        .copied()
        .filter(|e| e.track == Track::Native || e.track == Track::SharedLaw)
        .collect();
    let engines = if one_law.is_empty() {
        &finished
    } else {
        &one_law
    };
    let mut tiles: Vec<Tile> = comparison
        .quantities
        .iter()
        .filter(|q| q.is_load())
        .filter_map(|q| quantity_tile(comparison, engines, q, window))
        .collect();
    let efficiencies: Vec<f64> = engines
        .iter()
        .flat_map(|e| &e.figures)
        .filter(|f| f.window == window)
        .filter_map(|f| f.efficiency)
        .collect();
    // Only where the law's own energy is seen.
    let accounted: Vec<f64> = engines
        .iter()
        .flat_map(|e| &e.figures)
        .filter(|f| f.window == window)
        .filter_map(|f| f.efficiency.zip(f.efficiency_accounted))
        .filter(|(plain, own)| (plain - own).abs() > VISIBLE_SHARE)
        .map(|(_, own)| own)
        .collect();
    if let Some(value) = median(&efficiencies) {
        tiles.push(Tile {
            label: "Efficiency".to_owned(),
            value: format::significant(100.0 * value, 5),
            uncertainty: median(&efficiency_shares(engines, window)).map_or_else(
                String::new,
                |share| {
                    let off = format::significant(100.0 * value.abs() * share, 1);
                    format!("\u{b1}\u{202f}{off}")
                },
            ),
            unit: "%".to_owned(),
            detail: median(&accounted).map_or_else(String::new, |own| {
                format!(
                    "{}\u{202f}% without the energy that the contact law creates",
                    format::significant(100.0 * own, 5)
                )
            }),
            spread: spread(&efficiencies),
        });
    }
    tiles
}

/// How far each engine's efficiency may be off, as a share: its powers are those of the mean torques.
fn efficiency_shares(engines: &[&EngineSummary], window: WindowKind) -> Vec<f64> {
    let share = |engine: &EngineSummary, quantity: &str| {
        let mut known = engine.uncertainty.iter();
        let of = known.find(|u| u.window == window && u.quantity == quantity)?;
        let figures = engine.figures.iter().find(|f| f.window == window)?;
        let mean = figures.quantities.get(quantity)?.mean.abs();
        Some(of.mean.u()? / mean).filter(|share| share.is_finite())
    };
    let both = |engine: &&EngineSummary| {
        let input = share(engine, quantities::INPUT_TORQUE)?;
        Some(input + share(engine, quantities::OUTPUT_TORQUE)?)
    };
    engines.iter().filter_map(both).collect()
}

fn quantity_tile(
    comparison: &Comparison,
    engines: &[&EngineSummary],
    quantity: &Quantity,
    window: WindowKind,
) -> Option<Tile> {
    let statistics: Vec<_> = engines
        .iter()
        .flat_map(|e| &e.figures)
        .filter(|f| f.window == window)
        .filter_map(|f| f.quantities.get(&quantity.name))
        .collect();
    let all = |of: fn(&pinwheel_courses::norms::Statistics) -> f64| {
        statistics.iter().map(|s| of(s)).collect::<Vec<_>>()
    };
    let figure = |of| median(&all(of)).map(format::figure);
    let (main, kind, detail) = if quantity.is_torque() {
        let range = format!("{} to {}", figure(|s| s.min)?, figure(|s| s.max)?);
        (all(|s| s.mean), "mean", range)
    } else {
        let rest = format!("mean {}, rms {}", figure(|s| s.mean)?, figure(|s| s.rms)?);
        (all(|s| s.max), "largest", rest)
    };
    let load = match comparison.context.load_n_m {
        Some(load) if quantity.name == quantities::OUTPUT_TORQUE => {
            format!("; load {}", format::significant(load, 3))
        }
        _ => String::new(),
    };
    let of_all: Vec<f64> = engines
        .iter()
        .flat_map(|e| &e.uncertainty)
        .filter(|u| u.window == window && u.quantity == quantity.name)
        .filter_map(|u| {
            if quantity.is_torque() {
                u.mean.u()
            } else {
                u.peak.u()
            }
        })
        .collect();
    let scales = comparison.context.scales;
    let scale = if quantity.is_torque() {
        scales.torque_n_m
    } else {
        scales.force_n
    };
    let (value, uncertainty) =
        format::bounded(median(&main)?, median(&of_all), scale.unwrap_or(0.0));
    let nothing = value == "0";
    Some(Tile {
        label: format!("{}, {kind}", quantity.label),
        value,
        uncertainty,
        unit: quantity.unit.clone(),
        detail: if nothing {
            String::new()
        } else {
            format!("{detail}{load}")
        },
        spread: if nothing {
            format!("{} engines, all of them rounding", main.len())
        } else {
            spread(&main)
        },
    })
}

/// The window that the tiles are of.
pub(super) fn tiles_label(comparison: &Comparison) -> String {
    let first = comparison.windows.first();
    first.map_or_else(String::new, |w| window_label(comparison, w.kind))
}

/// Difference of two efficiencies that a reader sees.
pub(super) const VISIBLE_SHARE: f64 = 1e-6;

/// The middle value; of an even number the smaller of the two middle ones, so that it is always
/// some engine's figure.
fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len().checked_sub(1)? / 2).copied()
}

fn spread(values: &[f64]) -> String {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| {
            (l.min(v), h.max(v))
        });
    let scale = low.abs().max(high.abs());
    match values.len() {
        0 | 1 => "one engine".to_owned(),
        n if scale == 0.0 => format!("{n} engines agree"),
        n => format!(
            "{n} engines within {}",
            format::relative((high - low) / scale)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_someones_figure() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.0));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn spreads() {
        assert_eq!(spread(&[2.0]), "one engine");
        assert_eq!(spread(&[100.0, 99.0]), "2 engines within 1.0\u{202f}%");
        assert_eq!(spread(&[0.0, 0.0]), "2 engines agree");
    }
}
