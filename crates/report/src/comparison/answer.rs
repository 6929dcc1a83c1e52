//! The top of the page: the verdict in one sentence, and the figures people come for.

use pinwheel_compare::comparison::{EngineSummary, Pair, PairEntry};
use pinwheel_compare::uncertainty::Norm;
use pinwheel_compare::{Comparison, Metric, Quantity, Track, Verdict, WindowKind, quantities};
use pinwheel_timeseries::norms::Statistics;
use pinwheel_timeseries::table::Table;

use super::{Page, mark, pairs};
use crate::study::{self, Block, Tile, Tone};
use crate::{format, words};

/// Difference of two efficiencies that a reader sees.
const VISIBLE_SHARE: f64 = 1e-6;

/// The verdict.
pub(super) fn verdict(comparison: &Comparison) -> study::Verdict {
    let engines = || comparison.engines.iter();
    // An engine that cannot run a scene says so beforehand; that is no finding.
    let broken = engines().filter(|e| e.status.is_broken()).count();
    let finished = engines().filter(|e| e.status.is_finished()).count();
    let (tone, headline) = match (comparison.counts.exit_status(), broken) {
        (1, _) => (Tone::Bad, "Differs".to_owned()),
        (_, 1) => (Tone::Bad, "1 engine did not finish".to_owned()),
        (_, 2..) => (Tone::Bad, format!("{broken} engines did not finish")),
        (4, _) => (Tone::Open, "Not confirmed".to_owned()),
        _ if comparison.passed => (Tone::Good, "Pass".to_owned()),
        _ if finished == 0 => (Tone::Open, "No engine could run this scene".to_owned()),
        _ => (Tone::Open, "Nothing compared".to_owned()),
    };
    let counts = words::counts(comparison);
    let all = comparison.engines.len();
    study::Verdict {
        tone,
        headline,
        detail: format!("{counts}; {finished} of {all} engines finished"),
    }
}

/// Who leaves something to act on inconclusive, and who did not finish.
pub(super) fn inconclusive(comparison: &Comparison) -> Vec<Block> {
    let open = words::inconclusive(comparison).into_iter();
    let open = open.map(|(who, why)| format!("`{who}` inconclusive: {why}"));
    let lost = |broken: bool| {
        let engines = comparison.engines.iter();
        let engines = engines.filter(move |e| e.status.is_broken() == broken);
        engines.filter_map(|e| Some(format!("`{}` {}", e.name, e.status.reason()?)))
    };
    let told: Vec<String> = open.chain(lost(true)).collect();
    let out: Vec<String> = lost(false).collect();
    let mut blocks = Vec::new();
    if !told.is_empty() {
        blocks.push(Block::List(told));
    }
    if !out.is_empty() {
        let summary = format!("Left out: {}", out.len());
        blocks.push(Block::folded(summary, [Block::List(out)]));
    }
    blocks
}

