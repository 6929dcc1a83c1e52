//! Search for a cause: the one or two changes of the model that explain a residual best.

use std::cmp::Reverse;

use serde::Serialize;

use super::fit::{Fit, dot, fit, less, sizes, slope};
use super::judged::{ROUNDING, SURE, Stage, percent};
use super::model::{Change, Changes, Model, Work};
use super::suspects::{self, Size, Suspect};

/// Likely cause of a difference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cause {
    /// Changes that form the cause: one, or two if none alone explains enough.
    pub parts: Vec<Part>,
    /// Changes of every other cause that explains as much.
    pub others: Vec<Vec<Part>>,
    /// Share of the squared residual that the cause explains.
    pub explained: f64,
    /// Relative L2 distance of the run's forces from a native run, without the cause and with it.
    pub distance: Option<[f64; 2]>,
}

/// Change of the model as part of a cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// Stage that the change affects.
    pub stage: Stage,
    /// Kind in one word: `inertia`, `load`, `friction`, `stiffness`, `damping`, `curvature`, `phase`, `step`, ...
    pub word: &'static str,
    /// Change with its size, in words.
    pub what: String,
    /// Size of the change: factor minus 1, an angle in rad, or 1 for a change that is either present or not.
    pub size: f64,
    /// Error of the size if the entire unexplained residual is due to it.
    pub plus_minus: f64,
}

impl Cause {
    /// Returns the first stage that the cause affects.
    pub fn stage(&self) -> Option<Stage> {
        self.stages().first().copied()
    }

    /// Returns the first affected stage of each equally good cause, the likeliest first.
    pub fn stages(&self) -> Vec<Stage> {
        let first = |parts: &Vec<Part>| parts.iter().map(|part| part.stage).min();
        self.all().filter_map(first).collect()
    }

    /// Iterates over the changes of each equally good cause.
    fn all(&self) -> impl Iterator<Item = &Vec<Part>> {
        std::iter::once(&self.parts).chain(&self.others)
    }

    /// Returns stage and cause in words, with the size.
    pub fn words(&self) -> String {
        let all = |or, of: fn(&Part) -> &str| {
            let each = self.all().map(|parts| {
                let words: Vec<&str> = parts.iter().map(of).collect();
                words.join(" and ")
            });
            either(each, or)
        };
        let explained = percent(self.explained);
        let verb = ["explain", "explains"][usize::from(self.parts.len() == 1)];
        let [comma, open] = match self.others.is_empty() {
            true => ["", ""],
            false => [",", "; what was judged does not tell them apart"],
        };
        let stages = self.stages().into_iter();
        let stages = either(stages.map(|stage| stage.name().to_owned()), " or ");
        let word = all(" or ", |part| part.word);
        let what = all(", or ", |part| &part.what);
        format!("{stages}, likely {word}: {what}{comma} {verb} {explained}{open}")
    }
}

/// Joins alternatives in words; alternatives that differ only in the disc are merged.
fn either(all: impl Iterator<Item = String>, or: &str) -> String {
    let mut merged: Vec<[String; 3]> = Vec::new();
    for one in all {
        let number = one.find("disc ").map_or(one.len(), |at| at + 5);
        let (start, rest) = one.split_at(number);
        let end = rest.trim_start_matches(|c: char| c.is_ascii_digit());
        let disc = &rest[..rest.len() - end.len()];
        let mut alike = merged.iter_mut();
        match alike.find(|it| it[0] == start && it[2] == end) {
            Some([_, discs, _]) if discs.split(" or ").any(|it| it == disc) => {}
            Some([_, discs, _]) => *discs += &format!(" or {disc}"),
            None => merged.push([start, disc, end].map(str::to_owned)),
        }
    }
    let merged: Vec<String> = merged.iter().map(|parts| parts.concat()).collect();
    merged.join(or)
}

/// Cause with the changes of the model that form it.
pub(super) type Explained = (Cause, Vec<Change>);

/// Returns the changes of a cause with their sizes.
pub(super) fn changes((cause, changes): &Explained) -> Changes<'_> {
    let sizes = cause.parts.iter().map(|part| part.size);
    changes.iter().zip(sizes).collect()
}

