//! Contact search, law, assembly and driver: a run's columns against the native ones at the run's own states.

use std::f64::consts::TAU;
use std::ops::Range;

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Layout, Sleeve};
use pinwheel_timeseries::{TimeSeries, columns};

use super::judged::Depth;
use super::model::Model;
use super::motion::Sample;

/// Forces below this share of the largest do not count as contacts.
const TOUCHING: f64 = 1e-3;
/// Places on a lobe.
const PLACES: usize = 24;
/// Column of the driver's torque, of the output's, and first of the forces.
pub(super) const DRIVER: usize = 0;
pub(super) const OUTPUT: usize = 1;
pub(super) const FORCES: usize = 2;

/// Columns of a run and the native ones at the same states, each as a share of its kind's largest value.
pub(super) struct Columns {
    names: Vec<String>,
    times: Vec<f64>,
    /// Largest native value of each column's kind.
    scale: Vec<f64>,
    /// Rows as they are written.
    pub(super) written: Vec<Vec<f64>>,
    /// Rows of the native model.
    pub(super) native: Vec<Vec<f64>>,
}

impl Columns {
    /// Reads the columns of a run at the samples, and evaluates the native ones; `None` where a column is missing.
    pub(super) fn of(
        gearbox: &Gearbox,
        native: &mut Model<'_>,
        run: &TimeSeries,
        samples: &[Sample],
    ) -> Option<Self> {
        let all: Option<Vec<&[f64]>> = names(gearbox.layout)
            .iter()
            .map(|name| run.channel(name))
            .collect();
        let all = all?;
        let row = |sample: &Sample| all.iter().map(|column| column[sample.number]).collect();
        let written = samples.iter().map(row).collect();
        Some(Self::held(gearbox, samples, written, rows(native, samples)))
    }

    /// Holds rows against native ones.
    pub(super) fn held(
        gearbox: &Gearbox,
        samples: &[Sample],
        written: Vec<Vec<f64>>,
        native: Vec<Vec<f64>>,
    ) -> Self {
        let names = names(gearbox.layout);
        let floor = gearbox.least_loads();
        let largest = |of: Range<usize>, least: f64| {
            let values = native.iter().flat_map(|row| &row[of.clone()]);
            values.fold(least, |most: f64, value| most.max(value.abs()))
        };
        let mut scale = vec![largest(FORCES..names.len(), floor.force_n); names.len()];
        for torque in [DRIVER, OUTPUT] {
            scale[torque] = largest(torque..torque + 1, floor.torque_n_m);
        }
        Self {
            times: samples.iter().map(|sample| sample.time_s).collect(),
            written,
            native,
            names,
            scale,
        }
    }

    /// The columns of the forces.
    pub(super) fn forces(&self) -> Range<usize> {
        FORCES..self.names.len()
    }

    /// Difference of a column from the native one at a sample, as a share.
    fn off(&self, sample: usize, column: usize) -> f64 {
        (self.written[sample][column] - self.native[sample][column]) / self.scale[column]
    }

    /// The largest difference among these columns, and its place in words.
    pub(super) fn worst(&self, of: Range<usize>) -> (f64, String) {
        let places = (0..self.times.len()).flat_map(|k| of.clone().map(move |column| (k, column)));
        let size = |&(k, column): &(usize, usize)| self.off(k, column).abs();
        // What is not a number is farther off than any.
        let most = places.max_by(|a, b| size(a).total_cmp(&size(b)));
        most.map_or((0.0, String::new()), |at| {
            (
                size(&at),
                format!(
                    "most in {} at t = {:.3e} s",
                    self.names[at.1], self.times[at.0]
                ),
            )
        })
    }

