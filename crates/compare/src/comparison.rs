//! Result of a comparison, serialised as `summary.json`.
//!
//! No figure has a direction, because no engine is the truth. Quantities that need one (ratios, Sprague-Geers' M) are those of
//! `a` over `b`.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::metrics::PairMetrics;
use crate::participant::{Context, Cost, SharedModel, Status};
use crate::quantities::Quantity;
use crate::shown::Finding;
use crate::uncertainty::{Evidence, Method, Norm, QuantityUncertainty, Source};
use crate::verdict::{Assessment, Counts};
use crate::windows::{AbsentWindow, Window, WindowKind};
use pinwheel_timeseries::norms::Statistics;

/// Result of a comparison: all engines, pairs, figures and verdicts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Facts of the scene.
    pub context: Context,
    /// True if [`exit_status`](Self::exit_status) is 0.
    pub passed: bool,
    /// Evidence for each item that the user brought; one finding for all engines together if the user brought none.
    pub findings: Vec<Finding>,
    /// Largest U that still counts as resolved, relative.
    pub resolution: f64,
    /// Verdicts over all engines and pairs.
    pub counts: Counts,
    /// Engines that did not finish.
    pub unfinished: usize,
    /// Windows compared.
    pub windows: Vec<Window>,
    /// Windows that cannot be compared, with the reason.
    pub absent_windows: Vec<AbsentWindow>,
    /// Quantities of the time series.
    pub quantities: Vec<Quantity>,
    /// Every engine, finished or not, in input order.
    pub engines: Vec<EngineSummary>,
    /// Every pair of finished engines that shares a track.
    pub pairs: Vec<Pair>,
    /// Matrices, one per track and window.
    pub matrices: Vec<Matrix>,
}

impl Comparison {
    /// Returns the exit status of a program: 1 with a difference; 4 if an item of the user's lacks evidence, or if a
    /// setting would settle an inconclusive verdict; else 0.
    pub fn exit_status(&self) -> u8 {
        let findings = self.findings.iter().map(|finding| finding.status);
        let all = || findings.clone().chain([self.counts.exit_status()]);
        match all().any(|status| status == 1) {
            true => 1,
            false => all().max().unwrap_or(0),
        }
    }
}

/// Figures, verdicts and evidence of an engine alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EngineSummary {
    /// Name.
    pub name: String,
    /// Parts of the model shared with the native solver.
    pub track: SharedModel,
    /// Version.
    pub version: String,
    /// One-line description of the engine.
    pub summary: String,
    /// Differences from the native solver.
    pub differences: String,
    /// Ending of the run.
    pub status: Status,
    /// Cost of the run.
    pub cost: Cost,
    /// Figures per window; empty unless finished.
    pub figures: Vec<Figures>,
    /// Verdicts about this engine alone; empty unless finished.
    pub judged: Vec<EngineEntry>,
    /// Numerical uncertainty per window and quantity; empty without evidence.
    #[serde(
        rename = "numerical_uncertainty",
        skip_serializing_if = "Vec::is_empty"
    )]
    pub uncertainty: Vec<QuantityUncertainty>,
    /// Refinement study behind these uncertainties; `None` without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refinement: Option<RefinementSummary>,
}

impl EngineSummary {
    /// Returns the engine's uncertainty of a quantity in a window; `None` without evidence.
    pub(crate) fn uncertainty_of(
        &self,
        quantity: &str,
        window: WindowKind,
    ) -> Option<&QuantityUncertainty> {
        let mut all = self.uncertainty.iter();
        all.find(|u| u.quantity == quantity && u.window == window)
    }

    /// Returns the uncertainty of the engine's figure, in the quantity's unit; `None` if it is unknown.
    pub fn u(&self, quantity: &str, window: WindowKind, norm: Norm) -> Option<f64> {
        self.uncertainty_of(quantity, window)?.of(norm).u()
    }

    /// Returns the engine's figures in a window.
    pub fn figures_in(&self, window: WindowKind) -> Option<&Figures> {
        self.figures.iter().find(|figures| figures.window == window)
    }
}

