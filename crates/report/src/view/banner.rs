//! The top of the page: the verdict in one sentence, and the figures people come for.

use pinwheel_compare::comparison::{EngineSummary, Pair, PairEntry};
use pinwheel_compare::{
    Assessment, Comparison, Metric, Quantity, Track, Verdict, WindowKind, quantities,
};

use super::{Mark, mark, pairs, quantity_label, window_label};
use crate::{format, words};

/// The verdict.
pub(super) struct Banner {
    /// `pass`, `fail` or `open`.
    pub(super) class: &'static str,
    pub(super) sign: &'static str,
    pub(super) headline: String,
    /// How many verdicts of each kind there are.
    pub(super) counts: String,
    pub(super) finished: usize,
    /// Engine and reason of each run that did not finish.
    pub(super) unfinished: Vec<(String, String)>,
    /// Who leaves something to act on inconclusive, why, and what would do.
    pub(super) inconclusive: Vec<(String, String)>,
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
        // What is inconclusive with nothing to act on says less than what agrees.
        let rank = |found: &Assessment| {
            if found.rank() == 2 {
                0
            } else {
                1 + found.rank()
            }
        };
        let size = |(k, pair, entry): (usize, &'_ Pair, &'_ PairEntry)| {
            entry.result.metric?;
            let size = entry.result.difference.map_or(f64::INFINITY, f64::abs);
            Some((rank(&entry.result), size, k, pair.clone(), entry.clone()))
        };
        let most = entries
            .filter_map(size)
            .max_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        if let Some((_, _, k, pair, entry)) = most {
            let result = &entry.result;
            let quantity = quantity_label(comparison, &entry.quantity).to_lowercase();
            let difference = Difference {
                track: title,
                mark: mark(result),
                figure: format::relative_or_none(result.difference.map(f64::abs)),
                of: format!(
                    "{} of the {quantity}, {}",
                    result.metric.map_or("", Metric::label),
                    entry.window.word()
                ),
                said: words::verdict(result, format::relative),
                who: format!(
                    "{} \u{2194} {}",
                    words::short(&pair.a),
                    words::short(&pair.b)
                ),
                target: pairs::pair_id(k),
            };
            found.push((result.verdict == Verdict::Differ, difference));
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
    // An engine that cannot run a scene says so beforehand; that is no finding.
    let broken = comparison
        .engines
        .iter()
        .filter(|e| e.status.is_broken())
        .count();
    let summary = words::summary(comparison);
    let (class, sign, headline) = match (counts.exit_status(), broken) {
        (1, _) => ("fail", "\u{2715}", "Differs".to_owned()),
        (_, 1) => ("fail", "!", "1 engine did not finish".to_owned()),
        (_, 2..) => ("fail", "!", format!("{broken} engines did not finish")),
        (4, _) => ("open", "\u{25cb}", "Not confirmed".to_owned()),
        _ if comparison.passed => ("pass", "\u{2713}", "Pass".to_owned()),
        _ if comparison.unfinished == comparison.engines.len() => {
            let headline = "No engine could run this scene";
            ("open", "\u{25cb}", headline.to_owned())
        }
        _ => ("open", "\u{25cb}", "Nothing compared".to_owned()),
    };
    Banner {
        class,
        sign,
        headline,
        counts: summary.counts,
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
        inconclusive: words::inconclusive(comparison),
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
            "{n} engines, spread {}",
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
        assert_eq!(spread(&[100.0, 99.0]), "2 engines, spread 1.0\u{202f}%");
        assert_eq!(spread(&[0.0, 0.0]), "2 engines agree");
    }
}
