//! Equations and integration: the defect of one interval between samples.

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Layout, load_profile};
use pinwheel_timeseries::TimeSeries;

use super::fit::{dot, less};
use super::judged::{FLOW, Judged, SMALL, Stage};
use super::model::Model;
use super::pictures::Picture;
use super::states::Columns;

/// Share of the square of all defects from which one stands alone.
const ALONE: f64 = 0.8;
/// Share of its defect that a run with a larger step has at most where each step leaves a part of its own; an error of the equations is
/// the same for both, to a thousandth.
const GROWS: f64 = 0.8;

/// State of a run at a sample.
pub(super) struct Sample {
    /// Its number.
    pub(super) number: usize,
    /// Its time, s.
    pub(super) time_s: f64,
    /// Coordinates of the reduced form.
    pub(super) y: Vec<f64>,
}

/// Samples spread over a run, the last one left out, and those before which and after which the load changes.
pub(super) fn samples(
    gearbox: &Gearbox,
    columns: &Columns,
    run: &TimeSeries,
    most: usize,
) -> Vec<Sample> {
    let times = run.time_s();
    let intervals = times.len().saturating_sub(1);
    let mut numbers: Vec<usize> = (0..most).map(|k| k * intervals / most).collect();
    for time in load_profile::breaks(&gearbox.scene.drive) {
        let after = times.partition_point(|&sample| sample <= time);
        numbers.extend(after.checked_sub(1).filter(|&before| before < intervals));
    }
    numbers.sort_unstable();
    numbers.dedup();
    numbers.retain(|&number| number < intervals);
    let sample = |number| Sample {
        number,
        time_s: times[number],
        y: columns.at(run, number),
    };
    numbers.into_iter().map(sample).collect()
}

/// States at times as samples of these numbers.
pub(super) fn numbered(times: &[f64], states: Vec<Vec<f64>>) -> Vec<Sample> {
    let all = times.iter().zip(states).enumerate();
    all.map(|(number, (&time_s, y))| Sample { number, time_s, y })
        .collect()
}

/// Ends of intervals that a run reached and those that the native flow reaches from the same states, over which changes weigh by
/// what the load would do in the interval.
pub(super) struct Motion {
    /// Intervals: start and end, s, and the state at the start.
    intervals: Vec<(f64, f64, Vec<f64>)>,
    /// Weight of each coordinate in each interval; 0 for pins, which friction holds.
    weights: Vec<Vec<f64>>,
    /// States of the run at the ends.
    pub(super) reached: Vec<Vec<f64>>,
    /// States by the native flow there.
    pub(super) flowed: Vec<Vec<f64>>,
}

impl Motion {
    /// The motion of a run over the intervals that begin at the samples; `None` where the native flow does not come through.
    pub(super) fn of(
        gearbox: &Gearbox,
        native: &mut Model<'_>,
        columns: &Columns,
        run: &TimeSeries,
        samples: &[Sample],
    ) -> Option<Self> {
        let times = run.time_s();
        let intervals: Vec<(f64, f64, Vec<f64>)> = samples
            .iter()
            .map(|sample| {
                (
                    sample.time_s,
                    times[sample.number + 1],
                    columns.at(run, sample.number),
                )
            })
            .collect();
        let strength = strengths(gearbox, native, columns);
        let weigh = |(from, to, _): &(f64, f64, Vec<f64>)| {
            let length = to - from;
            let rates = strength.iter().map(|strength| strength / length);
            let places = strength.iter().map(|strength| strength / (length * length));
            places.chain(rates).collect()
        };
        let end = |sample: &Sample| columns.at(run, sample.number + 1);
        let mut motion = Self {
            weights: intervals.iter().map(weigh).collect(),
            intervals,
            reached: samples.iter().map(end).collect(),
            flowed: Vec::new(),
        };
        motion.flowed = motion.flows(native)?;
        Some(motion)
    }