/// Summary of a refinement study, and its cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RefinementSummary {
    /// Refined setting, and the order stated for it.
    #[serde(flatten)]
    pub method: Method,
    /// The finest run's step (s) or tolerance.
    pub finest: f64,
    /// Coarser runs.
    pub levels: Vec<LevelSummary>,
    /// Wall time of all runs over that of the finest; `None` where times are not known.
    pub cost: Option<f64>,
    /// Reason why the refinement stopped before the required uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Coarser run of a refinement study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelSummary {
    /// Ratio of the setting to the finest run's.
    pub refinement: f64,
    /// Wall time, s.
    pub wall_s: f64,
    /// Reason why the run has no time series.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

impl RefinementSummary {
    pub(crate) fn of(evidence: &Evidence, finest_wall_s: f64) -> Option<Self> {
        let Source::Refinement(ladder) = &evidence.source else {
            return None;
        };
        let levels = ladder.coarser.iter().map(|level| LevelSummary {
            refinement: ladder.refinement(level),
            wall_s: level.wall_s,
            failed: level.run.as_ref().err().cloned(),
        });
        let coarser: f64 = ladder.coarser.iter().map(|level| level.wall_s).sum();
        Some(Self {
            method: ladder.method,
            finest: ladder.finest,
            levels: levels.collect(),
            cost: (finest_wall_s > 0.0).then(|| 1.0 + coarser / finest_wall_s),
            reason: evidence.is_final.as_ref().map(|why| why.reason.clone()),
        })
    }
}

/// Figures of an engine in a window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// Window.
    pub window: WindowKind,
    /// Per quantity, over all its channels: mean, min, max, rms, peak.
    pub quantities: BTreeMap<String, Statistics>,
    /// Error of each figure from the signal between samples.
    pub sampling: BTreeMap<String, Statistics>,
    /// Power out over power in: mean `output_torque_n_m` * mean speed of `output_angle_rad` /
    /// (mean `input_torque_n_m` * input speed). `None` without these channels or without positive
    /// input power, and in the transient window, where energy is stored and returned.
    pub efficiency: Option<f64>,
    /// Reason why there is no efficiency, or why it exceeds 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efficiency_reason: Option<String>,
}

/// Verdict on an engine alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EngineEntry {
    /// Quantity name.
    pub quantity: String,
    /// Window.
    pub window: WindowKind,
    /// Verdict with its figures.
    #[serde(flatten)]
    pub result: Assessment,
}

/// Two engines side by side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pair {
    /// First engine, in input order.
    pub a: String,
    /// Second engine.
    pub b: String,
    /// Model that the foreign engine shares; `native` for two native runs.
    pub track: SharedModel,
    /// Entries, one per window and quantity.
    pub entries: Vec<PairEntry>,
}

/// Comparison of a quantity of a pair in a window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairEntry {
    /// Quantity name.
    pub quantity: String,
    /// Window.
    pub window: WindowKind,
    /// Every metric; `None` where the channels cannot be compared (see the verdict's reason).
    pub metrics: Option<PairMetrics>,
    /// Assessment of the difference in every metric against its bound; empty where no bound applies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub assessments: Vec<Assessment>,
    /// Gravest assessment among those that decide.
    #[serde(flatten)]
    pub result: Assessment,
}

/// Pairwise comparison of all engines of a track in one window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Matrix {
    /// Shared model of the engines; native engines are in every matrix.
    pub track: SharedModel,
    /// Window.
    pub window: WindowKind,
    /// Names of rows and columns.
    pub engines: Vec<String>,
    /// Cells below the diagonal, row by row: (1,0), (2,0), (2,1), ... The matrix is symmetric.
    pub cells: Vec<Cell>,
}

/// Cell of a matrix: a pair of engines.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// Row, an index into the matrix's engines; larger than `column`.
    pub row: usize,
    /// Column.
    pub column: usize,
    /// Index into [`Comparison::pairs`].
    pub pair: usize,
    /// Quantity of the gravest verdict.
    pub quantity: Option<String>,
    /// Largest relative L2 over forces (N).
    pub force: Option<f64>,
    /// Largest relative L2 over torques (N m).
    pub torque: Option<f64>,
    /// Gravest assessment of the pair's quantities in this window; the largest relative L2 over forces and torques if nothing
    /// was compared.
    #[serde(flatten)]
    pub result: Assessment,
}

impl Matrix {
    /// Returns the cell of two engines in either order; `None` on the diagonal.
    pub fn cell(&self, i: usize, j: usize) -> Option<&Cell> {
        let (row, column) = (i.max(j), i.min(j));
        (row != column)
            .then(|| self.cells.get(row * (row - 1) / 2 + column))
            .flatten()
    }
}