    /// Share of forces where only one of the two has a contact, and the first place in words.
    pub(super) fn search(&self) -> (f64, String) {
        let mut first = None;
        let mut count = 0;
        for (k, (written, native)) in self.written.iter().zip(&self.native).enumerate() {
            for column in self.forces() {
                let least = TOUCHING * self.scale[column];
                let [one, other] = [written[column], native[column]];
                if (one == 0.0 && other > least) || (other == 0.0 && one > least) {
                    count += 1;
                    first.get_or_insert((column, self.times[k], one == 0.0));
                }
            }
        }
        let all = self.times.len() * self.forces().len();
        let words = |(column, time, misses): (usize, f64, bool)| {
            let which = if misses {
                "a contact is missed"
            } else {
                "a contact where there is a gap"
            };
            format!("{which}: {} at t = {time:.3e} s", self.names[column])
        };
        (
            f64::from(count) / all as f64,
            first.map_or_else(String::new, words),
        )
    }

    /// Relative L2 distance of the forces from the native ones.
    pub(super) fn distance(&self) -> f64 {
        let square = |row: &Vec<f64>| row[FORCES..].iter().map(|force| force * force).sum::<f64>();
        let places =
            (0..self.times.len()).flat_map(|k| self.forces().map(move |column| (k, column)));
        let off: f64 = places
            .map(|(k, column)| (self.off(k, column) * self.scale[column]).powi(2))
            .sum();
        (off / self.native.iter().map(square).sum::<f64>()).sqrt()
    }

    /// All rows as one vector in which driver, output and forces weigh the same.
    pub(super) fn stacked(&self, rows: &[Vec<f64>]) -> Vec<f64> {
        let weight = |column: usize| match column {
            DRIVER | OUTPUT => self.scale[column],
            _ => self.scale[column] * (self.forces().len() as f64).sqrt(),
        };
        let shares = |row: &Vec<f64>| -> Vec<f64> {
            let columns = row.iter().enumerate();
            columns
                .map(|(column, value)| value / weight(column))
                .collect()
        };
        rows.iter().flat_map(shares).collect()
    }

    /// Residuals of the forces over time, pins and the profile.
    pub(super) fn depth(
        &self,
        native: &mut Model<'_>,
        layout: Layout,
        samples: &[Sample],
    ) -> Depth {
        let square = |k: usize, column: usize| self.off(k, column).powi(2);
        let mean = |column: usize| {
            let all: f64 = (0..samples.len()).map(|k| square(k, column)).sum();
            (all / samples.len() as f64).sqrt()
        };
        let mut places = [(0.0, 0.0); PLACES];
        for (k, sample) in samples.iter().enumerate() {
            let (bodies, pairs) = native.pairs(sample.time_s, &sample.y);
            for pair in pairs {
                let Sleeve::External(pin) = pair.sleeve else {
                    continue;
                };
                let disc = &bodies[layout.wheel_bodies().start + pair.wheel];
                let polar = (pair.point[1] - disc.y).atan2(pair.point[0] - disc.x) - disc.angle;
                let lobe = (polar * (layout.external_sleeves - 1) as f64 / TAU).rem_euclid(1.0);
                let (sum, count) = &mut places[(lobe * PLACES as f64) as usize % PLACES];
                *sum += square(k, FORCES + pin);
                *count += 1.0;
            }
        }
        Depth {
            time_s: self.times.clone(),
            force: (0..samples.len())
                .map(|k| {
                    self.forces()
                        .map(|column| self.off(k, column).abs())
                        .fold(0.0, f64::max)
                })
                .collect(),
            motion: Vec::new(),
            pins: self.forces().map(mean).collect(),
            profile: places
                .iter()
                .map(|(sum, count): &(f64, f64)| (sum / count).sqrt())
                .collect(),
        }
    }
}

/// Columns of a gear that are judged, in the order of a model's.
pub(super) fn names(layout: Layout) -> Vec<String> {
    let names = columns::of_gearbox(layout.external_sleeves, layout.internal_sleeves);
    names.filter(|name| name != columns::OUTPUT_ANGLE).collect()
}

/// Rows of a model at the samples.
pub(super) fn rows(model: &mut Model<'_>, samples: &[Sample]) -> Vec<Vec<f64>> {
    let row = |sample: &Sample| model.columns(sample.time_s, &sample.y);
    samples.iter().map(row).collect()
}
