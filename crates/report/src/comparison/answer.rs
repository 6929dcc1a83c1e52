//! The top of the page: the verdict in one sentence, and the figures people come for.

use pinwheel_compare::comparison::EngineSummary;
use pinwheel_compare::uncertainty::Norm;
use pinwheel_compare::{Comparison, Quantity, SharedModel, WindowKind, quantities};
use pinwheel_timeseries::norms::Statistics;

use super::Page;
use crate::study::{self, Block, Tile, Tone};
use crate::{format, words};

/// The verdict.
#[must_use]
pub fn verdict(comparison: &Comparison) -> study::Verdict {
    let engines = || comparison.engines.iter();
    // An engine that cannot run a scene says so beforehand; that is no finding.
    let broken = engines().filter(|e| e.status.is_broken()).count();
    let finished = engines().filter(|e| e.status.is_finished()).count();
    let (tone, headline) = match (comparison.exit_status(), broken) {
        _ if finished == 0 => (Tone::Open, "No engine could run this scene".to_owned()),
        (1, _) => (Tone::Bad, "Differs".to_owned()),
        (_, 1) => (Tone::Bad, "1 engine did not finish".to_owned()),
        (_, 2..) => (Tone::Bad, format!("{broken} engines did not finish")),
        (0, _) => (Tone::Good, "Pass".to_owned()),
        _ => (Tone::Open, "Not confirmed".to_owned()),
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

/// A headline figure: of one engine at all its samples.
#[derive(Debug, Clone)]
pub struct Headline<'a> {
    /// Its quantity.
    pub quantity: &'a Quantity,
    /// Name of the figure, e.g. `External sleeve force, largest`.
    pub label: String,
    /// The figure, in the quantity's unit.
    pub value: f64,
    /// How far it is from the exact solution of its equations, in the same unit; `None`: not known.
    pub numerical: Option<f64>,
    /// Size of rounding, in the figure's unit.
    pub scale: f64,
    /// Other figures of the same, and how far the other engines are from it.
    pub detail: String,
}

impl Headline<'_> {
    /// The figure, and after \u{b1} how far it is off.
    #[must_use]
    pub fn words(&self) -> (String, String) {
        format::bounded(self.value, self.numerical, self.scale)
    }
}

/// The engine that speaks for all, with the window that it is asked about: of those that share the contact law, or of all if
/// none does, one that is not recorded, and of those the one of the smallest uncertainty.
#[must_use]
pub fn best(comparison: &Comparison) -> Option<(&EngineSummary, WindowKind)> {
    // Of a run that does not come to be steady all of it: its largest force may come after the start-up.
    let windows = comparison.windows.iter().map(|window| window.kind);
    let window = windows.min_by_key(|kind| *kind == WindowKind::Transient)?;
    let rank = |e: &EngineSummary| {
        let off = numerical(comparison, e, window).unwrap_or(f64::INFINITY);
        (e.cost.recorded.is_some(), off)
    };
    let mut engines = shown(comparison);
    engines.retain(|engine| engine.figures_in(window).is_some());
    let best = engines.into_iter().min_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    Some((best?, window))
}

/// How far an engine's torques and forces are from the exact solution of its equations, as a share of themselves at most.
#[must_use]
pub fn numerical(
    comparison: &Comparison,
    engine: &EngineSummary,
    window: WindowKind,
) -> Option<f64> {
    let known = comparison.quantities.iter().filter(|q| q.is_load());
    let shares = known.filter_map(|q| {
        let size = engine.figures_in(window)?.quantities.get(&q.name)?.rms;
        Some(engine.u(&q.name, window, Norm::L2)? / size)
    });
    shares.reduce(f64::max)
}

