//! Record of a run.

use std::collections::BTreeMap;

use pinwheel_compare::quantities::derive;
use pinwheel_engines::Run;
use pinwheel_gearbox::Efficiency;
use pinwheel_scene::speed_profile;
use pinwheel_timeseries::sampling::Figures;
use pinwheel_timeseries::{ABOVE_ONE, Ending, EnergyAudit, NO_LOSS, efficiency, mean_powers};
use serde::{Deserialize, Serialize};

use crate::provenance::SOURCES;
use crate::sweep::PlannedRun;
use crate::sweep::spread::WindowStatistics;
use crate::sweep::written::Written;

/// Record of a run. A repeated run gives an equal record, except for both times.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Name of the engine.
    pub engine: String,
    /// Version of the engine.
    pub engine_version: String,
    /// Build of the engine, if it is not part of this program: see [`Engine::build`](pinwheel_engines::Engine::build).
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub engine_build: String,
    /// Version of this program.
    pub pinwheel_version: String,
    /// Hash of the program's sources.
    #[serde(default)]
    pub program: String,
    /// Complete scene, TOML.
    pub scene: String,
    /// File of its time series, if stored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_series: Option<Written>,
    /// Figures by quantity; empty unless finished.
    pub figures: BTreeMap<String, WindowStatistics>,
    /// Quantities in the order of the time series.
    pub quantities: Vec<String>,
    /// Figures of equilibria, by their columns.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub balances: BTreeMap<String, f64>,
    /// Figures without a valid number in a finished run, each with the reason.
    #[serde(default)]
    pub undefined: Vec<String>,
    /// Remarks of the engine.
    pub notes: Vec<String>,
    /// Ending of the run.
    #[serde(flatten)]
    pub ending: Ending,
    /// Cost, and figures without a quantity.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// Cost of a run, and its figures without a quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Window of the figures, s.
    pub window_s: [f64; 2],
    /// Power out over power in, at most 1; `None` if meaningless, e.g. if the contact law creates power.
    pub efficiency: Option<f64>,
    /// Power out over the sum of power out and contact losses, for any law, with or without friction; `None` without an account
    /// of most of the window.
    #[serde(default)]
    pub efficiency_accounted: Option<f64>,
    /// Unaccounted energy in the run's second half, as a share of the larger work, if the engine keeps an account.
    pub energy_remainder_share: Option<f64>,
    /// Number of steps.
    pub steps: u64,
    /// Evaluations of the contact forces.
    pub rhs_calls: u64,
    /// Relative numerical uncertainty of the forces and of the driver's torque, if the engine verified its run.
    #[serde(default, rename = "numerical_uncertainty", alias = "uncertainty")]
    pub uncertainty: Option<[f64; 2]>,
    /// Wall time, s.
    pub wall_s: f64,
    /// CPU time, s.
    pub cpu_s: f64,
}

impl RunRecord {
    /// Makes the record of a run, with figures if it finished.
    pub(crate) fn of(planned: &PlannedRun, scene: &str, run: &Run) -> Self {
        let (stats, engine) = (&run.stats, &planned.engine);
        let error = run.uncertainty.as_ref().and_then(|u| u.error);
        let outcome = Outcome {
            window_s: planned.window_s,
            efficiency: None,
            efficiency_accounted: None,
            energy_remainder_share: None,
            steps: stats.steps,
            rhs_calls: stats.rhs_calls,
            uncertainty: error.map(|e| [e.forces, e.driver_torque]),
            wall_s: stats.wall_s,
            cpu_s: stats.cpu_s,
        };
        let mut record = Self {
            engine_version: engine.version(),
            engine_build: engine.build(),
            scene: scene.to_owned(),
            notes: stats.notes.clone(),
            ..Self::bare(engine.name(), run.ending.clone(), outcome)
        };
        if run.ending.is_finished() {
            record.add_figures(planned, run);
        }
        record
    }

    /// Returns the record of an outcome without figures, by this program.
    pub(super) fn bare(engine: &str, ending: Ending, outcome: Outcome) -> Self {
        Self {
            engine: engine.to_owned(),
            engine_version: String::new(),
            engine_build: String::new(),
            pinwheel_version: env!("CARGO_PKG_VERSION").to_owned(),
            program: SOURCES.to_owned(),
            scene: String::new(),
            time_series: None,
            figures: BTreeMap::new(),
            quantities: Vec::new(),
            balances: BTreeMap::new(),
            undefined: Vec::new(),
            notes: Vec::new(),
            ending,
            outcome,
        }
    }

