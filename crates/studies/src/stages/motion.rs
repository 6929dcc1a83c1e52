//! Judgement of equations and integration by the defects of single intervals between samples.

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Layout, load_profile};
use pinwheel_timeseries::TimeSeries;

use super::fit::{dot, less};
use super::judged::{FLOW, Judged, ROUNDING, SMALL, Stage};
use super::model::Model;
use super::pictures::Picture;
use super::states::Columns;

/// Share of the sum of squared defects above which one interval stands alone.
const ALONE: f64 = 0.8;
/// Largest ratio of the defect to that of a run with a larger step, if the step is the cause. An error of the equations is
/// equal for both to a thousandth.
const GROWS: f64 = 0.8;

/// State of a run at a sample.
pub(super) struct Sample {
    /// Index of the row.
    pub(super) number: usize,
    /// Time of the row, s.
    pub(super) time_s: f64,
    /// Coordinates of the reduced form.
    pub(super) y: Vec<f64>,
}

/// Returns samples spread over a run without the last one, and those just before and after changes of the load.
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

/// Returns states at `times` as samples with these numbers.
pub(super) fn numbered(times: &[f64], states: Vec<Vec<f64>>) -> Vec<Sample> {
    let all = times.iter().zip(states).enumerate();
    all.map(|(number, (&time_s, y))| Sample { number, time_s, y })
        .collect()
}

/// Interval between samples. Changes are weighted by the effect of the load in it.
#[derive(Clone)]
struct Interval {
    from_s: f64,
    to_s: f64,
    start: Vec<f64>,
    /// Weight of each coordinate and rate; 0 for pins, which friction holds.
    weights: Vec<f64>,
    /// Final state of the run.
    reached: Vec<f64>,
    /// Final state of the native flow.
    flowed: Vec<f64>,
}

impl Interval {
    fn weighed(&self, state: &[f64]) -> Vec<f64> {
        let weighed = state.iter().zip(&self.weights);
        weighed.map(|(value, weight)| value * weight).collect()
    }

    /// Returns the defect of each coordinate and rate, as a share of the effect of the load.
    fn defect(&self) -> Vec<f64> {
        self.weighed(&less(&self.reached, &self.flowed))
    }

    fn size(&self) -> f64 {
        let defect = self.defect();
        dot(&defect, &defect).sqrt()
    }
}

/// Intervals of a run with the final states of the run and of the native flow from the same initial states.
pub(super) struct Motion(Vec<Interval>);

impl Motion {
    /// Evaluates the intervals that begin at the samples; `None` if the native flow fails.
    pub(super) fn of(
        gearbox: &Gearbox,
        native: &mut Model<'_>,
        columns: &Columns,
        run: &TimeSeries,
        samples: &[Sample],
    ) -> Option<Self> {
        let strength = strengths(gearbox, native, columns);
        let interval = |sample: &Sample| {
            let (from_s, to_s) = (sample.time_s, run.time_s()[sample.number + 1]);
            let start = columns.at(run, sample.number);
            let length = to_s - from_s;
            let rates = strength.iter().map(|strength| strength / length);
            let places = strength.iter().map(|strength| strength / (length * length));
            Some(Interval {
                from_s,
                to_s,
                weights: places.chain(rates).collect(),
                reached: columns.at(run, sample.number + 1),
                flowed: native.flow(from_s, &start, to_s)?,
                start,
            })
        };
        samples
            .iter()
            .map(interval)
            .collect::<Option<_>>()
            .map(Self)
    }

    /// Returns the motion over about `most` of the intervals.
    pub(super) fn few(&self, most: usize) -> Self {
        let every = self.0.len().div_ceil(most);
        Self(self.0.iter().step_by(every).cloned().collect())
    }

    /// Returns the weighted final states of all intervals, of the run and of the native flow.
    pub(super) fn ends(&self) -> [Vec<f64>; 2] {
        let of = |end: fn(&Interval) -> &Vec<f64>| {
            let each = self.0.iter().map(|of| of.weighed(end(of)));
            each.collect::<Vec<_>>().concat()
        };
        [of(|of| &of.reached), of(|of| &of.flowed)]
    }

    /// Returns the weighted final states of all intervals by a model.
    pub(super) fn flows(&self, model: &mut Model<'_>) -> Option<Vec<f64>> {
        let flow = |of: &Interval| Some(of.weighed(&model.flow(of.from_s, &of.start, of.to_s)?));
        let each: Option<Vec<_>> = self.0.iter().map(flow).collect();
        Some(each?.concat())
    }

