//! The figures that a data sheet gives, each with how far it may be off.
//!
//! Statics balances contacts to rounding; what is left is that poses are sampled. Every figure is read off all poses, off the
//! even and off the odd ones: the largest change is its uncertainty. A figure of a run is as uncertain as the run says.

use serde::Serialize;

use super::mesh::{Bearing, Pose, Pressure, Sharing, Stage};
use super::{ARCMIN, Cycle, Operating, Spread};

/// What balances leave of a figure: angles are found to 2e-15 rad, forces to 1e-10.
const ROUNDING: f64 = 1e-9;

/// One figure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figure {
    /// Its name for programs, with the unit.
    pub key: &'static str,
    /// What it is.
    #[serde(skip)]
    pub what: &'static str,
    /// Its unit; empty for counts.
    pub unit: &'static str,
    /// `None` where it does not exist: no work passes, or the run diverged.
    pub value: Option<f64>,
    /// How far it may be off; `None` where that is not known.
    pub uncertainty: Option<f64>,
    /// Least and largest over the mesh, of what is one figure a pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over_the_mesh: Option<[f64; 2]>,
    /// Its mean over the mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_over_the_mesh: Option<f64>,
    /// How it is counted.
    pub how: &'static str,
}

/// What statics found, before it is summed up.
pub(super) struct Balances {
    /// Lost motion at an even number of poses, arcmin.
    pub(super) lost: Vec<f64>,
    /// Stiffness there, one direction after the other, N m/arcmin.
    pub(super) stiffness: Vec<f64>,
    /// Poses of one period under the rated load.
    pub(super) loaded: Vec<Pose>,
    /// And under next to none.
    pub(super) unloaded: Vec<Pose>,
}

/// The same, summed up.
pub(super) struct Summed {
    pub(super) lost: Spread,
    pub(super) stiffness: Spread,
    pub(super) sharing: [Sharing; 2],
    pub(super) pressure: [Pressure; 2],
    pub(super) bearings: Vec<Bearing>,
    /// Peak to peak of the transmission error, rated and unloaded, arcmin.
    pub(super) error: [f64; 2],
}

impl Balances {
    /// Of the poses whose number leaves `of` when divided by `every`.
    pub(super) fn summed(&self, every: usize, of: usize) -> Summed {
        fn some<T>(list: &[T], every: usize, of: usize) -> Vec<&T> {
            list.iter().skip(of).step_by(every).collect()
        }
        let spread = |list: &[f64]| Spread::of(some(list, every, of).into_iter().copied());
        let loaded = some(&self.loaded, every, of);
        let error = [&self.loaded, &self.unloaded].map(|poses| {
            let errors = some(poses, every, of);
            let spread = Spread::of(errors.iter().map(|pose| ARCMIN * pose.error_rad));
            spread.max - spread.min
        });
        Summed {
            lost: spread(&self.lost),
            stiffness: spread(&self.stiffness),
            sharing: Stage::BOTH.map(|stage| Sharing::of(&loaded, stage)),
            pressure: Stage::BOTH.map(|stage| Pressure::of(&loaded, stage)),
            bearings: Bearing::all(&loaded),
            error,
        }
    }

    /// The figures of statics.
    pub(super) fn figures(&self) -> Vec<Figure> {
        halves(|every, of| self.summed(every, of).figures())
    }
}

impl Figure {
    /// A figure that is one for the whole mesh.
    pub(super) fn new(
        key: &'static str,
        what: &'static str,
        unit: &'static str,
        value: Option<f64>,
        uncertainty: Option<f64>,
        how: &'static str,
    ) -> Self {
        Self {
            key,
            what,
            unit,
            value,
            uncertainty: value.and(uncertainty),
            over_the_mesh: None,
            mean_over_the_mesh: None,
            how,
        }
    }

    /// With what it is over the mesh.
    pub(super) fn over(self, spread: &Spread) -> Self {
        Self {
            over_the_mesh: Some([spread.min, spread.max]),
            mean_over_the_mesh: Some(spread.mean),
            ..self
        }
    }
}

