//! Judgement of contact search, law, assembly and driver: columns of a run against native ones at the run's states.

use std::f64::consts::TAU;
use std::ops::Range;

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::PairContact;
use pinwheel_mbs::BodyState;
use pinwheel_scene::{Layout, Sleeve};
use pinwheel_timeseries::{TimeSeries, columns};

use super::fit::{dot, less};
use super::judged::Stage;
use super::model::Model;
use super::motion::Sample;
use super::pictures::Picture;

/// Least force that counts as a contact, as a share of the largest.
const TOUCHING: f64 = 1e-3;
/// Exponents of the forces in fits; 2/3 gives the penetration of a Hertzian contact.
pub(super) const POWERS: [f64; 2] = [1.0, 2.0 / 3.0];
/// Force that counts as a contact in a gap of the native discs, as a share of the largest.
const GAP: f64 = 0.05;
/// Indices of the driver torque, the output torque and the first force.
pub(super) const DRIVER: usize = 0;
pub(super) const OUTPUT: usize = 1;
pub(super) const FORCES: usize = 2;

/// Columns of a run and the native ones at the same states, each as a share of its kind's largest value.
pub(super) struct Columns {
    layout: Layout,
    names: Vec<String>,
    times: Vec<f64>,
    /// Largest native value of each column's kind.
    scale: Vec<f64>,
    /// Rows of the run.
    pub(super) written: Vec<Vec<f64>>,
    /// Rows of the native model.
    pub(super) native: Vec<Vec<f64>>,
    /// Bodies and touching pairs of the native model.
    pub(super) contacts: Vec<(Vec<BodyState>, Vec<PairContact>)>,
}

