//! Cost of one error with every engine, and the lead of the native solver over the fastest peer.

use pinwheel_engines::SharedModel;
use serde::Serialize;

use super::WorkPrecision;
use super::front::CostAt;
use super::series::{Measure, Series};

/// Cost of the error in one series.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Entry {
    /// Name of engine and method.
    pub label: String,
    /// Shared model of the engine.
    pub track: SharedModel,
    /// CPU time, s; `None` if no run finished.
    pub cpu_s: Option<CostAt>,
    /// Right-hand-side calls; `None` if no run finished or they are not counted.
    pub rhs_calls: Option<CostAt>,
}

/// Advantage of the native solver over its peers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Advantage {
    /// Fastest native series.
    pub native: String,
    /// CPU time of the native series, s.
    pub native_cpu_s: CostAt,
    /// Fastest peer, or the one with the lowest bound.
    pub peer: String,
    /// CPU time of the peer, s.
    pub peer_cpu_s: CostAt,
    /// CPU time of the peer over that of the native series.
    pub ratio: f64,
    /// True if the ratio is a lower bound: the native cost is an upper bound, or the peer's a lower one.
    pub at_least: bool,
}

/// All series at one error in one window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranking {
    /// Name of the window.
    pub window: String,
    /// Relative L2 force error.
    pub error: f64,
    /// Costs in the order of the series.
    pub entries: Vec<Entry>,
    /// Advantage of the native solver; `None` if it does not reach the error, or there is no peer.
    pub advantage: Option<Advantage>,
}

impl WorkPrecision {
    /// Ranks all series at a relative L2 force error in window `window`.
    ///
    /// Own-contact peers count if they reach the error; otherwise their model, not their step, is the reason. A peer that
    /// shares the law then counts with its lower bound.
    pub fn ranking(&self, window: usize, error: f64) -> Ranking {
        let entry = |series: &Series| Entry {
            label: series.label(),
            track: series.track,
            cpu_s: series.cost_at(window, error, Measure::Cpu),
            rhs_calls: series.cost_at(window, error, Measure::Rhs),
        };
        let entries: Vec<Entry> = self.series.iter().map(entry).collect();
        Ranking {
            window: self.windows.get(window).map_or("", |w| &w.name).to_owned(),
            error,
            advantage: advantage(&entries),
            entries,
        }
    }
}

/// Returns the advantage of the fastest native series over the fastest peer; `None` without either.
pub fn advantage(entries: &[Entry]) -> Option<Advantage> {
    let cheapest = |take: &dyn Fn(&Entry, CostAt) -> bool| {
        let known = entries
            .iter()
            .filter_map(|entry| Some((entry, entry.cpu_s?)));
        let known = known.filter(|&(entry, cost)| take(entry, cost));
        known.min_by(|a, b| a.1.value().total_cmp(&b.1.value()))
    };
    let (native, native_cost) =
        cheapest(&|entry, cost| entry.track == SharedModel::Native && cost.reached())?;
    let (peer, peer_cost) = cheapest(&|entry, cost| match entry.track {
        SharedModel::Native | SharedModel::Measured => false,
        SharedModel::SharedLaw => true,
        SharedModel::OwnContact => cost.reached(),
    })?;
    Some(Advantage {
        native: native.label.clone(),
        native_cpu_s: native_cost,
        peer: peer.label.clone(),
        peer_cpu_s: peer_cost,
        ratio: peer_cost.value() / native_cost.value(),
        at_least: match peer_cost {
            CostAt::AtMost(_) => false,
            CostAt::MoreThan(_) => true,
            CostAt::Interpolated(_) => matches!(native_cost, CostAt::AtMost(_)),
        },
    })
}