    /// The motion over one of so many intervals.
    pub(super) fn one_of(&self, many: usize) -> Self {
        fn thin<T: Clone>(all: &[T], many: usize) -> Vec<T> {
            all.iter().step_by(many).cloned().collect()
        }
        Self {
            intervals: thin(&self.intervals, many),
            weights: thin(&self.weights, many),
            reached: thin(&self.reached, many),
            flowed: thin(&self.flowed, many),
        }
    }

    /// States at the ends of the intervals by a model.
    pub(super) fn flows(&self, model: &mut Model<'_>) -> Option<Vec<Vec<f64>>> {
        let flow = |(from, to, y): &(f64, f64, Vec<f64>)| model.flow(*from, y, *to);
        self.intervals.iter().map(flow).collect()
    }

    /// States as one weighed vector.
    pub(super) fn stacked(&self, states: &[Vec<f64>]) -> Vec<f64> {
        let weighed = |(state, weights): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
            state
                .iter()
                .zip(weights)
                .map(|(value, weight)| value * weight)
                .collect()
        };
        states.iter().zip(&self.weights).flat_map(weighed).collect()
    }

    /// Defect of each coordinate and rate over each interval, as a share of what the load would do.
    fn defects(&self) -> Vec<Vec<f64>> {
        let [reached, flowed] = [&self.reached, &self.flowed].map(|states| self.stacked(states));
        let all = less(&reached, &flowed);
        let width = self.reached.first().map_or(1, Vec::len);
        all.chunks(width).map(<[f64]>::to_vec).collect()
    }

    /// Defect of each interval.
    fn sizes(&self) -> Vec<f64> {
        let defects = self.defects();
        defects
            .iter()
            .map(|defect| dot(defect, defect).sqrt())
            .collect()
    }

    /// Pictures of equations and integration. `coordinates`: their names.
    pub(super) fn pictures(&self, rough: Option<&Self>, coordinates: &[String]) -> Vec<Picture> {
        let times: Vec<f64> = self.intervals.iter().map(|(from, ..)| *from).collect();
        let sizes = |of: &Self| of.sizes().into_iter().map(|size| vec![size]).collect();
        let (fine, rough): (Vec<_>, Option<Vec<_>>) = (sizes(self), rough.map(sizes));
        let mut runs = vec![("smallest step", &fine[..])];
        runs.extend(rough.iter().map(|rough| ("a larger step", &rough[..])));
        let count = coordinates.len();
        let weights = self
            .weights
            .first()
            .map_or(&[][..], |weights| &weights[..count]);
        // Friction holds pins, whose weight is 0.
        let moved: Vec<usize> = (0..weights.len()).filter(|k| weights[*k] > 0.0).collect();
        let names: Vec<String> = moved.iter().map(|k| coordinates[*k].clone()).collect();
        let row = |defect: &Vec<f64>| {
            let both = moved.iter().map(|k| defect[*k].hypot(defect[count + k]));
            both.collect()
        };
        let rows: Vec<Vec<f64>> = self.defects().iter().map(row).collect();
        let pictures = |stage| {
            [
                Picture::over_time(stage, &times, &runs),
                Picture::over_columns(stage, &rows, names.clone()),
            ]
        };
        [Stage::Equations, Stage::Integration]
            .into_iter()
            .flat_map(pictures)
            .collect()
    }

    /// Root mean square of the defects.
    pub(super) fn size(&self) -> f64 {
        let sizes = self.sizes();
        (sizes.iter().map(|size| size * size).sum::<f64>() / sizes.len() as f64).sqrt()
    }

    /// Defect as a share of what the run's own motion changes: it grows with the motion's amplitude.
    pub(super) fn share(&self) -> f64 {
        let ends = self.stacked(&self.flowed);
        let starts = self.intervals.iter().map(|(_, _, y)| y.clone());
        let starts = self.stacked(&starts.collect::<Vec<_>>());
        let half = |k: usize| k % self.flowed[0].len() >= self.flowed[0].len() / 2;
        let changes = ends
            .iter()
            .zip(&starts)
            .enumerate()
            .filter(|(k, _)| half(*k));
        let square: f64 = changes.map(|(_, (end, start))| (end - start).powi(2)).sum();
        self.size() / (square / self.intervals.len() as f64).sqrt()
    }

    /// Interval of the largest defect, and its share of the square of all.
    fn peak(&self) -> (usize, f64) {
        let sizes = self.sizes();
        let square: f64 = sizes.iter().map(|size| size * size).sum();
        let place = (0..sizes.len()).max_by(|&a, &b| sizes[a].total_cmp(&sizes[b]));
        place.map_or((0, 0.0), |k| (k, sizes[k] * sizes[k] / square))
    }

    /// True if one interval has almost all of the defect.
    pub(super) fn is_alone(&self) -> bool {
        self.peak().1 > ALONE
    }

    /// Interval of the largest defect in words.
    fn place(&self) -> String {
        let which = if self.is_alone() { "alone" } else { "most" };
        let (from, to, _) = &self.intervals[self.peak().0];
        format!("{which} from t = {from:.4e} to {to:.4e} s")
    }

    /// Judges equations and integration. `rough`: the motion of the run with a larger step, and how far its defects should have
    /// fallen.
    pub(super) fn judged(&self, rough: Option<(&Self, f64)>) -> [Judged; 2] {
        let size = self.size();
        let Some((rough, falls)) = rough else {
            let note = "needs a run with a smaller step: state [refine]";
            return [Stage::Equations, Stage::Integration].map(|stage| Judged::untold(stage, note));
        };
        let fell = rough.share() / self.share();
        // An error of the step alone falls to half at least.
        let bound = size * (fell - 1.0).abs() + FLOW;
        let equations = Judged::told(Stage::Equations, size, bound, self.place());
        if equations.is_off() && fell < GROWS {
            let note = format!(
                "grows by {:.1} as the step shrinks, as where steps are solved to a loose tolerance, {}",
                fell.recip(),
                self.place()
            );
            return [
                Judged::untold(Stage::Equations, "hidden by the error of the steps"),
                Judged::told(Stage::Integration, size, FLOW, note),
            ];
        }
        let integration = Judged::told(
            Stage::Integration,
            size,
            (size * fell / falls).max(SMALL),
            format!(
                "falls by {:.1} where it should by {falls:.1}, {}",
                fell,
                self.place()
            ),
        );
        match equations.is_off() {
            true => [
                equations,
                Judged::untold(Stage::Integration, "hidden by an earlier stage"),
            ],
            false => [equations, integration],
        }
    }
}

/// Inverse of what the load would accelerate each coordinate by, with the masses it moves: s^2, or s^2/m.
pub(super) fn strengths(gearbox: &Gearbox, native: &Model<'_>, columns: &Columns) -> Vec<f64> {
    let scene = &gearbox.scene;
    let layout = gearbox.layout;
    let load = load_profile::largest(&scene.drive).max(gearbox.least_loads().torque_n_m);
    let each = load / layout.wheels as f64;
    let pins: f64 = gearbox
        .geometry
        .internal_points
        .iter()
        .map(|[x, y]| x * x + y * y)
        .sum();
    let mass = &scene.mass;
    let turning = native.free().iter().map(|&body| match body {
        Layout::OUTPUT => {
            (mass.output_shaft.moment_kg_m2 + mass.internal_sleeve.mass_kg * pins) / load
        }
        _ if layout.wheel_bodies().contains(&body) => mass.wheel.moment_kg_m2 / each,
        _ => 0.0,
    });
    let lever = scene.gear.lever_m();
    let floating = std::iter::repeat_n(mass.wheel.mass_kg * lever / each, columns.places());
    turning.chain(floating).collect()
}