impl Page<'_> {
    /// What the tiles are of.
    pub(super) fn tiles_title(&self) -> String {
        let first = self.comparison.windows.first();
        let window = first.map_or_else(String::new, |w| self.window(w.kind));
        format!("{window}; median of the engines that share the contact law")
    }

    /// Headline figures: torques by their mean, forces by their largest value, and the efficiency; each the median of the
    /// engines that share the contact law, or of all if none does.
    pub(super) fn tiles(&self) -> Vec<Tile> {
        let Some(window) = self.comparison.windows.first().map(|w| w.kind) else {
            return Vec::new();
        };
        let all = self.comparison.engines.iter();
        let finished: Vec<&EngineSummary> = all.filter(|e| e.status.is_finished()).collect();
        let mut engines = finished.clone();
        engines.retain(|e| matches!(e.track, Track::Native | Track::SharedLaw));
        if engines.is_empty() {
            engines = finished;
        }
        let loads = self.comparison.quantities.iter().filter(|q| q.is_load());
        let tiles = loads.filter_map(|q| self.tile(&engines, q, window));
        tiles.chain(self.efficiency(&engines, window)).collect()
    }

    fn efficiency(&self, engines: &[&EngineSummary], window: WindowKind) -> Option<Tile> {
        let figures = || engines.iter().filter_map(|e| e.figures_in(window));
        let all: Vec<f64> = figures().filter_map(|f| f.efficiency).collect();
        let value = median(&all)?;
        // Only where the law's own energy is seen.
        let both = figures().filter_map(|f| f.efficiency.zip(f.efficiency_accounted));
        let seen = both.filter(|(plain, own)| (plain - own).abs() > VISIBLE_SHARE);
        let own = median(&seen.map(|(_, own)| own).collect::<Vec<_>>());
        let own = own.map(|own| {
            let own = format::significant(100.0 * own, 5);
            format!("{own}\u{202f}% without the energy that the contact law creates; ")
        });
        // How far an efficiency may be off: its powers are those of the mean torques.
        let share = |engine: &EngineSummary, name: &str| {
            let mean = engine.figures_in(window)?.quantities.get(name)?.mean.abs();
            let share = engine.u(name, window, Norm::Mean)? / mean;
            Some(share).filter(|share| share.is_finite())
        };
        let shares = engines.iter().filter_map(|engine| {
            let [driver, load] = [quantities::INPUT_TORQUE, quantities::OUTPUT_TORQUE];
            Some(share(engine, driver)? + share(engine, load)?)
        });
        let off = median(&shares.collect::<Vec<_>>()).map_or_else(String::new, |share| {
            let off = format::significant(100.0 * value.abs() * share, 1);
            format!("\u{b1}\u{202f}{off} ")
        });
        let detail = format!("{}{}", own.unwrap_or_default(), spread(&all));
        let value = format::significant(100.0 * value, 5);
        Some(Tile::new("Efficiency", value, detail).unit(format!("{off}%")))
    }

    fn tile(&self, engines: &[&EngineSummary], of: &Quantity, window: WindowKind) -> Option<Tile> {
        let figures = engines.iter().filter_map(|e| e.figures_in(window));
        let statistics: Vec<&Statistics> =
            figures.filter_map(|f| f.quantities.get(&of.name)).collect();
        let all = |of: fn(&Statistics) -> f64| statistics.iter().map(|s| of(s)).collect::<Vec<_>>();
        let figure = |of| median(&all(of)).map(format::figure);
        let scales = self.comparison.context.scales;
        let (main, kind, norm, scale, mut detail) = if of.is_torque() {
            let range = format!("{} to {}", figure(|s| s.min)?, figure(|s| s.max)?);
            (
                all(|s| s.mean),
                "mean",
                Norm::Mean,
                scales.torque_n_m,
                range,
            )
        } else {
            let rest = format!("mean {}, rms {}", figure(|s| s.mean)?, figure(|s| s.rms)?);
            (all(|s| s.max), "largest", Norm::Peak, scales.force_n, rest)
        };
        let load = self.comparison.context.load_n_m;
        if let Some(load) = load.filter(|_| of.name == quantities::OUTPUT_TORQUE) {
            detail.push_str(&format!("; load {}", format::significant(load, 3)));
        }
        let known = engines.iter().filter_map(|e| e.u(&of.name, window, norm));
        let known: Vec<f64> = known.collect();
        let (value, off) = format::bounded(median(&main)?, median(&known), scale.unwrap_or(0.0));
        let detail = if value == "0" {
            format!("{} engines, all of them rounding", main.len())
        } else {
            format!("{detail}; {}", spread(&main))
        };
        let label = format!("{}, {kind}", of.label);
        Some(Tile::new(label, value, detail).unit(format!("{off} {}", of.unit)))
    }

    /// What stands below the tiles: what differs most on each track, gravest first, and remarks.
    pub(super) fn below(&self) -> Vec<Block> {
        let mut found = Vec::new();
        for (track, title) in [
            (Track::Measured, "Measured data"),
            (Track::OwnContact, "Own contact"),
            (Track::SharedLaw, "Shared law"),
            (Track::Native, "Native"),
        ] {
            let pairs = self.comparison.pairs.iter().enumerate();
            let pairs = pairs.filter(|(_, pair)| pair.track == track);
            let entries =
                pairs.flat_map(|(k, pair)| pair.entries.iter().map(move |e| (k, pair, e)));
            let entries = entries.filter(|(.., entry)| entry.result.metric.is_some());
            // What is inconclusive with nothing to act on says less than what agrees.
            let rank = |entry: &PairEntry| match entry.result.rank() {
                2 => 0,
                rank => 1 + rank,
            };
            let size = |e: &PairEntry| e.result.difference.map_or(f64::INFINITY, f64::abs);
            let most = entries
                .max_by(|(.., a), (.., b)| rank(a).cmp(&rank(b)).then(size(a).total_cmp(&size(b))));
            found.extend(most.map(|(k, pair, entry)| (title, k, pair, entry)));
        }
        found.sort_by_key(|(.., entry)| entry.result.verdict != Verdict::Differ);
        let who = |pair: &Pair| {
            let [a, b] = [&pair.a, &pair.b].map(|name| words::short(name));
            format!("{a} \u{2194} {b}")
        };
        let most = Table::of("What differs most", &found)
            .text("", "Pair", |(title, _, pair, _)| {
                format!("{title}: {}", who(pair))
            })
            .linked(|(_, k, ..)| Some(pairs::id(*k)))
            .number("", "D", |(.., entry)| entry.result.difference.map(f64::abs))
            .said(|(.., entry)| format::relative_or_none(entry.result.difference.map(f64::abs)))
            .text("", "Of", |(.., entry)| {
                let metric = entry.result.metric.map_or("", Metric::label);
                format!(
                    "{metric} of the {}",
                    self.place(&entry.quantity, entry.window)
                )
            })
            .text("", "Verdict", |(.., entry)| {
                words::verdict(&entry.result, format::relative)
            })
            .marked(|(.., entry)| mark(&entry.result))
            .done();
        let windows = words::of_windows(self.comparison);
        let divergence = self.comparison.context.divergence.iter();
        let divergence = divergence.map(|d| d.told.clone());
        let remarks = windows.chain(divergence).map(Block::Text);
        let most = (!most.is_empty()).then_some(Block::Table(most));
        most.into_iter().chain(remarks).collect()
    }
}

/// The middle value; of an even number the smaller of the two middle ones, so that it is always
/// some engine's figure.
fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len().checked_sub(1)? / 2).copied()
}

fn spread(values: &[f64]) -> String {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
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
