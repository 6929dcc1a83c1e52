//! `[sample]`: keys at random, all of them together.
//!
//! A sample is one more axis of a sweep: every point of it is a run with a value of each key. So it is planned, kept, resumed
//! and shared among machines as any other sweep, and the same seed gives the same runs everywhere.

use statrs::distribution::{ContinuousCDF, Normal};
use toml_edit::{Item, TableLike, Value as Toml};

use pinwheel_scene::{CheckedScene, nearest};

use super::axis::{Axis, Value};
use crate::dice::Dice;
use crate::sampling::hypercube;

/// Points of a sample at most, and keys of a Sobol sequence: what the library's direction numbers reach.
const MOST_POINTS: usize = 1 << 16;
const MOST_SOBOL: usize = 256;
/// Values of one key at most, and of a whole sample.
const MOST_EACH: usize = 1000;
const MOST_VALUES: usize = 5_000_000;
/// Of a normal distribution that its bounds must leave: below that its quantiles lose their digits.
const LEAST_SHARE: f64 = 1e-6;

/// How points are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Every key once in each of as many equal parts of its distribution as there are points.
    LatinHypercube,
    /// A Sobol sequence, scrambled after Owen: also even over several keys at once, best for powers of two.
    Sobol,
    /// Independent of each other.
    Random,
}

const METHODS: [(&str, Method); 3] = [
    ("latin-hypercube", Method::LatinHypercube),
    ("sobol", Method::Sobol),
    ("random", Method::Random),
];

/// How the values of a key are distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distribution {
    /// Middle; the value of the scene if left out. Of no use to a uniform distribution with two ends.
    mean: Option<f64>,
    /// Standard deviation of a normal distribution; without it every value between the ends is as likely.
    deviation: Option<f64>,
    /// Ends: none, from the key itself, or that far on both sides of the middle.
    from: Option<f64>,
    to: Option<f64>,
    plus_minus: Option<f64>,
    /// The key is a list of so many values, each drawn alone.
    each: Option<usize>,
}

/// The `[sample]` of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// How points are spread.
    pub method: Method,
    /// How many there are.
    pub points: usize,
    /// Another one gives other points.
    pub seed: u32,
    /// Keys of the scene and the distributions of their values.
    pub keys: Vec<(String, Distribution)>,
}

/// Where in the file, what, and the remedy.
type Fault = (usize, String, String);

const FORMS: &str = "write { from = 0.0, to = 1e-4 }, { mean = 0.05, deviation = 1e-6 }, both together for a truncated normal \
                     distribution, or { plus_minus = 5e-6 } about the scene's own value";

impl Sample {
    /// Reads the table `[sample]`; `place` gives the byte of a key.
    pub(super) fn of(
        table: &dyn TableLike,
        place: &dyn Fn(&dyn TableLike, &str) -> usize,
    ) -> Result<Self, Fault> {
        let whole = |key: &str, least: i64, most: i64| match table.get(key) {
            None => Ok(None),
            Some(item) => match item.as_integer() {
                Some(x) if (least..=most).contains(&x) => Ok(Some(x)),
                _ => Err((
                    place(table, key),
                    format!("`{key}` is no whole number from {least} to {most}"),
                    format!("write {key} = {}", if key == "seed" { 1 } else { 1000 }),
                )),
            },
        };
        // First: a mistyped key is named before a missing one.
        let mut keys = Vec::new();
        leaves(table, "", place, &mut keys)?;
        let points = whole("points", 2, MOST_POINTS as i64)?.ok_or_else(|| {
            (
                0,
                "the sample has no `points`".to_owned(),
                "say how many runs it takes, such as points = 1000".to_owned(),
            )
        })? as usize;
        let seed = whole("seed", 0, i64::from(u32::MAX))?.unwrap_or(1) as u32;
        let method = match table.get("method") {
            None => Method::LatinHypercube,
            Some(item) => {
                let name = item.as_str().unwrap_or_default();
                let known = METHODS.iter().find(|(known, _)| *known == name);
                known.map(|(_, method)| *method).ok_or_else(|| {
                    (
                        place(table, "method"),
                        "`method` is not understood".to_owned(),
                        "write \"latin-hypercube\", \"sobol\" or \"random\"".to_owned(),
                    )
                })?
            }
        };
        if keys.is_empty() {
            return Err((
                0,
                "the sample has no key of the scene".to_owned(),
                format!("name what is uncertain, such as gear.backlash_m; {FORMS}"),
            ));
        }
        let columns: usize = keys.iter().map(|(_, of)| of.each.unwrap_or(1)).sum();
        if method == Method::Sobol && columns > MOST_SOBOL {
            return Err((
                0,
                format!(
                    "{columns} values a run are more than the {MOST_SOBOL} of a Sobol sequence"
                ),
                "write method = \"latin-hypercube\"".to_owned(),
            ));
        }
        if columns * points > MOST_VALUES {
            return Err((
                0,
                format!(
                    "{columns} values in each of {points} runs are more than {MOST_VALUES} in all"
                ),
                "take fewer points, or fewer keys".to_owned(),
            ));
        }
        Ok(Self {
            method,
            points,
            seed,
            keys,
        })
    }