/// Function that evaluates a model to the values with which a run is compared.
pub(super) type Values<'a> = &'a dyn Fn(&mut Model<'_>) -> Option<Vec<f64>>;

/// Difference of the explained shares below which causes count as equally good. Among these, a sign error or a missing part is
/// the likeliest.
const ALIKE: f64 = 1e-4;
/// Ratio of unexplained shares from which causes are not equally good, unless both leave only rounding errors.
const NEARLY: f64 = 10.0;
const SAME: f64 = 1e-8;
/// Factor on a mass that is left out.
const LIGHTEST: f64 = 1e-9;
/// Margin of the linearly explained share within which other changes are still fitted after an exact one.
const BESIDE: f64 = 0.01;
/// Least linearly explained share of a change that is fitted. The share of a large change is far from its linear one.
const LEAST: f64 = 0.05;
/// Number of changes, and of pairs of changes, that are fitted; ties are fitted too.
const FOLLOWED: usize = 6;
/// Fitted size that counts as 0, as a share of the change's small size.
const NOTHING: f64 = 1e-2;
/// Least ratio of a size to its standard error.
const CLEAR: f64 = 10.0;

/// Fits the suspected changes to the values of a run and of the native model, and returns the best cause that explains at least
/// `least`. Pairs of changes are tried if no single one suffices and the error of the step is known.
pub(super) fn cause(
    work: &Work<'_>,
    [run, native]: [&[f64]; 2],
    least: f64,
    is_asked: fn(&Suspect) -> bool,
    values: Values<'_>,
) -> Option<Explained> {
    let mut suspects = suspects::of(work.gearbox);
    suspects.retain(is_asked);
    let predict = |of: &[usize], sizes: &[f64]| {
        let of = of.iter().map(|k| &suspects[*k].change);
        let changes = of.zip(sizes.iter().copied()).collect();
        values(&mut Model::new(work, changes).filter(|_| work.left() > 0)?)
    };
    let slopes = |k: usize| {
        let near = &mut |sizes: &[f64]| predict(&[k], sizes);
        let slope = slope(suspects[k].limits()[0], native, near)?;
        (dot(&slope, &slope) > 0.0).then_some((k, slope))
    };
    let slopes: Vec<(usize, Vec<f64>)> = (0..suspects.len()).filter_map(slopes).collect();
    let residual = less(run, native);
    let total = dot(&residual, &residual);
    // Share that the changes explain in the linear approximation.
    let share = |of: &[usize]| {
        let views: Vec<&[f64]> = of.iter().map(|k| slopes[*k].1.as_slice()).collect();
        let sizes = sizes(&views, &residual);
        let each = sizes.iter().zip(&views);
        each.map(|([size, _], slope)| size * dot(slope, &residual))
            .sum::<f64>()
            / total
    };
    // Best causes; the likeliest first among equally good ones.
    let best = |sets: Vec<Vec<usize>>, least: f64| {
        let telling = |(of, fit): &(Vec<usize>, Fit)| {
            let each = of.iter().zip(&fit.sizes);
            each.filter(|(k, [size, _])| suspects[**k].size.is_telling(*size))
                .count()
        };
        let sets = sets.into_iter().map(|set| (share(&set), set));
        let mut sets: Vec<_> = sets.filter(|(share, _)| *share > LEAST).collect();
        sets.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let mut enough = LEAST;
        let mut fits: Vec<(Vec<usize>, Fit)> = Vec::new();
        for (number, (share, set)) in sets.into_iter().enumerate() {
            if share < enough {
                break;
            }
            // Ties are fitted together.
            if number + 1 == FOLLOWED {
                enough = enough.max(share - ALIKE);
            }
            let of: Vec<usize> = set.iter().map(|k| slopes[*k].0).collect();
            let limits: Vec<_> = of.iter().map(|k| suspects[*k].limits()).collect();
            let begun = set.iter().map(|k| slopes[*k].1.clone()).collect();
            let near = &mut |sizes: &[f64]| predict(&of, sizes);
            let Some(fit) = fit(run, native, begun, &limits, near) else {
                continue;
            };
            let free = (run.len() as f64).sqrt();
            // One change of a pair may be zero.
            let each = of.into_iter().zip(fit.sizes);
            let (of, sizes): (Vec<usize>, Vec<[f64; 2]>) = each
                .filter(|(k, [size, _])| size.abs() > NOTHING * suspects[*k].limits()[0])
                .unzip();
            let mut each = sizes.iter();
            let is_clear = each.all(|[size, error]| free * size.abs() > CLEAR * error);
            if fit.explained >= least && is_clear {
                let tried = (of, Fit { sizes, ..fit });
                // No other cause explains more or is likelier; equally good ones have about the same linear share.
                if 1.0 - tried.1.explained < ALIKE && telling(&tried) == tried.0.len() {
                    enough = enough.max(share - BESIDE);
                }
                fits.push(tried);
            }
        }
        let each = fits.iter().map(|(_, fit)| fit.explained);
        let most = each.fold(0.0, f64::max);
        // Exact causes are distinguished from almost exact ones.
        let apart = ALIKE.min(SAME + NEARLY * (1.0 - most));
        fits.retain(|(_, fit)| most - fit.explained < apart);
        fits.sort_by_cached_key(|tried| (Reverse(telling(tried)), tried.0.clone()));
        fits.dedup_by(|a, b| a.0 == b.0);
        fits
    };
    let singles = (0..slopes.len()).map(|k| vec![k]);
    let mut fits = best(singles.collect(), least);
    if fits.is_empty() && least != SURE {
        let pairs = (0..slopes.len()).flat_map(|i| (0..i).map(move |j| vec![j, i]));
        fits = best(pairs.collect(), least.max(SURE));
    }
    // If the evaluations ran out, a better cause may not have been fitted.
    let fits = Some(fits).filter(|_| work.left() > 0)?;
    let (first, fit) = fits.first()?;
    let part = |(k, [size, plus_minus]): (&usize, &[f64; 2])| {
        let suspect = &suspects[*k];
        Part {
            stage: suspect.stage,
            word: suspect.cause,
            what: suspect.size.words(&suspect.what, *size, *plus_minus),
            size: *size,
            plus_minus: *plus_minus,
        }
    };
    let parts = |(of, fit): &(Vec<usize>, Fit)| of.iter().zip(&fit.sizes).map(part).collect();
    let mut all = fits.iter().map(parts);
    let cause = Cause {
        parts: all.next()?,
        others: all.collect(),
        explained: fit.explained,
        distance: None,
    };
    let changes = suspects.into_iter().enumerate();
    let changes = changes.filter(|(k, _)| first.contains(k));
    Some((cause, changes.map(|(_, suspect)| suspect.change).collect()))
}

impl Suspect {
    /// Returns a small size, at which the change acts linearly, and the least admissible size.
    fn limits(&self) -> [f64; 2] {
        let small = match self.size {
            Size::Shift(_, small) => small,
            Size::Factor | Size::Switch => 1e-4,
        };
        let least = match self.change {
            Change::Mass(_) => LIGHTEST - 1.0,
            _ => f64::NEG_INFINITY,
        };
        [small, least]
    }
}

impl Size {
    /// True for a typical size of a fault: opposite sign, zero, double, or the other form.
    fn is_telling(self, size: f64) -> bool {
        let known: &[f64] = match self {
            Self::Factor => &[-2.0, -1.0, 1.0],
            Self::Switch => &[1.0],
            _ => &[],
        };
        known.iter().any(|known| (size - known).abs() < 0.02)
    }

    /// Returns the change in words, with its size.
    fn words(self, what: &str, size: f64, plus_minus: f64) -> String {
        let off = plus_minus.max(ROUNDING);
        let telling = self.is_telling(size);
        match self {
            Self::Factor if telling && size < -1.5 => format!("{what} with the other sign"),
            Self::Factor if telling && size < 0.0 => format!("{what}, missing"),
            Self::Factor if telling => format!("{what} twice"),
            Self::Factor => format!("{what} times {:.6} +- {off:.0e}", 1.0 + size),
            Self::Shift(unit, small) => {
                format!(
                    "{what} off by {size:.3e} +- {:.0e}{unit}",
                    plus_minus.max(small)
                )
            }
            Self::Switch if telling => what.to_owned(),
            Self::Switch => format!("{what}, to {:.3} +- {off:.0e}", size),
        }
    }
}