impl Columns {
    /// Reads the columns of a run at the samples and evaluates the native ones; `None` if a column is missing.
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
        Some(Self::held(gearbox, native, samples, written))
    }

    /// Compares rows with native ones.
    pub(super) fn held(
        gearbox: &Gearbox,
        model: &mut Model<'_>,
        samples: &[Sample],
        written: Vec<Vec<f64>>,
    ) -> Self {
        let names = names(gearbox.layout);
        let native = rows(model, samples);
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
            layout: gearbox.layout,
            times: samples.iter().map(|sample| sample.time_s).collect(),
            contacts: samples
                .iter()
                .map(|at| model.pairs(at.time_s, &at.y))
                .collect(),
            written,
            native,
            names,
            scale,
        }
    }

    /// Returns the range of the force columns.
    pub(super) fn forces(&self) -> Range<usize> {
        FORCES..self.names.len()
    }

    /// Returns the scaled difference of a column from the native one at a sample.
    fn off(&self, sample: usize, column: usize) -> f64 {
        (self.written[sample][column] - self.native[sample][column]) / self.scale[column]
    }

    /// Iterates over the pairs of sample and column.
    fn places(&self, of: Range<usize>) -> impl Iterator<Item = (usize, usize)> {
        let samples = 0..self.times.len();
        samples.flat_map(move |k| of.clone().map(move |column| (k, column)))
    }

    /// Returns the largest difference in these columns and its place in words.
    pub(super) fn worst(&self, of: Range<usize>) -> (f64, String) {
        let size = |&(k, column): &(usize, usize)| self.off(k, column).abs();
        // NaN counts as the largest difference.
        let most = self.places(of).max_by(|a, b| size(a).total_cmp(&size(b)));
        most.map_or((0.0, String::new()), |at| {
            (
                size(&at),
                format!(
                    "of the largest {}, most in {} at t = {:.3e} s",
                    if at.1 < FORCES { "torque" } else { "force" },
                    self.names[at.1],
                    self.times[at.0]
                ),
            )
        })
    }

    /// True if only the run or only the native model has a force there.
    fn has_one_contact(&self, sample: usize, column: usize) -> bool {
        let least = TOUCHING * self.scale[column];
        let [one, other] = [&self.written, &self.native].map(|rows| rows[sample][column]);
        (one == 0.0 && other > least) || (other == 0.0 && one > least)
    }

    /// True if the run has more force in a gap of the native discs than another law or a late step could leave.
    fn fills_gap(&self, sample: usize, column: usize) -> bool {
        let body = self.layout.external_bodies().start + column - FORCES;
        let mut pairs = self.contacts[sample].1.iter();
        let touches = pairs.any(|pair| self.layout.sleeve_body(pair.sleeve) == body);
        let [written, native] = [&self.written, &self.native].map(|rows| rows[sample][column]);
        !touches && native == 0.0 && written > GAP * self.scale[column]
    }

    /// Returns the share of forces that only the run or only the native model has, and the first place in words. `both` is
    /// false if rates are unknown; a contact that the run lacks then does not count.
    pub(super) fn search(&self, both: bool) -> (f64, String) {
        // A wrong law may open a contact; its size is known only with rates.
        let touch =
            |&(k, c): &(usize, usize)| self.written[k][c] != 0.0 && self.native[k][c] != 0.0;
        let law = self.places(self.forces()).filter(|at| both && touch(at));
        let law = law
            .map(|(k, column)| self.off(k, column).abs())
            .fold(0.0, f64::max);
        let misses = |k: usize, column: usize| self.written[k][column] == 0.0;
        let is_alone = |&(k, column): &(usize, usize)| {
            let known = both || !misses(k, column);
            let is_one = known && self.has_one_contact(k, column);
            is_one && self.off(k, column).abs() > law || self.fills_gap(k, column)
        };
        let alone: Vec<_> = self.places(self.forces()).filter(is_alone).collect();
        let share = alone.len() as f64 / self.places(self.forces()).count() as f64;
        let words = alone.first().map(|&(k, column)| {
            let which = match misses(k, column) {
                true => "a contact is missed",
                false => "a contact where there is a gap",
            };
            let (name, time) = (&self.names[column], self.times[k]);
            format!("of all forces, first {which}: {name} at t = {time:.3e} s")
        });
        (share, words.unwrap_or_default())
    }

    /// Returns the relative L2 distance of the forces from the native ones.
    pub(super) fn distance(&self) -> f64 {
        let square = |row: &[f64]| dot(&row[FORCES..], &row[FORCES..]);
        let off = self.written.iter().zip(&self.native);
        let off: f64 = off.map(|(a, b)| square(&less(a, b))).sum();
        (off / self.native.iter().map(|row| square(row)).sum::<f64>()).sqrt()
    }

    /// Returns all rows as one vector in which driver, output and forces have equal weight. Forces are raised to `power`.
    pub(super) fn stacked(&self, rows: &[Vec<f64>], power: f64) -> Vec<f64> {
        let count = (self.forces().len() as f64).sqrt();
        let shares = |row: &Vec<f64>| -> Vec<f64> {
            let columns = row.iter().enumerate();
            let share = |(column, value): (usize, &f64)| match column {
                DRIVER | OUTPUT => value / self.scale[column],
                _ => (value / self.scale[column]).powf(power) / count,
            };
            columns.map(share).collect()
        };
        rows.iter().flat_map(shares).collect()
    }

    /// Plots the largest residual of each sample.
    pub(super) fn over_time(&self, stage: Stage, rows: &[Vec<f64>]) -> Picture {
        Picture::over_time(stage, &self.times, &[("residual", rows)])
    }

    /// Plots contact search, law, assembly and driver.
    pub(super) fn pictures(&self) -> Vec<Picture> {
        let rows = |off: &dyn Fn(usize, usize) -> f64, of: Range<usize>| -> Vec<Vec<f64>> {
            let row = |k| of.clone().map(|column| off(k, column)).collect();
            (0..self.times.len()).map(row).collect()
        };
        let off = |k, column| self.off(k, column);
        let alone = |k, column| match self.has_one_contact(k, column) {
            true => self.off(k, column),
            false => 0.0,
        };
        // Ring pins and positions of contact on a lobe, by sample.
        let mut lobes = Vec::new();
        for (k, (bodies, pairs)) in self.contacts.iter().enumerate() {
            for pair in pairs {
                let Sleeve::External(pin) = pair.sleeve else {
                    continue;
                };
                let disc = &bodies[self.layout.wheel_bodies().start + pair.wheel];
                let polar = (pair.point[1] - disc.y).atan2(pair.point[0] - disc.x) - disc.angle;
                let lobe =
                    (polar * (self.layout.external_sleeves - 1) as f64 / TAU).rem_euclid(1.0);
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

/// Returns the names of the judged columns of a gear, in the model's order.
pub(super) fn names(layout: Layout) -> Vec<String> {
    let names = columns::of_gearbox(layout.external_sleeves, layout.internal_sleeves);
    names.filter(|name| name != columns::OUTPUT_ANGLE).collect()
}

/// Evaluates a model at the samples.
pub(super) fn rows(model: &mut Model<'_>, samples: &[Sample]) -> Vec<Vec<f64>> {
    let row = |sample: &Sample| model.columns(sample.time_s, &sample.y);
    samples.iter().map(row).collect()
}
