//! Snapshot of a run: a few exact numbers for each quantity, and the run's cost.
//!
//! A time series is cut into four windows of equal length. Each has the mean, the root mean square and the largest
//! magnitude of all channels together, at full precision. A relative change of any force by 1e-9 changes them by about as
//! much, while rounding changes them by 1e-15 to 1e-10.

use std::collections::BTreeMap;

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::energy::EnergyAudit;
use pinwheel_scene::Layout;
use pinwheel_timeseries::norms::{self, View};
use pinwheel_timeseries::{TimeSeries, columns};
use serde::{Deserialize, Serialize};

/// Recorded quantity of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Torque of the driver, N m.
    DriverTorque,
    /// Torque on the output shaft, N m.
    OutputTorque,
    /// Output angle less that of the ideal mesh, rad: angles grow to radians, the twist is a milliradian.
    OutputTwist,
    /// Forces on the ring pins, N.
    ExternalForce,
    /// Forces on the output pins, N.
    InternalForce,
    /// Works of driver and load, changes of kinetic and stored energy, losses by damping and friction, J.
    Energy,
    /// Largest joint error, m.
    JointDrift,
}

impl Quantity {
    /// Returns the label.
    pub fn label(self) -> &'static str {
        match self {
            Self::DriverTorque => "driver torque",
            Self::OutputTorque => "output torque",
            Self::OutputTwist => "output angle against the ideal ratio",
            Self::ExternalForce => "ring pin forces",
            Self::InternalForce => "output pin forces",
            Self::Energy => "energy account",
            Self::JointDrift => "largest joint error",
        }
    }
}

/// Number of windows of a time series.
pub(super) const WINDOWS: usize = 4;

/// Statistics of a quantity of one run, in its unit.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Statistics {
    /// Means by window; single values (energies, joint error) unchanged.
    pub mean: Vec<f64>,
    /// Root mean squares by window.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rms: Vec<f64>,
    /// Largest magnitudes by window.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub peak: Vec<f64>,
}

impl Statistics {
    /// Returns the statistics of all channels together, which are equally long.
    pub fn of_course(channels: &[&[f64]]) -> Self {
        let samples = channels.first().map_or(0, |channel| channel.len());
        let mut course = Self::default();
        for k in 0..WINDOWS {
            let range = k * samples / WINDOWS..(k + 1) * samples / WINDOWS;
            let all = channels.iter();
            let cut = all.filter_map(|channel| channel.get(range.clone()));
            let figures = norms::Statistics::of(&View::new(cut.collect()));
            let figures = figures.map_or([f64::NAN; 3], |it| [it.mean, it.rms, it.peak]);
            let lists = [&mut course.mean, &mut course.rms, &mut course.peak];
            for (list, figure) in lists.into_iter().zip(figures) {
                list.push(figure);
            }
        }
        course
    }

    fn of_values(values: Vec<f64>) -> Self {
        Self {
            mean: values,
            ..Self::default()
        }
    }

    fn all(&self) -> impl Iterator<Item = f64> + '_ {
        let all = self.mean.iter().chain(&self.rms).chain(&self.peak);
        all.copied()
    }

    /// Returns the root mean square of the differences to `other`; `None` for other windows.
    pub fn distance(&self, other: &Self) -> Option<f64> {
        let shape = |it: &Self| [it.mean.len(), it.rms.len(), it.peak.len()];
        let differences = self.all().zip(other.all()).map(|(a, b)| a - b);
        (shape(self) == shape(other)).then(|| rms(differences))
    }

    /// Returns the mean over the windows.
    pub fn whole_mean(&self) -> f64 {
        self.mean.iter().sum::<f64>() / self.mean.len().max(1) as f64
    }

    /// Returns the root mean square over the windows.
    pub fn whole_rms(&self) -> f64 {
        rms(self.rms.iter().copied())
    }

    /// Returns the largest magnitude of all windows.
    pub fn whole_peak(&self) -> f64 {
        self.all().fold(0.0, |most, x| most.max(x.abs()))
    }
}

/// Returns the root mean square; 0 without values.
fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u32);
    for value in values {
        sum += value * value;
        count += 1;
    }
    (sum / f64::from(count.max(1))).sqrt()
}

/// Returns the quantities of a finished run, with its complete energy balance and its joints' largest error, m. Quantities
/// that the engine does not report are missing.
pub(super) fn statistics(
    gearbox: &Gearbox,
    time_series: &TimeSeries,
    account: Option<EnergyAudit>,
    joint_drift_m: Option<f64>,
) -> BTreeMap<Quantity, Statistics> {
    let twist = twist(gearbox, time_series);
    let course = |name: &str| time_series.channel(name).into_iter().collect::<Vec<_>>();
    let forces = |name: &str| time_series.group(name);
    let followed = [
        (Quantity::DriverTorque, course(columns::INPUT_TORQUE)),
        (Quantity::OutputTorque, course(columns::OUTPUT_TORQUE)),
        (Quantity::OutputTwist, vec![twist.as_slice()]),
        (Quantity::ExternalForce, forces(columns::EXTERNAL_FORCE)),
        (Quantity::InternalForce, forces(columns::INTERNAL_FORCE)),
    ];
    let followed = followed.map(|(quantity, of)| (quantity, Statistics::of_course(&of)));
    let mut all = BTreeMap::from(followed);
    if let Some(a) = account {
        let works = [a.driver_j, a.load_j, a.kinetic_j, a.stored_j];
        let values = [&works[..], &[a.damping_j, a.friction_j]].concat();
        all.insert(Quantity::Energy, Statistics::of_values(values));
    }
    if let Some(drift_m) = joint_drift_m {
        let values = Statistics::of_values(vec![drift_m]);
        all.insert(Quantity::JointDrift, values);
    }
    all
}

fn twist(gearbox: &Gearbox, time_series: &TimeSeries) -> Vec<f64> {
    let motion = gearbox.input_motion();
    let start = gearbox.kinematic_states()[Layout::OUTPUT].angle;
    let angles = time_series.channel(columns::OUTPUT_ANGLE).unwrap_or(&[]);
    let ideal = |t: f64| start + gearbox.geometry.ideal_turn_of_output(motion.at(t).0);
    let samples = time_series.time_s().iter().zip(angles);
    samples.map(|(&t, angle)| angle - ideal(t)).collect()
}

/// Returns a hash of all bits of all samples.
pub(super) fn bits(time_series: &TimeSeries) -> u64 {
    let channels = time_series.channels().iter();
    let values = channels.flat_map(|channel| &channel.values);
    pinwheel_files::fnv(values.flat_map(|value| value.to_bits().to_le_bytes()))
}
