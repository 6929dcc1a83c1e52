//! Contact search, law, assembly and driver: a run's columns against the native ones at the run's own states.

use std::f64::consts::TAU;
use std::ops::Range;

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Layout, Sleeve};
use pinwheel_timeseries::{TimeSeries, columns};

use super::judged::Stage;
use super::model::Model;
use super::motion::Sample;
use super::pictures::Picture;

/// Forces below this share of the largest do not count as contacts.
const TOUCHING: f64 = 1e-3;
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

    /// True if only one of the two has a force there.
    fn has_one_contact(&self, sample: usize, column: usize) -> bool {
        let least = TOUCHING * self.scale[column];
        let [one, other] = [&self.written, &self.native].map(|rows| rows[sample][column]);
        (one == 0.0 && other > least) || (other == 0.0 && one > least)
    }

    /// Share of forces where only one of the two has a contact, and the first place in words. `both`: false where rates are
    /// not known, so that a contact may part which the native one has.
    pub(super) fn search(&self, both: bool) -> (f64, String) {
        let mut first = None;
        let mut count = 0;
        // A law that is off may let go of a contact; it is known where rates are.
        let is_both = |(k, column): &(usize, usize)| {
            both && self.written[*k][*column] != 0.0 && self.native[*k][*column] != 0.0
        };
        let all = (0..self.times.len()).flat_map(|k| self.forces().map(move |column| (k, column)));
        let law = all
            .filter(is_both)
            .map(|(k, column)| self.off(k, column).abs());
        let law = law.fold(0.0, f64::max);
        for k in 0..self.times.len() {
            for column in self.forces() {
                let misses = self.written[k][column] == 0.0;
                if self.has_one_contact(k, column)
                    && self.off(k, column).abs() > law
                    && (both || !misses)
                {
                    count += 1;
                    first.get_or_insert((column, self.times[k], misses));
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

    /// Draws the largest residual of each sample.
    pub(super) fn over_time(&self, stage: Stage, rows: &[Vec<f64>]) -> Picture {
        Picture::over_time(stage, &self.times, &[("residual", rows)])
    }

    /// Pictures of contact search, law, assembly and driver.
    pub(super) fn pictures(
        &self,
        native: &mut Model<'_>,
        layout: Layout,
        samples: &[Sample],
    ) -> Vec<Picture> {
        let rows = |off: &dyn Fn(usize, usize) -> f64, of: Range<usize>| -> Vec<Vec<f64>> {
            let row = |k| of.clone().map(|column| off(k, column)).collect();
            (0..samples.len()).map(row).collect()
        };
        let off = |k, column| self.off(k, column);
        let alone = |k, column| match self.has_one_contact(k, column) {
            true => self.off(k, column),
            false => 0.0,
        };
        // Ring pins and places on a lobe where they touch, by sample.
        let mut lobes = Vec::new();
        for (k, sample) in samples.iter().enumerate() {
            let (bodies, pairs) = native.pairs(sample.time_s, &sample.y);
            for pair in pairs {
                let Sleeve::External(pin) = pair.sleeve else {
                    continue;
                };
                let disc = &bodies[layout.wheel_bodies().start + pair.wheel];
                let polar = (pair.point[1] - disc.y).atan2(pair.point[0] - disc.x) - disc.angle;
                let lobe = (polar * (layout.external_sleeves - 1) as f64 / TAU).rem_euclid(1.0);
                lobes.push((k, pin, lobe));
            }
        }
        let mut all = Vec::new();
        for (stage, rows) in [
            (Stage::ContactSearch, rows(&alone, self.forces())),
            (Stage::Law, rows(&off, self.forces())),
        ] {
            let at = lobes.iter().map(|(k, pin, lobe)| (*lobe, rows[*k][*pin]));
            all.push(self.over_time(stage, &rows));
            all.push(Picture::over_columns(stage, &rows, Vec::new()));
            all.push(Picture::over_lobe(stage, at));
        }
        for (stage, column) in [(Stage::Assembly, OUTPUT), (Stage::Driver, DRIVER)] {
            all.push(self.over_time(stage, &rows(&off, column..column + 1)));
        }
        all
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
