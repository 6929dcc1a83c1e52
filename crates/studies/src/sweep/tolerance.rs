//! Statistics of a sample: quantiles, sensitivities to each key, and the yield.
//!
//! * **Quantiles** with 95 % intervals between order statistics, for any distribution (W. J. Conover, Practical Nonparametric
//!   Statistics, 1999, section 3.2). The intervals apply to independent points; those of a hypercube or a Sobol sequence are more
//!   uniform, so that the intervals are too wide rather than too narrow.
//! * **Standardised regression coefficients** of the figure over the keys (A. Saltelli et al., Global Sensitivity Analysis, 2008,
//!   section 1.2.5): the change of the figure, in its standard deviations, when a key changes by one of its own. For independent keys
//!   their squares add up to R^2, the share of the figure's variance that a straight line explains.
//! * **First-order Sobol indices**: the share of the figure's variance that the key alone explains, linear or not. They are the
//!   variance of the figure's means over classes of the key (E. Plischke, E. Borgonovo, C. L. Smith, Eur. J. Oper. Res. 226, 2013), less
//!   the variance that as many classes of pure noise have.
//! * **Yield**: share of runs within every limit, with the 95 % interval of C. J. Clopper and E. S. Pearson, Biometrika 26, 1934. A run
//!   without the figure counts as outside its limit.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{Beta, Binomial, ContinuousCDF, DiscreteCDF};

use pinwheel_timeseries::figure::FigureDef;
use pinwheel_timeseries::table::{Table, Values};

use super::results::keeps;
use super::statics::definition;
use super::{Limit, Plan};

/// Confidence of all intervals.
const CONFIDENCE: f64 = 0.95;
const TAIL: f64 = 0.5 * (1.0 - CONFIDENCE);
/// Shares of the quantiles that are reported.
const QUANTILES: [f64; 5] = [0.01, 0.05, 0.5, 0.95, 0.99];
/// Least number of runs in a class, and largest number of classes.
const CLASS: usize = 20;
const CLASSES: usize = 30;

/// Quantile with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantile {
    /// Share of the values below it.
    pub share: f64,
    /// Estimate.
    pub value: f64,
    /// Interval with 95 % confidence; open where the sample has too few points.
    pub interval: [Option<f64>; 2],
}

/// Effect of a key on a figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivity {
    /// Name of the key.
    pub key: String,
    /// Standardised regression coefficient; for a list of values the root of the sum of squares. `None` with too few runs.
    pub coefficient: Option<f64>,
    /// First-order Sobol index; for a list of values their sum. `None` with too few runs.
    pub first_order: Option<f64>,
}

/// Statistics of a figure over the sample.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FigureOfSample {
    /// Definition; its key is the column of the results.
    #[serde(flatten)]
    pub def: FigureDef,
    /// Number of runs with the figure.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
    /// Least and largest.
    pub range: [f64; 2],
    /// Quantiles.
    pub quantiles: Vec<Quantile>,
    /// Share R^2 of the variance that a straight line explains.
    pub linear: Option<f64>,
    /// Effects of the keys, the strongest first.
    pub sensitivities: Vec<Sensitivity>,
}

/// Yield of a sample.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Yield {
    /// Number of runs within all limits.
    pub kept: usize,
    /// Number of all runs.
    pub runs: usize,
    /// Share of runs within all limits.
    pub share: f64,
    /// Interval of the share with 95 % confidence.
    pub interval: [f64; 2],
    /// Share of the runs within each single limit, in the order of the specification.
    pub alone: Vec<f64>,
}

/// Results of the sample for one engine, at one point of the other varied keys.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampleResult {
    /// Name of the engine.
    pub engine: String,
    /// Other varied keys with their values at this point, in words.
    pub varied: Vec<(String, String)>,
    /// Number of runs, finished or not.
    pub runs: usize,
    /// Statistics of the figures that vary.
    pub figures: Vec<FigureOfSample>,
    /// Yield; `None` without a specification.
    #[serde(rename = "yield")]
    pub yielded: Option<Yield>,
}

/// Columns that are figures of a run.
fn is_figure(name: &str, plan: &Plan) -> bool {
    const OTHERS: [&str; 4] = [
        "diverged_at_s",
        "window_from_s",
        "window_to_s",
        "energy_remainder_share",
    ];
    !OTHERS.contains(&name) && !plan.keys().any(|key| key == name)
}

