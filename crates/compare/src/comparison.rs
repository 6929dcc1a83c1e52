//! The result of a comparison. Serialised, this is `summary.json`.
//!
//! Nothing here has a direction: no engine is the truth. What has one by nature (ratios,
//! Sprague-Geers' M) is stored for the pair as named, `a` over `b`.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::metrics::{Metric, PairMetrics};
use crate::participant::{Context, Cost, Status, Track};
use crate::quantities::Quantity;
use crate::uncertainty::{Evidence, Method, QuantityUncertainty, Source};
use crate::validation::Budget;
use crate::verdict::{Check, Counts, Outcome, Verdict};
use crate::windows::{AbsentWindow, Window, WindowKind};
use pinwheel_courses::norms::Statistics;

/// Everything that was compared, and how it turned out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The scene.
    pub context: Context,
    /// True when something was judged and everything judged holds.
    pub passed: bool,
    /// What the verdicts amount to; a program's exit status is [`Outcome::exit_status`] of it.
    pub outcome: Outcome,
    /// The largest U that still counts as resolved, relative.
    pub resolution: f64,
    /// Verdicts over all engines and pairs.
    pub counts: Counts,
    /// Engines that did not finish.
    pub unfinished: usize,
    /// Windows compared.
    pub windows: Vec<Window>,
    /// Windows that could not be, with the reason.
    pub absent_windows: Vec<AbsentWindow>,
    /// Quantities found in the courses.
    pub quantities: Vec<Quantity>,
    /// Every engine, finished or not, in the order given.
    pub engines: Vec<EngineSummary>,
    /// Every pair of finished engines that shares a track.
    pub pairs: Vec<Pair>,
    /// One matrix per track and window.
    pub matrices: Vec<Matrix>,
}

/// One engine alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EngineSummary {
    /// Name.
    pub name: String,
    /// Track.
    pub track: Track,
    /// Version.
    pub version: String,
    /// One line on what it is.
    pub summary: String,
    /// How it differs from the native solver.
    pub differences: String,
    /// How the run ended.
    pub status: Status,
    /// What it cost.
    pub cost: Cost,
    /// Figures per window; empty unless finished.
    pub figures: Vec<Figures>,
    /// What was judged of this engine alone; empty unless finished.
    pub judged: Vec<EngineEntry>,
    /// Its numerical uncertainty per window and quantity; empty where no evidence was given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub uncertainty: Vec<QuantityUncertainty>,
    /// The runs that these rest on; `None` where there is no ladder.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ladder: Option<LadderSummary>,
}

/// What a ladder was and what it cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LadderSummary {
    /// What is refined, and the order stated for it.
    #[serde(flatten)]
    pub method: Method,
    /// The finest run's step (s) or tolerance.
    pub finest: f64,
    /// The coarser runs.
    pub rungs: Vec<RungSummary>,
    /// Wall time of all runs over that of the finest; `None` where times are not known.
    pub cost: Option<f64>,
    /// Why it was not refined further, where it was not sharp enough.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excuse: Option<String>,
}

/// One coarser run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RungSummary {
    /// Its setting over the finest run's.
    pub refinement: f64,
    /// Wall time, s.
    pub wall_s: f64,
    /// Why it has no time series.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

impl LadderSummary {
    pub(crate) fn of(evidence: &Evidence, finest_wall_s: f64) -> Option<Self> {
        let Source::Ladder(ladder) = &evidence.source else {
            return None;
        };
        let rungs = ladder.coarser.iter().map(|rung| RungSummary {
            refinement: rung.refinement,
            wall_s: rung.wall_s,
            failed: rung.run.as_ref().err().cloned(),
        });
        let coarser: f64 = ladder.coarser.iter().map(|rung| rung.wall_s).sum();
        Some(Self {
            method: ladder.method,
            finest: ladder.finest,
            rungs: rungs.collect(),
            cost: (finest_wall_s > 0.0).then(|| 1.0 + coarser / finest_wall_s),
            excuse: evidence.excuse.clone(),
        })
    }
}