    /// Plots equations and integration over the named `coordinates`.
    pub(super) fn pictures(&self, rough: Option<&Self>, coordinates: &[String]) -> Vec<Picture> {
        let times: Vec<f64> = self.0.iter().map(|of| of.from_s).collect();
        let sizes = |of: &Self| of.0.iter().map(|of| vec![of.size()]).collect();
        let (fine, rough): (Vec<_>, Option<Vec<_>>) = (sizes(self), rough.map(sizes));
        let mut runs = vec![("smallest step", &fine[..])];
        runs.extend(rough.iter().map(|rough| ("a larger step", &rough[..])));
        let count = coordinates.len();
        // Pins held by friction have weight 0.
        let weights = self.0.first().map_or(&[][..], |of| &of.weights[..count]);
        let moved: Vec<usize> = (0..weights.len()).filter(|k| weights[*k] > 0.0).collect();
        let names: Vec<String> = moved.iter().map(|k| coordinates[*k].clone()).collect();
        let row = |of: &Interval| {
            let defect = of.defect();
            let both = moved.iter().map(|k| defect[*k].hypot(defect[count + k]));
            both.collect()
        };
        let rows: Vec<Vec<f64>> = self.0.iter().map(row).collect();
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

    /// Returns the root of the mean of a square over all intervals.
    fn mean(&self, square: impl Fn(&Interval) -> f64) -> f64 {
        (self.0.iter().map(square).sum::<f64>() / self.0.len() as f64).sqrt()
    }

    /// Returns the root mean square of the defects.
    pub(super) fn size(&self) -> f64 {
        self.mean(|of| of.size().powi(2))
    }

    /// Returns the defect as a share of the change of the run's own motion, with whose amplitude it grows.
    pub(super) fn share(&self) -> f64 {
        let change = |of: &Interval| {
            let all = of.weighed(&less(&of.flowed, &of.start));
            let rates = &all[all.len() / 2..];
            dot(rates, rates)
        };
        self.size() / self.mean(change)
    }

    /// True if one interval has almost the entire defect.
    pub(super) fn is_alone(&self) -> bool {
        let most = self.0.iter().map(Interval::size).fold(0.0, f64::max);
        most.powi(2) > ALONE * self.0.len() as f64 * self.size().powi(2)
    }

    /// Returns the interval of the largest defect in words.
    fn place(&self) -> String {
        let which = if self.is_alone() { "alone" } else { "most" };
        let most = self.0.iter();
        let most = most.max_by(|a, b| a.size().total_cmp(&b.size()));
        most.map_or_else(String::new, |of| {
            format!("{which} from t = {:.4e} to {:.4e} s", of.from_s, of.to_s)
        })
    }

    /// True if the run's pins keep rates that the native flow changes.
    pub(super) fn keeps_pins(&self) -> bool {
        let turned = |end: fn(&Interval) -> &Vec<f64>| {
            let each = self.0.iter().flat_map(|of| {
                let rates = of.start.len() / 2..of.start.len();
                let pins = rates.filter(|k| of.weights[*k] == 0.0);
                pins.map(|k| (end(of)[k] - of.start[k]).abs())
            });
            each.fold(0.0, f64::max)
        };
        turned(|of| &of.reached) < ROUNDING * turned(|of| &of.flowed)
    }

    /// Judges equations and integration. `rough` has the motion of the run with a larger step, and the factor by which its
    /// defects should fall.
    pub(super) fn judged(&self, rough: Option<(&Self, f64)>) -> [Judged; 2] {
        let size = self.size();
        let Some((rough, falls)) = rough else {
            let note = "needs a run with a smaller step: state [refine]";
            return [Stage::Equations, Stage::Integration]
                .map(|stage| Judged::unknown(stage, note));
        };
        let fell = rough.share() / self.share();
        // An integration error falls at least to half.
        let bound = size * (fell - 1.0).abs() + FLOW;
        let place = self.place();
        let kept = match self.keeps_pins() {
            true => "pins keep their rates, as where friction is not solved, ",
            false => "",
        };
        let equations = Judged::measured(Stage::Equations, size, bound, format!("{kept}{place}"));
        if equations.is_off() && fell < GROWS {
            let note = format!(
                "grows by {:.1} as the step shrinks, as where steps are solved to a loose tolerance, {place}",
                fell.recip()
            );
            return [
                Judged::unknown(Stage::Equations, "hidden by the error of the steps"),
                Judged::measured(Stage::Integration, size, FLOW, note),
            ];
        }
        let bound = (size * fell / falls).max(SMALL);
        let note = format!("falls by {fell:.1} where it should by {falls:.1}, {place}");
        let integration = Judged::measured(Stage::Integration, size, bound, note);
        match equations.is_off() {
            true => [
                equations,
                Judged::unknown(Stage::Integration, "hidden by an earlier stage"),
            ],
            false => [equations, integration],
        }
    }
}

/// Returns the inverse of each coordinate's acceleration by the load, with the masses it moves: s^2, or s^2/m.
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