/// Returns the statistics of a sweep's sample from the table of [results](super::results); none without a sample.
pub fn tolerances(plan: &Plan, table: &Table) -> Vec<SampleResult> {
    let Some(sample) = &plan.sweep.sample else {
        return Vec::new();
    };
    let engines = plan.sweep.engines.len();
    // The engine changes fastest, then the sample, which is the last axis.
    let block = engines * sample.points;
    let limits = &plan.sweep.specification;
    let mut all = Vec::new();
    for first in (0..plan.len()).step_by(block) {
        for engine in first..first + engines {
            let rows: Vec<usize> = (engine..first + block).step_by(engines).collect();
            let sampled = |key: &str| sample.keys.iter().any(|(known, _)| known == key);
            let others = plan.keys().zip(plan.values(engine));
            let others = others.filter(|(key, _)| !sampled(key));
            let name = table
                .column("engine")
                .and_then(|all| all.values.words(engine));
            let inputs = inputs(plan, &rows, sampled);
            let columns = table.columns.iter();
            let figures = columns.filter_map(|column| match &column.values {
                Values::Number(values) if is_figure(&column.name, plan) => {
                    let values: Vec<_> = rows.iter().map(|&row| values[row]).collect();
                    figure(&column.name, &values, &inputs)
                }
                _ => None,
            });
            all.push(SampleResult {
                engine: name.unwrap_or_default().to_owned(),
                varied: others
                    .map(|(key, value)| (key.to_owned(), value.to_string()))
                    .collect(),
                runs: rows.len(),
                figures: figures.collect(),
                yielded: (!limits.is_empty()).then(|| yielded(limits, table, &rows)),
            });
        }
    }
    all
}

fn yielded(limits: &[Limit], table: &Table, rows: &[usize]) -> Yield {
    let runs = rows.len();
    let share = |kept: usize| kept as f64 / runs.max(1) as f64;
    let kept = rows.iter().filter(|row| keeps(table, limits, **row));
    let kept = kept.count();
    let alone = limits.iter().map(|limit| {
        let held = |row: &&usize| limit.holds(table.number(&limit.figure, **row));
        share(rows.iter().filter(held).count())
    });
    Yield {
        kept,
        runs,
        share: share(kept),
        interval: clopper_pearson(kept, runs),
        alone: alone.collect(),
    }
}

/// Returns the 95 % interval of a share of which `kept` of `runs` were observed.
pub fn clopper_pearson(kept: usize, runs: usize) -> [f64; 2] {
    let at = |a: usize, b: usize, share: f64| {
        Beta::new(a as f64, b as f64).map_or(f64::NAN, |beta| beta.inverse_cdf(share))
    };
    let low = (kept > 0).then(|| at(kept, runs - kept + 1, TAIL));
    let high = (kept < runs).then(|| at(kept + 1, runs - kept, 1.0 - TAIL));
    [low.unwrap_or(0.0), high.unwrap_or(1.0)]
}

/// Key with its values in all rows; one list for each element if the key is a list.
type Input = (String, Vec<Vec<f64>>);

fn inputs(plan: &Plan, rows: &[usize], sampled: impl Fn(&str) -> bool) -> Vec<Input> {
    let places = plan.keys().enumerate().filter(|(_, key)| sampled(key));
    let input = |(place, key): (usize, &str)| {
        let at = |&row: &usize| plan.values(row)[place].numbers();
        let lists: Vec<Vec<f64>> = rows.iter().map(at).collect();
        let columns = lists.iter().map(Vec::len).min().unwrap_or(0);
        let column = |k: usize| lists.iter().map(|list| list[k]).collect();
        (key.to_owned(), (0..columns).map(column).collect())
    };
    places.map(input).collect()
}

