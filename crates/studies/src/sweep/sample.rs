//! `[sample]`: keys drawn at random from their distributions.
//!
//! A sample is an additional axis of a sweep; every point is a run with a value of each key. It is planned, resumed and
//! distributed like any other axis, and a seed gives equal runs on every machine.

use pinwheel_files::{Document, FileError, Item, Node, nearest};
use pinwheel_scene::CheckedScene;
use serde::Deserialize;
use statrs::distribution::{ContinuousCDF, Normal};
use toml::Value as Toml;

use super::axis::{Axis, Value};
use super::leaves::leaves;
use crate::rng::Rng;
use crate::sampling::hypercube;

/// Largest number of points of a sample and of keys of a Sobol sequence, the limit of the library's direction numbers.
const MOST_POINTS: usize = 1 << 16;
const MOST_SOBOL: usize = 256;
/// Largest number of values of one key, and of a sample.
const MOST_EACH: usize = 1000;
const MOST_VALUES: usize = 5_000_000;
/// Least share of a normal distribution within its bounds; with less its quantiles lose their digits.
const LEAST_SHARE: f64 = 1e-6;

/// Method of sampling.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Latin hypercube: each key takes one value in each of as many equal parts of its distribution as there are points.
    #[default]
    LatinHypercube,
    /// Sobol sequence, scrambled after Owen: uniform over several keys at once, best for powers of two.
    Sobol,
    /// Independent points.
    Random,
}

/// Distribution of the values of a key.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Distribution {
    /// Mean; the value of the scene if left out. A uniform distribution with two ends does not take one.
    mean: Option<f64>,
    /// Standard deviation of a normal distribution; without it the distribution is uniform.
    deviation: Option<f64>,
    /// Ends of the distribution: none, stated, or equally far on both sides of the mean.
    from: Option<f64>,
    to: Option<f64>,
    plus_minus: Option<f64>,
    /// Number of values of a key that is a list; each is drawn independently.
    each: Option<usize>,
}

/// Table `[sample]` of a sweep.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sample {
    /// Method of sampling.
    #[serde(default)]
    pub method: Method,
    /// Number of points.
    pub points: usize,
    /// Seed of the random numbers.
    #[serde(default = "one")]
    pub seed: u32,
    /// Keys of the scene and the distributions of their values.
    #[serde(skip_deserializing)]
    pub keys: Vec<(String, Distribution)>,
}

fn one() -> u32 {
    1
}

/// Keys of `[sample]` that are no scene keys.
const SETTINGS: [&str; 3] = ["points", "seed", "method"];
/// Keys of a distribution.
pub(super) const DISTRIBUTION: [&str; 6] =
    ["mean", "deviation", "from", "to", "plus_minus", "each"];

const FORMS: &str = "write { from = 0.0, to = 1e-4 }, { mean = 0.05, deviation = 1e-6 }, both together for a truncated normal \
                     distribution, or { plus_minus = 5e-6 } about the scene's own value";