    /// Adds the figures of a complete run.
    fn add_figures(&mut self, planned: &PlannedRun, run: &Run) {
        for figure in &run.figures {
            let key = figure.def.key.to_string();
            match figure.value {
                Some(value) => drop(self.balances.insert(key, value)),
                None => self.undefined.push(format!("{key} is not finite")),
            }
        }
        // Equilibria have no time series.
        if run.time_series.is_empty() && !run.figures.is_empty() {
            return;
        }
        let [from, to] = planned.window_s;
        let samples = run.time_series.window(from, to);
        for quantity in derive([&run.time_series]) {
            let of = |samples| {
                let name = &quantity.name;
                Figures::of(&run.time_series, name, &quantity.channels, samples)
            };
            if let Some(figure) = of(samples.clone()) {
                let mean = figure.statistics.mean;
                let late = of(samples.start + samples.len() / 2..samples.end);
                let spread = WindowStatistics {
                    drift: late.map_or(0.0, |late| (late.statistics.mean - mean).abs()),
                    statistics: figure.statistics,
                    sampling: Some(figure.sampling),
                };
                self.quantities.push(quantity.name.clone());
                self.figures.insert(quantity.name, spread);
            }
        }
        let share = run.stats.energy.last().map(|audit| audit.remainder_share);
        self.outcome.energy_remainder_share = share.flatten().filter(|share| share.is_finite());
        if share.is_some() && self.outcome.energy_remainder_share.is_none() {
            let reason = "no share of energy: no work is done in the run's second half";
            self.undefined.push(reason.to_owned());
        }
        // By works or, without an account, by means of samples: mean T_out * mean speed out / (mean T_in * speed in). Otherwise
        // the reason why it is no efficiency.
        let speed = speed_profile::final_rad_s(&planned.scene);
        let account = account(run, planned.window_s);
        let powers = account
            .and_then(|account| account.mean_powers(from, to))
            .or_else(|| mean_powers(&run.time_series, samples, speed));
        let powers = powers.ok_or("a torque or the output's angle is missing");
        match powers.and_then(|[power_in, power_out]| efficiency(power_in, power_out)) {
            Err(reason) => self.undefined.push(format!("no efficiency: {reason}")),
            // Powers that are rounding also have a ratio.
            Ok(_) if share == Some(None) => {
                let reason = "no efficiency: no work is done";
                self.undefined.push(reason.to_owned());
            }
            Ok(plain) => {
                let losses = account.and_then(Efficiency::of);
                self.outcome.efficiency_accounted = losses.map(|account| account.of_losses);
                let defined = match losses {
                    Some(account) => account.defined(),
                    None if !planned.scene.rubs() => Err(NO_LOSS.to_owned()),
                    None if plain > 1.0 => Err(ABOVE_ONE.to_owned()),
                    None => Ok(plain),
                };
                match defined {
                    Ok(defined) => self.outcome.efficiency = Some(defined),
                    Err(reason) => self.undefined.push(format!("efficiency {reason}")),
                }
            }
        }
    }

    /// Returns all inputs of the figures, as text: records with equal identity have equal figures.
    pub fn identity(&self) -> String {
        let made_by = (&*self.engine, &*self.engine_version, &*self.engine_build);
        let program = (&*self.pinwheel_version, &*self.program);
        identity(made_by, program, self.outcome.window_s, &self.scene)
    }
}

/// Returns the account that shares most of the window.
fn account(run: &Run, [from, to]: [f64; 2]) -> Option<&EnergyAudit> {
    let shared = |audit: &&EnergyAudit| audit.overlap(from, to);
    let near = run.stats.energy.iter().filter(|audit| shared(audit) > 0.5);
    near.max_by(|a, b| shared(a).total_cmp(&shared(b)))
}

/// Returns all inputs of a run's figures, as text: the engine with version and build, the program's version and sources, the
/// window, and the complete scene as TOML.
pub(super) fn identity(
    (engine, version, build): (&str, &str, &str),
    (pinwheel, program): (&str, &str),
    window_s: [f64; 2],
    scene: &str,
) -> String {
    format!("{engine}\n{version}\n{build}\n{pinwheel}\n{program}\n{window_s:?}\n{scene}")
}