/// Returns the statistics of one figure with its sensitivities to each key; `None` where the figure does not vary.
pub fn figure(name: &str, values: &[Option<f64>], inputs: &[Input]) -> Option<FigureOfSample> {
    let there: Vec<usize> = (0..values.len()).filter(|&k| values[k].is_some()).collect();
    let of: Vec<f64> = values.iter().copied().flatten().collect();
    let [mean, deviation] = moments(&of);
    let mut sorted = of.clone();
    sorted.sort_by(f64::total_cmp);
    let (low, high) = (*sorted.first()?, *sorted.last()?);
    if !(high > low) {
        return None;
    }
    let part = |column: &Vec<f64>| there.iter().map(|&k| column[k]).collect::<Vec<f64>>();
    let columns = inputs.iter().flat_map(|(_, lists)| lists.iter().map(part));
    let columns: Vec<Vec<f64>> = columns.collect();
    let regression = regression(&columns, &of);
    let mut place = 0;
    let sensitivity = |(key, lists): &Input| {
        let own = place..place + lists.len();
        place = own.end;
        let coefficient = regression.as_ref().map(|(all, _)| match &all[own.clone()] {
            [one] => *one,
            several => several.iter().map(|c| c * c).sum::<f64>().sqrt(),
        });
        let indices = columns[own].iter().map(|column| first_order(column, &of));
        Sensitivity {
            key: key.clone(),
            coefficient,
            first_order: indices.sum::<Option<f64>>(),
        }
    };
    let mut sensitivities: Vec<Sensitivity> = inputs.iter().map(sensitivity).collect();
    let size = |s: &Sensitivity| s.coefficient.unwrap_or(0.0).abs();
    sensitivities.sort_by(|a, b| size(b).total_cmp(&size(a)));
    Some(FigureOfSample {
        def: definition(name),
        count: of.len(),
        mean,
        deviation,
        range: [low, high],
        quantiles: QUANTILES.map(|share| quantile(&sorted, share)).to_vec(),
        linear: regression.map(|(_, r2)| r2),
        sensitivities,
    })
}

/// Returns mean and standard deviation.
fn moments(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    [mean, (squares / (count - 1.0)).sqrt()]
}

/// Returns the quantile by linear interpolation between the two neighbouring order statistics.
pub fn quantile(sorted: &[f64], share: f64) -> Quantile {
    let count = sorted.len();
    let at = share * (count - 1) as f64;
    let below = (at as usize).min(count - 1);
    let above = (below + 1).min(count - 1);
    let value = sorted[below] + (at - below as f64) * (sorted[above] - sorted[below]);
    // The rank of the quantile among the order statistics is binomial.
    let interval = Binomial::new(share, count as u64).map_or([None; 2], |places| {
        let low = (places.inverse_cdf(TAIL) as usize).checked_sub(1);
        let high = places.inverse_cdf(1.0 - TAIL) as usize;
        [low.map(|k| sorted[k]), sorted.get(high).copied()]
    });
    Quantile {
        share,
        value,
        interval,
    }
}

/// Returns standardised regression coefficients and R^2; `None` with too few runs, or keys that are collinear.
fn regression(columns: &[Vec<f64>], of: &[f64]) -> Option<(Vec<f64>, f64)> {
    let (runs, keys) = (of.len(), columns.len());
    if runs <= keys + 1 {
        return None;
    }
    let standard = |values: &[f64]| {
        let [mean, deviation] = moments(values);
        let scaled = move |v: &f64| (v - mean) / deviation;
        values.iter().map(scaled).collect::<Vec<f64>>()
    };
    let columns: Vec<Vec<f64>> = columns.iter().map(|column| standard(column)).collect();
    let of = standard(of);
    let product = |a: &[f64], b: &[f64]| {
        let sum: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        sum / (runs - 1) as f64
    };
    let correlations = DMatrix::from_fn(keys, keys, |i, j| product(&columns[i], &columns[j]));
    let with = DVector::from_fn(keys, |i, _| product(&columns[i], &of));
    let slopes = correlations.cholesky()?.solve(&with);
    let explained = slopes.dot(&with);
    let coefficients = slopes.iter().copied().collect();
    explained
        .is_finite()
        .then(|| (coefficients, explained.min(1.0)))
}

/// Returns the first-order Sobol index from classes of one key; `None` with too few runs for three classes.
fn first_order(column: &[f64], of: &[f64]) -> Option<f64> {
    let runs = of.len();
    let classes = (runs / CLASS).min(CLASSES);
    if classes < 3 {
        return None;
    }
    let mut order: Vec<usize> = (0..runs).collect();
    order.sort_by(|&a, &b| column[a].total_cmp(&column[b]));
    let mean = of.iter().sum::<f64>() / runs as f64;
    let total: f64 = of.iter().map(|v| (v - mean) * (v - mean)).sum();
    let apart = |class: usize| {
        let members = &order[class * runs / classes..(class + 1) * runs / classes];
        let sum: f64 = members.iter().map(|&k| of[k] - mean).sum();
        sum * sum / members.len() as f64
    };
    let between: f64 = (0..classes).map(apart).sum();
    // Variance of class means from noise alone.
    let [classes, runs] = [classes as f64, runs as f64];
    let share = between / total;
    Some((share - (1.0 - share) * (classes - 1.0) / (runs - classes)).max(0.0))
}