/// One engine's figures in one window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// Window.
    pub window: WindowKind,
    /// Per quantity, over all its channels: mean, min, max, rms, peak.
    pub quantities: BTreeMap<String, Statistics>,
    /// Power out over power in: mean `output_torque_n_m` * mean speed of `output_angle_rad` /
    /// (mean `input_torque_n_m` * input speed). `None` without these channels or without positive
    /// input power, and in the transient window, where energy is stored and returned.
    pub efficiency: Option<f64>,
    /// Why there is no efficiency, or why it is above 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efficiency_reason: Option<String>,
    /// The efficiency with the energy that nothing accounts for added to the power in: efficiency / (1 + remainder /
    /// driver's work). Where a contact law creates energy this is the efficiency of the gear. `None` without an
    /// energy account.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efficiency_accounted: Option<f64>,
}

/// A verdict on one engine alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EngineEntry {
    /// Quantity name.
    pub quantity: String,
    /// Window.
    pub window: WindowKind,
    /// Limits checked; empty when not judged.
    pub checks: Vec<Check>,
    /// The worst of the checks.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// Two engines side by side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pair {
    /// First engine, in the order given.
    pub a: String,
    /// Second engine.
    pub b: String,
    /// The foreign engine's track, or `native` for two native runs.
    pub track: Track,
    /// One entry per window and quantity.
    pub entries: Vec<PairEntry>,
}

/// One quantity of a pair in one window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairEntry {
    /// Quantity name.
    pub quantity: String,
    /// Window.
    pub window: WindowKind,
    /// Every metric; `None` where the channels cannot be compared (see the verdict's reason).
    pub metrics: Option<PairMetrics>,
    /// Limits checked; empty when not judged.
    pub checks: Vec<Check>,
    /// The distance against the numerical uncertainty of both, metric by metric; empty where no evidence was given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub judgements: Vec<Judgement>,
    /// The same with the leading error term of every confirmed ladder taken off (Richardson).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extrapolated: Option<Judgement>,
    /// The worst of the checks and of the judgements that count.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// A distance against uncertainties. All values relative, as the metric is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judgement {
    /// Which metric.
    pub metric: Metric,
    /// D. Signed where its verdict is on a mean with a predicted sign.
    pub distance: Option<f64>,
    /// u of the first participant.
    pub u_a: Option<f64>,
    /// u of the second.
    pub u_b: Option<f64>,
    /// Whether it counts for the entry's verdict; the others are shown beside it.
    pub counts: bool,
    /// The parts of a validation uncertainty, of measured data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub budget: Option<Budget>,
    /// Why a tolerance is what it is; empty for others.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub reason: &'static str,
    /// What follows.
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl Judgement {
    /// U, where both are known.
    #[must_use]
    pub fn combined(&self) -> Option<f64> {
        Some(self.u_a? + self.u_b?)
    }
}

/// All engines of a track against each other in one window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Matrix {
    /// Track; native engines stand in every matrix.
    pub track: Track,
    /// Window.
    pub window: WindowKind,
    /// Names of rows and columns.
    pub engines: Vec<String>,
    /// The cells below the diagonal, row by row: (1,0), (2,0), (2,1), ... The matrix is symmetric.
    pub cells: Vec<Cell>,
}

/// One pair in a matrix.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// Row, an index into the matrix's engines; larger than `column`.
    pub row: usize,
    /// Column.
    pub column: usize,
    /// Index into [`Comparison::pairs`].
    pub pair: usize,
    /// The figure that decided the verdict: of what was judged the one that uses most of its limit or uncertainty. Where
    /// nothing was judged the largest relative L2 over forces and torques; `None` if there is none.
    pub worst: Option<f64>,
    /// The quantity that has it.
    pub worst_quantity: Option<String>,
    /// The metric it is of.
    pub worst_metric: Option<Metric>,
    /// U of it, where it was held against one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst_uncertainty: Option<f64>,
    /// Largest relative L2 over forces (N).
    pub force: Option<f64>,
    /// Largest relative L2 over torques (N m).
    pub torque: Option<f64>,
    /// The worst verdict over the pair's quantities in this window.
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl Matrix {
    /// The cell of two engines in either order; `None` on the diagonal.
    #[must_use]
    pub fn cell(&self, i: usize, j: usize) -> Option<&Cell> {
        let (row, column) = (i.max(j), i.min(j));
        (row != column)
            .then(|| self.cells.get(row * (row - 1) / 2 + column))
            .flatten()
    }
}
