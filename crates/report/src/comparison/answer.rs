//! The top of the page: the verdict in one sentence, and the figures people come for.

use pinwheel_compare::comparison::{EngineSummary, Pair, PairEntry};
use pinwheel_compare::uncertainty::Norm;
use pinwheel_compare::{Comparison, Metric, Quantity, Track, Verdict, WindowKind, quantities};
use pinwheel_timeseries::norms::Statistics;
use pinwheel_timeseries::table::Table;

use super::{Page, mark, pairs};
use crate::study::{self, Block, Tile, Tone};
use crate::{format, words};

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
        let first = self.comparison.windows.first().map(|w| w.kind);
        let of = first.and_then(|window| Some((window, self.best(window)?)));
        of.map_or_else(String::new, |(window, engine)| {
            format!("{}, by {}", self.window(window), engine.name)
        })
    }

    /// The engines that the tiles speak of: those that share the contact law, or all if none does.
    fn shown(&self) -> Vec<&EngineSummary> {
        let all = self.comparison.engines.iter();
        let finished: Vec<&EngineSummary> = all.filter(|e| e.status.is_finished()).collect();
        let shares = |e: &&EngineSummary| matches!(e.track, Track::Native | Track::SharedLaw);
        let sharing: Vec<&EngineSummary> = finished.iter().copied().filter(shares).collect();
        match sharing.is_empty() {
            true => finished,
            false => sharing,
        }
    }

    /// The one of them whose figures are shown: not recorded, and of the smallest uncertainty.
    fn best(&self, window: WindowKind) -> Option<&EngineSummary> {
        let off = |engine: &EngineSummary| {
            let known = self.comparison.quantities.iter().filter(|q| q.is_load());
            let shares = known.filter_map(|q| {
                let size = engine.figures_in(window)?.quantities.get(&q.name)?.rms;
                Some(engine.u(&q.name, window, Norm::L2)? / size)
            });
            shares.reduce(f64::max).unwrap_or(f64::INFINITY)
        };
        let rank = |engine: &EngineSummary| (engine.cost.recorded.is_some(), off(engine));
        let mut engines = self.shown();
        engines.retain(|engine| engine.figures_in(window).is_some());
        engines.into_iter().min_by(|a, b| {
            let (a, b) = (rank(a), rank(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        })
    }

    /// Headline figures: torques by their mean, forces by their largest value, and the efficiency, of one engine at all its
    /// samples; how far the others are from it beside them.
    pub(super) fn tiles(&self) -> Vec<Tile> {
        let Some(window) = self.comparison.windows.first().map(|w| w.kind) else {
            return Vec::new();
        };
        let Some(best) = self.best(window) else {
            return Vec::new();
        };
        let loads = self.comparison.quantities.iter().filter(|q| q.is_load());
        let tiles = loads.filter_map(|q| self.tile(best, q, window));
        tiles.chain(efficiency(best, window)).collect()
    }

    fn tile(&self, best: &EngineSummary, of: &Quantity, window: WindowKind) -> Option<Tile> {
        let own = best.figures_in(window)?.quantities.get(&of.name)?;
        let engines = self.shown();
        let figures = engines.iter().filter_map(|e| e.figures_in(window));
        let statistics = figures.filter_map(|f| f.quantities.get(&of.name));
        let scales = self.comparison.context.scales;
        type Of = fn(&Statistics) -> f64;
        let (main, kind, norm, scale, mut detail): (Of, _, _, _, _) = if of.is_torque() {
            let range = [own.min, own.max].map(format::figure).join(" to ");
            (|s| s.mean, "mean", Norm::Mean, scales.torque_n_m, range)
        } else {
            let [mean, rms] = [own.mean, own.rms].map(format::figure);
            let rest = format!("mean {mean}, rms {rms}");
            (|s| s.max, "largest", Norm::Peak, scales.force_n, rest)
        };
        let load = self.comparison.context.load_n_m;
        if let Some(load) = load.filter(|_| of.name == quantities::OUTPUT_TORQUE) {
            detail.push_str(&format!("; load {}", format::significant(load, 3)));
        }
        let known = best.u(&of.name, window, norm);
        let (value, off) = format::bounded(main(own), known, scale.unwrap_or(0.0));
        let all: Vec<f64> = statistics.map(main).collect();
        let detail = match value.as_str() {
            "0" => format!("{} engines, all of them rounding", all.len()),
            _ => format!("{detail}; {}", spread(&all)),
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

/// The efficiency, or why there is none.
fn efficiency(best: &EngineSummary, window: WindowKind) -> Option<Tile> {
    let figures = best.figures_in(window)?;
    // How far it may be off: its powers are those of the mean torques.
    let share = |name: &str| {
        let mean = figures.quantities.get(name)?.mean.abs();
        let share = best.u(name, window, Norm::Mean)? / mean;
        Some(share).filter(|share| share.is_finite())
    };
    let [driver, load] = [quantities::INPUT_TORQUE, quantities::OUTPUT_TORQUE].map(share);
    let off = driver.zip(load).map(|(driver, load)| driver + load);
    match (figures.efficiency, &figures.efficiency_reason) {
        (Some(value), _) => {
            let percent = 100.0 * value;
            let (value, off) = format::bounded(percent, off.map(|off| off * percent), 0.0);
            Some(Tile::new("Efficiency", value, "by what contacts lose").unit(format!("{off} %")))
        }
        (None, Some(reason)) => Some(Tile::new("Efficiency", format::NONE, reason.as_str())),
        (None, None) => None,
    }
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
    fn spreads() {
        assert_eq!(spread(&[2.0]), "one engine");
        assert_eq!(spread(&[100.0, 99.0]), "2 engines, spread 1.0\u{202f}%");
        assert_eq!(spread(&[0.0, 0.0]), "2 engines agree");
    }
}
