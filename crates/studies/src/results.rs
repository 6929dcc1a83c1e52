//! Main figures of a run: driver's torque, peaks of the forces and efficiency after the start-up, each with its uncertainty
//! if known.

use pinwheel_compare::quantities::{derive, label_and_unit};
use pinwheel_engines::Run;
use pinwheel_gearbox::{Distance, Efficiency};
use pinwheel_scene::{CheckedScene, Scales};
use pinwheel_timeseries::figure::definitions::{SHARE_CREATED, SHARE_DELIVERED, SHARE_LOST};
use pinwheel_timeseries::figure::{Figure, FigureDef};
use pinwheel_timeseries::sampling::Figures;
use pinwheel_timeseries::{TimeSeries, columns};
use serde::Serialize;

use crate::band::Bands;

/// Figures of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Results {
    /// Start of their window, s; it ends with the run.
    pub from_s: f64,
    /// Source of the uncertainties.
    #[serde(rename = "numerical_uncertainty")]
    pub uncertainty: &'static str,
    /// Figures in display order.
    pub figures: Vec<Figure>,
}

/// Returns the start of a run's results, s: the last window of its energy balance, or half of its duration.
pub fn from_s(run: &Run, scene: &CheckedScene) -> f64 {
    let account = run.stats.energy.last();
    account.map_or(0.5 * scene.solver.duration_s, |audit| audit.from_s)
}

impl Results {
    /// Computes the results of `run` from `from_s` on ([`from_s`]) for its available channels. The shares are relative
    /// uncertainties of forces and torque; `uncertainty`: their source; `bands`: of the forces by contact laws.
    pub fn of(
        run: &Run,
        scene: &CheckedScene,
        from_s: f64,
        (uncertainty, shares): (&'static str, Option<Distance>),
        bands: Option<&Bands>,
    ) -> Self {
        let mut figures = Vec::new();
        let scales = Scales::of(scene);
        let share = |of: fn(&Distance) -> f64| shares.as_ref().map(of);
        let torque = share(|d| d.driver_torque);
        let of_torque = [torque, share(|d| d.torque_at_most)];
        let of_forces = [share(|d| d.forces), share(|d| d.force_at_most)];
        let (least_torque, least_force) = (scales.rounding_n_m(), scales.pressing_n());
        for (quantity, kinds, [all, at_most], rounding) in [
            (
                columns::INPUT_TORQUE,
                &["mean", "min", "max"][..],
                of_torque,
                least_torque,
            ),
            (columns::EXTERNAL_FORCE, &FORCES, of_forces, least_force),
            (columns::INTERNAL_FORCE, &FORCES, of_forces, least_force),
        ] {
            let Some(of) = figures_of(&run.time_series, quantity, from_s) else {
                continue;
            };
            let (label, unit) = label_and_unit(quantity);
            let (efficiency, sampling) = (of.statistics, of.sampling);
            for &kind in kinds {
                let (value, size, share, sampling) = match kind {
                    "mean" => (efficiency.mean, efficiency.rms, all, sampling.mean),
                    "min" => (efficiency.min, efficiency.peak, at_most, sampling.min),
                    "max" => (efficiency.max, efficiency.peak, at_most, sampling.max),
                    _ => (efficiency.peak, efficiency.peak, at_most, sampling.peak),
                };
                let def = FigureDef::named(
                    format!("{kind}_{quantity}"),
                    format!("{label}, {kind}"),
                    unit.clone(),
                );
                let mut figure = known(&def, value, share.map(|share| size * share), sampling);
                // A load within rounding is 0.
                if value.abs() < rounding {
                    (figure.value, figure.sampling) = (Some(0.0), None);
                    figure.uncertainty = Some(figure.uncertainty.unwrap_or(rounding));
                }
                figure.uncertainty = figure.uncertainty.map(|u| u.max(rounding));
                if let Some(bands) = bands {
                    bands.bound_load(&mut figure, quantity);
                }
                figures.push(figure);
            }
        }
        let account = run.stats.energy.last();
        let account = account.filter(|audit| audit.from_s == from_s);
        if let Some(efficiency) = account.and_then(Efficiency::of) {
            figures.push(match efficiency.defined() {
                Ok(share) => {
                    let off = torque.map(|torque| share.abs() * torque);
                    known(&SHARE_DELIVERED, share, off, efficiency.lost_off)
                }
                Err(reason) => SHARE_DELIVERED.of(None, None).withheld(reason),
            });
            let lost = |(def, share)| known(def, share, torque, efficiency.lost_off);
            figures.push(lost((&SHARE_LOST, efficiency.lost_share)));
            figures.extend(efficiency.by_cause().map(lost));
            let (created, off) = (efficiency.created_share, efficiency.created_off);
            figures.push(known(&SHARE_CREATED, created, torque, off));
        }
        Self {
            from_s,
            uncertainty,
            figures,
        }
    }

    /// Returns the figure of a definition.
    pub fn get(&self, def: &FigureDef) -> Option<&Figure> {
        self.figures.iter().find(|figure| figure.is(def))
    }

    /// Returns a statistic of a quantity of the time series: `mean`, `min`, `max` or `peak`.
    pub fn statistic(&self, kind: &str, quantity: &str) -> Option<&Figure> {
        let key = format!("{kind}_{quantity}");
        self.figures.iter().find(|figure| figure.def.key == key)
    }
}

/// Statistics of forces.
const FORCES: [&str; 2] = ["peak", "mean"];

/// Creates a figure of a run with the uncertainty `off` and that of sampling.
fn known(def: &FigureDef, value: f64, off: Option<f64>, sampling: f64) -> Figure {
    Figure {
        sampling: Some(sampling),
        ..def.of(value, off.map(|off| off + sampling))
    }
}

/// Computes figures over all channels of a quantity, from `from_s` on.
fn figures_of(time_series: &TimeSeries, quantity: &str, from_s: f64) -> Option<Figures> {
    let window = time_series.window(from_s, f64::INFINITY);
    let all = derive([time_series]);
    let channels = &all.iter().find(|known| known.name == quantity)?.channels;
    Figures::of(time_series, quantity, channels, window)
}