impl Sample {
    /// Reads the table `[sample]`, which begins at `line`.
    pub(super) fn read(
        document: &Document<'_>,
        line: usize,
        entries: &[(String, Item<'_>)],
    ) -> Result<Self, FileError> {
        let is_setting = |key: &str| SETTINGS.contains(&key);
        // Keys first, so that a mistyped key is reported before a missing one.
        let mut keys = Vec::new();
        for (key, item) in leaves(entries, &DISTRIBUTION) {
            if !is_setting(&key) {
                keys.push((key.clone(), Distribution::read(document, &key, item)?));
            }
        }
        let settings = entries.iter().filter(|(key, _)| is_setting(key));
        let settings = Item {
            line,
            text: "",
            node: Node::Table(settings.cloned().collect()),
        };
        let form = "state the number of runs, such as points = 1000; seed and method may follow";
        let dist: Self = document.read("sample", &settings, form)?;
        let columns: usize = keys.iter().map(|(_, of)| of.each.unwrap_or(1)).sum();
        let points = dist.points;
        let (what, remedy) = if !(2..=MOST_POINTS).contains(&points) {
            let what = format!("`points` is no whole number from 2 to {MOST_POINTS}");
            (what, "write points = 1000".to_owned())
        } else if keys.is_empty() {
            let remedy = format!("name an uncertain key, such as gear.backlash_m; {FORMS}");
            ("the sample has no key of the scene".to_owned(), remedy)
        } else if dist.method == Method::Sobol && columns > MOST_SOBOL {
            let what = format!(
                "{columns} values a run are more than the {MOST_SOBOL} of a Sobol sequence"
            );
            (what, "write method = \"latin-hypercube\"".to_owned())
        } else if columns * points > MOST_VALUES {
            let what = format!(
                "{columns} values in each of {points} runs are more than {MOST_VALUES} in all"
            );
            (what, "take fewer points, or fewer keys".to_owned())
        } else {
            return Ok(Self { keys, ..dist });
        };
        Err(document.fault(line, what, remedy))
    }

    /// Returns the sample as an axis; distributions without a mean use the value of `scene`.
    ///
    /// # Errors
    /// Fault with the key.
    pub(super) fn axis(&self, scene: &CheckedScene) -> Result<Axis, String> {
        let mut rng = Rng::new(u64::from(self.seed));
        let mut columns = 0;
        let mut unit = || {
            columns += 1;
            match self.method {
                Method::LatinHypercube => hypercube(&mut rng, self.points),
                Method::Random => (0..self.points).map(|_| rng.share()).collect(),
                Method::Sobol => {
                    let at = |k: usize| sobol_burley::sample(k as u32, columns - 1, self.seed);
                    // Points are on a grid of 2^-24; the middle of a cell is never an end.
                    let middle = |k| f64::from(at(k)) + 0.5_f64.powi(25);
                    (0..self.points).map(middle).collect()
                }
            }
        };
        let mut keys = Vec::new();
        for (key, distribution) in &self.keys {
            let quantiles = distribution.quantiles(key, scene)?;
            let mut column = || unit().into_iter().map(&quantiles).collect::<Vec<f64>>();
            let values = match distribution.each {
                None => column().into_iter().map(Value::Number).collect(),
                Some(count) => {
                    let lists: Vec<Vec<f64>> = (0..count).map(|_| column()).collect();
                    let at = |point: usize| {
                        let list = lists.iter().map(|values| Toml::Float(values[point]));
                        Value::Other(Toml::Array(list.collect()).to_string())
                    };
                    (0..self.points).map(at).collect()
                }
            };
            keys.push((key.clone(), values));
        }
        Ok(Axis { keys })
    }
}

impl Distribution {
    /// Reads the distribution of a key.
    fn read(document: &Document<'_>, key: &str, item: &Item<'_>) -> Result<Self, FileError> {
        if item.node.as_table().is_none() {
            let near = nearest(key, SETTINGS).map(|near| format!("did you mean `{near}`?"));
            let what = format!("`{key}` has no distribution");
            return Err(document.fault(item.line, what, near.unwrap_or_else(|| FORMS.to_owned())));
        }
        let dist: Self = document.read(key, item, FORMS)?;
        let wrong = |what: &str| Err(document.fault(item.line, format!("`{key}`: {what}"), FORMS));
        let widths = [dist.deviation, dist.plus_minus];
        let numbers = [dist.mean, dist.from, dist.to].into_iter().chain(widths);
        if !numbers.flatten().all(f64::is_finite) {
            return wrong("has a value that is no finite number");
        }
        if widths.iter().flatten().any(|x| *x <= 0.0) {
            return wrong("`deviation` or `plus_minus` is not above 0");
        }
        let each = dist.each.unwrap_or(1);
        if !(1..=MOST_EACH).contains(&each) {
            return wrong(&format!("`each` is no whole number from 1 to {MOST_EACH}"));
        }
        let one_end = dist.from.is_some() || dist.to.is_some();
        let both = dist.from.zip(dist.to);
        if both.is_some_and(|(from, to)| from >= to) {
            return wrong("`from` is not below `to`");
        }
        if one_end && dist.plus_minus.is_some() {
            return wrong("`plus_minus` and `from` or `to` are two ways to say one thing");
        }
        match widths {
            [None, None] if dist.mean.is_some() => {
                wrong("has a mean and no `deviation` or `plus_minus`")
            }
            [None, None] if dist.from.is_none() || dist.to.is_none() => {
                wrong("has no `deviation`, and not both `from` and `to`")
            }
            _ => Ok(dist),
        }
    }

    /// Returns the quantile function, from a share above 0 and below 1 to a value.
    fn quantiles(
        &self,
        key: &str,
        scene: &CheckedScene,
    ) -> Result<impl Fn(f64) -> f64 + use<>, String> {
        // Errors of parts that are missing in the scene are 0.
        let none = || key.starts_with("gear.errors.").then_some(0.0);
        let middle = || {
            self.mean.or_else(|| scene.number(key)).or_else(none).ok_or_else(|| {
                format!("sample.{key}: the scene has no number there that its values could be about; give a `mean`, or `from` and `to`")
            })
        };
        let ends = match self.plus_minus {
            Some(half) => {
                let middle = middle()?;
                [Some(middle - half), Some(middle + half)]
            }
            None => [self.from, self.to],
        };
        let shape = match self.deviation {
            None => None,
            Some(deviation) => {
                let mean = middle()?;
                let normal = Normal::new(mean, deviation).map_err(|_| {
                    format!(
                        "sample.{key}: a mean of {mean} with a deviation of {deviation} is no distribution"
                    )
                })?;
                let below = ends[0].map_or(0.0, |x| normal.cdf(x));
                let until = ends[1].map_or(1.0, |x| normal.cdf(x));
                if !(until - below > LEAST_SHARE) {
                    return Err(format!(
                        "sample.{key}: `from` and `to` leave next to nothing of the distribution about {mean}; move them, or the `mean`"
                    ));
                }
                Some((normal, below, until - below))
            }
        };
        let low = ends[0].unwrap_or(f64::NEG_INFINITY);
        let high = ends[1].unwrap_or(f64::INFINITY);
        Ok(move |share: f64| match shape {
            None => low + (high - low) * share,
            // The first share may be 0, which has no quantile.
            Some((normal, below, kept)) => normal
                .inverse_cdf((below + kept * share).max(f64::MIN_POSITIVE))
                .clamp(low, high),
        })
    }
}
