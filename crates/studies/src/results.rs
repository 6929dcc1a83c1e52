//! Figures for which one runs a scene: driver's torque, peaks of the forces and efficiency after the start-up, each
//! with its possible error where that is known.

use pinwheel_compare::quantities::derive;
use pinwheel_engines::Run;
use pinwheel_gearbox::{Distance, Efficiency};
use pinwheel_scene::{CheckedScene, Scales};
use pinwheel_timeseries::sampling::Figures;
use pinwheel_timeseries::{TimeSeries, columns};
use serde::Serialize;

/// A figure of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// As in the columns of a sweep, e.g. `mean_input_torque_n_m`.
    pub name: String,
    /// The figure, in the unit of its name.
    pub value: f64,
    /// How far it may be off by the run's numerical error and by sampling; `None` where the first is not known.
    #[serde(rename = "numerical_uncertainty")]
    pub uncertainty: Option<f64>,
    /// How far by sampling alone; `None` of what is no figure of samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampling: Option<f64>,
}

impl Figure {
    /// True if sampling causes more than half of the figure's uncertainty.
    #[must_use]
    pub fn is_off_by_sampling(&self) -> bool {
        let both = self.sampling.zip(self.uncertainty);
        both.is_some_and(|(sampling, all)| sampling > 0.5 * all)
    }
}

/// The figures of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Results {
    /// Where their window begins, s; it ends with the run.
    pub from_s: f64,
    /// How it is known how far they may be off.
    #[serde(rename = "numerical_uncertainty")]
    pub uncertainty: &'static str,
    /// In the order in which they are shown.
    pub figures: Vec<Figure>,
    /// Why there is no efficiency.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efficiency_reason: Option<String>,
}

/// Where the results of a run begin, s: with the last window of its energy account, or at its half.
#[must_use]
pub fn from_s(run: &Run, scene: &CheckedScene) -> f64 {
    let account = run.stats.energy.last();
    account.map_or(0.5 * scene.solver.duration_s, |audit| audit.from_s)
}

impl Results {
    /// Results of `run` from `from_s` on ([`from_s`]), as far as it has the channels for them, off by these shares of
    /// forces and torque; `uncertainty`: how that is known.
    #[must_use]
    pub fn of(
        run: &Run,
        scene: &CheckedScene,
        from_s: f64,
        uncertainty: &'static str,
        shares: Option<Distance>,
    ) -> Self {
        let (mut figures, mut efficiency_reason) = (Vec::new(), None);
        let scales = Scales::of(scene);
        let mut push = |name: &str, value: f64, size: f64, share: Option<f64>, sampling: f64| {
            let known = share.map(|share| size.abs() * share + sampling);
            let rounding = match name {
                _ if name.ends_with("_n_m") => scales.rounding_n_m(),
                _ if name.ends_with("_n") => scales.pressing_n(),
                _ => 0.0,
            };
            // A load that is only rounding is none.
            let is_rounding = value.abs() < rounding;
            figures.push(Figure {
                name: name.to_owned(),
                value: if is_rounding { 0.0 } else { value },
                uncertainty: match known {
                    None if is_rounding => Some(rounding),
                    known => known.map(|u| u.max(rounding)),
                },
                sampling: Some(sampling).filter(|_| !is_rounding),
            });
        };
        let share = |of: fn(&Distance) -> f64| shares.as_ref().map(of);
        let torque = share(|d| d.driver_torque);
        let of_torque = [torque, share(|d| d.torque_at_most)];
        let of_forces = [share(|d| d.forces), share(|d| d.force_at_most)];
        for (quantity, kinds, [all, at_most]) in [
            (
                columns::INPUT_TORQUE,
                &["mean", "min", "max"][..],
                of_torque,
            ),
            (columns::EXTERNAL_FORCE, &["peak", "mean"], of_forces),
            (columns::INTERNAL_FORCE, &["peak", "mean"], of_forces),
        ] {
            let Some(of) = figures_of(&run.time_series, quantity, from_s) else {
                continue;
            };
            let (found, sampling) = (of.statistics, of.sampling);
            for &kind in kinds {
                let (value, size, share, sampling) = match kind {
                    "mean" => (found.mean, found.rms, all, sampling.mean),
                    "min" => (found.min, found.peak, at_most, sampling.min),
                    "max" => (found.max, found.peak, at_most, sampling.max),
                    _ => (found.peak, found.peak, at_most, sampling.peak),
                };
                push(&format!("{kind}_{quantity}"), value, size, share, sampling);
            }
        }
        let account = run.stats.energy.last();
        let account = account.filter(|audit| audit.from_s == from_s);
        if let Some(found) = account.and_then(Efficiency::of) {
            match found.defined() {
                Ok(share) => push("efficiency", share, share, torque, found.lost_off),
                Err(reason) => efficiency_reason = Some(reason),
            }
            push("lost_share", found.lost_share, 1.0, torque, found.lost_off);
            for (name, share) in found.by_cause() {
                push(name, share, 1.0, torque, found.lost_off);
            }
            let (created, off) = (found.created_share, found.created_off);
            push("created_share", created, 1.0, torque, off);
        }
        Self {
            from_s,
            uncertainty,
            figures,
            efficiency_reason,
        }
    }

    /// The figure of that name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Figure> {
        self.figures.iter().find(|figure| figure.name == name)
    }
}

/// Over all channels of a quantity, from `from_s` on.
fn figures_of(time_series: &TimeSeries, quantity: &str, from_s: f64) -> Option<Figures> {
    let window = time_series.window(from_s, f64::INFINITY);
    let all = derive([time_series]);
    let channels = &all.iter().find(|known| known.name == quantity)?.channels;
    Figures::of(time_series, quantity, channels, window)
}