/// The engines that share the contact law, or all if none does.
fn shown(comparison: &Comparison) -> Vec<&EngineSummary> {
    let all = comparison.engines.iter();
    let finished: Vec<&EngineSummary> = all.filter(|e| e.status.is_finished()).collect();
    let shares =
        |e: &&EngineSummary| matches!(e.track, SharedModel::Native | SharedModel::SharedLaw);
    let sharing: Vec<&EngineSummary> = finished.iter().copied().filter(shares).collect();
    match sharing.is_empty() {
        true => finished,
        false => sharing,
    }
}

/// Headline figures: torques by their mean, forces by their largest value.
#[must_use]
pub fn headlines(comparison: &Comparison) -> Vec<Headline<'_>> {
    let Some((best, window)) = best(comparison) else {
        return Vec::new();
    };
    let loads = comparison.quantities.iter().filter(|q| q.is_load());
    let found = loads.filter_map(|q| headline(comparison, best, q, window));
    found.collect()
}

fn headline<'a>(
    comparison: &Comparison,
    best: &EngineSummary,
    of: &'a Quantity,
    window: WindowKind,
) -> Option<Headline<'a>> {
    let own = best.figures_in(window)?.quantities.get(&of.name)?;
    let engines = shown(comparison);
    let figures = engines.iter().filter_map(|e| e.figures_in(window));
    let statistics = figures.filter_map(|f| f.quantities.get(&of.name));
    let scales = comparison.context.scales;
    type Of = fn(&Statistics) -> f64;
    let (main, kind, norm, scale, mut detail): (Of, _, _, _, _) = if of.is_torque() {
        let range = [own.min, own.max].map(format::figure).join(" to ");
        (|s| s.mean, "mean", Norm::Mean, scales.torque_n_m, range)
    } else {
        let [mean, rms] = [own.mean, own.rms].map(format::figure);
        let rest = format!("mean {mean}, rms {rms}");
        (|s| s.max, "largest", Norm::Peak, scales.force_n, rest)
    };
    let load = comparison.context.load_n_m;
    if let Some(load) = load.filter(|_| of.name == quantities::OUTPUT_TORQUE) {
        detail.push_str(&format!("; load {}", format::significant(load, 3)));
    }
    let mut found = Headline {
        quantity: of,
        label: format!("{}, {kind}", of.label),
        value: main(own),
        numerical: best.u(&of.name, window, norm),
        scale: scale.unwrap_or(0.0),
        detail: String::new(),
    };
    let all: Vec<f64> = statistics.map(main).collect();
    found.detail = match found.words().0.as_str() {
        "0" => format!("{} engines, all of them rounding", all.len()),
        _ => format!("{detail}; {}", spread(&all)),
    };
    Some(found)
}

impl Page<'_> {
    /// Title of the tiles: their window and engine.
    pub(super) fn tiles_title(&self) -> String {
        best(self.comparison).map_or_else(String::new, |(engine, window)| {
            format!("{}, by {}", self.window(window), engine.name)
        })
    }

    /// Headline figures and the efficiency.
    pub(super) fn tiles(&self) -> Vec<Tile> {
        let tiles = headlines(self.comparison).into_iter().map(|found| {
            let (value, off) = found.words();
            let unit = format!("{off} {}", found.quantity.unit);
            Tile::new(found.label, value, found.detail).unit(unit)
        });
        let efficiency = best(self.comparison);
        let efficiency = efficiency.and_then(|(best, window)| efficiency_of(best, window));
        tiles.chain(efficiency).collect()
    }

    /// Blocks below the tiles: remarks.
    pub(super) fn below(&self) -> Vec<Block> {
        let windows = words::of_windows(self.comparison);
        let divergence = self.comparison.context.divergence.iter();
        let divergence = divergence.map(|d| d.told.clone());
        windows.chain(divergence).map(Block::Text).collect()
    }
}

/// The efficiency, or why there is none.
#[must_use]
pub fn efficiency_of(best: &EngineSummary, window: WindowKind) -> Option<Tile> {
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
            Some(Tile::new("Efficiency", value, "by what is lost").unit(format!("{off} %")))
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