    /// The sample as an axis; `scene` has the values that distributions are about where they say no mean.
    ///
    /// # Errors
    /// Names the key.
    pub(super) fn axis(&self, scene: &CheckedScene) -> Result<Axis, String> {
        let mut dice = Dice::new(u64::from(self.seed));
        let mut columns = 0;
        let mut unit = || {
            columns += 1;
            match self.method {
                Method::LatinHypercube => hypercube(&mut dice, self.points),
                Method::Random => (0..self.points).map(|_| dice.share()).collect(),
                Method::Sobol => (0..self.points)
                    .map(|k| {
                        // Points lie on a grid of 2^-24: the middle of their cell is never an end.
                        let at = sobol_burley::sample(k as u32, columns - 1, self.seed);
                        f64::from(at) + 0.5_f64.powi(25)
                    })
                    .collect::<Vec<f64>>(),
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
                    (0..self.points)
                        .map(|point| {
                            let list = lists.iter().map(|values| values[point]);
                            Value::Other(Toml::Array(list.collect()).to_string())
                        })
                        .collect()
                }
            };
            keys.push((key.clone(), values));
        }
        Ok(Axis { keys })
    }
}

/// Keys of the scene below `table`, with their distributions.
fn leaves(
    table: &dyn TableLike,
    prefix: &str,
    place: &dyn Fn(&dyn TableLike, &str) -> usize,
    found: &mut Vec<(String, Distribution)>,
) -> Result<(), Fault> {
    for (name, item) in table.iter() {
        let key = format!("{prefix}{name}");
        if ["points", "seed", "method"].contains(&key.as_str()) {
            continue;
        }
        let at = place(table, name);
        let Some(inner) = item.as_table_like() else {
            let (what, remedy) = match nearest(&key, ["points", "seed", "method"]) {
                Some(near) if !key.contains('.') => (
                    format!("`{key}` is no key of a sample"),
                    format!("did you mean `{near}`?"),
                ),
                _ => (format!("`{key}` has no distribution"), FORMS.to_owned()),
            };
            return Err((at, what, remedy));
        };
        if inner
            .iter()
            .any(|(name, _)| Distribution::KEYS.contains(&name))
        {
            let read = Distribution::of(inner);
            let of = read.map_err(|what| (at, format!("`{key}`: {what}"), FORMS.to_owned()))?;
            found.push((key, of));
        } else {
            leaves(inner, &format!("{key}."), place, found)?;
        }
    }
    Ok(())
}

/// A value that is no finite number.
pub(super) struct NotFinite;

/// The number of an item.
pub(super) fn finite(item: &Item) -> Result<f64, NotFinite> {
    let whole = || item.as_integer().map(|x| x as f64);
    let number = item.as_float().or_else(whole);
    number.filter(|x| x.is_finite()).ok_or(NotFinite)
}

impl Distribution {
    const KEYS: [&str; 6] = ["mean", "deviation", "from", "to", "plus_minus", "each"];

    fn of(table: &dyn TableLike) -> Result<Self, String> {
        for (key, _) in table.iter() {
            if !Self::KEYS.contains(&key) {
                return Err(format!("`{key}` is no key of a distribution"));
            }
        }
        let number = |key: &str| {
            let number = table.get(key).map(finite).transpose();
            number.map_err(|NotFinite| format!("`{key}` is no finite number"))
        };
        let above_0 = |key: &str| match number(key)? {
            Some(x) if x <= 0.0 => Err(format!("`{key}` is not above 0")),
            x => Ok(x),
        };
        let each = match table.get("each").map(|item| item.as_integer()) {
            None => None,
            Some(Some(x)) if (1..=MOST_EACH as i64).contains(&x) => Some(x as usize),
            Some(_) => {
                return Err(format!("`each` is no whole number from 1 to {MOST_EACH}"));
            }
        };
        let found = Self {
            mean: number("mean")?,
            deviation: above_0("deviation")?,
            from: number("from")?,
            to: number("to")?,
            plus_minus: above_0("plus_minus")?,
            each,
        };
        let one_end = found.from.is_some() || found.to.is_some();
        if let (Some(from), Some(to)) = (found.from, found.to)
            && from >= to
        {
            return Err("`from` is not below `to`".to_owned());
        }
        if one_end && found.plus_minus.is_some() {
            return Err("`plus_minus` and `from` or `to` are two ways to say one thing".to_owned());
        }
        match (found.deviation, found.plus_minus) {
            (None, None) if found.mean.is_some() => {
                Err("has a mean and no `deviation` or `plus_minus`".to_owned())
            }
            (None, None) if found.from.is_none() || found.to.is_none() => {
                Err("has no `deviation`, and not both `from` and `to`".to_owned())
            }
            _ => Ok(found),
        }
    }

    /// The quantile function: from a share, above 0 and below 1, to a value.
    fn quantiles(
        &self,
        key: &str,
        scene: &CheckedScene,
    ) -> Result<impl Fn(f64) -> f64 + use<>, String> {
        // What is left out of the errors is none.
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
                let wrong = || {
                    format!(
                        "sample.{key}: a mean of {mean} with a deviation of {deviation} is no distribution"
                    )
                };
                let normal = Normal::new(mean, deviation).map_err(|_| wrong())?;
                let [below, until] = [
                    ends[0].map_or(0.0, |x| normal.cdf(x)),
                    ends[1].map_or(1.0, |x| normal.cdf(x)),
                ];
                if !(until - below > LEAST_SHARE) {
                    return Err(format!(
                        "sample.{key}: `from` and `to` leave next to nothing of the distribution about {mean}; move them, or the `mean`"
                    ));
                }
                Some((normal, below, until - below))
            }
        };
        let [low, high] = [
            ends[0].unwrap_or(f64::NEG_INFINITY),
            ends[1].unwrap_or(f64::INFINITY),
        ];
        Ok(move |share: f64| match shape {
            None => low + (high - low) * share,
            // A first share may be 0, which has no quantile.
            Some((normal, below, kept)) => normal
                .inverse_cdf((below + kept * share).max(f64::MIN_POSITIVE))
                .clamp(low, high),
        })
    }
}