/// Figures of every so many poses from one on: those of all, as uncertain as those of either half differ from them.
pub(super) fn halves(of: impl Fn(usize, usize) -> Vec<Figure>) -> Vec<Figure> {
    let mut figures = of(1, 0);
    for half in [0, 1] {
        for (figure, other) in figures.iter_mut().zip(of(2, half)) {
            let moved = figure.value.zip(other.value).map(|(a, b)| (a - b).abs());
            figure.uncertainty = figure.uncertainty.zip(moved).map(|(u, moved)| u.max(moved));
        }
    }
    figures
}

impl Summed {
    fn figures(&self) -> Vec<Figure> {
        let of = |key, what, unit, value: f64, how| {
            let rounding = ROUNDING * value.abs();
            Figure::new(key, what, unit, Some(value), Some(rounding), how)
        };
        let [external, internal] = &self.sharing;
        let [loaded, unloaded] = self.error;
        let pressed = |k: usize| 1e-6 * self.pressure[k].largest_pa;
        let slid = |k: usize| 1e-6 * self.pressure[k].pressure_sliding_w_m2;
        let touch = "touch a wheel, on average";
        let mut figures = vec![
            of(
                "lost_motion_arcmin",
                "lost motion",
                "arcmin",
                self.lost.max,
                "largest over the mesh, between +3 and -3 % of the rated torque",
            )
            .over(&self.lost),
            of(
                "torsional_stiffness_n_m_per_arcmin",
                "torsional stiffness",
                "N m/arcmin",
                self.stiffness.mean,
                "between 50 and 100 % of the rated torque, mean",
            )
            .over(&self.stiffness),
            of(
                "transmission_error_rated_arcmin",
                "transmission error, rated load",
                "arcmin",
                loaded,
                "peak to peak",
            ),
            of(
                "transmission_error_no_load_arcmin",
                "transmission error, no load",
                "arcmin",
                unloaded,
                "peak to peak, at a ten-thousandth of the load",
            ),
            of(
                "external_force_n",
                "largest pin force, external",
                "N",
                external.largest_force_n.max,
                "largest of a pose",
            )
            .over(&external.largest_force_n),
            of(
                "internal_force_n",
                "largest pin force, internal",
                "N",
                internal.largest_force_n.max,
                "largest of a pose",
            )
            .over(&internal.largest_force_n),
            of(
                "external_touching",
                "external pins that carry",
                "",
                external.touching.mean,
                touch,
            ),
            of(
                "internal_touching",
                "internal pins that carry",
                "",
                internal.touching.mean,
                touch,
            ),
            of(
                "external_pressure_mpa",
                "largest pressure, external",
                "MPa",
                pressed(0),
                "line contact over the face width, edges left out",
            ),
            of(
                "internal_pressure_mpa",
                "largest pressure, internal",
                "MPa",
                pressed(1),
                "likewise",
            ),
            of(
                "pressure_sliding_mpa_m_s",
                "largest pressure times sliding",
                "MPa m/s",
                slid(0).max(slid(1)),
                "on pins that do not turn",
            ),
        ];
        if let Some(bearing) = self.bearings.first() {
            figures.push(
                of(
                    "eccentric_bearing_force_n",
                    "eccentric bearing, largest force",
                    "N",
                    bearing.force_n.max,
                    "of the contacts on wheel 0",
                )
                .over(&bearing.force_n),
            );
        }
        figures
    }
}

/// The figures of runs.
pub(super) fn of_runs(cycle: Option<&Cycle>, efficiency: &[Operating]) -> Vec<Figure> {
    let figure = Figure::new;
    let mut figures = Vec::new();
    if let Some(cycle) = cycle {
        figures.push(figure(
            "lost_motion_run_arcmin",
            "lost motion by a run",
            "arcmin",
            cycle.lost_motion_arcmin,
            cycle.lost_motion_uncertainty_arcmin,
            "of a slow loop of the load, the mean of both branches",
        ));
        figures.push(figure(
            "hysteresis_width_arcmin",
            "width of the loop at no load",
            "arcmin",
            cycle.width_arcmin,
            cycle.width_uncertainty_arcmin,
            "what friction holds back, and what swings",
        ));
    }
    if let Some(rated) = efficiency.last() {
        figures.push(figure(
            "efficiency_rated_percent",
            "efficiency, rated",
            "%",
            rated.efficiency.map(|e| 100.0 * e.of_losses),
            rated.uncertainty.map(|u| 100.0 * u),
            "by what contacts lose",
        ));
    }
    figures
}
